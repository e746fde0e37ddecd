// Faults of friction, limits, gears and armatures of joints. The engines are a slider and a pair of geared rotors by
// semi-implicit Euler, which share no code with the library. Each has one fault at a time.
#include "check/joint_event_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace polhode {
namespace {

constexpr double slider_mass = 2, slider_force = 3, slider_friction = 1.2, slider_spring = 20, slider_limit = 0.35,
                 slider_restitution = 0.5, slider_armature = 0.8;

Scene slider() {
    Scene scene;
    scene.name = "slider", scene.duration = 3;
    scene.bodies.resize(1);
    scene.bodies[0].name = "block", scene.bodies[0].body.mass = slider_mass;
    scene.bodies[0].body.inertia_B = diagonal(Vector3<double>(1, 1, 1));
    scene.joints.resize(1);
    Joint& rail = scene.joints[0];
    rail.name = "rail", rail.type = JointType::prismatic, rail.child = "block", rail.axes[0] = {1, 0, 0};
    rail.rate[0] = 1.5, rail.stiffness[0] = slider_spring, rail.friction = slider_friction;
    rail.limits.upper = slider_limit, rail.limits.restitution = slider_restitution;
    rail.armature[0] = slider_armature;
    scene.loads = {Motor{"rail", slider_force, {}}};
    return scene;
}

struct SliderFaults {
    double friction = 1, viscous = 0, limit_shift = 0, restitution = slider_restitution, armature = 1;
    bool limited = true;
};

// Semi-implicit Euler; friction stops the slider within a step at most.
TrajectoryFile slide(const SliderFaults& faults, double h) {
    TrajectoryFile file;
    file.bodies = {"block"}, file.has_position = file.has_velocity = true;
    const double m = slider_mass + faults.armature * slider_armature;
    double x = 0, v = 1.5;
    const int rows = 60, substeps = static_cast<int>(std::lround(3 / (rows * h)));
    for (int row = 0; row <= rows; ++row) {
        file.rows.push_back({3.0 * row / rows, {1, 0, 0, 0}, {}, {x, 0, 0}, {v, 0, 0}});
        for (int i = 0; i < substeps; ++i) {
            v += h * (slider_force - slider_spring * x - faults.viscous * v) / m;
            const double most = h * faults.friction * slider_friction / m;
            v = std::abs(v) <= most ? 0 : v - std::copysign(most, v);
            x += h * v;
            const double limit = slider_limit + faults.limit_shift;
            if (faults.limited && x > limit && v > 0) x = limit, v *= -faults.restitution;
        }
    }
    return file;
}

std::string found(const Scene& scene, const TrajectoryFile& file) {
    std::string all;
    for (const Diagnosis& d : joint_event_faults(scene, file)) all += d.fault + ": " + d.message + "\n";
    return all;
}

class SliderTest : public ::testing::TestWithParam<double> {};

TEST_P(SliderTest, ASoundEngineHasNoFault) { EXPECT_EQ(found(slider(), slide({}, GetParam())), ""); }

TEST_P(SliderTest, FaultsAreNamedAndMeasured) {
    const auto expect = [&](const SliderFaults& faults, const char* fault, const char* text) {
        const std::string all = found(slider(), slide(faults, GetParam()));
        EXPECT_TRUE(all.starts_with(fault) && all.find(text) != std::string::npos)
            << "expected " << fault << ": " << text << "\nfound " << all;
        EXPECT_EQ(std::ranges::count(all, '\n'), 1) << all;
    };
    expect({.friction = 0}, "joint_friction_missing", "the friction of joint rail is missing");
    expect({.friction = 2}, "joint_friction_scaled", "the friction of joint rail is 2");
    expect({.friction = 0, .viscous = 3}, "joint_friction_viscous", "is viscous: 3");
    expect({.limit_shift = 0.05}, "joint_limit_shifted", "the upper limit of joint rail acts 0.05");
    expect({.restitution = 0.9}, "joint_limit_restitution", "is 0.9");
    expect({.limited = false}, "joint_limit_missing", "the limits of joint rail do not act");
    expect({.armature = 0}, "armature_missing", "the armature of joint rail is missing");
}

// the smaller step is accurate; the larger one has errors of some percent
INSTANTIATE_TEST_SUITE_P(Steps, SliderTest, ::testing::Values(1e-5, 1.0 / 240));

constexpr double gear_ratio = -2.5, rotor_moment = 0.2, driven_moment = 0.05, motor_torque = 0.4;

Scene gears() {
    Scene scene;
    scene.name = "gears", scene.duration = 2;
    scene.bodies.resize(2);
    for (const int i : {0, 1}) {
        NamedBody& body = scene.bodies[static_cast<std::size_t>(i)];
        body.name = i == 0 ? "rotor" : "driven", body.body.mass = 1;
        const double moment = i == 0 ? rotor_moment : driven_moment;
        body.body.inertia_B = diagonal(Vector3<double>(moment, moment, moment));
    }
    scene.joints.resize(2);
    for (const int i : {0, 1}) {
        Joint& joint = scene.joints[static_cast<std::size_t>(i)];
        joint.name = i == 0 ? "shaft" : "wheel", joint.child = i == 0 ? "rotor" : "driven";
        joint.axes[0] = {0, 0, 1}, joint.parent_point = {i == 0 ? 0.0 : 1.0, 0, 0};
    }
    scene.couplings = {{"shaft", "wheel", gear_ratio, 0}};
    scene.loads = {Motor{"shaft", motor_torque, {}}};
    return scene;
}

// The angles are a t^2/2 and k times that, with a = torque / (I_1 + k^2 I_2).
TrajectoryFile turn(double k) {
    TrajectoryFile file;
    file.bodies = {"rotor", "driven"};
    const double a = motor_torque / (rotor_moment + k * k * driven_moment);
    for (int row = 0; row <= 40; ++row) {
        const double t = 2.0 * row / 40, angle = a * t * t / 2;
        for (const double x : {angle, k * angle})
            file.rows.push_back({t, {std::cos(x / 2), 0, 0, std::sin(x / 2)}, {}, {}, {}});
    }
    return file;
}

TEST(JointEventFaults, GearsAreTested) {
    EXPECT_EQ(found(gears(), turn(gear_ratio)), "");
    const auto expect = [&](double k, const char* fault) {
        const std::string all = found(gears(), turn(k));
        EXPECT_TRUE(all.starts_with(fault)) << "expected " << fault << "\nfound " << all;
    };
    expect(1 / gear_ratio, "gear_inverted");
    expect(-gear_ratio, "gear_reversed");
    expect(0, "gear_missing");
    expect(1.2 * gear_ratio, "gear_scaled: the ratio of joints shaft and wheel is 1.2 times the scene's");
}

}  // namespace
}  // namespace polhode
