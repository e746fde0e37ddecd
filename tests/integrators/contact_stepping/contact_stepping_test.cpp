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
/// Methods whose contact is a spring: they converge to the motion of this model, and need short steps.
bool is_soft_model(const Method& method) {
    return method.name.starts_with("mujoco") || method.name.starts_with("penalty");
}
/// Coulomb's friction times this factor acts at 45 degrees between the axes t1 and t2. Components limited one by one:
/// to the corner of a square. A pyramid with edges on the axes: to the middle of its side.
double diagonal_friction(const Method& method) {
    if (method.name.starts_with("contact_impulses_pyramid")) return std::numbers::sqrt2;
    if (method.name == "mujoco_contacts_pyramidal" || method.name == "anitescu_potra_4" ||
        method.name == "stewart_trinkle_4")
        return std::numbers::sqrt2 / 2;
    return 1;
}

/// The accuracy of a method on balls and blocks on a ramp: rounding, unless measured as written here.
struct ContactAccuracy {
    double h = 1.0 / 256;  ///< s
    double ball;           ///< relative error of the velocities of a ball
    double block;          ///< m/s, error of the velocity of a block after 1 s, of which 0.040 m/s decide
    double height;         ///< m
};
ContactAccuracy accuracy_of(const Method& method) {
    // relative rounding after some hundred steps
    const double rounding = method.precision == Precision::binary32 ? 2e-4 : 1e-11;
    ContactAccuracy found{.ball = rounding, .block = 10 * rounding, .height = rounding};
    const auto is = [&](std::string_view name) { return method.name.starts_with(name); };
    // errors of the first steps, from zero impulses: 0.007 with Baumgarte's term, 0.004 without warm start
    if (is("contact_impulses") || is("bullet") || is("jolt")) found.block = 0.01;
    // sinks by 7e-5 m, and r (w h)^2 / 2; measured 1e-3, 5e-4, 1.8e-4
    if (is("soft_contacts")) found.ball = 2e-3, found.block = 0.002, found.height = 3e-4;
    // velocities are differences of positions: measured 1.7e-3, proportional to h; friction of a block is 2.3 % low
    // and their rounding 2^-24 / h
    if (is("xpbd")) found.ball = method.precision == Precision::binary32 ? 0.03 : 3e-3, found.block = 0.15;
    // slip of the regularised friction: measured 3.5e-3 and 2.4e-3, depth 3.6e-4
    if (is("mujoco")) found = {1.0 / 1024, 5e-3, 0.005, 5e-4};
    // slip of 0.01 m/s where friction is just sufficient; measured 1.6e-3, 0.013, 1e-4
    if (is("penalty")) found = {1.0 / 1024, 3e-3, 0.015, 2e-4};
    // the damper of four points is unstable above 1/2500 s
    if (is("penalty_contacts_linear")) found.h = 1.0 / 4096;
    return found;
}

Sample end_of(const Scene& scene, const Method& method, double step) {
    const Trajectory run = with_step(scene, method.name.data(), step);
    EXPECT_EQ(run.status, Status::ok) << method.name << ": " << run.message;
    return run.samples.empty() ? Sample{} : run.samples.back();
}

class ContactMethod : public ::testing::TestWithParam<const Method*> {
  protected:
    static const Method& method() { return *GetParam(); }
    static ContactAccuracy accuracy() { return accuracy_of(method()); }
};

/// A ball rolls down a ramp with 5/7 g sin a if tan a <= 3.5 mu, else slides with g (sin a - mu cos a) and the angular
/// acceleration 5 mu g cos a / (2 r). Both accelerations are constant, so semi-implicit Euler has an error of a h T / 2
/// in the position.
TEST_P(ContactMethod, BallRollsOrSlidesDownARamp) {
    constexpr double angle = 0.3, r = 0.1;
    const auto [h, relative, block, height] = accuracy();
    for (const double friction : {0.5, 0.05}) {
        const bool rolls = std::tan(angle) <= 3.5 * friction;
        const double a =
            rolls ? 5.0 / 7 * contact_g * std::sin(angle) : contact_g * (std::sin(angle) - friction * std::cos(angle));
        const double spin = rolls ? a / r : 2.5 * friction * contact_g * std::cos(angle) / r;
        const Sample end = end_of(on_ramp(SolidSphere{r}, r, angle, friction), method(), h);
        EXPECT_NEAR(end.velocity_W[0], a, relative * a) << friction;
        EXPECT_NEAR(rotate(end.q, end.angular_velocity_B)[1], spin, relative * spin) << friction;
        EXPECT_NEAR(end.position_W[0], a / 2, (0.51 * h + relative) * a) << friction;
        EXPECT_NEAR(end.position_W[2], r, 1e-5 * h + height) << friction;
    }
}

