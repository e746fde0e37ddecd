// Points with constant distances, solved by IDA, against the rigid motion.
#include <gtest/gtest.h>

#include "integrators/points/point_runs.h"
#include "integrators/scenes.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// A body in flight, a flat one, one with a pivot, and one with every load.
TEST(PointConstraintsIda, FollowsTheMotionToItsTolerance) {
    for (const Scene& scene : {symmetric_body(5), free_body(5), heavy_top(1), everything(2)}) {
        const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back();
        const Problem problem = pose(scene);
        double before = 1;
        for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
            Settings settings;
            settings.tolerance = tolerance, settings.samples = 10;
            const PointRun run = point_constraints_ida(problem, settings, {});
            ASSERT_EQ(run.trajectory.status, Status::ok) << scene.name << ": " << run.trajectory.message;
            const Sample& end = run.trajectory.samples.back();
            const double error = attitude_error(end.q, truth.q);
            // the errors of hundreds of steps add up
            EXPECT_LT(error, 1e4 * tolerance * scene.duration) << scene.name;
            EXPECT_LT(distance(end.position_W, truth.position_W), 1e4 * tolerance * scene.duration) << scene.name;
            EXPECT_LT(error, before / 5) << scene.name;
            before = error;
            EXPECT_LT(run.largest_stretch, 100 * tolerance) << scene.name;
            EXPECT_GT(run.largest_stretch, 0.0);
        }
    }
}

/// The centre of mass moves freely on a line, however far. The tolerance applies to the points relative to it.
TEST(PointConstraintsIda, LosesNoAttitudeByFlyingFar) {
    Scene scene = symmetric_body(5);
    scene.initial.velocity_W = {1000, 0, 0};
    const Trajectory t = with_tolerance(scene, "point_constraints_ida", 1e-8);
    ASSERT_EQ(t.status, Status::ok) << t.message;
    EXPECT_LT(attitude_error(t.samples.back().q, symmetric_attitude(scene, 5)), 1e-4);
    EXPECT_NEAR(t.samples.back().position_W[0], 5000, 1e-6);
}

TEST(PointConstraintsIda, SaysWhyWhereItCannotMeetItsTolerance) {
    const Trajectory t = with_tolerance(symmetric_body(5), "point_constraints_ida", 1e-17);
    EXPECT_EQ(t.status, Status::tolerance_not_met);
    EXPECT_FALSE(t.message.empty());
}

}  // namespace
}  // namespace polhode
