// The truth of built-in scenes against closed forms evaluated in 100 digits. This test contains no integration.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "whole/truth_values.h"

namespace polhode {
namespace {

// 25 digits are promised, relative to the size of each block
constexpr double promised = 1e-24;

double distance(const Vector3<Real100>& a, const Vector3<Real100>& b) { return length(a - b).convert_to<double>(); }
double distance(const Quaternion<Real100>& a, const Quaternion<Real100>& b) {
    return square_root(squared_norm(Quaternion<Real100>{a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z}))
        .convert_to<double>();
}
Vector3<Real100> unit(int axis) {
    Vector3<Real100> e;
    e[axis] = 1;
    return e;
}
// unit quaternion of a rotation by `angle` about the unit vector `axis`
Quaternion<Real100> turn(const Vector3<Real100>& axis, const Real100& angle) {
    const Real100 s = sin(Real100(angle / 2));
    return {cos(Real100(angle / 2)), s * axis[0], s * axis[1], s * axis[2]};
}

TEST(ClosedForms, Separatrix) {
    const Reference truth = fresh_truth(find_scene("separatrix"), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const Real100 root = sqrt(Real100(2));
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 u = Real100(sample.t) / root, sech = 1 / cosh(u);
        EXPECT_LT(distance(value(sample.angular_velocity_B), {2 * sech, 3 / root * tanh(u), sech}), promised);
    }
}

// A free asymmetric body with zero initial rate about its middle axis, in Jacobi's functions (Landau & Lifshitz 1976,
// section 37). The rate about the axis that the motion encircles is dn, that about the other outer axis cn, and that
// about the middle axis sn.
struct FreeRates {
    int round, other;
    Real100 p, k, middle;
    Vector3<Real100> start;

    Vector3<Real100> at(const Real100& t) const {
        Real100 cn, dn;
        const Real100 sn = boost::math::jacobi_elliptic(k, Real100(p * t), &cn, &dn);
        Vector3<Real100> w;
        w[round] = start[round] * dn, w[other] = start[other] * cn, w[1] = middle * sn;
        return w;
    }
};
FreeRates free_rates(const Scene& scene) {
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const Vector3<Real100> w = body.angular_velocity_B,
                           I(body.inertia_B[0][0], body.inertia_B[1][1], body.inertia_B[2][2]);
    Real100 E2 = 0, L2 = 0;
    for (int i = 0; i < 3; ++i) E2 += I[i] * w[i] * w[i], L2 += I[i] * I[i] * w[i] * w[i];
    const int largest = I[0] > I[2] ? 0 : 2;
    const int c = L2 > E2 * I[1] ? largest : 2 - largest, a = 2 - c;
    // c is the encircled axis and a the other outer one; both differences have the same sign
    const Real100 outer = (I[c] - I[1]) * (L2 - E2 * I[a]), inner = (I[1] - I[a]) * (E2 * I[c] - L2);
    const Real100 amplitude = sqrt(Real100((E2 * I[c] - L2) / (I[1] * (I[c] - I[1]))));
    const bool up = (I[2] - I[0]) * w[2] * w[0] > 0;
    return {c,
            a,
            sqrt(Real100(outer / (I[0] * I[1] * I[2]))),
            sqrt(Real100(inner / outer)),
            up ? amplitude : Real100(-amplitude),
            w};
}

class FreeAsymmetric : public ::testing::TestWithParam<const char*> {};
TEST_P(FreeAsymmetric, FollowsJacobisFunctions) {
    const Scene scene = find_scene(GetParam());
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const FreeRates rates = free_rates(scene);
    const double scale = length(rates.start).convert_to<double>();
    for (const ReferenceSample& sample : truth.samples)
        EXPECT_LT(distance(value(sample.angular_velocity_B), rates.at(Real100(sample.t))), promised * scale)
            << sample.t;
}
INSTANTIATE_TEST_SUITE_P(Scenes, FreeAsymmetric, ::testing::Values("near_separatrix", "toutatis"));

TEST(ClosedForms, ToutatisHasThePublishedPeriods) {
    // Hudson & Ostro 1995: 5.41 days about the long axis and on average 7.35 days for that axis about L. After one
    // period of the rates the body has the same rates and has rotated about L by 2 pi 5.41 / 7.35.
    const Scene scene = find_scene("toutatis");
    const FreeRates rates = free_rates(scene);
    EXPECT_EQ(rates.round, 2) << "not a long-axis mode";
    const double period = Real100(4 * boost::math::ellint_1(rates.k) / rates.p).convert_to<double>();
    EXPECT_NEAR(period / 86400 / 5.41, 1, 1e-7);
    Scene one_period = scene;
    one_period.duration = period;
    const Reference truth = fresh_truth(one_period, 1);
    ASSERT_TRUE(truth.available) << truth.message;
    const Quaternion<Real100> q = value(truth.samples[1].q);
    const Vector3<Real100> L = value(truth.samples[0].angular_momentum_W), axis = (1 / length(L)) * L;
    // the rotation is about L alone, up to the rounding of the period
    const Real100 cosine = q.w, sine = dot(vector_part(q), axis);
    EXPECT_NEAR(Real100(cosine * cosine + sine * sine).convert_to<double>(), 1, 1e-15);
    double angle = Real100(2 * atan2(sine, cosine)).convert_to<double>();
    if (angle < 0) angle += 2 * std::numbers::pi;
    EXPECT_NEAR(angle / (2 * std::numbers::pi) * 7.35 / 5.41, 1, 1e-7);
}

class FreeSymmetric : public ::testing::TestWithParam<std::pair<const char*, int>> {};
TEST_P(FreeSymmetric, PrecessesRegularly) {
    // about L by |L| t / I1 after about the body's axis by (1 - I3/I1) w3 t (Landau & Lifshitz 1976, section 33)
    const auto [name, axis] = GetParam();
    const Scene scene = find_scene(name);
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const int across = (axis + 1) % 3;
    const Real100 I1 = body.inertia_B[across][across], I3 = body.inertia_B[axis][axis];
    ASSERT_EQ(gap(body.inertia_B[(axis + 2) % 3][(axis + 2) % 3], I1), 0);
    const Vector3<Real100> L_W = rotate(body.q, body.inertia_B * body.angular_velocity_B);
    const Real100 size = length(L_W);
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 t(sample.t);
        const Quaternion<Real100> q = turn((1 / size) * L_W, Real100(size * t / I1)) * body.q *
                                      turn(unit(axis), Real100((1 - I3 / I1) * body.angular_velocity_B[axis] * t));
        EXPECT_LT(distance(value(sample.q), q), promised) << sample.t;
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, FreeSymmetric,
                         ::testing::Values(std::pair("feynman_plate", 2), std::pair("explorer_1", 2),
                                           std::pair("nanodumbbell", 0), std::pair("symmetric", 2)));

// Lagrange's top whose axis starts at rest or moves horizontally: u = cos(tilt) satisfies u'^2 = f(u), a cubic with the
// root u(0), and oscillates between two of its roots u1 < u2 < u3, u1 + (u2 - u1) sn^2 (Goldstein 1980, section 5-7).
struct Nutation {
    Real100 u1, u2, u3, speed, k;
    bool from_above;