/// A block holds on a ramp just below the angle of friction and slides with g (sin a - mu cos a) just above, which is
/// 0.040 m/s after 1 s. The ramp descends along x, which is an axis of every pyramid.
TEST_P(ContactMethod, BlockHoldsUntilTheAngleOfFriction) {
    constexpr double friction = 0.4;
    const double critical = std::atan(friction), h = std::min(accuracy().h, 1.0 / 128);
    const double tolerance = accuracy().block;
    const Box box{{0.2, 0.15, 0.05}};
    const Sample held = end_of(on_ramp(box, 0.05, 0.99 * critical, friction), method(), h);
    EXPECT_NEAR(held.velocity_W[0], 0, tolerance);
    EXPECT_NEAR(held.position_W[0], 0, tolerance);
    // friction between single points, each all or nothing, does not hold
    if (method().name.starts_with("xpbd")) {
        EXPECT_GT(held.velocity_W[0], 0.05);
    }
    const double angle = 1.01 * critical, a = contact_g * (std::sin(angle) - friction * std::cos(angle));
    const Sample slid = end_of(on_ramp(box, 0.05, angle, friction), method(), h);
    EXPECT_NEAR(slid.velocity_W[0], a, tolerance);
    EXPECT_LT(length(slid.angular_velocity_B), tolerance > 0.001 ? 0.1 : tolerance);
}

INSTANTIATE_TEST_SUITE_P(Of, ContactMethod, ::testing::ValuesIn(contact_methods(true)),
                         [](const auto& of) { return std::string(of.param->name); });

/// Median error of a quantity over runs with n, n + n/16, .. steps. Single runs are late by a fraction of a step at an
/// impact or at the end of sliding, which varies irregularly with the step.
template <class Error>
double median_error(long n, const Error& error) {
    constexpr long runs = 16;
    std::vector<double> errors;
    for (long i = 0; i < runs; ++i) errors.push_back(error(1.0 / static_cast<double>(n + n * i / runs)));
    std::nth_element(errors.begin(), errors.begin() + runs / 2, errors.end());
    return errors[runs / 2];
}
template <class Error>
double measured_order(long n, const Error& error) {
    return std::log2(median_error(n, error) / median_error(4 * n, error)) / 2;
}

class ContactOrder : public ::testing::TestWithParam<const Method*> {
  protected:
    static const Method& method() { return *GetParam(); }
};

/// The binary64 methods that converge to the rigid motion.
std::vector<const Method*> rigid_contact_methods() {
    std::vector<const Method*> found = contact_methods(false);
    std::erase_if(found, [](const Method* method) { return is_soft_model(*method); });
    return found;
}

