#include "integrators/closed_form/lagrange_top.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "integrators/closed_form/free_motion.h"

namespace polhode {
namespace {

using testing::FreeMotion, testing::ulp;

struct Top {
    double I1, I3;
    Vector3<double> field_W;
    FreeMotion motion;  // its moments are not used

    Rotation<double> at(const FreeMotion& m) const {
        const LagrangeStart<Wide> start(2, I1, I3, cast<Wide>(field_W), cast<Wide>(m.w), cast<Wide>(m.q));
        return LagrangeTop<double>(LagrangeStart<double>(start), m.q).at(m.t);
    }
};

// fast and slow spin, hanging and upright, with and without initial nutation, and nearly upright
Top any_top() {
    Top top;
    top.I1 = testing::moderate(0.3, 2.5), top.I3 = testing::moderate(0.3, 2.5);
    top.field_W = 2.0 * testing::moderate_vector();
    if (testing::size(top.field_W) < 0.1) top.field_W = {0, 0, -1};
    FreeMotion& m = top.motion;
    m.w = testing::moderate_vector();
    if (*rc::gen::inRange(0, 2) == 0) m.w[2] *= 20;
    m.q = testing::moderate_orientation();
    m.t = testing::moderate(-6, 6);
    if (*rc::gen::inRange(0, 3) == 0) {
        top.field_W = {0, 0, -testing::moderate(0.1, 4)};
        m.q = normalized(Quaternion<double>{1, testing::moderate(-1, 1) * testing::small(9), 0, 0});
        m.w = {0, 0, m.w[2]};
    }
    return top;
}

// dw/dt with the torque e3 x R^T G
struct TopEquations {
    double I1, I3;
    Vector3<double> field_W;
    template <class S>
    void derivative(const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Vector3<S> G = rotate_back(q, field_W);
        const double c = (I1 - I3) / I1;
        put(dy, 0, Vector3<S>{c * (w[1] * w[2]) - (1 / I1) * G[1], (1 / I1) * G[0] - c * (w[0] * w[2]), S(0)});
        put(dy, 3, attitude_rate(0.5, q, w));
    }
};

RC_GTEST_PROP(LagrangeTop, AgreesWithTaylorSeries, ()) {
    for (int i = 0; i < 100; ++i) {
        const Top top = any_top();
        const FreeMotion& m = top.motion;
        const double rate = testing::size(m.w) + std::sqrt(testing::size(top.field_W) / top.I1) + 1;
        const Rotation<double> end = top.at(m);
        int steps = 0;
        const auto y = testing::by_taylor(TopEquations{top.I1, top.I3, top.field_W}, m, steps);
        const double bound = testing::amplified([&](const FreeMotion& n) { return top.at(n); }, m, 20 * ulp) *
                                 (1 + std::sqrt(steps)) * (1 + rate / (testing::size(m.w) + 1e-3)) +
                             steps * 10 * ulp;
        RC_ASSERT(testing::distance(end.q, quaternion_at(y.data(), 3)) <= bound);
        RC_ASSERT(testing::size(end.w - vector_at(y.data(), 0)) <= bound * (rate + testing::size(m.w)));
    }
}

RC_GTEST_PROP(LagrangeTop, KeepsEnergyAndBothMomenta, ()) {
    for (int i = 0; i < 100; ++i) {
        const Top top = any_top();
        const FreeMotion& m = top.motion;
        const Rotation<double> end = top.at(m);
        const auto energy = [&](const Vector3<double>& w, const Quaternion<double>& q) {
            return (top.I1 * (w[0] * w[0] + w[1] * w[1]) + top.I3 * w[2] * w[2]) / 2 -
                   dot(top.field_W, rotate(q, Vector3<double>(0, 0, 1)));
        };
        const auto upright = [&](const Vector3<double>& w, const Quaternion<double>& q) {
            return dot(top.field_W, rotate(q, Vector3<double>(top.I1 * w[0], top.I1 * w[1], top.I3 * w[2])));
        };
        const double G = testing::size(top.field_W), w = testing::size(m.w) + std::sqrt(G / top.I1);
        RC_ASSERT(std::abs(energy(end.w, end.q) - energy(m.w, m.q)) <= 400 * ulp * 3 * w * w);
        RC_ASSERT(std::abs(upright(end.w, end.q) - upright(m.w, m.q)) <= 400 * ulp * 3 * w * G);
        RC_ASSERT(end.w[2] == m.w[2]);
        RC_ASSERT(std::abs(squared_norm(end.q) - 1) <= 4 * ulp);
    }
}

RC_GTEST_PROP(LagrangeTop, RunsBackwardsAndGoesOn, ()) {
    for (int i = 0; i < 100; ++i) {
        const Top top = any_top();
        const FreeMotion& m = top.motion;
        const auto at = [&](const FreeMotion& n) { return top.at(n); };
        const Rotation<double> end = at(m);
        FreeMotion back = m;
        back.w = -end.w, back.q = end.q;
        const double size = testing::size(m.w) + std::sqrt(testing::size(top.field_W) / top.I1);
        const double unit = 60 * ulp * (1 + size / (testing::size(m.w) + 1e-3));
        const double bound = testing::amplified(at, m, unit) + testing::amplified(at, back, unit);
        RC_ASSERT(testing::distance(at(back).q, m.q) <= bound);
        FreeMotion half = m, rest = m;
        half.t = m.t / 2, rest.t = m.t / 2;
        const Rotation<double> middle = at(half);
        rest.w = middle.w, rest.q = middle.q;
        RC_ASSERT(testing::distance(at(rest).q, end.q) <= bound + testing::amplified(at, rest, unit));
    }
}

// A top started with w = W z + s e3, where I1 W^2 cos theta - I3 w3 W + |G| = 0, precesses without nutation.
TEST(LagrangeTop, PrecessesRegularly) {
    const double I1 = 0.8, I3 = 0.5, G = 5, theta = 0.6, w3 = 9;
    for (const double sign : {-1.0, 1.0}) {
        const double root = std::sqrt(I3 * I3 * w3 * w3 - 4 * I1 * std::cos(theta) * G);
        const double W = (I3 * w3 + sign * root) / (2 * I1 * std::cos(theta));
        const Quaternion<double> q{std::cos(theta / 2), std::sin(theta / 2), 0, 0};
        const Vector3<double> w(0, W * std::sin(theta), w3);
        const LagrangeTop<double> top(2, I1, I3, {0, 0, -G}, w, q);
        for (const double t : {0.5, 3.0, 20.0}) {
            // rotation about z by W t after a rotation about e3 by (w3 - W cos theta) t
            const double a = W * t / 2, b = (w3 - W * std::cos(theta)) * t / 2;
            const Quaternion<double> expected = Quaternion<double>{std::cos(a), 0, 0, std::sin(a)} * q *
                                                Quaternion<double>{std::cos(b), 0, 0, std::sin(b)};
            EXPECT_LT(testing::distance(top.at(t).q, expected), 100 * ulp * (1 + 20 * t));
        }
    }
}

// Without spin, released from rest, the top is a plane pendulum: cos theta from sn with the modulus sin(amplitude / 2).
TEST(LagrangeTop, WithoutSpinIsAPendulum) {
    const double I1 = 0.8, G = 5, theta = 2.0;  // from upright: the amplitude about hanging is pi - 2
    const Quaternion<double> q{std::cos(theta / 2), std::sin(theta / 2), 0, 0};
    const LagrangeTop<double> top(2, I1, 0.5, {0, 0, -G}, {0, 0, 0}, q);
    const double k = std::sin((std::numbers::pi - theta) / 2), rate = std::sqrt(G / I1);
    const Lattice<double> lattice(k * k, 1 - k * k);
    for (const double t : {0.4, 1.0, 7.0}) {
        double u = rate * t + lattice.quarter;  // sin(angle/2) = k sn(rate t + K)
        const double j = lattice.reduce(u);
        Harmonics<double> h{};
        lattice.harmonics<false>(u, h);
        const double half_sine = k * lattice.jacobi(h).sn * (std::fmod(j, 2) == 0 ? 1 : -1);
        const Vector3<double> e3 = rotate(top.at(t).q, Vector3<double>(0, 0, 1));
        EXPECT_NEAR(e3[2], -(1 - 2 * half_sine * half_sine), 100 * ulp);
        EXPECT_NEAR(e3[0], 0, 100 * ulp);
    }
}

}  // namespace
}  // namespace polhode
