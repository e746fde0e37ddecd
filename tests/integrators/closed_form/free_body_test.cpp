// The closed form of the free body against Taylor series, invariants, the separatrix and the symmetric body.
#include "integrators/closed_form/free_body.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "integrators/closed_form/free_motion.h"

namespace polhode {
namespace {

using testing::FreeMotion, testing::ulp;

// a hundred bodies in each of RapidCheck's hundred runs
template <class Check>
void for_bodies(Check&& check) {
    for (int i = 0; i < 100; ++i) check(testing::any_free_motion());
}

Rotation<double> closed_form(const FreeMotion& m) { return FreeAsymmetricBody<double>(m.moments, m.w, m.q).at(m.t); }

Vector3<double> momentum_B(const Vector3<double>& moments, const Vector3<double>& w) {
    return {moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]};
}
double energy(const Vector3<double>& moments, const Vector3<double>& w) { return dot(w, momentum_B(moments, w)) / 2; }

// round-off of a few operations, amplified by the motion
double allowed(const FreeMotion& m) { return testing::amplified(closed_form, m, 10 * ulp) + 20 * ulp; }

RC_GTEST_PROP(FreeAsymmetricBody, KeepsMomentumEnergyAndNorm, ()) {
    for_bodies([](const FreeMotion& m) {
        const Rotation<double> end = closed_form(m);
        const Vector3<double> L = rotate(m.q, momentum_B(m.moments, m.w));
        // invariants do not depend on the phase, so they have no amplification
        RC_ASSERT(testing::size(rotate(end.q, momentum_B(m.moments, end.w)) - L) <= 40 * ulp * testing::size(L));
        RC_ASSERT(std::abs(energy(m.moments, end.w) / energy(m.moments, m.w) - 1) <= 40 * ulp);
        RC_ASSERT(std::abs(squared_norm(end.q) - 1) <= 4 * ulp);
    });
}

RC_GTEST_PROP(FreeAsymmetricBody, StartsWhereItIsTold, ()) {
    for_bodies([](FreeMotion m) {
        m.t = 0;
        const Rotation<double> start = closed_form(m);
        RC_ASSERT(testing::distance(start.q, m.q) <= 8 * ulp);
        RC_ASSERT(testing::size(start.w - m.w) <= 16 * ulp * testing::size(m.w));
    });
}

RC_GTEST_PROP(FreeAsymmetricBody, AgreesWithTaylorSeries, ()) {
    for_bodies([](const FreeMotion& m) {
        const Rotation<double> end = closed_form(m);
        int steps = 0;
        const auto y = testing::by_taylor(testing::FreeEquations{m.moments}, m, steps);
        // each step of the series rounds as well
        const double bound = allowed(m) * (1 + std::sqrt(steps));
        RC_ASSERT(testing::distance(end.q, quaternion_at(y.data(), 3)) <= bound);
        RC_ASSERT(testing::size(end.w - vector_at(y.data(), 0)) <= bound * testing::size(m.w));
    });
}

RC_GTEST_PROP(FreeAsymmetricBody, GoesOnAsOneMotion, ()) {
    for_bodies([](const FreeMotion& m) {
        // advancing by t1 and then by t2 equals advancing by t1 + t2
        FreeMotion rest = m;
        const Rotation<double> middle = FreeAsymmetricBody<double>(m.moments, m.w, m.q).at(0.375 * m.t);
        rest.w = middle.w, rest.q = middle.q, rest.t = m.t - 0.375 * m.t;
        const Rotation<double> end = closed_form(m), joined = closed_form(rest);
        RC_ASSERT(testing::distance(end.q, joined.q) <= 2 * (allowed(m) + allowed(rest)));
        RC_ASSERT(testing::size(end.w - joined.w) <= 2 * (allowed(m) + allowed(rest)) * testing::size(m.w));
    });
}

RC_GTEST_PROP(FreeAsymmetricBody, RunsBackwards, ()) {
    for_bodies([](const FreeMotion& m) {
        const Rotation<double> end = closed_form(m);
        const FreeMotion back{m.moments, -end.w, end.q, m.t};
        const Rotation<double> start = closed_form(back);
        RC_ASSERT(testing::distance(start.q, m.q) <= 2 * (allowed(m) + allowed(back)));
        RC_ASSERT(testing::size(start.w + m.w) <= 2 * (allowed(m) + allowed(back)) * testing::size(m.w));
    });
}

RC_GTEST_PROP(FreeAsymmetricBody, KnowsNoWorldFrameAndNoNameOfAnAxis, ()) {
    for_bodies([](const FreeMotion& m) {
        const Rotation<double> end = closed_form(m);
        FreeMotion turned = m;
        const Quaternion<double> world = testing::moderate_orientation();
        turned.q = world * m.q;
        RC_ASSERT(testing::distance(closed_form(turned).q, world * end.q) <= 20 * ulp);
        // renaming the axes 1 -> 2 -> 3 -> 1 is a rotation by a third about (1, 1, 1)
        const Quaternion<double> rename{0.5, 0.5, 0.5, 0.5};
        FreeMotion renamed = m;
        for (int i = 0; i < 3; ++i) renamed.moments[(i + 1) % 3] = m.moments[i], renamed.w[(i + 1) % 3] = m.w[i];
        renamed.q = m.q * conjugate(rename);
        RC_ASSERT(testing::distance(closed_form(renamed).q * rename, end.q) <= 40 * ulp);
    });
}

TEST(FreeAsymmetricBody, IsContinuousOverManyPeriods) {
    for (const double w2 : {0.0, 1.0, 1e-6}) {
        const FreeAsymmetricBody<double> body({1, 2, 3}, {1, w2, w2 == 0 ? 0.57735026 : 1}, {0.5, 0.5, 0.5, 0.5});
        Rotation<double> last = body.at(0);
        for (int k = 1; k <= 40000; ++k) {
            const Rotation<double> next = body.at(0.005 * k);
            // |dq/dt| = |w|/2
            ASSERT_LT(testing::distance(next.q, last.q), 0.005 * 0.5 * 2.0) << k;
            last = next;
        }
    }
}

// I = (3, 4, 6), w = (2, 0, 1): w = (2 sech, 3/sqrt 2 tanh, sech)(t/sqrt 2), for any order of the axes
TEST(FreeAsymmetricBody, FollowsTheSeparatrix) {
    const double root = std::sqrt(2.0);
    for (int shift = 0; shift < 3; ++shift)
        for (const double sign : {1.0, -1.0}) {
            Vector3<double> moments, w;
            const double I[3] = {3, 4, 6}, start[3] = {2 * sign, 0, sign};
            for (int i = 0; i < 3; ++i) moments[(i + shift) % 3] = I[i], w[(i + shift) % 3] = start[i];
            const FreeAsymmetricBody<double> body(moments, w, {});
            for (const double t : {-40.0, -3.0, 0.0, 0.7, 12.0, 35.0, 700.0}) {
                const double sech = 1 / std::cosh(t / root);
                const double expected[3] = {2 * sign * sech, 3 / root * std::tanh(t / root), sign * sech};
                const Vector3<double> found = body.at(t).w;
                for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[(i + shift) % 3], expected[i], 8 * ulp) << t;
            }
        }
}