/// The end of sliding falls inside a step: order 1.
TEST_P(ContactOrder, IsOneFromSlidingToRolling) {
    constexpr double u = 3, friction = 0.2;
    const Scene scene = bowling_ball(u, friction);
    const auto error = [&](double h) {
        const Sample end = end_of(scene, method(), h);
        EXPECT_NEAR(end.velocity_W[0], 5 * u / 7, method().name.starts_with("xpbd") ? 3 * h : 1e-10);
        return std::abs(end.position_W[0] - bowled_distance(u, friction, 1));
    };
    // where the depth of a soft contact is not negligible, its error is of the other sign
    const long n = method().name.starts_with("soft") ? 1024 : 64;
    const double order = measured_order(n, error);
    RecordProperty("order", std::to_string(order));
    EXPECT_GT(order, 0.9) << median_error(n, error);
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
    if (method().name == "bullet_contacts") {
        // a contact that acts before the gap closes loses gap / h of the rebound: at any step
        EXPECT_LT(order, 0.5);
        EXPECT_GT(median_error(1024, error), 0.02);
    } else {
        EXPECT_NEAR(order, 1, 0.35) << median_error(256, error);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, ContactOrder, ::testing::ValuesIn(rigid_contact_methods()),
                         [](const auto& of) { return std::string(of.param->name); });

/// A block slides with speed 2 at 45 degrees to the axes of the pyramids. Coulomb's friction decelerates it by mu g; a
/// pyramid gives another factor. Jolt's friction is 1.5 % low here: the impulse limited to the disc is that of separate
/// effective masses along both axes, which does not oppose the slip. XPBD's is 2.3 % low.
TEST(ContactPyramid, DependsOnTheDirectionOfSlip) {
    constexpr double friction = 0.2, u = 2, T = 0.25;
    for (const Method* method : contact_methods(false)) {
        Scene scene = on_floor(Box{{0.2, 0.15, 0.05}}, 0.05, 0, friction);
        scene.duration = T;
        scene.initial.velocity_W = {u * std::numbers::sqrt2 / 2, u * std::numbers::sqrt2 / 2, 0};
        const double factor = diagonal_friction(*method);
        const bool exact = method->family == Family::published_update && !method->name.starts_with("xpbd");
        const Sample end = end_of(scene, *method, std::min(T / 64, accuracy_of(*method).h));
        EXPECT_NEAR(std::hypot(end.velocity_W[0], end.velocity_W[1]), u - factor * friction * contact_g * T,
                    exact ? 1e-3 : 0.012)
            << method->name;
    }
}

/// Times of impacts of a ball that falls from 0.5 m with e = 0.8: t_1 = (2 d / g)^(1/2), then 2 e v_1 / g later. A step
/// reports the impact at its start, up to one step late, and the error adds up.
TEST(ContactImpacts, AreReportedInTheStepThatAppliesThem) {
    constexpr double e = 0.8, drop = 0.5, h = 1.0 / 2048;
    const Scene scene = on_floor(SolidSphere{0.1}, 0.1 + drop, e, 0.3);
    const double first = std::sqrt(2 * drop / contact_g);
    for (const Method* method : contact_methods(false)) {
        if (!refusal(*method, pose(scene)).empty() || is_soft_model(*method)) continue;
        const Trajectory run = with_step(scene, method->name.data(), h);
        ASSERT_GE(run.impact_times.size(), 2U) << method->name;
        EXPECT_NEAR(run.impact_times[0], first, 2 * h) << method->name;
        // a contact that acts before the gap closes shortens the rebound at any step
        if (method->name == "bullet_contacts") continue;
        EXPECT_EQ(run.impact_times.size(), 2U) << method->name;
        EXPECT_NEAR(run.impact_times[1], first + 2 * e * first, 6 * h) << method->name;
    }
}

/// A body that slides, rolls or rests has no impacts. Soft models may bounce when they are released.
TEST(ContactImpacts, AreNoneInLastingContact) {
    for (const Method* method : contact_methods(false)) {
        if (is_soft_model(*method)) continue;
        EXPECT_TRUE(with_step(bowling_ball(3, 0.2), method->name.data(), 1.0 / 256).impact_times.empty())
            << method->name;
        const Scene block = on_ramp(Box{{0.2, 0.15, 0.05}}, 0.05, 0.5, 0.4);
        EXPECT_TRUE(with_step(block, method->name.data(), 1.0 / 128).impact_times.empty()) << method->name;
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

/// Speed after an impact of unit speed with the force max(0, w^2 s + 2 zeta w s') for the depth s = exp(-zeta w t)
/// sin(w_d t) / w_d: it ends where the force vanishes, tan(w_d t) = -2 zeta w_d w / (w^2 (1 - 2 zeta^2)).
double damped_rebound(double e) {
    if (e == 0) return std::exp(-2.0);  // s = t exp(-w t) ends at w t = 2
    const double zeta = -std::log(e) / std::hypot(std::numbers::pi, std::log(e)), root = std::sqrt(1 - zeta * zeta);
    const double angle = std::atan2(2 * zeta * root, 2 * zeta * zeta - 1);
    return -std::exp(-zeta / root * angle) * (std::cos(angle) - zeta / root * std::sin(angle));
}

/// A ball hits the floor without gravity, with steps of a thousandth of the contact's duration.
TEST(PenaltyContacts, SpringAndDamperReboundAsInClosedForm) {
    for (const double e : {0.0, 0.2, 0.5, 0.8, 1.0}) {
        Scene scene = on_floor(SolidSphere{0.1}, 0.101, e, 0);
        scene.duration = 0.02, scene.loads.clear();
        scene.initial.velocity_W = {0, 0, -1};
        const Sample end = end_of(scene, *find_method("penalty_contacts_linear"), 1e-5);
        EXPECT_NEAR(end.velocity_W[2], damped_rebound(e), 0.005) << e;
    }
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
