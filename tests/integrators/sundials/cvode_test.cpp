// The wrapped methods of CVODE: accuracy against closed forms, events, samples, limits, failures.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "integrators/method.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/build.h"
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/serial_vector_of.h"
#include "motion/systems.h"

namespace polhode {
namespace {

Eigen::Quaterniond eigen(const Quaternion<double>& q) { return {q.w, q.x, q.y, q.z}; }
Eigen::Vector3d eigen(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

// the angle between two attitudes; normalises the first one
double angle(const Quaternion<double>& a, const Eigen::Quaterniond& b) {
    const Eigen::Quaterniond r = eigen(a).conjugate() * b;
    return 2 * std::atan2(r.vec().norm(), std::abs(r.w()));
}

Scene body(double I1, double I2, double I3, const Vector3<double>& w, double duration) {
    Scene scene;
    scene.name = "test", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(I1, I2, I3));
    scene.initial.angular_velocity = w;
    return scene;
}

Trajectory run(const Scene& scene, const char* method, double tolerance, Settings settings = {}) {
    settings.tolerance = tolerance;
    return solve(scene, *find_method(method), settings);
}

void expect_ok(const Trajectory& t) { ASSERT_EQ(t.status, Status::ok) << t.message; }

class Cvode : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Cvode, ::testing::Values("cvode_adams", "cvode_bdf"));

// A free symmetric body, I1 = I2, precesses about L at |L|/I1 and spins about its axis at w3 (1 - I3/I1):
// q = exp(t/2 L/I1) q0 exp(t/2 spin e3).
TEST_P(Cvode, FollowsTheSymmetricBodyInProportionToItsTolerance) {
    Scene scene = body(2, 2, 3, {0.6, 0.2, 1.1}, 20);
    scene.initial.orientation = {0.5, 0.5, 0.5, 0.5};
    const Eigen::Quaterniond q0(0.5, 0.5, 0.5, 0.5);
    const Eigen::Vector3d rate_W = q0 * Eigen::Vector3d(2 * 0.6, 2 * 0.2, 3 * 1.1) / 2;
    const auto turn = [](const Eigen::Vector3d& v) {
        return Eigen::Quaterniond(Eigen::AngleAxisd(v.norm(), v.normalized()));
    };
    double first = 0, last = 0;
    for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
        const Trajectory t = run(scene, GetParam(), tolerance);
        expect_ok(t);
        ASSERT_EQ(t.samples.size(), 101u);
        double worst = 0;
        for (const Sample& s : t.samples) {
            const Eigen::Quaterniond q = turn(s.t * rate_W) * q0 * turn(s.t * Eigen::Vector3d(0, 0, 1.1 * (1 - 1.5)));
            worst = std::max(worst, angle(s.q, q));
        }
        // each step errs by at most 2 R per component; with 7 components, rotation angles twice those of the
        // quaternion, and a rate error acting for the rest of the run: at most steps * 2 R * sqrt(7) * 2 * T
        EXPECT_LT(worst, static_cast<double>(t.steps) * 2 * tolerance * std::sqrt(7.0) * 2 * 20);
        (tolerance == 1e-5 ? first : last) = worst;
    }
    // a tolerance ratio of 1e-4 gives this error ratio, apart from changes of order
    EXPECT_GT(last / first, 1e-5);
    EXPECT_LT(last / first, 1e-3);
}

// Rotation about a principal axis with drag: w = w0 exp(-c t / I), angle = w0 I / c (1 - exp(-c t / I)).
TEST_P(Cvode, FollowsADampedSpinAboutAPrincipalAxis) {
    Scene scene = body(1, 2, 3, {0, 0, 4}, 10);
    scene.loads = {Drag{{0, 0, 0.9}, 0, {}}};
    const Trajectory t = run(scene, GetParam(), 1e-11);
    expect_ok(t);
    for (const Sample& s : t.samples) {
        const double decay = std::exp(-0.3 * s.t), turned = 4 / 0.3 * -std::expm1(-0.3 * s.t);
        // bound: steps * 2 R * sqrt(3), over 10 s, at the scale of 4 rad/s
        const double bound = static_cast<double>(t.steps) * 2e-11 * std::sqrt(3.0) * 4 * 2 * 10;
        EXPECT_NEAR(s.angular_velocity_B[2], 4 * decay, bound);
        EXPECT_LT(angle(s.q, Eigen::Quaterniond(std::cos(turned / 2), 0, 0, std::sin(turned / 2))), bound);
    }
}

