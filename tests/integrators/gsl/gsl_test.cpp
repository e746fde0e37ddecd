#include "integrators/gsl/gsl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "build_kind.h"
#include "integrators/method.h"
#include "integrators/scenes.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

using testing::attitude_error;
using testing::with_tolerance;

double length(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }
Quaternion<double> high(const Quaternion<Pair>& q) { return {q.w.high, q.x.high, q.y.high, q.z.high}; }
Vector3<double> high(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

Trajectory run(const Scene& scene, const char* method, double tolerance, Settings settings = {}) {
    settings.tolerance = tolerance;
    return solve(scene, *find_method(method), settings);
}

class Gsl : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Gsl, ::testing::Values("gsl_rk8pd", "gsl_msadams", "gsl_bsimp", "gsl_msbdf"));

class ExplicitGsl : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, ExplicitGsl, ::testing::Values("gsl_rk8pd", "gsl_msadams"));

TEST(GslFamily, IsInTheListOfMethods) {
    ASSERT_EQ(gsl_methods.size(), 4U);
    for (const Method& method : gsl_methods) EXPECT_EQ(find_method(method.name), &method) << method.name;
    EXPECT_FALSE(gsl_library_version().empty());
}

// The error is proportional to the tolerance R, also at samples inside steps. Measured: 1e2 to 1e5 times R.
TEST_P(Gsl, FollowsAFreeBodyInProportionToItsTolerance) {
    const Scene scene = testing::free_body(20);
    const Trajectory exact = solve(scene, *find_method("exact"), {});
    double first = 0, last = 0;
    for (const double tolerance : {1e-5, 1e-8, 1e-11}) {
        const Trajectory t = run(scene, GetParam(), tolerance);
        ASSERT_EQ(t.status, Status::ok) << t.message;
        ASSERT_EQ(t.samples.size(), exact.samples.size());
        double worst = 0;
        for (std::size_t k = 0; k < t.samples.size(); ++k)
            worst = std::max(worst, attitude_error(t.samples[k].q, exact.samples[k].q));
        EXPECT_LT(worst, 1e5 * tolerance) << tolerance;
        if (first == 0) first = worst;
        last = worst;
    }
    EXPECT_GT(first, 1e3 * last);
}

TEST_P(Gsl, FollowsTheTruthUnderEveryLoad) {
    const FreshCache cache;
    const Scene scene = testing::everything(3);
    const Reference truth = reference(scene, 10);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory t = with_tolerance(scene, GetParam(), 1e-11, 10);
    ASSERT_EQ(t.status, Status::ok) << t.message;
    ASSERT_EQ(t.samples.size(), truth.samples.size());
    for (std::size_t k = 0; k < t.samples.size(); ++k) {
        const Sample& s = t.samples[k];
        const ReferenceSample& right = truth.samples[k];
        EXPECT_EQ(s.t, right.t);
        EXPECT_LT(attitude_error(s.q, high(right.q)), 1e-7) << k;
        EXPECT_LT(length(s.angular_velocity_B - high(right.angular_velocity_B)), 1e-7) << k;
        EXPECT_LT(length(s.position_W - high(right.position_W)), 1e-7) << k;
        EXPECT_LT(length(s.velocity_W - high(right.velocity_W)), 1e-7) << k;
    }
}

TEST_P(Gsl, TakesTheSameStepsHoweverItIsSampled) {
    Scene scene = testing::free_body(5);
    scene.loads = {Torque{{0.1, 0, 0}, Frame::body, {2, 3}}, Spring{1, {1, 0, 0, 0}, {}}};
    const Trajectory whole = run(scene, GetParam(), 1e-7);
    ASSERT_EQ(whole.status, Status::ok) << whole.message;
    for (const long samples : {1L, 7L, 300L})
        for (const bool record : {true, false}) {
            Settings settings;
            settings.samples = samples, settings.record = record, settings.repetitions = record ? 1 : 3;
            const Trajectory t = run(scene, GetParam(), 1e-7, settings);
            ASSERT_EQ(t.status, Status::ok) << t.message;
            EXPECT_EQ(t.samples.size(), record ? static_cast<std::size_t>(samples) + 1 : 1U);
            EXPECT_EQ(t.samples.back().q, whole.samples.back().q);
            EXPECT_EQ(t.samples.back().angular_velocity_B, whole.samples.back().angular_velocity_B);
            EXPECT_EQ(t.steps, whole.steps);
            EXPECT_EQ(t.rhs_evaluations - t.sample_evaluations, whole.rhs_evaluations - whole.sample_evaluations);
        }
}

TEST_P(Gsl, EndsAtEveryToleranceWithAResultOrAReason) {
    for (const Scene& scene : {testing::free_body(1), testing::heavy_top(0.3)})
        for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12, 1e-14, 1e-15, 2.3e-16}) {
            Settings settings;
            settings.max_steps = 20000;
            const Trajectory t = run(scene, GetParam(), tolerance, settings);
            EXPECT_EQ(t.status == Status::ok, t.samples.size() == 101U) << tolerance;
            EXPECT_TRUE(t.status == Status::ok || !t.message.empty()) << tolerance;
        }
    for (const double tolerance : {1e-16, 1e-100, 1e-300, 5e-324}) {
        const Trajectory t = run(testing::free_body(1), GetParam(), tolerance);
        EXPECT_EQ(t.status, Status::tolerance_not_met) << tolerance;
        EXPECT_NE(t.message.find("below the spacing of binary64"), std::string::npos) << t.message;
    }
}