TEST(FreeAsymmetricBody, IsTheSameInEveryScalar) {
    const Vector3<double> moments(1.25, 2.5, 3.125), w(0.75, -0.5, 1.5);
    const FreeAsymmetricBody<double> narrow(moments, w, {});
    const FreeAsymmetricBody<Wide> wide(cast<Wide>(moments), cast<Wide>(w), {});
    const FreeAsymmetricBody<Real<50>> many(cast<Real<50>>(moments), cast<Real<50>>(w), {});
    for (const double t : {-17.0, 0.1, 5.0, 60.0}) {
        const Rotation<double> a = narrow.at(t);
        const Rotation<Wide> b = wide.at(t);
        const Rotation<Real<50>> c = many.at(t);
        const auto digits = [](const Wide& x) {
            const double high = static_cast<double>(x), low = static_cast<double>(x - high);
            const double rest = static_cast<double>(x - high - low);
            return Real<50>(high) + Real<50>(low) + Real<50>(rest);
        };
        EXPECT_LT(abs(Real<50>(digits(b.q.w) - c.q.w)).convert_to<double>(), 1e-31 * (1 + std::abs(t)));
        EXPECT_LT(abs(Real<50>(digits(b.w[1]) - c.w[1])).convert_to<double>(), 1e-31 * (1 + std::abs(t)));
        EXPECT_NEAR(a.q.x, c.q.x.convert_to<double>(), 8 * ulp * (1 + std::abs(t)));
        EXPECT_NEAR(a.w[2], c.w[2].convert_to<double>(), 8 * ulp * (1 + std::abs(t)));
    }
}

