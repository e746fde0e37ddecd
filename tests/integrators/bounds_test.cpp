// Every method stays within its limits, and a run that diverges reports the time and the last state.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "build_kind.h"
#include "integrators/run/march.h"
#include "integrators/run/processor_time.h"
#include "integrators/run/stiffness.h"
#include "integrators/scenes.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

using namespace polhode::testing;

class Bounds : public ::testing::TestWithParam<const Method*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Bounds, ::testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& of) { return std::string(of.param->name); });

Settings by_tolerance_or_step(const Method& method, double tolerance, double step) {
    Settings settings;
    settings.samples = 4;
    if (takes_tolerance(method))
        settings.tolerance = tolerance;
    else if (takes_step(method))
        settings.step = step;
    return settings;
}

TEST_P(Bounds, StopsAtTheLimitOfSteps) {
    const Method& method = *GetParam();
    for (const Scene& scene : {free_body(50), heavy_top(50)}) {
        Settings settings = by_tolerance_or_step(method, 1e-6, 0.01);
        settings.max_steps = 5;
        const Trajectory t = solve(scene, method, settings);
        if (method.control == Control::none || t.status == Status::unsupported) continue;
        EXPECT_EQ(t.status, Status::failed) << t.message;
        EXPECT_TRUE(t.limit_reached);
        EXPECT_LE(t.steps, 5);
        EXPECT_NE(t.message.find("limit of 5 steps"), std::string::npos) << t.message;
    }
}

TEST_P(Bounds, StopsAtTheLimitOfEvaluations) {
    const Method& method = *GetParam();
    constexpr long of_one_step = 1000;  // seven stages of fifty Newton iterations, or an extrapolation of nine columns
    for (const Scene& scene : {free_body(50), heavy_top(50)}) {
        Settings settings = by_tolerance_or_step(method, 1e-6, 0.01);
        settings.max_evaluations = 30;
        const Trajectory t = solve(scene, method, settings);
        EXPECT_LE(t.rhs_evaluations, 30 + of_one_step);
        EXPECT_EQ(t.status == Status::failed && t.limit_reached, t.rhs_evaluations >= 30) << t.message;
        if (t.limit_reached) {
            EXPECT_NE(t.message.find("limit of 30 evaluations"), std::string::npos) << t.message;
        }
    }
}

TEST_P(Bounds, StopsAtTheLimitOfTime) {
    const Method& method = *GetParam();
    if (method.name == "truth") GTEST_SKIP() << "a truth in the cache takes no time; another test asks";
    for (const Scene& scene : {free_body(50), heavy_top(50)}) {
        Settings settings = by_tolerance_or_step(method, 1e-6, 0.01);
        settings.seconds_limit = 1e-9;
        const Trajectory t = solve(scene, method, settings);
        if (t.status == Status::unsupported) continue;
        EXPECT_EQ(t.status, Status::failed) << t.message;
        EXPECT_TRUE(t.limit_reached);
        EXPECT_NE(t.message.find("limit of 1e-09 s"), std::string::npos) << t.message;
    }
}

void work_for(double seconds) {
    const double until = processor_time() + seconds;
    while (processor_time() < until) {
    }
}

/// A slow right-hand side in a very long run.
TEST_P(Bounds, LooksAtTheClockWhenEvaluationsAreSlow) {
    const Method& method = *GetParam();
    Scene scene = free_body(50);
    bool slow = false;
    scene.loads = {UserTorque{"slow",
                              [&slow](const LoadState&) {
                                  if (slow) work_for(1e-4);
                                  return Vector3<double>(0, 0, 0.1);
                              },
                              {}}};
    const Problem problem = pose(scene);
    slow = true;
    Settings settings = by_tolerance_or_step(method, 1e-12, 1e-5);
    settings.seconds_limit = 0.005;
    const double start = processor_time();
    const Trajectory t = solve(problem, method, settings);
    const double spent = processor_time() - start;
    if (t.status == Status::unsupported) return;
    EXPECT_TRUE(t.limit_reached) << name_of(t.status) << " " << t.message;
    // some methods first pose the scene in other axes, which takes a thousand evaluations
    EXPECT_LT(spent, 0.25);
}

/// The time that follows "t = " in a message.
double time_in(const std::string& message) {
    const std::size_t at = message.find("t = ");
    return at == std::string::npos ? std::numeric_limits<double>::quiet_NaN() : std::stod(message.substr(at + 4));
}