    Real100 at(const Real100& t) const {
        Real100 cn, dn;
        const Real100 sn = boost::math::jacobi_elliptic(k, Real100(speed * t), &cn, &dn);
        // a quarter period later sn becomes cn / dn
        const Real100 swing = from_above ? Real100(cn / dn) : sn;
        return u1 + (u2 - u1) * swing * swing;
    }
};
Nutation nutation(const Scene& scene, int axis) {
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const Vector3<Real100> e = unit(axis), w = body.angular_velocity_B;
    const int across = (axis + 1) % 3;
    const Real100 I1 = body.inertia_B[across][across], I3 = body.inertia_B[axis][axis];
    const Real100 weight = -body.mass * Real100(std::get<Gravity>(scene.loads.at(0)).acceleration_W[2]);
    const Real100 u0 = rotate(body.q, e)[2], mgl = weight * body.arm[axis];
    const Real100 a = I3 * w[axis] / I1, b = rotate(body.q, body.inertia_B * w)[2] / I1, beta = 2 * mgl / I1;
    const Vector3<Real100> level = w - w[axis] * e;
    const Real100 alpha = dot(level, level) + beta * u0;
    // f = (alpha - beta u)(1 - u^2) - (b - a u)^2, divided by u - u0
    const Real100 half = (beta * u0 - alpha - a * a) / (2 * beta);
    const Real100 product = (2 * a * b - beta + 2 * beta * half * u0) / beta;
    const Real100 root = sqrt(Real100(half * half - product));
    std::array<Real100, 3> roots{u0, Real100(-half - root), Real100(-half + root)};
    std::sort(roots.begin(), roots.end());
    return {roots[0],
            roots[1],
            roots[2],
            Real100(sqrt(Real100(beta * (roots[2] - roots[0]))) / 2),
            sqrt(Real100((roots[1] - roots[0]) / (roots[2] - roots[0]))),
            u0 == roots[1]};
}

class LagrangesTop : public ::testing::TestWithParam<std::pair<const char*, int>> {};
TEST_P(LagrangesTop, NutatesByJacobisFunctions) {
    const auto [name, axis] = GetParam();
    const Scene scene = shortened(name, std::min(find_scene(name).duration, 8.0));
    const Reference truth = fresh_truth(scene, 24);
    ASSERT_TRUE(truth.available) << truth.message;
    const Nutation top = nutation(scene, axis);
    EXPECT_GT(top.u3.convert_to<double>(), 1);
    double lowest = 1, highest = -1;
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 u = rotate(value(sample.q), unit(axis))[2];
        EXPECT_LT(gap(u, top.at(Real100(sample.t))), promised) << sample.t;
        lowest = std::min(lowest, u.convert_to<double>()), highest = std::max(highest, u.convert_to<double>());
    }
    // the samples cover most of the oscillation
    EXPECT_GT(highest - lowest, 0.5 * Real100(top.u2 - top.u1).convert_to<double>());
}
INSTANTIATE_TEST_SUITE_P(Scenes, LagrangesTop,
                         ::testing::Values(std::pair("lagrange_top", 2), std::pair("looping_top", 2),
                                           std::pair("slow_top", 2), std::pair("sleeping_top", 2),
                                           std::pair("simo_wong_top", 2), std::pair("bruls_top", 1)));

TEST(ClosedForms, CompoundPendulum) {
    // sin(angle / 2) = k cd(t sqrt(m g l / I), k), where k is its value at the start from rest
    const Scene scene = find_scene("compound_pendulum");
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const Real100 k = body.q.y, speed = sqrt(Real100(body.mass * Real100(9.81) / 2 / body.inertia_B[1][1]));
    for (const ReferenceSample& sample : truth.samples) {
        Real100 cn, dn;
        boost::math::jacobi_elliptic(k, Real100(speed * Real100(sample.t)), &cn, &dn);
        EXPECT_LT(gap(abs(value(sample.q.y)), abs(Real100(k * cn / dn))), promised) << sample.t;
        EXPECT_EQ(sample.q.x.high, 0);
        EXPECT_EQ(sample.q.z.high, 0);
    }
}

TEST(ClosedForms, StruckBarTurnsAboutItsCentreOfPercussion) {
    const Reference truth = fresh_truth(find_scene("struck_bar"), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 after = Real100(std::max(0.0, sample.t - 1));
        const bool struck = sample.t >= 1;
        EXPECT_LT(distance(value(sample.angular_velocity_B), {Real100(0), Real100(struck ? -1 : 0), Real100(0)}),
                  promised);
        EXPECT_LT(distance(value(sample.velocity_W), {Real100(0), Real100(0), Real100(struck ? 0.5 : 0)}), promised);
        EXPECT_LT(distance(value(sample.position_W), {Real100(0), Real100(0), Real100(after / 2)}), 10 * promised);
        EXPECT_LT(distance(value(sample.q), turn(unit(1), Real100(-after))), promised);
        if (sample.t != 1) continue;
        const Vector3<Real100> end(Real100(-0.5), Real100(0), Real100(0));
        const Vector3<Real100> speed = value(sample.velocity_W) + cross(value(sample.angular_velocity_B), end);
        EXPECT_LT(distance(speed, {}), promised);
    }
}

TEST(ClosedForms, StokesSphereRelaxesExponentially) {
    const Scene scene = find_scene("stokes_sphere");
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const Drag& drag = std::get<Drag>(scene.loads.at(2));
    const Real100 rate = Real100(drag.translational) / body.mass,
                  turning = Real100(drag.rotational[0]) / body.inertia_B[0][0];
    const Real100 pull = Real100(std::get<Gravity>(scene.loads.at(0)).acceleration_W[2]) +
                         Real100(std::get<Force>(scene.loads.at(1)).vector[2]) / body.mass;
    const Vector3<Real100> sinking(Real100(0), Real100(0), Real100(pull / rate));
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 t(sample.t), left = exp(Real100(-rate * t));
        const Vector3<Real100> velocity = sinking + left * (body.velocity_W - sinking);
        const Vector3<Real100> position = t * sinking + Real100((1 - left) / rate) * (body.velocity_W - sinking);
        EXPECT_LT(distance(value(sample.velocity_W), velocity), promised);
        EXPECT_LT(distance(value(sample.position_W), position), promised);
        EXPECT_LT(
            distance(value(sample.angular_velocity_B), Real100(exp(Real100(-turning * t))) * body.angular_velocity_B),
            60 * promised);
    }
    EXPECT_NEAR(truth.samples.back().velocity_W[2].high, -0.063, 5e-4);
}

