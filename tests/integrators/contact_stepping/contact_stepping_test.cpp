// Time-stepping contact methods against closed forms: rolling, sliding, sticking, impacts and friction pyramids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contact_cases.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// All methods of contact_stepping, or those in binary64.
std::vector<const Method*> contact_methods(bool binary32) {
    std::vector<const Method*> found;
    for (const Method* method : methods())
        if (method->planes && takes_step(*method) && method->family != Family::engine &&
            !method->name.starts_with("impact_") && (binary32 || method->precision == Precision::binary64))
            found.push_back(method);
    return found;
}
/// Coulomb's friction times this factor acts at 45 degrees between the axes t1 and t2. Components limited one by one:
/// to the corner of a square. A pyramid with edges on the axes: to the middle of its side.
double diagonal_friction(const Method& method) {
    if (method.name.find("pyramid") != std::string_view::npos) return std::numbers::sqrt2;
    if (method.name.ends_with("_4")) return std::numbers::sqrt2 / 2;
    return 1;
}

Sample end_of(const Scene& scene, const Method& method, double step) {
    const Trajectory run = with_step(scene, method.name.data(), step);
    EXPECT_EQ(run.status, Status::ok) << method.name << ": " << run.message;
    return run.samples.empty() ? Sample{} : run.samples.back();
}

class ContactMethod : public ::testing::TestWithParam<const Method*> {
  protected:
    static const Method& method() { return *GetParam(); }
    // relative rounding after some hundred steps
    static double rounding() { return method().precision == Precision::binary32 ? 2e-4 : 1e-11; }
};

/// A ball rolls down a ramp with 5/7 g sin a if tan a <= 3.5 mu, else slides with g (sin a - mu cos a) and the angular
/// acceleration 5 mu g cos a / (2 r). Both accelerations are constant, so semi-implicit Euler has an error of a h T / 2
/// in the position.
TEST_P(ContactMethod, BallRollsOrSlidesDownARamp) {
    constexpr double angle = 0.3, r = 0.1, h = 1.0 / 256;
    for (const double friction : {0.5, 0.05}) {
        const bool rolls = std::tan(angle) <= 3.5 * friction;
        const double a =
            rolls ? 5.0 / 7 * contact_g * std::sin(angle) : contact_g * (std::sin(angle) - friction * std::cos(angle));
        const double spin = rolls ? a / r : 2.5 * friction * contact_g * std::cos(angle) / r;
        const Sample end = end_of(on_ramp(SolidSphere{r}, r, angle, friction), method(), h);
        EXPECT_NEAR(end.velocity_W[0], a, rounding() * a) << friction;
        EXPECT_NEAR(rotate(end.q, end.angular_velocity_B)[1], spin, rounding() * spin) << friction;
        EXPECT_NEAR(end.position_W[0], a / 2, (0.51 * h + rounding()) * a) << friction;
        EXPECT_NEAR(end.position_W[2], r, 1e-3 * h + rounding() * r) << friction;
    }
}

/// A block holds on a ramp just below the angle of friction and slides with g (sin a - mu cos a) just above, which is
/// 0.040 m/s after 1 s. The ramp descends along x, which is an axis of every pyramid. Ten sweeps of sequential impulses
/// leave an error in the first steps: measured 0.007 m/s with Baumgarte's term, 0.004 m/s from zero impulses.
TEST_P(ContactMethod, BlockHoldsUntilTheAngleOfFriction) {
    constexpr double friction = 0.4, h = 1.0 / 128;
    const double critical = std::atan(friction);
    const double tolerance = method().family == Family::engine_update ? 0.01 : 10 * rounding();
    const Box box{{0.2, 0.15, 0.05}};
    const Sample held = end_of(on_ramp(box, 0.05, 0.99 * critical, friction), method(), h);
    EXPECT_NEAR(held.velocity_W[0], 0, tolerance);
    EXPECT_NEAR(held.position_W[0], 0, tolerance);
    const double angle = 1.01 * critical, a = contact_g * (std::sin(angle) - friction * std::cos(angle));
    const Sample slid = end_of(on_ramp(box, 0.05, angle, friction), method(), h);
    EXPECT_NEAR(slid.velocity_W[0], a, tolerance);
    EXPECT_LT(length(slid.angular_velocity_B), tolerance);
}

INSTANTIATE_TEST_SUITE_P(Of, ContactMethod, ::testing::ValuesIn(contact_methods(true)),
                         [](const auto& of) { return std::string(of.param->name); });

/// Mean error of a quantity over runs with n, n + 1, .. steps. Single runs are late by a fraction of a step at an
/// impact or at the end of sliding, which varies irregularly with the step.
template <class Error>
double mean_error(long n, const Error& error) {
    constexpr long runs = 16;
    double sum = 0;
    for (long i = 0; i < runs; ++i) sum += error(1.0 / static_cast<double>(n + n * i / runs));
    return sum / runs;
}
template <class Error>
double measured_order(long n, const Error& error) {
    return std::log2(mean_error(n, error) / mean_error(4 * n, error)) / 2;
}