TEST_P(Gsl, StopsAtTheLimitOfSteps) {
    Settings settings;
    settings.max_steps = 10;
    const Trajectory t = run(testing::free_body(100), GetParam(), 1e-8, settings);
    EXPECT_EQ(t.status, Status::failed);
    EXPECT_TRUE(t.limit_reached);
    EXPECT_NE(t.message.find("10 steps"), std::string::npos) << t.message;
    EXPECT_LT(t.samples.size(), 101U);
}

TEST_P(Gsl, PassesASegmentOfOneRoundingError) {
    Scene scene = testing::free_body(2);
    const Trajectory plain = with_tolerance(scene, GetParam(), 1e-10);
    scene.loads = {Torque{{1, 0, 0}, Frame::body, {1, std::nextafter(1, std::numeric_limits<double>::infinity())}}};
    const Trajectory t = with_tolerance(scene, GetParam(), 1e-10);
    ASSERT_EQ(plain.status, Status::ok) << plain.message;
    ASSERT_EQ(t.status, Status::ok) << t.message;
    EXPECT_LT(attitude_error(t.samples.back().q, plain.samples.back().q), 1e-6);
}

TEST(GslFamily, TakesAUsersTorqueWhereItNeedsNoJacobian) {
    Scene scene = testing::free_body(2);
    scene.initial.angular_velocity = {0, 0, 1};
    scene.loads = {UserTorque{"constant", [](const LoadState&) { return Vector3<double>(0, 0, 3); }, {}}};
    for (const char* method : {"gsl_rk8pd", "gsl_msadams"}) {
        const Trajectory t = with_tolerance(scene, method, 1e-10);
        ASSERT_EQ(t.status, Status::ok) << t.message;
        EXPECT_NEAR(t.samples.back().angular_velocity_B[2], 1 + 2, 1e-8) << method;  // w0 + t tau / I3
    }
    for (const char* method : {"gsl_bsimp", "gsl_msbdf"}) {
        const Trajectory t = with_tolerance(scene, method, 1e-10);
        EXPECT_EQ(t.status, Status::unsupported) << method;
        EXPECT_FALSE(t.message.empty()) << method;
    }
}

TEST_P(ExplicitGsl, NamesATorqueThatIsNotFinite) {
    for (const double from : {0.0, 0.3}) {
        Scene scene = testing::free_body(1);
        scene.loads = {
            UserTorque{"nan after a while",
                       [from](const LoadState& s) { return Vector3<double>(s.t >= from ? std::nan("") : 0, 0, 0); },
                       {}}};
        const Trajectory t = with_tolerance(scene, GetParam(), 1e-9);
        EXPECT_EQ(t.status, Status::diverged);
        EXPECT_NE(t.message.find("not finite at t = "), std::string::npos) << t.message;
        EXPECT_LT(t.rhs_evaluations, 20000);
    }
}

TEST_P(ExplicitGsl, LetsAnExceptionOfAUsersTorqueThrough) {
    bool armed = false;
    Scene scene = testing::free_body(2);
    scene.loads = {UserTorque{"throws later",
                              [&](const LoadState& s) -> Vector3<double> {
                                  if (armed && s.t > 1) throw std::domain_error("beyond its table");
                                  return {};
                              },
                              {}}};
    // posing evaluates the torque too
    const Problem problem = pose(scene);
    armed = true;
    Settings settings;
    settings.tolerance = 1e-8;
    EXPECT_THROW(solve(problem, *find_method(GetParam()), settings), std::domain_error);
}

TEST(GslFamily, ImplicitMethodsAreFarCheaperWhereTheMotionIsStiff) {
    Scene scene = testing::heavy_top(optimised_build ? 20 : 2);
    scene.initial.angular_velocity = {0.1, 0.2, 1};
    scene.loads = {Gravity{{0, 0, -10}, {}}, Drag{{1000, 1000, 1000}, 0, {}}};
    const Trajectory explicit_pair = with_tolerance(scene, "gsl_rk8pd", 1e-6);
    ASSERT_EQ(explicit_pair.status, Status::ok) << explicit_pair.message;
    for (const char* method : {"gsl_bsimp", "gsl_msbdf"}) {
        const Trajectory t = with_tolerance(scene, method, 1e-6);
        ASSERT_EQ(t.status, Status::ok) << t.message;
        EXPECT_LT(5 * t.rhs_evaluations, explicit_pair.rhs_evaluations) << method;
        EXPECT_LT(attitude_error(t.samples.back().q, explicit_pair.samples.back().q), 1e-4) << method;
    }
}

}  // namespace
}  // namespace polhode