/// A torque that becomes NaN at t = 0.5 s: the message names the step where this happens and the state before.
TEST_P(Bounds, NamesTheStepInWhichTheMotionIsLost) {
    const Method& method = *GetParam();
    const auto torque = [](const LoadState& s) {
        return Vector3<double>(0.2, s.t > 0.5 ? std::numeric_limits<double>::quiet_NaN() : 0.1, 0.3);
    };
    Scene scene = free_body(10);
    scene.loads = {UserTorque{"lost", torque, {}}};
    for (const long samples : {2L, 700L}) {
        Settings settings = by_tolerance_or_step(method, 1e-6, 0.004);
        settings.samples = samples, settings.max_steps = 100'000;
        const Trajectory t = solve(scene, method, settings);
        if (t.status == Status::unsupported) return;
        EXPECT_NE(t.status, Status::ok);
        EXPECT_FALSE(t.limit_reached) << t.message;
        // the longest step by tolerance is about 2 s
        EXPECT_NEAR(time_in(t.message), 0.5, t.step > 0 ? 2.001 * t.step : 2) << t.message;
        // and it is the last step counted
        if (t.status == Status::diverged && t.step > 0) {
            EXPECT_NEAR(static_cast<double>(t.steps) * t.step, time_in(t.message), 1.5 * t.step) << t.message;
        }
        EXPECT_NE(t.message.find("; the last state, at t = "), std::string::npos) << t.message;
        EXPECT_NE(t.message.find("rad/s, q = ("), std::string::npos) << t.message;
        EXPECT_EQ(t.message.find("nan"), std::string::npos) << t.message;
        for (const Sample& s : t.samples)
            EXPECT_TRUE(all_finite({&s.angular_velocity_B[0], 3}) && std::isfinite(squared_norm(s.q)));
    }
}

/// dw/dt = w^2 w: |w| = 1/sqrt(1 - 2t) becomes infinite at t = 1/2 s.
TEST_P(Bounds, NamesABlowUpInFiniteTime) {
    const Method& method = *GetParam();
    if (method.name.starts_with("point_")) GTEST_SKIP() << "springs and steps go by the scene's largest rate: infinite";
    if (method.name.starts_with("xpbd_")) GTEST_SKIP() << "its w is the rotation divided by h, at most 2/h";
    const auto torque = [](const LoadState& s) {
        const Vector3<double>& w = s.angular_velocity_B;
        return dot(w, w) * w;
    };
    Scene scene = free_body(2);
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 1));
    scene.initial.angular_velocity = {0, 0, 1};
    scene.loads = {UserTorque{"growing", torque, {}}};
    Settings settings = by_tolerance_or_step(method, 1e-6, 0.01);
    settings.samples = 2, settings.max_steps = 100'000;
    const Trajectory t = solve(scene, method, settings);
    if (t.status == Status::unsupported) return;
    EXPECT_NE(t.status, Status::ok);
    EXPECT_FALSE(t.message.empty());
    if (t.status == Status::diverged) {
        EXPECT_NEAR(time_in(t.message), 0.5, 0.3) << t.message;
        EXPECT_NE(t.message.find("; the last state, at t = "), std::string::npos) << t.message;
    }
}

TEST_P(Bounds, EndsAtAbsurdTolerances) {
    const Method& method = *GetParam();
    if (!takes_tolerance(method)) GTEST_SKIP();
    for (const double tolerance :
         {5e-324, 1e-300, 1e-100, 1e-18, 1e-15, 1e-12, 1e-6, 1e-3, 0.5, 1.0, 1e3, 1e100, 1e300, 1.7e308}) {
        Settings settings;
        settings.tolerance = tolerance, settings.samples = 3;
        settings.max_steps = optimised_build ? 3000 : 300;
        const Trajectory t = solve(heavy_top(0.5), method, settings);
        EXPECT_EQ(t.status == Status::ok, t.samples.size() == 4 && t.status != Status::tolerance_not_met)
            << tolerance << " " << t.message;
        if (t.status != Status::ok) {
            EXPECT_FALSE(t.message.empty()) << tolerance;
        }
        for (const Sample& s : t.samples)
            EXPECT_TRUE(all_finite({&s.angular_velocity_B[0], 3}) && std::isfinite(squared_norm(s.q))) << tolerance;
    }
}

TEST(Limits, AreRefusedWhereTheyMeanNothing) {
    const Method& method = *find_method("odeint_rk4");
    const auto with = [&](auto&& set) {
        Settings settings;
        set(settings);
        return solve(free_body(1), method, settings);
    };
    EXPECT_EQ(with([](Settings& s) { s.max_evaluations = 0; }).status, Status::failed);
    EXPECT_EQ(with([](Settings& s) { s.seconds_limit = 0; }).status, Status::failed);
    EXPECT_EQ(with([](Settings& s) { s.seconds_limit = std::nan(""); }).status, Status::failed);
    EXPECT_EQ(with([](Settings& s) { s.seconds_limit = std::numeric_limits<double>::infinity(); }).status, Status::ok);
}

