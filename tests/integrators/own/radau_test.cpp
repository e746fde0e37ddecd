// Radau IIA: stiff motion against a closed form and the truth, other motion against `exact`.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "build_kind.h"
#include "integrators/scenes.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// A symmetric body about its axis z, driven by a torque against drag c: I dw/dt = torque - c w.
Scene driven_spin(double c, double torque, double duration) {
    Scene scene;
    scene.name = "driven spin", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 2));
    scene.initial.angular_velocity = {0, 0, 3};
    scene.loads = {Torque{{0, 0, torque}, Frame::body, {}}, Drag{{c, c, c}, 0, {}}};
    return scene;
}

/// The attitude of driven_spin(): the integral of w = u + (3 - u) e^(-c t / 2) with u = torque / c.
Quaternion<double> driven_attitude(double c, double torque, double t) {
    const double u = torque / c, angle = u * t - (3 - u) * std::expm1(-c * t / 2) * 2 / c;
    return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
}

/// The heavy body in a viscous fluid of the built-in scene stiff_drag, with this drag.
Scene viscous(double c, double duration) {
    Scene scene;
    scene.name = "viscous", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1.75, 2.75));
    scene.body.center_of_mass = {0.5, 0, 0};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.initial.orientation = {0.8600655610487502, 0, -0.5101835264862032, 0};
    scene.initial.angular_velocity = {1, 1, 1};
    scene.loads = {Gravity{{0, 0, -10}, {}}, Drag{{c, c, c}, 0, {}}};
    return scene;
}

double error_at(const Scene& scene, const Trajectory& trajectory, const Quaternion<double>& q) {
    EXPECT_EQ(trajectory.status, Status::ok) << scene.name << ": " << trajectory.message;
    return trajectory.samples.empty() ? std::numeric_limits<double>::infinity()
                                      : attitude_error(trajectory.samples.back().q, q);
}

TEST(RadauMethod, MeetsItsToleranceWhateverTheStiffness) {
    for (const double c : {1.0, 1e2, 1e4, 1e6, 1e8})
        for (const Formulation formulation : {Formulation::reduced, Formulation::full})
            for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
                const Scene scene = driven_spin(c, 2 * c, 10);
                Settings settings;
                settings.tolerance = tolerance, settings.samples = 3, settings.formulation = formulation;
                const Trajectory trajectory = solve(scene, *find_method("radau"), settings);
                ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
                for (const Sample& sample : trajectory.samples)
                    EXPECT_LT(attitude_error(sample.q, driven_attitude(c, 2 * c, sample.t)), 300 * tolerance + 1e-13)
                        << c << ", " << tolerance << ", t = " << sample.t;
            }
}

// The number of steps does not grow when the drag grows by a factor of a million, except for the first steps, which
// start from the time scale of the decay.
TEST(RadauMethod, TakesNoMoreStepsWhereTheMotionIsStiffer) {
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        long least = std::numeric_limits<long>::max(), most = 0;
        for (const double c : {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
            const Trajectory trajectory = with_tolerance(viscous(c, 100), "radau", tolerance);
            ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
            least = std::min(least, trajectory.steps), most = std::max(most, trajectory.steps);
        }
        EXPECT_LT(most, 2 * least) << tolerance;
        EXPECT_LT(most, 40) << tolerance;
    }
}

// After the transient the cost per unit of time is that of the smooth motion, here a rotation at 2 rad/s.
TEST(RadauMethod, PaysNothingForDampingAfterTheTransient) {
    constexpr double c = 1e6, tolerance = 1e-12;
    const Scene brief = driven_spin(c, 2 * c, 10), whole = driven_spin(c, 2 * c, 20);
    const Trajectory first = with_tolerance(brief, "radau", tolerance),
                     both = with_tolerance(whole, "radau", tolerance);
    EXPECT_LT(error_at(brief, first, driven_attitude(c, 2 * c, 10)), 1e-10);
    EXPECT_LT(error_at(whole, both, driven_attitude(c, 2 * c, 20)), 1e-10);
    const auto of_steps = [](const Trajectory& t) { return t.rhs_evaluations - t.sample_evaluations; };
    EXPECT_LT(of_steps(both) - of_steps(first), 10 * 100);
}