// If two moments differ only in the last place, the result tends to the symmetric body's closed form, whose formulas
// share nothing with Jacobi's functions.
TEST(FreeAsymmetricBody, TendsToTheSymmetricBody) {
    const Vector3<double> w(0.9, 0.4, 1.1);
    for (const double gap : {1e-15, 1e-13, 1e-9})
        for (int axis = 0; axis < 3; ++axis)
            for (const double I3 : {0.5, 1.75}) {
                Vector3<double> moments(1, 1, 1);
                moments[axis] = I3, moments[(axis + 1) % 3] = 1 + gap;
                const FreeAsymmetricBody<double> near(moments, w, {});
                const FreeSymmetricBody<double> symmetric(axis, 1, I3, w, {});
                for (const double t : {0.3, 8.0, 50.0}) {
                    const Rotation<double> a = near.at(t), b = symmetric.at(t);
                    EXPECT_LT(testing::distance(a.q, b.q), (gap + 10 * ulp) * (1 + 3 * t));
                    EXPECT_LT(testing::size(a.w - b.w), (gap + 10 * ulp) * (1 + 3 * t));
                }
            }
}

RC_GTEST_PROP(FreeSymmetricBody, AgreesWithTaylorSeries, ()) {
    for_bodies([](FreeMotion m) {
        const int axis = *rc::gen::inRange(0, 3);
        m.moments[(axis + 1) % 3] = m.moments[(axis + 2) % 3];
        const FreeSymmetricBody<double> body(axis, m.moments[(axis + 1) % 3], m.moments[axis], m.w, m.q);
        const Rotation<double> end = body.at(m.t);
        int steps = 0;
        const auto y = testing::by_taylor(testing::FreeEquations{m.moments}, m, steps);
        const double bound = 100 * ulp * (1 + steps + testing::size(m.w) * std::abs(m.t));
        RC_ASSERT(testing::distance(end.q, quaternion_at(y.data(), 3)) <= bound);
        RC_ASSERT(testing::size(end.w - vector_at(y.data(), 0)) <= bound * testing::size(m.w));
    });
}

// dw/dt = a - k w about one axis
struct DrivenAxis {
    double acceleration, decay;
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = dy[1] = S(0);
        dy[2] = S(acceleration) - decay * y[2];
        put(dy, 3, attitude_rate(0.5, quaternion_at(y, 3), vector_at(y, 0)));
    }
};
RC_GTEST_PROP(AxisRotation, AgreesWithTaylorSeries, ()) {
    for_bodies([](FreeMotion m) {
        m.w = {0, 0, testing::moderate(-2, 2)};
        m.t = std::abs(m.t);
        const double a = testing::moderate(-1, 1), k = *rc::gen::element(0.0, 1e-12, 1e-5, 0.2, 1.0, 3.0);
        const AxisRotation<double> body({0, 0, 1}, m.w[2], m.q, a, k);
        const Rotation<double> end = body.at(m.t);
        int steps = 0;
        const auto y = testing::by_taylor(DrivenAxis{a, k}, m, steps);
        const double bound = 40 * ulp * (1 + m.t) * (3 + std::abs(a) * m.t) * (1 + steps);
        RC_ASSERT(testing::distance(end.q, quaternion_at(y.data(), 3)) <= bound);
        RC_ASSERT(testing::size(end.w - vector_at(y.data(), 0)) <= bound);
    });
}

}  // namespace
}  // namespace polhode
