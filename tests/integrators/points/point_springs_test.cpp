// Bodies of points on springs, by each method: momenta, orders, and the effect of stiffness on the motion.
#include <gtest/gtest.h>

#include <array>

#include "integrators/points/point_runs.h"
#include "integrators/points/stiffness.h"
#include "integrators/scenes.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// A free body that is not flat.
Scene tumbling(double duration) {
    Scene scene = free_body(duration);
    scene.name = "tumbling", scene.body.inertia_B = diagonal(Vector3<double>(1, 1.5, 2));
    return scene;
}

Sample rigid_end(const Scene& scene) { return with_tolerance(scene, "odeint_fehlberg78", 1e-12).samples.back(); }

Settings stepped(double step, long samples = 1) {
    Settings settings;
    settings.step = step, settings.samples = samples;
    return settings;
}
Settings tolerant(double tolerance) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = 4;
    return settings;
}

Vector3<double> momentum_W(const Scene& scene, const Sample& s) {
    return rotate(s.q, scene.body.inertia_B * s.angular_velocity_B);
}

/// The order with respect to the motion of the springs, measured against a finer step.
TEST(PointSprings, HaveTheOrdersOfTheirSchemes) {
    const Problem problem = pose(everything(1));
    PointOptions options;
    options.stiffness = 300;
    const auto end = [&](auto method, double h) {
        const PointRun run = method(problem, stepped(h), options);
        EXPECT_EQ(run.trajectory.status, Status::ok) << run.trajectory.message;
        return run.trajectory.samples.back();
    };
    const Sample fine = end(point_springs_rk4, 1.0 / 6400);
    const auto order = [&](auto method, double h) {
        const Sample a = end(method, h), b = end(method, h / 2);
        EXPECT_GT(attitude_error(b.q, fine.q), 1e-10);
        return std::array{std::log2(attitude_error(a.q, fine.q) / attitude_error(b.q, fine.q)),
                          std::log2(distance(a.position_W, fine.position_W) / distance(b.position_W, fine.position_W)),
                          std::log2(distance(a.angular_velocity_B, fine.angular_velocity_B) /
                                    distance(b.angular_velocity_B, fine.angular_velocity_B))};
    };
    for (const double found : order(point_springs_rk4, 1.0 / 400)) EXPECT_NEAR(found, 4, 0.25);
    for (const double found : order(point_springs_verlet, 1.0 / 800)) EXPECT_NEAR(found, 2, 0.1);
}

/// The attitude error and the stretch are proportional to 1/k.
TEST(PointSprings, ApproachTheRigidBodyAsStiffnessGrows) {
    const Scene scene = tumbling(3);
    const Problem problem = pose(scene);
    const Sample truth = rigid_end(scene);
    const PointBody body = point_body(problem, {});
    std::array<double, 3> error{}, stretch{};
    for (int i = 0; i < 3; ++i) {
        PointOptions options;
        options.stiffness = 1e3 * std::pow(10, i);
        const double h = 0.2 / spring_frequencies(body, *options.stiffness).fastest;
        const PointRun run = point_springs_rk4(problem, stepped(h, 20), options);
        ASSERT_EQ(run.trajectory.status, Status::ok) << run.trajectory.message;
        error[i] = attitude_error(run.trajectory.samples.back().q, truth.q), stretch[i] = run.largest_stretch;
    }
    EXPECT_NEAR(error[0] / error[1], 10, 1);
    EXPECT_NEAR(error[1] / error[2], 10, 1);
    EXPECT_NEAR(stretch[1] / stretch[2], 10, 1);
}

/// Three points in a plane that rotates about its normal. By symmetry each is pulled by two springs at 30 degrees:
/// sqrt(3) k (l - l0) = m w^2 r with l = sqrt(3) r, so (l - l0) / l0 = m w^2 / (3 k - m w^2).
TEST(PointSprings, StretchAsMuchAsTheRotationAsks) {
    Scene scene;
    scene.name = "triangle", scene.duration = 1;
    scene.body.mass = 1.5;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 2));
    scene.initial.angular_velocity = {0, 0, 3};
    PointOptions options;
    options.stiffness = 1e4;
    const double m = 0.5, expected = m * 9 / (3e4 - m * 9);
    const PointRun run = point_springs_rk4(pose(scene), stepped(1e-3, 10), options);
    ASSERT_EQ(run.trajectory.status, Status::ok);
    EXPECT_NEAR(run.largest_stretch, expected, 1e-3 * expected);
}