// With all terms of the 13-dimensional system, BDF with the exact Jacobian and Adams without any give the same motion.
TEST(CvodeFamily, AgreesOnTheFullMotion) {
    Scene scene = body(1, 2, 3, {0.4, 1, -0.3}, 5);
    scene.body.mass = 2;
    scene.initial.velocity_W = {1, 0, 0};
    scene.loads = {Gravity{{0, 0, -9.8}, {}}, Force{{0, 1, 0}, Frame::body, {0.2, 0, 0.1}, Frame::body, {}},
                   Force{{0, 0, 3}, Frame::world, {0.5, 0, 0}, Frame::world, {}}, Drag{{0.1, 0.2, 0.3}, 0.4, {}},
                   Spring{2, {1, 0, 0, 0}, {}}};
    const Trajectory a = run(scene, "cvode_adams", 1e-12), b = run(scene, "cvode_bdf", 1e-12);
    expect_ok(a), expect_ok(b);
    const double bound = static_cast<double>(b.steps) * 2e-12 * std::sqrt(13.0) * 100;  // all scales are below 100
    for (std::size_t k = 0; k < a.samples.size(); ++k) {
        EXPECT_LT(angle(a.samples[k].q, eigen(b.samples[k].q)), bound);
        EXPECT_LT((eigen(a.samples[k].position_W) - eigen(b.samples[k].position_W)).norm(), bound);
    }
}

TEST(CvodeFamily, BdfIsFarCheaperWhereTheMotionIsStiff) {
    Scene scene = body(1, 2, 3, {1, 1, 1}, 1);
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.loads = {Gravity{{0, -9.8, -9.8}, {}}, Drag{{1e4, 1e4, 1e4}, 0, {}}};
    const Trajectory bdf = run(scene, "cvode_bdf", 1e-8), adams = run(scene, "cvode_adams", 1e-8);
    expect_ok(bdf), expect_ok(adams);
    // measured: 75 times fewer evaluations
    EXPECT_LT(20 * bdf.rhs_evaluations, adams.rhs_evaluations);
}

TEST_P(Cvode, StopsAtTheLimitOfSteps) {
    Settings settings;
    settings.max_steps = 50;
    const Trajectory t = run(body(1, 2, 3, {1, 1, 1}, 100), GetParam(), 1e-8, settings);
    EXPECT_EQ(t.status, Status::failed);
    EXPECT_EQ(t.steps, 50);
    EXPECT_TRUE(t.limit_reached);
    EXPECT_NE(t.message.find("50 steps"), std::string::npos) << t.message;
    EXPECT_LT(t.samples.size(), 101u);
}