TEST(ClosedForms, EarthsPoleGoesRoundInEulersPeriod) {
    // period of the small wobble: 2 pi / (w3 sqrt((C - A)(C - B) / (A B))), with an error of the order of its
    // amplitude squared, 1e-12
    const Scene scene = find_scene("earth_wobble");
    const ExactBody<Real100> body = exact_body<Real100>(scene);
    const Real100 A = body.inertia_B[0][0], B = body.inertia_B[1][1], C = body.inertia_B[2][2];
    const Real100 pace = body.angular_velocity_B[2] * sqrt(Real100((C - A) * (C - B) / (A * B)));
    EXPECT_NEAR(Real100(2 * boost::math::constants::pi<Real100>() / pace / 86400).convert_to<double>(), 304, 0.5);
    const Reference truth = fresh_truth(shortened("earth_wobble", 2592000), 6);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples) {
        const Real100 wobble = body.angular_velocity_B[0] * cos(Real100(pace * Real100(sample.t)));
        EXPECT_NEAR(Real100(value(sample.angular_velocity_B[0]) / body.angular_velocity_B[0]).convert_to<double>(),
                    Real100(wobble / body.angular_velocity_B[0]).convert_to<double>(), 1e-11);
    }
}

}  // namespace
}  // namespace polhode
