// The wrapped methods of ARKODE: error in proportion to the tolerance, samples, counts, failures.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "integrators/scenes.h"
#include "integrators/sundials/build.h"

namespace polhode {
namespace {

using namespace polhode::testing;

class Arkode : public ::testing::TestWithParam<const char*> {
  protected:
    static bool implicit() { return std::string(GetParam()).find("dirk") != std::string::npos; }
    static int order() { return find_method(GetParam())->order; }
};
INSTANTIATE_TEST_SUITE_P(Methods, Arkode,
                         ::testing::Values("arkode_erk2", "arkode_erk3", "arkode_erk4", "arkode_erk5", "arkode_erk6",
                                           "arkode_erk8", "arkode_dirk3", "arkode_dirk4", "arkode_dirk5"),
                         [](const auto& of) { return std::string(of.param); });

class ExplicitArkode : public Arkode {};
INSTANTIATE_TEST_SUITE_P(Methods, ExplicitArkode,
                         ::testing::Values("arkode_erk2", "arkode_erk3", "arkode_erk4", "arkode_erk5", "arkode_erk6",
                                           "arkode_erk8"),
                         [](const auto& of) { return std::string(of.param); });

double worst_error(const Scene& scene, const Trajectory& trajectory) {
    double worst = 0;
    for (const Sample& sample : trajectory.samples)
        worst = std::max(worst, attitude_error(sample.q, symmetric_attitude(scene, sample.t)));
    return worst;
}

// For a method of order p with an error estimate of order p - 1, h ~ R^(1/p) and the global error is ~ h^p ~ R. The
// slope of log(error) over log(R) is 1, apart from the bias of the step control.
TEST_P(Arkode, ErrsInProportionToItsTolerance) {
    const Scene scene = symmetric_body(20);
    std::vector<double> found;
    const std::vector<double> tolerances =
        order() < 4 ? std::vector<double>{1e-3, 1e-4, 1e-5, 1e-6} : std::vector<double>{1e-4, 1e-6, 1e-8, 1e-10};
    for (const double R : tolerances) {
        const Trajectory trajectory = with_tolerance(scene, GetParam(), R, 40);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        ASSERT_EQ(trajectory.samples.size(), 41u);
        found.push_back(worst_error(scene, trajectory));
        if (found.size() > 1) {
            EXPECT_LT(found.back(), found[found.size() - 2] / 2) << R;
        }
    }
    const double slope = std::log(found.front() / found.back()) / std::log(tolerances.front() / tolerances.back());
    EXPECT_GT(slope, 0.75) << ::testing::PrintToString(found);
    EXPECT_LT(slope, 1.25) << ::testing::PrintToString(found);
}

// Samples inside steps have the accuracy of the method. ARKODE's interpolation, of degree 5 at most, would err by
// 1e-5 and more over steps of 0.6 s at 1e-10.
TEST(ArkodeSamples, AreAsRightAsTheSteps) {
    const Scene scene = symmetric_body(20);
    const Trajectory steps = with_tolerance(scene, "arkode_erk8", 1e-10, 1);
    const Trajectory samples = with_tolerance(scene, "arkode_erk8", 1e-10, 997);
    ASSERT_EQ(samples.status, Status::ok) << samples.message;
    EXPECT_LT(steps.steps, 200);
    EXPECT_LT(worst_error(scene, samples), 2 * worst_error(scene, steps) + 1e-10);
}

TEST_P(ExplicitArkode, CountsWhatAUserTorqueSees) {
    long calls = 0;
    Scene scene = free_body(5);
    scene.loads = {UserTorque{"counting",
                              [&calls](const LoadState& s) {
                                  ++calls;
                                  return -0.1 * s.angular_velocity_B;
                              },
                              {}}};
    const Problem problem = pose(scene);
    for (const bool fixed : {true, false}) {
        calls = 0;
        Settings settings;
        (fixed ? settings.step : settings.tolerance) = fixed ? 0.1 : 1e-5;
        settings.record = false;
        const Trajectory trajectory = solve(problem, *find_method(GetParam()), settings);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        EXPECT_EQ(trajectory.rhs_evaluations, calls);
    }
}

TEST_P(ExplicitArkode, HandsAUserTorqueTheTimesOfItsSteps) {
    // a torque that depends only on t: a wrong time shows in the rate, its integral 1 + (1 - cos 3 t) / 3 / I3
    Scene scene = free_body(2);
    scene.initial.angular_velocity = {0, 0, 1};
    scene.loads = {
        UserTorque{"swinging", [](const LoadState& s) { return Vector3<double>(0, 0, std::sin(3 * s.t)); }, {}},
        Impulse{{1e-300, 0, 0}, Frame::body, {0, 1, 0}, Frame::body, 0.777}};
    const double rate = 1 + (1 - std::cos(6.0)) / 9;
    // for order p the quadrature error is below (3 h)^p
    const double h = 1.0 / 128;
    EXPECT_NEAR(with_step(scene, GetParam(), h).samples.back().angular_velocity_B[2], rate,
                std::pow(3 * h, order()) + 1e-14);
    EXPECT_NEAR(with_tolerance(scene, GetParam(), 1e-6).samples.back().angular_velocity_B[2], rate, 1e-4);
}

TEST_P(Arkode, RefusesATorqueWithoutAJacobianWhereItNeedsOne) {
    Scene scene = free_body(2);
    scene.loads = {UserTorque{"constant", [](const LoadState&) { return Vector3<double>(0, 0, 3); }, {}}};
    const Trajectory trajectory = with_step(scene, GetParam(), 0.1);
    EXPECT_EQ(trajectory.status, implicit() ? Status::unsupported : Status::ok);
    EXPECT_EQ(trajectory.message.find("Jacobian") != std::string::npos, implicit());
}

TEST_P(Arkode, SaysWhichToleranceIsTooSmallAndWritesNothing) {
    ::testing::internal::CaptureStderr();
    for (const double tolerance : {1e-17, 1e-20, 1e-100, 1e-300, 5e-324}) {
        const Trajectory t = with_tolerance(free_body(1), GetParam(), tolerance);
        EXPECT_EQ(t.status, Status::tolerance_not_met) << tolerance << ": " << t.message;
        EXPECT_NE(t.message.find("ARKODE: At t = 0, too much accuracy requested."), std::string::npos) << t.message;
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// At the smallest tolerances that ARKODE accepts a run succeeds or reports why not, in bounded time.
TEST_P(Arkode, EndsAtTheEdgeOfRoundOff) {
    for (const double tolerance : {1e-15, 1e-16, 7e-17}) {
        Settings settings;
        settings.tolerance = tolerance, settings.samples = 3;
        settings.max_steps = 10000;
        const Trajectory t = solve(free_body(1), *find_method(GetParam()), settings);
        EXPECT_EQ(t.status == Status::ok, t.samples.size() == 4u) << tolerance;
        EXPECT_TRUE(t.status == Status::ok || !t.message.empty());
    }
}

TEST_P(ExplicitArkode, EndsAtOnceWhereATorqueIsNotFinite) {
    for (const bool fixed : {true, false})
        for (const double from : {0.0, 1.0}) {
            Scene scene = free_body(100);
            scene.loads = {
                UserTorque{"nan after a while",
                           [from](const LoadState& s) { return Vector3<double>(s.t >= from ? std::nan("") : 0, 0, 0); },
                           {}}};
            ::testing::internal::CaptureStderr();
            const Trajectory t = fixed ? with_step(scene, GetParam(), 0.01) : with_tolerance(scene, GetParam(), 1e-5);
            EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
            EXPECT_EQ(t.status, Status::diverged);
            EXPECT_NE(t.message.find("not finite at t = "), std::string::npos) << t.message;
            EXPECT_NE(t.message.find("ARKODE: "), std::string::npos) << t.message;
            // a hundred fixed steps with thirteen stages up to t = 1
            EXPECT_LT(t.rhs_evaluations, from == 0 ? 2 : 1400);
        }
}

TEST_P(ExplicitArkode, LetsAnExceptionOfAUsersTorqueThrough) {
    Scene scene = free_body(2);
    bool armed = false;
    scene.loads = {UserTorque{"throws later",
                              [&](const LoadState& s) -> Vector3<double> {
                                  if (armed && s.t > 1) throw std::domain_error("beyond its table");
                                  return {};
                              },
                              {}}};
    const Problem problem = pose(scene);
    armed = true;
    Settings settings;
    settings.tolerance = 1e-4;
    EXPECT_THROW(solve(problem, *find_method(GetParam()), settings), std::domain_error);
    settings.tolerance.reset(), settings.step = 0.01;
    EXPECT_THROW(solve(problem, *find_method(GetParam()), settings), std::domain_error);
}

TEST_P(Arkode, PassesASegmentOfOneRoundingError) {
    Scene scene = free_body(2);
    const Trajectory plain = with_tolerance(scene, GetParam(), 1e-6);
    scene.loads = {Torque{{1, 0, 0}, Frame::body, {1, std::nextafter(1, HUGE_VAL)}}};
    const Trajectory t = with_tolerance(scene, GetParam(), 1e-6);
    ASSERT_EQ(t.status, Status::ok) << t.message;
    // one more restart: both are within steps * 2 R * sqrt(7) * 2 * T of the exact motion
    const double bound = static_cast<double>(plain.steps + t.steps) * 2e-6 * std::sqrt(7.0) * 2 * 2;
    EXPECT_LT(attitude_error(t.samples.back().q, plain.samples.back().q), bound);
    const Trajectory fixed = with_step(scene, GetParam(), 0.01);
    EXPECT_EQ(fixed.status, Status::ok) << fixed.message;
}

TEST(ArkodeFamily, ImplicitMethodsAreFarCheaperWhereTheMotionIsStiff) {
    Scene scene = free_body(1);
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.loads = {Gravity{{0, -9.8, -9.8}, {}}, Drag{{1e4, 1e4, 1e4}, 0, {}}};
    const Trajectory implicit = with_tolerance(scene, "arkode_dirk5", 1e-8);
    const Trajectory explicit_one = with_tolerance(scene, "arkode_erk5", 1e-8);
    ASSERT_EQ(implicit.status, Status::ok) << implicit.message;
    ASSERT_EQ(explicit_one.status, Status::ok) << explicit_one.message;
    EXPECT_LT(10 * implicit.rhs_evaluations, explicit_one.rhs_evaluations);
    EXPECT_LT(attitude_error(implicit.samples.back().q, explicit_one.samples.back().q), 1e-6);
}

// Newton's method fails at a step that is far too long: the run reports it and does not return a wrong motion.
TEST(ArkodeFamily, AFixedStepWhoseEquationsHaveNoSolutionIsNamed) {
    Scene scene = free_body(1e6);
    const Trajectory t = with_step(scene, "arkode_dirk4", 1e3);
    EXPECT_NE(t.status, Status::ok);
    EXPECT_FALSE(t.message.empty());
}

TEST_P(Arkode, NamesAnUnoptimisedLibraryBesideEveryTiming) {
    EXPECT_EQ(with_step(free_body(1), GetParam(), 0.1).message.find("SUNDIALS unoptimised") != std::string::npos,
              sundials_unoptimised());
    EXPECT_EQ(with_tolerance(free_body(1), GetParam(), 1e-3).message.find("SUNDIALS unoptimised") != std::string::npos,
              sundials_unoptimised());
}

}  // namespace
}  // namespace polhode