TEST(Limits, HoldForATruthAndLeaveNothingBehind) {
    // a unique motion, so that the truth is not in the cache
    Scene scene = heavy_top(20);
    scene.initial.angular_velocity[1] =
        1e-3 * static_cast<double>(std::chrono::system_clock::now().time_since_epoch().count() % 1000);
    const Reference none = reference(scene, 2, 25, 1e-3);
    EXPECT_FALSE(none.available);
    EXPECT_EQ(none.message, "no truth within the limit of 0.001 s");
    Settings settings;
    settings.samples = 2, settings.seconds_limit = 1e-3;
    const Trajectory t = solve(scene, *find_method("truth"), settings);
    EXPECT_EQ(t.status, Status::failed);
    EXPECT_TRUE(t.limit_reached);
    scene.duration = 0.1;
    EXPECT_TRUE(reference(scene, 2, 25, 60).available);
}

TEST(SolverCounts, ContainRejectionsIfTheSolverReportsThem) {
    // a torque that sets in suddenly: every error control must reject a step
    Scene scene = free_body(4);
    scene.loads = {
        UserTorque{"sudden", [](const LoadState& s) { return Vector3<double>(0, s.t > 1.234 ? 50 : 0, 0); }, {}}};
    for (const char* name : {"dop853", "extrapolation", "odeint_dopri5", "odeint_bulirsch_stoer", "cvode_adams",
                             "arkode_erk5", "cvode_impacts"}) {
        Settings settings;
        settings.tolerance = 1e-8;
        const Trajectory t = solve(scene, *find_method(name), settings);
        ASSERT_EQ(t.status, Status::ok) << name << t.message;
        EXPECT_GT(t.counts.rejected_steps.value_or(0), 0) << name;
    }
    Settings settings;
    settings.step = 0.01;
    EXPECT_FALSE(solve(scene, *find_method("odeint_rk4"), settings).counts.rejected_steps.has_value());
}

/// Weakly damped vibration lies where BDF of order 5 is unstable.
TEST(SolverCounts, TellWhatStabilityLimitDetectionDid) {
    Scene scene = free_body(20);
    scene.initial.orientation = {0.96, 0.28, 0, 0};
    scene.loads = {Spring{4e3, {1, 0, 0, 0}, {}}, Drag{{0.02, 0.02, 0.02}, 0, {}}};
    Settings settings;
    settings.tolerance = 1e-4, settings.samples = 2;
    const Trajectory t = solve(scene, *find_method("cvode_bdf"), settings);
    ASSERT_EQ(t.status, Status::ok) << t.message;
    EXPECT_TRUE(t.counts.order_reductions.has_value());
    EXPECT_FALSE(solve(scene, *find_method("cvode_adams"), settings).counts.order_reductions.has_value());
}

TEST(CvodeAndArkode, ChooseByTheStiffnessOfTheScene) {
    Scene calm = free_body(10), stiff = free_body(10);
    stiff.loads = {Drag{{1e4, 1e4, 1e4}, 0, {}}, Torque{{1e3, 2e3, 3e3}, Frame::body, {}}};
    ASSERT_TRUE(is_stiff(pose(stiff)));
    const auto run = [](const Scene& scene, const char* method) {
        Settings settings;
        settings.tolerance = 1e-7;
        return solve(scene, *find_method(method), settings);
    };
    const auto same = [](const Trajectory& a, const Trajectory& b, const char* word) {
        ASSERT_EQ(a.status, Status::ok) << a.message;
        EXPECT_NE(a.message.find(word), std::string::npos) << a.message;
        EXPECT_EQ(a.samples.back().q, b.samples.back().q);
        EXPECT_EQ(a.rhs_evaluations, b.rhs_evaluations);
    };
    same(run(calm, "cvode"), run(calm, "cvode_adams"), "Adams");
    same(run(stiff, "cvode"), run(stiff, "cvode_bdf"), "BDF");
    same(run(calm, "arkode"), run(calm, "arkode_erk8"), "explicit");
    same(run(stiff, "arkode"), run(stiff, "arkode_dirk5"), "implicit");
    Scene user = calm;
    user.loads = {UserTorque{"none", [](const LoadState&) { return Vector3<double>(); }, {}}};
    EXPECT_EQ(run(user, "cvode").status, Status::ok);
    EXPECT_EQ(run(user, "arkode").status, Status::ok);
}

}  // namespace
}  // namespace polhode
