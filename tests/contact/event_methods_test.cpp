// Methods that follow contact, joint limits and dry friction from event to event, on all scenes of the catalogue with
// such events, against Taylor series of 13 digits, which other tests compare with the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "body/orientation.h"
#include "catalogue.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/method.h"

namespace polhode {
namespace {

constexpr std::array methods{"taylor", "extrapolation", "dop853", "radau", "cvode_adams", "cvode_bdf"};

/// Largest attitude error, rad, and largest error of the velocities, relative to their largest size above 1 m/s.
struct Errors {
    double attitude = 0, velocity = 0;
};

Trajectory solved(const Scene& scene, const char* method, double tolerance, long samples) {
    Settings settings;
    settings.samples = samples, settings.tolerance = tolerance;
    return solve(scene, *find_method(method), settings);
}

Errors errors_of(const Trajectory& trajectory, const Trajectory& exact) {
    Errors errors;
    double largest = 1, difference = 0;
    for (std::size_t i = 0; i < exact.samples.size(); ++i) {
        const Sample &expected = exact.samples[i], &sample = trajectory.samples[i];
        errors.attitude = std::max(errors.attitude, rotation_angle_between(sample.q, expected.q));
        for (std::size_t k = 0; k < 3; ++k) {
            largest = std::max(largest, std::abs(expected.velocity_W[k]));
            difference = std::max(difference, std::abs(sample.velocity_W[k] - expected.velocity_W[k]));
        }
    }
    errors.velocity = difference / largest;
    return errors;
}

bool is_multistep(const char* method) { return std::string_view(method).starts_with("cvode"); }

void expect_agreement(const std::string& scene_name) {
    const Scene scene = find_scene(scene_name);
    const Trajectory exact = solved(scene, "taylor", 1e-13, 7);
    ASSERT_EQ(exact.status, Status::ok) << scene_name << ": " << exact.message;
    for (const char* name : methods) {
        const Trajectory trajectory = solved(scene, name, 1e-10, 7);
        ASSERT_EQ(trajectory.status, Status::ok) << name << " on " << scene_name << ": " << trajectory.message;
        ASSERT_EQ(trajectory.samples.size(), exact.samples.size()) << name << " on " << scene_name;
        const Errors errors = errors_of(trajectory, exact);
        // the errors of many short steps add up; the long steps of extrapolation are inaccurate at small bounces
        const bool is_loose = is_multistep(name) || std::string_view(name) == "extrapolation";
        const double allowed = is_loose ? 1e-4 : 1e-6;
        EXPECT_LE(errors.attitude, allowed) << name << " on " << scene_name;
        EXPECT_LE(errors.velocity, allowed) << name << " on " << scene_name;
    }
}

std::vector<std::string> scenes_with_events() {
    std::vector<std::string> all = scenes_in("contact");
    for (const std::string& name : scenes_in("joints"))
        if (contact::has_events(find_scene(name))) all.push_back(name);
    return all;
}

TEST(EventMethods, AgreeWithTaylorSeries) {
    const std::vector<std::string> scenes = scenes_with_events();
    EXPECT_GE(scenes.size(), 30u);
    for (const std::string& scene : scenes) expect_agreement(scene);
}

// 2 |u| / (7 mu g): the end of the slip of a bowling ball
TEST(EventMethods, LocateTheStartOfRolling) {
    const Scene scene = find_scene("contact/bowling_ball");
    const Vector3<double>&v = scene.initial.velocity_W, &w = scene.initial.angular_velocity;
    const double r = scene.initial.position_W[2], mu = scene.planes[0].friction,
                 g = -std::get<Gravity>(scene.loads[0]).acceleration_W[2];
    const double expected = 2 * std::hypot(v[0] - r * w[1], v[1] + r * w[0]) / (7 * mu * g);
    for (const char* name : methods) {
        Settings settings;
        settings.tolerance = 1e-11, settings.samples = 1;
        const contact::Run<double> run = contact::follow_in_binary64(pose(scene), settings, find_method(name)->steps);
        ASSERT_EQ(run.record.events.size(), 1u) << name;
        EXPECT_NEAR(run.record.events.front().t, expected, is_multistep(name) ? 1e-7 : 1e-9) << name;
    }
}

// The error decreases with the tolerance.
TEST(EventMethods, ConvergeWithTheTolerance) {
    const Scene scene = find_scene("contact/tippe_top");
    const Trajectory exact = solved(scene, "taylor", 1e-13, 4);
    for (const char* name : methods) {
        double former = 1;
        for (const double tolerance : {1e-6, 1e-9}) {
            const Trajectory trajectory = solved(scene, name, tolerance, 4);
            ASSERT_EQ(trajectory.status, Status::ok) << name << ": " << trajectory.message;
            const double error = errors_of(trajectory, exact).attitude;
            EXPECT_LT(error, former / 10) << name << " at " << tolerance;
            former = error;
        }
    }
}

TEST(EventMethods, RefuseLoadsThatContactDoesNotSupport) {
    Scene scene = find_scene("contact/bowling_ball");
    scene.loads.emplace_back(UserTorque{"none", [](const LoadState&) { return Vector3<double>(); }, {}});
    for (const char* name : methods) EXPECT_NE(refusal(*find_method(name), pose(scene)), "") << name;
}

}  // namespace
}  // namespace polhode