class ContactOrder : public ::testing::TestWithParam<const Method*> {
  protected:
    static const Method& method() { return *GetParam(); }
};

/// The end of sliding falls inside a step: order 1.
TEST_P(ContactOrder, IsOneFromSlidingToRolling) {
    constexpr double u = 3, friction = 0.2;
    const Scene scene = bowling_ball(u, friction);
    const auto error = [&](double h) {
        const Sample end = end_of(scene, method(), h);
        EXPECT_NEAR(end.velocity_W[0], 5 * u / 7, 1e-10);
        return std::abs(end.position_W[0] - bowled_distance(u, friction, 1));
    };
    const double order = measured_order(64, error);
    RecordProperty("order", std::to_string(order));
    EXPECT_GT(order, 0.9) << mean_error(64, error);
}

/// A ball falls from 0.5 m with e = 0.8 and bounces three times in 1.5 s: the position at the end has order 1.
TEST_P(ContactOrder, IsOneOverBounces) {
    constexpr double e = 0.8, drop = 0.5;
    Scene scene = on_floor(SolidSphere{0.1}, 0.1 + drop, e, 0.3);
    scene.duration = 1.5;
    double t = std::sqrt(2 * drop / contact_g), speed = contact_g * t;
    int bounces = 0;
    while (t + 2 * e * speed / contact_g < scene.duration) speed *= e, t += 2 * speed / contact_g, ++bounces;
    speed *= e;
    ASSERT_EQ(bounces, 2);
    if (const std::string why = refusal(method(), pose(scene)); !why.empty()) GTEST_SKIP() << why;
    const double after = scene.duration - t, height = 0.1 + speed * after - contact_g * after * after / 2;
    const auto error = [&](double h) { return std::abs(end_of(scene, method(), h).position_W[2] - height); };
    const double order = measured_order(256, error);
    RecordProperty("order", std::to_string(order));
    EXPECT_NEAR(order, 1, 0.25) << mean_error(256, error);
}

INSTANTIATE_TEST_SUITE_P(Of, ContactOrder, ::testing::ValuesIn(contact_methods(false)),
                         [](const auto& of) { return std::string(of.param->name); });

/// A block slides with speed 2 at 45 degrees to the axes of the pyramids. Coulomb's friction decelerates it by mu g;
/// a pyramid gives another factor.
TEST(ContactPyramid, DependsOnTheDirectionOfSlip) {
    constexpr double friction = 0.2, u = 2, T = 0.25;
    for (const Method* method : contact_methods(false)) {
        Scene scene = on_floor(Box{{0.2, 0.15, 0.05}}, 0.05, 0, friction);
        scene.duration = T;
        scene.initial.velocity_W = {u * std::numbers::sqrt2 / 2, u * std::numbers::sqrt2 / 2, 0};
        const double factor = diagonal_friction(*method);
        const Sample end = end_of(scene, *method, T / 64);
        EXPECT_NEAR(std::hypot(end.velocity_W[0], end.velocity_W[1]), u - factor * friction * contact_g * T, 2e-3)
            << method->name;
    }
}

/// Split impulses remove penetrations without adding to the velocity; Baumgarte's term adds up to 0.2 u.
TEST(ContactImpulses, BaumgarteGainsEnergyAtALanding) {
    Scene scene = on_floor(SolidSphere{0.1}, 0.6, 0, 0);
    scene.duration = 0.4;  // lands at t = 0.319
    const double impact = std::sqrt(2 * contact_g * 0.5);
    double largest = 0;
    for (long n = 1000; n < 1016; ++n) {
        const double h = scene.duration / static_cast<double>(n);
        const double split = end_of(scene, *find_method("contact_impulses_cone"), h).velocity_W[2];
        EXPECT_NEAR(split, 0, contact_g * h);
        Settings settings;
        settings.step = h, settings.samples = n;
        double fastest = 0;
        for (const Sample& s : solve(scene, *find_method("contact_impulses_cone_baumgarte"), settings).samples)
            fastest = std::max(fastest, s.velocity_W[2]);
        largest = std::max(largest, fastest);
        EXPECT_LT(fastest, 0.2 * impact + contact_g * h);
    }
    EXPECT_GT(largest, 0.1 * impact);
}

TEST(ContactRefusal, NamesFrictionTorques) {
    Scene scene = on_floor(SolidSphere{0.1}, 0.1, 0, 0.3);
    scene.planes[0].rolling_friction = 0.01;
    for (const Method* method : contact_methods(true)) {
        const Trajectory run = with_step(scene, method->name.data(), 0.01);
        EXPECT_EQ(run.status, Status::unsupported) << method->name;
        EXPECT_NE(run.message.find("rolling friction"), std::string::npos) << run.message;
    }
}

}  // namespace
}  // namespace polhode
