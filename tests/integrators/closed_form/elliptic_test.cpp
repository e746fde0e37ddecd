// Elliptic functions against Boost.Math and against identities.
#include "integrators/closed_form/elliptic.h"

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_rf.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>

#include "integrators/series/real.h"

namespace polhode {
namespace {

using Real50 = Real<50>;

double near(const Real50& a, const Real50& b) { return Real50(abs(Real50(a - b)) / (1 + abs(b))).convert_to<double>(); }

// parameters on both sides of the switch between lattices, and close to both ends
constexpr const char* parameters[] = {"0.75", "1e-30", "1e-9", "0.1", "0.4999", "0.5001", "0.9", "0.999999999"};

TEST(ArithmeticGeometricMean, GivesTheCompleteIntegral) {
    for (const char* text : parameters) {
        const Real50 m(text);
        const Lattice<Real50> lattice(m, Real50(1 - m));
        EXPECT_LT(near(lattice.quarter, boost::math::ellint_1(Real50(sqrt(m)))), 1e-47) << text;
        // 1 - m loses digits of a small m
        const double lost = m.convert_to<double>();
        EXPECT_LT(near(lattice.imaginary_quarter, boost::math::ellint_1(Real50(sqrt(Real50(1 - m))))), 1e-48 / lost)
            << text;
    }
    // Gauss's constant 1/agm(1, sqrt 2) (OEIS A014549)
    EXPECT_NEAR(1 / arithmetic_geometric_mean(1.0, std::sqrt(2.0)), 0.83462684167407318628, 2e-16);
}

TEST(CarlsonRf, AgreesWithBoostAndScales) {
    const double values[] = {0, 1e-12, 0.3, 1, 2.5, 1e8};
    for (const double x : values)
        for (const double y : values)
            for (const double z : values) {
                if ((x == 0) + (y == 0) + (z == 0) > 1) continue;
                const Real50 expected = boost::math::ellint_rf(Real50(x), Real50(y), Real50(z));
                EXPECT_LT(near(carlson_rf(Real50(x), Real50(y), Real50(z)), expected), 1e-47);
                const double relative = carlson_rf(x, y, z) / expected.convert_to<double>() - 1;
                EXPECT_LT(std::abs(relative), 6e-16) << x << ' ' << y << ' ' << z;
                // homogeneous of degree -1/2
                EXPECT_DOUBLE_EQ(carlson_rf(4 * x, 4 * y, 4 * z), carlson_rf(x, y, z) / 2);
            }
}

TEST(Lattice, GivesJacobisFunctions) {
    for (const char* text : parameters) {
        const Real50 m(text);
        const Lattice<Real50> lattice(m, Real50(1 - m));
        for (int k = -8; k <= 8; ++k) {
            const Real50 u = lattice.quarter * k / 8;
            Harmonics<Real50> h;
            lattice.harmonics<true>(u, h);
            const Jacobi<Real50> f = lattice.jacobi(h);
            Real50 cn, dn;
            const Real50 sn = boost::math::jacobi_elliptic(Real50(sqrt(m)), u, &cn, &dn);
            EXPECT_LT(near(f.sn, sn), 1e-45) << text << ' ' << k;
            EXPECT_LT(near(f.cn, cn), 1e-45) << text << ' ' << k;
            // Boost computes dn as a quotient by cn, which vanishes at the ends
            EXPECT_LT(near(f.dn, Real50(sqrt(Real50(1 - m * sn * sn)))), 1e-45) << text << ' ' << k;
        }
    }
}

TEST(Lattice, InBinary64KeepsSquaresAtOne) {
    for (int e = 0; e <= 300; e += 3) {
        const double m1 = std::pow(10, -e) * 0.7;
        for (const bool swapped : {false, true}) {
            const Lattice<double> lattice(swapped ? m1 : 1 - m1, swapped ? 1 - m1 : m1);
            const double edge = lattice.quarter;
            for (int k = -16; k <= 16; ++k) {
                Harmonics<double> h{};
                lattice.harmonics<false>(edge * k / 16, h);
                const Jacobi<double> f = lattice.jacobi(h);
                ASSERT_NEAR(f.sn * f.sn + f.cn * f.cn, 1, 2e-15) << m1 << ' ' << k;
                ASSERT_NEAR(f.dn * f.dn + (swapped ? m1 : 1 - m1) * f.sn * f.sn, 1, 2e-15) << m1 << ' ' << k;
            }
        }
    }
}

// theta' / theta of the series agrees with differences, in both lattices
TEST(ShiftedTheta, HasTheDerivativeItSays) {
    using Kind = ShiftedTheta<Real50>::Kind;
    for (const char* text : parameters)
        for (const Kind kind : {Kind::theta1, Kind::theta2}) {
            const Real50 m(text), step("1e-15");
            const Lattice<Real50> lattice(m, Real50(1 - m));
            const ShiftedTheta<Real50> theta(lattice, kind, Real50(lattice.imaginary_quarter / 3));
            const auto at = [&](const Real50& u) {
                Harmonics<Real50> h;
                lattice.harmonics<true>(u, h);
                // all harmonics have a common scale factor, which quotients by the real theta_4 cancel
                const Complex<Real50> sum = theta.sum(h);
                const Real50 down = lattice.denominator(h);
                return Complex<Real50>{Real50(sum.re / down), Real50(sum.im / down)};
            };
            const Real50 u = lattice.quarter / 5;
            Harmonics<Real50> h;
            lattice.harmonics<true>(u, h);
            const Complex<Real50> sum = theta.sum(h), slope = theta.derivative(h);
            const Real50 down = lattice.denominator(h), down_slope = lattice.denominator_slope(h);
            const Complex<Real50> before = at(Real50(u - step)), after = at(Real50(u + step));
            const Real50 scale = lattice.scale;
            const Real50 re = scale * (slope.re * down - sum.re * down_slope) / (down * down);
            const Real50 im = scale * (slope.im * down - sum.im * down_slope) / (down * down);
            EXPECT_LT(near(Real50((after.re - before.re) / (2 * step)), re), 1e-25) << text;
            EXPECT_LT(near(Real50((after.im - before.im) / (2 * step)), im), 1e-25) << text;
        }
}

}  // namespace
}  // namespace polhode
