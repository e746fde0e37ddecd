// The truth of catalogue scenes against closed forms worked out in 100 digits: nothing here integrates anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "whole/truth_values.h"

namespace polhode {
namespace {

// 25 digits are promised, of blocks whose size is the scale
constexpr double promised = 1e-24;

double distance(const Vector3<R>& a, const Vector3<R>& b) { return length(a - b).convert_to<double>(); }
double distance(const Quaternion<R>& a, const Quaternion<R>& b) {
    return square_root(squared_norm(Quaternion<R>{a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z})).convert_to<double>();
}
Vector3<R> unit(int axis) {
    Vector3<R> e;
    e[axis] = 1;
    return e;
}
// the unit quaternion of a turn by `angle` about the unit vector `axis`
Quaternion<R> turn(const Vector3<R>& axis, const R& angle) {
    const R s = sin(R(angle / 2));
    return {cos(R(angle / 2)), s * axis[0], s * axis[1], s * axis[2]};
}

TEST(ClosedForms, Separatrix) {
    const Reference truth = fresh_truth(find_scene("separatrix"), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const R root = sqrt(R(2));
    for (const ReferenceSample& sample : truth.samples) {
        const R u = R(sample.t) / root, sech = 1 / cosh(u);
        EXPECT_LT(distance(value(sample.angular_velocity_B), {2 * sech, 3 / root * tanh(u), sech}), promised);
    }
}

// A free asymmetric body started with no rate about its middle axis, by Jacobi's functions (Landau & Lifshitz 1976,
// section 37): the axis that the motion goes round as dn, the other outer one as cn, the middle one as sn.
struct FreeRates {
    int round, other;
    R p, k, middle;
    Vector3<R> start;

    Vector3<R> at(const R& t) const {
        R cn, dn;
        const R sn = boost::math::jacobi_elliptic(k, R(p * t), &cn, &dn);
        Vector3<R> w;
        w[round] = start[round] * dn, w[other] = start[other] * cn, w[1] = middle * sn;
        return w;
    }
};
FreeRates free_rates(const Scene& scene) {
    const ExactBody<R> body = exact_body<R>(scene);
    const Vector3<R> w = body.angular_velocity_B, I(body.inertia_B[0][0], body.inertia_B[1][1], body.inertia_B[2][2]);
    R E2 = 0, L2 = 0;
    for (int i = 0; i < 3; ++i) E2 += I[i] * w[i] * w[i], L2 += I[i] * I[i] * w[i] * w[i];
    const int largest = I[0] > I[2] ? 0 : 2;
    const int c = L2 > E2 * I[1] ? largest : 2 - largest, a = 2 - c;
    // with c for the axis gone round and a for the other; both differences have the same sign
    const R outer = (I[c] - I[1]) * (L2 - E2 * I[a]), inner = (I[1] - I[a]) * (E2 * I[c] - L2);
    const R amplitude = sqrt(R((E2 * I[c] - L2) / (I[1] * (I[c] - I[1]))));
    const bool up = (I[2] - I[0]) * w[2] * w[0] > 0;
    return {c, a, sqrt(R(outer / (I[0] * I[1] * I[2]))), sqrt(R(inner / outer)), up ? amplitude : R(-amplitude), w};
}

class FreeAsymmetric : public ::testing::TestWithParam<const char*> {};
TEST_P(FreeAsymmetric, FollowsJacobisFunctions) {
    const Scene scene = find_scene(GetParam());
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const FreeRates rates = free_rates(scene);
    const double scale = length(rates.start).convert_to<double>();
    for (const ReferenceSample& sample : truth.samples)
        EXPECT_LT(distance(value(sample.angular_velocity_B), rates.at(R(sample.t))), promised * scale) << sample.t;
}
INSTANTIATE_TEST_SUITE_P(Scenes, FreeAsymmetric, ::testing::Values("near_separatrix", "toutatis"));

TEST(ClosedForms, ToutatisHasThePublishedPeriods) {
    // Hudson & Ostro 1995: 5.41 days about the long axis, 7.35 days on the average for that axis about L. After one
    // period of the rates the body has the same rates, and has turned about L by 2 pi 5.41 / 7.35.
    const Scene scene = find_scene("toutatis");
    const FreeRates rates = free_rates(scene);
    EXPECT_EQ(rates.round, 2) << "not a long-axis mode";
    const double period = R(4 * boost::math::ellint_1(rates.k) / rates.p).convert_to<double>();
    EXPECT_NEAR(period / 86400 / 5.41, 1, 1e-7);
    Scene one_period = scene;
    one_period.duration = period;
    const Reference truth = fresh_truth(one_period, 1);
    ASSERT_TRUE(truth.available) << truth.message;
    const Quaternion<R> q = value(truth.samples[1].q);
    const Vector3<R> L = value(truth.samples[0].angular_momentum_W), axis = (1 / length(L)) * L;
    // about L alone, to the rounding of the period
    const R cosine = q.w, sine = dot(vector_part(q), axis);
    EXPECT_NEAR(R(cosine * cosine + sine * sine).convert_to<double>(), 1, 1e-15);
    double angle = R(2 * atan2(sine, cosine)).convert_to<double>();
    if (angle < 0) angle += 2 * std::numbers::pi;
    EXPECT_NEAR(angle / (2 * std::numbers::pi) * 7.35 / 5.41, 1, 1e-7);
}

class FreeSymmetric : public ::testing::TestWithParam<std::pair<const char*, int>> {};
TEST_P(FreeSymmetric, PrecessesRegularly) {
    // about L by |L| t / I1, after (1 - I3/I1) w3 t about the body's axis (Landau & Lifshitz 1976, section 33)
    const auto [name, axis] = GetParam();
    const Scene scene = find_scene(name);
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<R> body = exact_body<R>(scene);
    const int across = (axis + 1) % 3;
    const R I1 = body.inertia_B[across][across], I3 = body.inertia_B[axis][axis];
    ASSERT_EQ(gap(body.inertia_B[(axis + 2) % 3][(axis + 2) % 3], I1), 0);
    const Vector3<R> L_W = rotate(body.q, body.inertia_B * body.angular_velocity_B);
    const R size = length(L_W);
    for (const ReferenceSample& sample : truth.samples) {
        const R t(sample.t);
        const Quaternion<R> q = turn((1 / size) * L_W, R(size * t / I1)) * body.q *
                                turn(unit(axis), R((1 - I3 / I1) * body.angular_velocity_B[axis] * t));
        EXPECT_LT(distance(value(sample.q), q), promised) << sample.t;
    }
}
INSTANTIATE_TEST_SUITE_P(Scenes, FreeSymmetric,
                         ::testing::Values(std::pair("feynman_plate", 2), std::pair("explorer_1", 2),
                                           std::pair("nanodumbbell", 0), std::pair("symmetric", 2)));

// Lagrange's top, its axis at rest or moving level at the start: u = cos(tilt) obeys u'^2 = f(u), a cubic with the root
// u(0), and swings between two of its roots u1 < u2 < u3 as u1 + (u2 - u1) sn^2 (Goldstein 1980, section 5-7).
struct Nutation {
    R u1, u2, u3, speed, k;
    bool from_above;

    R at(const R& t) const {
        R cn, dn;
        const R sn = boost::math::jacobi_elliptic(k, R(speed * t), &cn, &dn);
        // a quarter period later sn is cn / dn
        const R swing = from_above ? R(cn / dn) : sn;
        return u1 + (u2 - u1) * swing * swing;
    }
};
Nutation nutation(const Scene& scene, int axis) {
    const ExactBody<R> body = exact_body<R>(scene);
    const Vector3<R> e = unit(axis), w = body.angular_velocity_B;
    const int across = (axis + 1) % 3;
    const R I1 = body.inertia_B[across][across], I3 = body.inertia_B[axis][axis];
    const R weight = -body.mass * R(std::get<Gravity>(scene.loads.at(0)).acceleration_W[2]);
    const R u0 = rotate(body.q, e)[2], mgl = weight * body.arm[axis];
    const R a = I3 * w[axis] / I1, b = rotate(body.q, body.inertia_B * w)[2] / I1, beta = 2 * mgl / I1;
    const Vector3<R> level = w - w[axis] * e;
    const R alpha = dot(level, level) + beta * u0;
    // f = (alpha - beta u)(1 - u^2) - (b - a u)^2, divided by u - u0
    const R half = (beta * u0 - alpha - a * a) / (2 * beta);
    const R product = (2 * a * b - beta + 2 * beta * half * u0) / beta;
    const R root = sqrt(R(half * half - product));
    std::array<R, 3> roots{u0, R(-half - root), R(-half + root)};
    std::sort(roots.begin(), roots.end());
    return {roots[0],
            roots[1],
            roots[2],
            R(sqrt(R(beta * (roots[2] - roots[0]))) / 2),
            sqrt(R((roots[1] - roots[0]) / (roots[2] - roots[0]))),
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
        const R u = rotate(value(sample.q), unit(axis))[2];
        EXPECT_LT(gap(u, top.at(R(sample.t))), promised) << sample.t;
        lowest = std::min(lowest, u.convert_to<double>()), highest = std::max(highest, u.convert_to<double>());
    }
    // the samples see most of the swing
    EXPECT_GT(highest - lowest, 0.5 * R(top.u2 - top.u1).convert_to<double>());
}
INSTANTIATE_TEST_SUITE_P(Scenes, LagrangesTop,
                         ::testing::Values(std::pair("lagrange_top", 2), std::pair("looping_top", 2),
                                           std::pair("slow_top", 2), std::pair("sleeping_top", 2),
                                           std::pair("simo_wong_top", 2), std::pair("bruls_top", 1)));

TEST(ClosedForms, CompoundPendulum) {
    // sin(angle / 2) = k cd(t sqrt(m g l / I), k), k its value at the start, where it is at rest
    const Scene scene = find_scene("compound_pendulum");
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<R> body = exact_body<R>(scene);
    const R k = body.q.y, speed = sqrt(R(body.mass * R(9.81) / 2 / body.inertia_B[1][1]));
    for (const ReferenceSample& sample : truth.samples) {
        R cn, dn;
        boost::math::jacobi_elliptic(k, R(speed * R(sample.t)), &cn, &dn);
        EXPECT_LT(gap(abs(value(sample.q.y)), abs(R(k * cn / dn))), promised) << sample.t;
        EXPECT_EQ(sample.q.x.high, 0);
        EXPECT_EQ(sample.q.z.high, 0);
    }
}

TEST(ClosedForms, StruckBarTurnsAboutItsCentreOfPercussion) {
    const Reference truth = fresh_truth(find_scene("struck_bar"), 20);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples) {
        const R after = R(std::max(0.0, sample.t - 1));
        const bool struck = sample.t >= 1;
        EXPECT_LT(distance(value(sample.angular_velocity_B), {R(0), R(struck ? -1 : 0), R(0)}), promised);
        EXPECT_LT(distance(value(sample.velocity_W), {R(0), R(0), R(struck ? 0.5 : 0)}), promised);
        EXPECT_LT(distance(value(sample.position_W), {R(0), R(0), R(after / 2)}), 10 * promised);
        EXPECT_LT(distance(value(sample.q), turn(unit(1), R(-after))), promised);
        if (sample.t != 1) continue;
        const Vector3<R> end(R(-0.5), R(0), R(0));
        const Vector3<R> speed = value(sample.velocity_W) + cross(value(sample.angular_velocity_B), end);
        EXPECT_LT(distance(speed, {}), promised);
    }
}

TEST(ClosedForms, StokesSphereRelaxesExponentially) {
    const Scene scene = find_scene("stokes_sphere");
    const Reference truth = fresh_truth(scene, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    const ExactBody<R> body = exact_body<R>(scene);
    const Drag& drag = std::get<Drag>(scene.loads.at(2));
    const R rate = R(drag.translational) / body.mass, turning = R(drag.rotational[0]) / body.inertia_B[0][0];
    const R pull = R(std::get<Gravity>(scene.loads.at(0)).acceleration_W[2]) +
                   R(std::get<Force>(scene.loads.at(1)).vector[2]) / body.mass;
    const Vector3<R> sinking(R(0), R(0), R(pull / rate));
    for (const ReferenceSample& sample : truth.samples) {
        const R t(sample.t), left = exp(R(-rate * t));
        const Vector3<R> velocity = sinking + left * (body.velocity_W - sinking);
        const Vector3<R> position = t * sinking + R((1 - left) / rate) * (body.velocity_W - sinking);
        EXPECT_LT(distance(value(sample.velocity_W), velocity), promised);
        EXPECT_LT(distance(value(sample.position_W), position), promised);
        EXPECT_LT(distance(value(sample.angular_velocity_B), R(exp(R(-turning * t))) * body.angular_velocity_B),
                  60 * promised);
    }
    EXPECT_NEAR(truth.samples.back().velocity_W[2].high, -0.063, 5e-4);
}

TEST(ClosedForms, EarthsPoleGoesRoundInEulersPeriod) {
    // small wobble: 2 pi / (w3 sqrt((C - A)(C - B) / (A B))), to the square of its size, 1e-12
    const Scene scene = find_scene("earth_wobble");
    const ExactBody<R> body = exact_body<R>(scene);
    const R A = body.inertia_B[0][0], B = body.inertia_B[1][1], C = body.inertia_B[2][2];
    const R pace = body.angular_velocity_B[2] * sqrt(R((C - A) * (C - B) / (A * B)));
    EXPECT_NEAR(R(2 * boost::math::constants::pi<R>() / pace / 86400).convert_to<double>(), 304, 0.5);
    const Reference truth = fresh_truth(shortened("earth_wobble", 2592000), 6);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples) {
        const R wobble = body.angular_velocity_B[0] * cos(R(pace * R(sample.t)));
        EXPECT_NEAR(R(value(sample.angular_velocity_B[0]) / body.angular_velocity_B[0]).convert_to<double>(),
                    R(wobble / body.angular_velocity_B[0]).convert_to<double>(), 1e-11);
    }
}

}  // namespace
}  // namespace polhode