TEST(PointSprings, KeepTheMomentaOfAFreeBodyByVerlet) {
    Scene scene = tumbling(5);
    scene.initial.velocity_W = {0.3, -0.2, 0.1};
    const Trajectory t = with_step(scene, "point_springs_verlet", 2e-3, 10);
    ASSERT_EQ(t.status, Status::ok) << t.message;
    // L of the points, which differs from that of the rigid body with this attitude and rate by the stretch
    const Vector3<double> L = momentum_W(scene, t.samples.front());
    for (const Sample& s : t.samples) {
        EXPECT_LT(distance(s.velocity_W, scene.initial.velocity_W), 1e-12);
        EXPECT_LT(distance(momentum_W(scene, s), L), 2e-4 * std::sqrt(dot(L, L)));
    }
}

/// Every load, events and a pivot, by all three methods: the remaining error is that of the stretch.
TEST(PointSprings, FollowTheMotionUnderEveryLoad) {
    Scene user = heavy_top(0.3);
    user.loads.push_back(
        UserTorque{"swirl",
                   [](const LoadState& s) { return Vector3<double>(std::sin(s.t), s.q.x, -s.angular_velocity_B[2]); },
                   {}});
    for (const Scene& scene : {everything(1), heavy_top(0.3), user}) {
        const Problem problem = pose(scene);
        const Sample truth = rigid_end(scene);
        const PointBody body = point_body(problem, {});
        const double k = default_stiffness(problem, body), h = 1 / spring_frequencies(body, k).fastest;
        for (const PointRun& run :
             {point_springs_rk4(problem, stepped(h, 4), {}), point_springs_verlet(problem, stepped(h, 4), {}),
              point_springs_cvode_bdf(problem, tolerant(1e-9), {})}) {
            ASSERT_EQ(run.trajectory.status, Status::ok) << scene.name << ": " << run.trajectory.message;
            EXPECT_LT(attitude_error(run.trajectory.samples.back().q, truth.q), 2e-3) << scene.name;
            EXPECT_LT(distance(run.trajectory.samples.back().position_W, truth.position_W), 1e-3) << scene.name;
            EXPECT_LT(run.largest_stretch, 3e-3);
        }
    }
}

TEST(PointSprings, SayWhichStepTheyWant) {
    const Scene scene = tumbling(4);
    const Problem problem = pose(scene);
    const PointBody body = point_body(problem, {});
    const double fastest = spring_frequencies(body, default_stiffness(problem, body)).fastest;
    // just beyond the limit the classical scheme folds the body up and continues
    for (const double share : {1.04, 1.2})
        for (const auto& [method, limit] :
             {std::pair{&point_springs_rk4, 2 * std::sqrt(2)}, std::pair{&point_springs_verlet, 2.0}}) {
            EXPECT_EQ(method(problem, stepped(0.97 * limit / fastest, 4), {}).trajectory.status, Status::ok);
            const Trajectory beyond = method(problem, stepped(share * limit / fastest, 4), {}).trajectory;
            EXPECT_EQ(beyond.status, Status::diverged);
            EXPECT_NE(beyond.message.find("require steps below"), std::string::npos) << beyond.message;
        }
}

/// Dampers let CVODE take steps longer than the vibrations and do not change the motion at this accuracy.
TEST(PointSpringsCvode, OutgrowsDampedVibrations) {
    const Scene scene = tumbling(3);
    const Problem problem = pose(scene);
    const Sample truth = rigid_end(scene);
    PointOptions damped, undamped;
    damped.stiffness = undamped.stiffness = 1e6;
    undamped.damping_ratio = 0;
    Settings settings = tolerant(1e-8);
    settings.max_steps = 20000;
    const PointRun with = point_springs_cvode_bdf(problem, settings, damped);
    ASSERT_EQ(with.trajectory.status, Status::ok) << with.trajectory.message;
    EXPECT_LT(attitude_error(with.trajectory.samples.back().q, truth.q), 1e-3);
    // half the number of steps that the explicit scheme of order 4 needs
    const double fastest = spring_frequencies(point_body(problem, {}), 1e6).fastest;
    EXPECT_LT(static_cast<double>(with.trajectory.steps), 0.5 * fastest * scene.duration / 2.83);
    const PointRun without = point_springs_cvode_bdf(problem, settings, undamped);
    EXPECT_GT(without.trajectory.steps, 2 * with.trajectory.steps);
}

}  // namespace
}  // namespace polhode