// The truth uses multiprecision collocation in two formulations.
TEST(RadauMethod, FollowsTheTruthOfStiffMotion) {
    const FreshCache cache;
    std::vector<Scene> scenes{viscous(1000, 20)};
    Scene spring = free_body(1);
    spring.name = "overdamped spring";
    spring.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    spring.initial.angular_velocity = {1, 5, 10};
    spring.loads = {Spring{1e4, {1, 0, 0, 0}, {}}, Drag{{1000, 1000, 1000}, 0, {}}};
    scenes.push_back(spring);
    for (const Scene& scene : scenes) {
        const Reference truth = reference(scene, 2L, 17);
        ASSERT_TRUE(truth.available) << truth.message;
        for (const double tolerance : {1e-5, 1e-8, 1e-11, 1e-13}) {
            const Trajectory trajectory = with_tolerance(scene, "radau", tolerance, 2);
            ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
            for (std::size_t k = 0; k < 3; ++k) {
                const Quaternion<Pair>& q = truth.samples[k].q;
                const Quaternion<double> rounded{q.w.high, q.x.high, q.y.high, q.z.high};
                EXPECT_LT(attitude_error(trajectory.samples[k].q, rounded), 100 * tolerance + 1e-14)
                    << scene.name << ", " << tolerance;
            }
        }
    }
}

TEST(RadauMethod, FollowsMotionThatIsNotStiff) {
    for (const Scene& scene : {free_body(20), heavy_top(5)}) {
        const Quaternion<double> q = solve(scene, *find_method("exact")).samples.back().q;
        for (const char* method : {"radau", "radau9", "radau13"})
            for (const double tolerance : {1e-6, 1e-9, 1e-12})
                EXPECT_LT(error_at(scene, with_tolerance(scene, method, tolerance), q), 100 * tolerance + 1e-12)
                    << method << ", " << scene.name << ", " << tolerance;
    }
}

// |q| stays constant to the tolerance without projection.
TEST(RadauMethod, KeepsTheLengthOfTheQuaternionToItsTolerance) {
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        const Trajectory trajectory = with_tolerance(heavy_top(5), "radau", tolerance, 20);
        for (const Sample& sample : trajectory.samples) EXPECT_NEAR(squared_norm(sample.q), 1, 100 * tolerance + 1e-14);
    }
}

TEST(RadauMethod, EndsByResultOrNameAtEveryTolerance) {
    Scene huge = viscous(1, 1);
    huge.name = "huge torque", huge.loads = {Torque{{1e200, 2e200, 1e200}, Frame::body, {}}};
    for (const Scene& scene : {everything(2), heavy_top(1), viscous(1e6, 10), huge})
        for (const char* method : {"radau", "radau5", "radau13"})
            for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13, 1e-15, 1e-16, 1e-300}) {
                if (std::string_view(method) == "radau5" && tolerance < (optimised_build ? 1e-12 : 1e-8)) continue;
                Settings settings;
                settings.tolerance = tolerance, settings.samples = 2, settings.max_steps = 5000;
                const Trajectory trajectory = solve(scene, *find_method(method), settings);
                if (trajectory.status == Status::ok) {
                    EXPECT_GE(tolerance, 1e-15) << scene.name;
                    EXPECT_EQ(trajectory.samples.size(), 3U);
                } else {
                    EXPECT_FALSE(trajectory.message.empty()) << scene.name;
                }
                if (scene.name != "huge torque" && tolerance >= 1e-13) {
                    EXPECT_EQ(trajectory.status, Status::ok) << scene.name << ", " << tolerance << ", " << method;
                }
            }
}

TEST(RadauMethod, NamesAStepWhoseEquationsItCannotSolve) {
    const Trajectory trajectory = with_step(heavy_top(10), "radau13", 5);
    EXPECT_EQ(trajectory.status, Status::failed);
    EXPECT_NE(trajectory.message.find("did not converge at t = "), std::string::npos) << trajectory.message;
}

TEST(RadauMethod, KnowsNoUsersTorque) {
    Scene scene = free_body(1);
    scene.loads = {UserTorque{"mine", [](const LoadState&) { return Vector3<double>(1, 0, 0); }, {}}};
    EXPECT_EQ(with_tolerance(scene, "radau", 1e-6).status, Status::unsupported);
    EXPECT_EQ(with_step(scene, "radau5", 0.1).status, Status::unsupported);
}

// Performance target: an attitude error of 1e-9 rad with less than half of the right-hand sides of CVODE's BDF.
TEST(RadauMethod, NeedsFewerRightHandSidesThanBdf) {
    const Scene scene = viscous(1000, 20);
    const Quaternion<double> truth = with_tolerance(scene, "radau5", 1e-13).samples.back().q;
    const auto cheapest = [&](const char* method) {
        long least = std::numeric_limits<long>::max();
        for (double tolerance = 1e-6; tolerance > 1e-14; tolerance /= 10) {
            const Trajectory trajectory = with_tolerance(scene, method, tolerance);
            if (trajectory.status == Status::ok && attitude_error(trajectory.samples.back().q, truth) < 1e-9)
                least = std::min(least, trajectory.rhs_evaluations - trajectory.sample_evaluations);
        }
        return least;
    };
    EXPECT_LT(cheapest("radau"), cheapest("cvode_bdf") / 2);
}

}  // namespace
}  // namespace polhode
