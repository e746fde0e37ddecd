// Projection onto the invariants of the motion: what it improves, what it leaves unchanged and which errors it hides.
#include "integrators/geometric/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "integrators/scenes.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// A spring about an axis other than a principal axis: only the energy is conserved.
Scene sprung_body(double duration) {
    Scene scene = free_body(duration);
    scene.name = "sprung body", scene.loads = {Spring{1.3, {0.8, 0.6, 0, 0}, {}}};
    return scene;
}
/// A pendulum that swings about a principal axis.
Scene pendulum(double duration) {
    Scene scene = heavy_top(duration);
    scene.name = "pendulum", scene.initial.angular_velocity = {3, 0, 0};
    return scene;
}
Scene thrown_body(double duration) {
    Scene scene = free_body(duration);
    scene.name = "thrown body", scene.initial.velocity_W = {1, 2, 3};
    scene.loads = {Gravity{{0, 0, -9.80665}, {}}};
    return scene;
}

/// The largest relative drift of the conserved quantities over the samples, computed by motion/conserved.h, which is
/// independent of the projection's polynomials.
double worst_drift(const Scene& scene, const Trajectory& trajectory) {
    const Problem problem = pose(scene);
    double worst = 0;
    for (const Conserved& one : conserved(problem)) {
        if (one.kind == ConservedKind::integral_of_a_special_top) continue;
        double size = 0, drift = 0;
        for (const Sample& sample : trajectory.samples) {
            const std::vector<double> value = one.of(problem, one, sample);
            for (std::size_t i = 0; i < value.size(); ++i) {
                size = std::max(size, std::abs(one.value[i]));
                drift = std::max(drift, std::abs(value[i] - one.value[i]));
            }
        }
        worst = std::max(worst, size > 0 ? drift / size : drift);
    }
    return worst;
}
double worst_norm(const Trajectory& trajectory) {
    double worst = 0;
    for (const Sample& sample : trajectory.samples)
        worst = std::max(worst, std::abs(std::sqrt(squared_norm(sample.q)) - 1));
    return worst;
}

struct Case {
    const char* method;
    double setting;  ///< a step if above 1e-4, else a tolerance
};
class Projected : public ::testing::TestWithParam<Case> {
  protected:
    static Trajectory run(const Scene& scene, Formulation formulation = Formulation::reduced) {
        Settings settings;
        (GetParam().setting > 1e-4 ? settings.step : settings.tolerance) = GetParam().setting;
        settings.samples = 37, settings.formulation = formulation;
        return solve(scene, *find_method(GetParam().method), settings);
    }
};
INSTANTIATE_TEST_SUITE_P(
    Methods, Projected,
    ::testing::Values(Case{"odeint_rk4_projected", 1e-2}, Case{"odeint_fehlberg78_projected", 5e-2},
                      Case{"odeint_fehlberg78_projected", 1e-6}, Case{"cvode_bdf_projected", 1e-6}),
    [](const auto& of) { return std::string(of.param.method) + (of.param.setting > 1e-4 ? "_fixed" : "_controlled"); });

TEST_P(Projected, KeepsWhatTheMotionKeepsToRoundOff) {
    for (const Scene& scene :
         {free_body(20), symmetric_body(20), heavy_top(5), sprung_body(10), pendulum(5), thrown_body(1)})
        for (const Formulation formulation : {Formulation::reduced, Formulation::full}) {
            const Trajectory trajectory = run(scene, formulation);
            ASSERT_EQ(trajectory.status, Status::ok) << scene.name << ": " << trajectory.message;
            // measured at most 5e-15: 4 ulp from the projection in each of up to nine constraints, and as many from
            // the evaluation here, where the potential is a difference of larger numbers
            EXPECT_LT(worst_drift(scene, trajectory), 5e-14) << scene.name;
            EXPECT_LT(worst_norm(trajectory), 4e-15) << scene.name;
        }
}

TEST_P(Projected, KeepsTheNormAloneWhereNothingElseIsKept) {
    const Trajectory trajectory = run(everything(3));
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    EXPECT_LT(worst_norm(trajectory), 4e-15);
}