TEST_P(Cvode, SaysWhichToleranceIsTooSmallAndWritesNothing) {
    ::testing::internal::CaptureStderr();
    for (const double tolerance : {1e-17, 1e-20, 1e-100, 1e-300, 5e-324}) {
        const Trajectory t = run(body(1, 2, 3, {1, 1, 1}, 1), GetParam(), tolerance);
        EXPECT_EQ(t.status, Status::tolerance_not_met) << tolerance << ": " << t.message;
        EXPECT_NE(t.message.find("CVODE: At t = 0, too much accuracy requested."), std::string::npos) << t.message;
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// At the smallest tolerances that CVODE accepts a run succeeds or reports why not, in bounded time.
TEST_P(Cvode, EndsAtTheEdgeOfRoundOff) {
    for (const double tolerance : {1e-15, 1e-16, 7e-17, 3e-17}) {
        Settings settings;
        settings.max_steps = 200000;
        const Trajectory t = run(body(1, 2, 3, {1, 1, 1}, 1), GetParam(), tolerance, settings);
        EXPECT_EQ(t.status == Status::ok, t.samples.size() == 101u) << tolerance;
        EXPECT_TRUE(t.status == Status::ok || !t.message.empty());
    }
}

TEST(CvodeFamily, EndsAtOnceWhereATorqueIsNotFinite) {
    for (const double from : {0.0, 1.0}) {
        Scene scene = body(1, 2, 3, {1, 1, 1}, 100);
        scene.loads = {
            UserTorque{"nan after a while",
                       [from](const LoadState& s) { return Vector3<double>(s.t >= from ? std::nan("") : 0, 0, 0); },
                       {}}};
        ::testing::internal::CaptureStderr();
        const Trajectory t = run(scene, "cvode_adams", 1e-9);
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
        EXPECT_EQ(t.status, Status::diverged);
        EXPECT_NE(t.message.find("not finite at t = "), std::string::npos) << t.message;
        // one second at 1e-9 takes about 60 evaluations; endless retries would take thousands
        EXPECT_LT(t.rhs_evaluations, from == 0 ? 2 : 200);
    }
}

TEST(CvodeFamily, TakesAUsersTorqueWithoutAJacobian) {
    Scene scene = body(1, 2, 3, {0, 0, 1}, 2);
    scene.loads = {UserTorque{"constant", [](const LoadState&) { return Vector3<double>(0, 0, 3); }, {}}};
    const Trajectory t = run(scene, "cvode_adams", 1e-10);
    expect_ok(t);
    EXPECT_NEAR(t.samples.back().angular_velocity_B[2], 1 + 2, 1e-8);  // w0 + t tau / I3
    const Trajectory refused = run(scene, "cvode_bdf", 1e-10);
    EXPECT_EQ(refused.status, Status::unsupported);
    EXPECT_FALSE(refused.message.empty());
}

TEST(CvodeFamily, LetsAnExceptionOfAUsersTorqueThrough) {
    Scene scene = body(1, 2, 3, {0, 0, 1}, 2);
    scene.loads = {UserTorque{"throws",
                              [](const LoadState& s) -> Vector3<double> {
                                  if (s.t > 1) throw std::domain_error("beyond its table");
                                  return {};
                              },
                              {}}};
    // posing evaluates the torque too
    EXPECT_THROW(run(scene, "cvode_adams", 1e-8), std::domain_error);
    bool armed = false;
    scene.loads = {UserTorque{"throws later",
                              [&](const LoadState&) -> Vector3<double> {
                                  if (armed) throw std::domain_error("beyond its table");
                                  return {};
                              },
                              {}}};
    const Problem problem = pose(scene);
    armed = true;
    Settings settings;
    settings.tolerance = 1e-8;
    EXPECT_THROW(solve(problem, *find_method("cvode_adams"), settings), std::domain_error);
}

// A torque from 0.5 to 1 s and an impulse at 1.5 s, compared with three runs joined by hand.
TEST_P(Cvode, MeetsEventsExactly) {
    constexpr double tolerance = 1e-12;
    const Vector3<double> push(0, 0.7, 0.2), point(0.5, 0, 0.1);
    Scene scene = body(1, 2, 3, {1, 0.2, -0.4}, 2);
    const Scene piece = scene;
    scene.loads = {Torque{{0.5, 1, 0}, Frame::body, {0.5, 1}}, Impulse{push, Frame::world, point, Frame::body, 1.5}};
    Settings settings;
    settings.samples = 4;
    const Trajectory whole = run(scene, GetParam(), tolerance, settings);
    expect_ok(whole);
    ASSERT_EQ(whole.samples.size(), 5u);

    settings.samples = 1;
    Sample s;
    s.angular_velocity_B = scene.initial.angular_velocity;
    for (int k = 1; k <= 4; ++k) {
        Scene next = piece;
        next.duration = 0.5;
        next.initial.orientation = s.q, next.initial.angular_velocity = s.angular_velocity_B;
        if (k == 2) next.loads = {Torque{{0.5, 1, 0}, Frame::body, {}}};
        s = run(next, GetParam(), tolerance, settings).samples.back();
        if (k == 3) {  // dw = I^-1 (r x R^T J)
            const Eigen::Vector3d kick = eigen(point).cross(eigen(s.q).conjugate() * eigen(push));
            s.angular_velocity_B = s.angular_velocity_B + Vector3<double>(kick[0], kick[1] / 2, kick[2] / 3);
        }
        // the sample at 1.5 s shows the motion after the impulse; each run errs by at most steps * 2 R * sqrt(7) * 2
        const double bound = static_cast<double>(whole.steps) * 2 * tolerance * std::sqrt(7.0) * 2 * 2;
        const Sample& sample = whole.samples[static_cast<std::size_t>(k)];
        EXPECT_EQ(sample.t, 0.5 * k);
        EXPECT_LT(angle(sample.q, eigen(s.q)), bound) << k;
        EXPECT_LT((eigen(sample.angular_velocity_B) - eigen(s.angular_velocity_B)).norm(), bound) << k;
    }
}

TEST_P(Cvode, ShowsAnImpulseAtTheVeryEnd) {
    Scene scene = body(1, 2, 3, {0, 0, 1}, 2);
    const Trajectory before = run(scene, GetParam(), 1e-9);
    scene.loads = {Impulse{{1, 0, 0}, Frame::body, {0, 1, 0}, Frame::body, 2}};
    for (const bool record : {true, false}) {
        Settings settings;
        settings.record = record;
        const Trajectory t = run(scene, GetParam(), 1e-9, settings);
        expect_ok(t);
        EXPECT_EQ(t.samples.size(), record ? 101u : 1u);
        EXPECT_EQ(t.samples.back().t, 2);
        // (0, 1, 0) x (1, 0, 0) = (0, 0, -1), divided by I3 = 3; each run is accurate to its tolerance at w = 1
        EXPECT_NEAR(t.samples.back().angular_velocity_B[2], 1 - 1.0 / 3, 1e-9);
    }
    EXPECT_NEAR(before.samples.back().angular_velocity_B[2], 1, 1e-9);
}

TEST_P(Cvode, PassesASegmentOfOneRoundingError) {
    Scene scene = body(1, 2, 3, {1, 0.3, 0}, 2);
    const Trajectory plain = run(scene, GetParam(), 1e-10);
    scene.loads = {Torque{{1, 0, 0}, Frame::body, {1, std::nextafter(1, HUGE_VAL)}}};
    const Trajectory t = run(scene, GetParam(), 1e-10);
    expect_ok(t), expect_ok(plain);
    // one more restart: both are within steps * 2 R * sqrt(7) * 2 * T of the exact motion
    const double bound = static_cast<double>(plain.steps + t.steps) * 2e-10 * std::sqrt(7.0) * 2 * 2;
    EXPECT_LT(angle(t.samples.back().q, eigen(plain.samples.back().q)), bound);
}

// The steps do not depend on recording or repetitions, so a timed run is the measured run.
TEST_P(Cvode, TakesTheSameStepsHoweverItIsSampled) {
    Scene scene = body(1, 2, 3, {1, 1, 1}, 10);
    scene.loads = {Torque{{0.1, 0, 0}, Frame::body, {3, 4}}, Spring{1, {1, 0, 0, 0}, {}}};
    const Trajectory whole = run(scene, GetParam(), 1e-8);
    expect_ok(whole);
    for (const long samples : {1L, 7L, 1000L})
        for (const bool record : {true, false}) {
            Settings settings;
            settings.samples = samples, settings.record = record, settings.repetitions = record ? 1 : 3;
            const Trajectory t = run(scene, GetParam(), 1e-8, settings);
            expect_ok(t);
            EXPECT_EQ(t.samples.size(), record ? static_cast<std::size_t>(samples) + 1 : 1u);
            EXPECT_EQ(t.samples.back().q, whole.samples.back().q);
            EXPECT_EQ(t.samples.back().angular_velocity_B, whole.samples.back().angular_velocity_B);
            EXPECT_EQ(t.steps, whole.steps);
            EXPECT_EQ(t.rhs_evaluations, whole.rhs_evaluations);
        }
}

// Both vectors sum in the same order. They differ only in SUNDIALS' special case c (x + y).
TEST(CvodeFamily, RunsAlikeOnTheSerialVector) {
    const Problem problem = pose(body(1, 2, 3, {1, 1, 1}, 10));
    using System7 = FreeRotation;
    CvodeSession<System7> fixed(problem, Multistep::adams, Iteration::functional, 1e-9);
    CvodeSession<System7, SerialVectorOf<7>> serial(problem, Multistep::adams, Iteration::functional, 1e-9);
    fixed.enter(problem.segments[0]), serial.enter(problem.segments[0]);
    while (fixed.time() < 10) {
        ASSERT_GE(fixed.step(), 0);
        ASSERT_GE(serial.step(), 0);
        // each differs by at most one ulp per step
        ASSERT_NEAR(fixed.time(), serial.time(), 1e-12);
        for (int i = 0; i < 7; ++i) ASSERT_NEAR(fixed.y()[i], serial.y()[i], 1e-12);
    }
    EXPECT_EQ(fixed.steps(), serial.steps());
    EXPECT_EQ(fixed.rhs_evaluations(), serial.rhs_evaluations());
}

TEST_P(Cvode, NamesAnUnoptimisedLibraryBesideEveryTiming) {
    const Trajectory t = run(body(1, 2, 3, {1, 1, 1}, 1), GetParam(), 1e-6);
    EXPECT_EQ(t.message.find("SUNDIALS unoptimised") != std::string::npos, sundials_unoptimised());
    EXPECT_EQ(sundials_build().find("unoptimised") != std::string::npos, sundials_unoptimised());
    EXPECT_EQ(sundials_build().find(sundials_version() + ", "), 0u) << sundials_build();
}

}  // namespace
}  // namespace polhode
