// The joints of every available engine, on mechanisms whose motion is known independently.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "body/orientation.h"
#include "integrators/method.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_file.h"
#include "tests/integrators/engines/engines_here.h"

namespace polhode {
namespace {

Trajectory jointed_motion(const EngineMethod& engine, const Scene& scene, double step) {
    Settings settings;
    settings.step = step, settings.samples = 10, settings.seconds_limit = 60;
    return solve(scene, *engine.method, settings);
}

Trajectory truth_of(const Scene& scene) {
    Settings settings;
    settings.tolerance = 1e-12, settings.samples = 10;
    return solve(scene, *find_method("taylor"), settings);
}

double worst_attitude(const Trajectory& run, const Trajectory& truth) {
    double worst = 0;
    for (std::size_t k = 0; k < truth.samples.size(); ++k)
        worst = std::max(worst, rotation_angle_between(run.samples[k].q, truth.samples[k].q));
    return worst;
}

double worst_place(const Trajectory& run, const Trajectory& truth) {
    double worst = 0;
    for (std::size_t k = 0; k < truth.samples.size(); ++k)
        worst = std::max(worst, hypotenuse(run.samples[k].position_W - truth.samples[k].position_W));
    return worst;
}

/// One setting without joint damping of each engine that has joints.
std::vector<const EngineMethod*> jointed() {
    std::vector<const EngineMethod*> all;
    std::set<std::string> seen;
    for (const EngineMethod& engine : engines_here())
        if (is_undamped(engine) && !engine.inspect(nullptr).hello.joints.empty() &&
            seen.insert(engine.engine + (engine.setting == "rk4" ? "4" : "")).second)
            all.push_back(&engine);
    return all;
}

// The error is of first order and halves with the step; engines of higher order are already accurate. Engines in
// binary32 also have rounding errors.
TEST(EngineJoints, FollowPendulums) {
    SKIP_WITHOUT_ENGINES();
    for (const char* name : {"mechanisms/physical_pendulum", "mechanisms/double_pendulum"}) {
        Scene scene = find_scene(name);
        scene.duration = 1;
        const Trajectory truth = truth_of(scene);
        ASSERT_EQ(truth.status, Status::ok) << truth.message;
        for (const EngineMethod* engine : jointed()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, name));
            const bool is_single = engine->method->precision == Precision::binary32;
            const Trajectory coarse = jointed_motion(*engine, scene, 2e-3), fine = jointed_motion(*engine, scene, 1e-3);
            ASSERT_EQ(coarse.status, Status::ok) << coarse.message;
            ASSERT_EQ(fine.status, Status::ok) << fine.message;
            ASSERT_EQ(fine.bodies, static_cast<int>(scene.bodies.size()));
            const double at_coarse = worst_attitude(coarse, truth), at_fine = worst_attitude(fine, truth);
            // an undamped motion at some rad/s with h = 1/1000 s (largest error: 0.016 rad, Bullet's reduced
            // coordinates on the double pendulum)
            EXPECT_LT(at_fine, is_single ? 0.05 : 0.03);
            EXPECT_LT(worst_place(fine, truth), is_single ? 0.05 : 0.03);
            if (at_coarse > 1e-4 && !is_single) {
                EXPECT_NEAR(at_coarse / at_fine, 2, 0.5);
            }
        }
    }
}

// Each type of joint, with different axes and frames.
TEST(EngineJoints, KeepEachTypeOfJoint) {
    SKIP_WITHOUT_ENGINES();
    for (const char* name :
         {"mechanisms/double_pendulum_spatial", "mechanisms/spherical_pendulum", "mechanisms/elliptic_trammel",
          "mechanisms/welded_pendulum", "mechanisms/four_bar", "mechanisms/free_body_as_mechanism"}) {
        Scene scene = find_scene(name);
        scene.duration = 0.25;
        const Trajectory truth = truth_of(scene);
        ASSERT_EQ(truth.status, Status::ok) << truth.message;
        double turned = 0;
        for (const Sample& s : truth.samples) turned = std::max(turned, hypotenuse(s.angular_velocity_B));
        for (const EngineMethod* engine : jointed()) {
            SCOPED_TRACE(fmt::format("{} {}", engine->method->name, name));
            // no gyroscopic term, so motion in space differs for reasons other than joints
            if (engine->engine == "havok" || engine->engine == "cannon_es" || engine->engine == "ammo") continue;
            const Trajectory run = jointed_motion(*engine, scene, 2.5e-4);
            if (run.status == Status::unsupported) {
                EXPECT_NE(run.message, "");
                continue;
            }
            ASSERT_EQ(run.status, Status::ok) << run.message;
            EXPECT_LT(worst_attitude(run, truth), 0.005 * (1 + turned));
            EXPECT_LT(worst_place(run, truth), 0.02);
        }
    }
}

TEST(EngineJoints, RepeatTheirNumbers) {
    SKIP_WITHOUT_ENGINES();
    Scene scene = find_scene("mechanisms/double_pendulum");
    scene.duration = 0.2;
    for (const EngineMethod* engine : jointed()) {
        SCOPED_TRACE(engine->method->name);
        const Trajectory first = jointed_motion(*engine, scene, 1e-2), second = jointed_motion(*engine, scene, 1e-2);
        ASSERT_EQ(first.samples.size(), 22u) << first.message;
        for (std::size_t k = 0; k < first.samples.size(); ++k) EXPECT_EQ(first.samples[k].q, second.samples[k].q);
    }
}

}  // namespace
}  // namespace polhode