// In steady rotation the gradients of energy and momentum are parallel; for a sphere they always are.
TEST_P(Projected, StandsConstraintsThatDependOnEachOther) {
    Scene steady = free_body(10), sphere = free_body(10), nearly = free_body(10), at_rest = free_body(10);
    steady.initial.angular_velocity = {0, 1, 0};
    sphere.body.inertia_B = diagonal(Vector3<double>(2, 2, 2));
    nearly.initial.angular_velocity = {1e-9, 1, 1e-9};
    at_rest.initial.angular_velocity = {0, 0, 0};
    for (const Scene& scene : {steady, sphere, nearly, at_rest}) {
        const Trajectory trajectory = run(scene, Formulation::full);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        EXPECT_LT(worst_drift(scene, trajectory), 5e-14);
        EXPECT_LT(worst_norm(trajectory), 4e-15);
    }
}

// The conserved quantities are accurate to round-off, but the attitude error remains that of the step. Measured over
// T = 100 s with I = (1, 2, 3), omega = (1, 1, 1), h = 0.1 s: attitude error 6.0e-4 without and 1.7e-4 with
// projection, energy error 1.1e-5 and 3e-16.
TEST(Projection, HidesTheErrorAlongTheManifold) {
    const Scene scene = free_body(100);
    const Quaternion<double> truth = with_step(scene, "odeint_fehlberg78", 0.02).samples.back().q;
    const Trajectory plain = with_step(scene, "odeint_rk4", 0.1, 10),
                     moved = with_step(scene, "odeint_rk4_projected", 0.1, 10);
    EXPECT_GT(worst_drift(scene, plain), 1e-6);
    EXPECT_LT(worst_drift(scene, moved), 5e-14);
    const double before = attitude_error(plain.samples.back().q, truth),
                 after = attitude_error(moved.samples.back().q, truth);
    EXPECT_GT(after, before / 20);
    EXPECT_LT(after, before);
    EXPECT_GT(after, 1e-5);
}

// The error estimate is not projected. A projected estimate keeps CVODE at order 1 with five to ten times the steps.
TEST(Projection, CostsBdfNoSteps) {
    for (const Scene& scene : {symmetric_body(100), heavy_top(20)}) {
        const Trajectory plain = with_tolerance(scene, "cvode_bdf", 1e-6),
                         moved = with_tolerance(scene, "cvode_bdf_projected", 1e-6);
        ASSERT_EQ(moved.status, Status::ok) << moved.message;
        EXPECT_LT(moved.steps, 2 * plain.steps);
    }
}

// The projection moves a state perpendicularly to the manifold, in units of the scales.
TEST(Projection, GoesToTheNearestPoint) {
    const Problem problem = pose(heavy_top(1));
    using System7 = LoadedRotation;
    Projection<System7> projection(problem);
    EXPECT_EQ(projection.count(), 4);  // |q|, L_z, spin, E
    double scale[7], start[7];
    System7(problem).scales(scale);
    System7(problem).initial(start);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int k = 0; k < 100; ++k) {
        double off[7], on[7];
        // a state on the manifold, far from the start
        for (int i = 0; i < 7; ++i) on[i] = start[i] + 0.3 * scale[i] * uniform(random);
        if (!projection.project(on)) continue;
        for (int i = 0; i < 7; ++i) off[i] = on[i] + 1e-6 * scale[i] * uniform(random);
        std::copy(off, off + 7, on);
        ASSERT_TRUE(projection.project(on));
        double move = 0;
        for (int i = 0; i < 7; ++i) move += std::pow((off[i] - on[i]) / scale[i], 2);
        EXPECT_LT(move, 7e-12);
        double along[7], product = 0, length = 0;
        for (int i = 0; i < 7; ++i) along[i] = on[i] + 1e-5 * scale[i] * uniform(random);
        ASSERT_TRUE(projection.project(along));
        for (int i = 0; i < 7; ++i) {
            product += (along[i] - on[i]) * (off[i] - on[i]) / (scale[i] * scale[i]);
            length += std::pow((along[i] - on[i]) / scale[i], 2);
        }
        // over this distance the manifold curves by 1e-5 and the linearisation errs by 1e-6; times curvatures below 20
        EXPECT_LT(std::abs(product), 1e-3 * std::sqrt(length * move)) << k;
    }
}

TEST(Projection, LeavesWhatIsTooFarOrNotANumber) {
    const Problem problem = pose(heavy_top(1));
    Projection<LoadedRotation> projection(problem);
    double y[7];
    LoadedRotation(problem).initial(y);
    y[4] = std::nan("");
    EXPECT_FALSE(projection.project(y));
    double zero[7] = {};
    projection.project(zero);
    for (double value : zero) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace polhode
