#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/run/stiffness.h"
#include "integrators/scenes.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// A body with drag c (N m s) over 10 s; I = (1, 2, 3) kg m^2, so the fastest decay rate is c per second.
Scene damped(double c, double duration = 10) {
    Scene scene = testing::free_body(duration);
    scene.loads = {Drag{{c, c, c}, 0, {}}};
    return scene;
}
Scene on_spring(double stiffness, double c, double duration) {
    Scene scene = damped(c, duration);
    scene.initial.orientation = {0.96, 0.28, 0, 0};
    scene.loads = {Drag{{c, c, c}, 0, {}}, Spring{stiffness, {1, 0, 0, 0}, {}}};
    return scene;
}

std::string chosen(const Scene& scene, Formulation formulation = Formulation::reduced) {
    const Choice choice = choose_method(pose(scene, formulation));
    EXPECT_FALSE(choice.why.empty());
    return std::string(choice.method->name);
}

TEST(ChooseMethod, TakesAnImplicitOneWhereDampingBindsTheStep) {
    for (const Formulation formulation : {Formulation::reduced, Formulation::full}) {
        EXPECT_EQ(chosen(damped(1100), formulation), "radau");
        EXPECT_EQ(chosen(damped(55), formulation), "radau");
        EXPECT_NE(chosen(damped(45), formulation), "radau");
    }
    EXPECT_NE(chosen(damped(1e-3)), "radau");
    EXPECT_EQ(chosen(damped(0)), "exact");
    EXPECT_NE(chosen(damped(0), Formulation::full), "radau");
}

// An overdamped spring: I lambda^2 + c lambda + k = 0 per axis. The largest |lambda| is just below c / I - k / c.
TEST(ChooseMethod, SeesDampedSprings) {
    EXPECT_EQ(chosen(on_spring(1e4, 1000, 5)), "radau");
    // 80 slowly decaying oscillations, which an explicit method follows as efficiently
    EXPECT_NE(chosen(on_spring(1e4, 10, 5)), "radau");
    // long after coming to rest, an explicit method would still take steps as for the oscillation
    EXPECT_EQ(chosen(on_spring(1e4, 10, 500)), "radau");
    // without damping a moving body is not stiff
    EXPECT_NE(chosen(on_spring(1e8, 0, 10)), "radau");
}

// A sustained spin rotates the body as fast as the damping decays.
TEST(ChooseMethod, LeavesFastSustainedTurningToAnExplicitOne) {
    Scene scene = damped(1, 1000);
    scene.loads = {Drag{{1, 1, 1}, 0, {}}, Torque{{50, 30, 20}, Frame::body, {}}};
    EXPECT_NE(chosen(scene), "radau");
    scene.loads = {Drag{{1, 1, 1}, 0, {}}, Torque{{0.005, 0.003, 0.002}, Frame::body, {}}};
    EXPECT_EQ(chosen(scene), "radau");
}

TEST(ChooseMethod, LooksAtEverySegmentByItself) {
    Scene scene = damped(1000);
    scene.loads = {Drag{{1000, 1000, 1000}, 0, {9.9, 10}}};
    EXPECT_NE(chosen(scene), "radau");
    scene.loads = {Drag{{1000, 1000, 1000}, 0, {5, 10}}};
    EXPECT_EQ(chosen(scene), "radau");
}

// An implicit method would need the derivative of the user-defined torque.
TEST(ChooseMethod, LeavesAUsersTorqueToAnExplicitOne) {
    Scene scene = damped(1100);
    scene.loads = {Drag{{1100, 1100, 1100}, 0, {}},
                   UserTorque{"none", [](const LoadState&) { return Vector3<double>(); }, {}}};
    EXPECT_NE(chosen(scene), "radau");
    EXPECT_EQ(stiffness(pose(scene)).decay_times, 0);
}

// For a spin about the first axis omega_1 decays as e^(-c t): the body rotates by 1 / c rad during c T decays.
TEST(Stiffness, CountsDecaysAndTurning) {
    for (const double c : {1.0, 100.0}) {
        Scene scene = damped(c);
        scene.initial.angular_velocity = {1, 0, 0};
        const Stiffness found = stiffness(pose(scene));
        EXPECT_NEAR(found.decay_times, 10 * c, 1e-6 * c);
        EXPECT_LT(found.rotation, 1 / c);
        EXPECT_EQ(found.stiff(), c == 100.0);
    }
}

// Right-hand sides with few operations use series, those with many use extrapolation, earlier at loose tolerances.
TEST(ChooseMethod, TakesWhatIsFastestForJoinedBodies) {
    const auto taken = [](const char* name, double tolerance) {
        return std::string(choose_method(pose(find_scene(name)), tolerance).method->name);
    };
    for (const double tolerance : {1e-6, 1e-9, 1e-12})
        EXPECT_EQ(taken("mechanisms/double_pendulum", tolerance), "taylor");
    EXPECT_EQ(taken("mechanisms/four_bar", 1e-9), "extrapolation");
    EXPECT_EQ(taken("mechanisms/four_bar", 1e-13), "taylor");
    EXPECT_EQ(taken("mechanisms/chain_10", 1e-12), "extrapolation");
    // at this tolerance only rounding matters
    EXPECT_EQ(taken("mechanisms/chain_10", 1e-15), "taylor");
}

}  // namespace
}  // namespace polhode
