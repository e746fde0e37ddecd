// The wrapped steppers of Boost.Odeint: accuracy against closed forms, exact counts, and no allocation in a step.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

#include "integrators/odeint/odeint_algebra.h"
#include "integrators/odeint/rosenbrock.h"
#include "integrators/scenes.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

// counts every allocation of this program
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size ? size : 1)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++allocations;
    return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace polhode {
namespace {

using namespace polhode::testing;

class Tolerance : public ::testing::TestWithParam<const char*> {};

TEST_P(Tolerance, GovernsTheErrorOnAFreeSymmetricBody) {
    const double T = 100;
    const Scene scene = symmetric_body(T);
    double last = 1;
    for (double R : {1e-5, 1e-7, 1e-9, 1e-11}) {
        const Trajectory trajectory = with_tolerance(scene, GetParam(), R, 10);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        double worst = 0;
        for (const Sample& sample : trajectory.samples)
            worst = std::max(worst, attitude_error(sample.q, symmetric_attitude(scene, sample.t)));
        // 150 rad of motion; each step errs by up to 2 R per component and rate errors propagate: some thousand R
        EXPECT_LT(worst, 3000 * R) << R;
        EXPECT_LT(worst, last / 5) << R;
        last = worst;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Tolerance,
                         ::testing::Values("odeint_cash_karp54", "odeint_dopri5", "odeint_fehlberg78",
                                           "odeint_bulirsch_stoer", "odeint_rosenbrock4"),
                         [](const auto& of) { return std::string(of.param); });

TEST(Fehlberg78, IsWithin1e11AtTheTightestToleranceOverAHundredSeconds) {
    const Scene scene = symmetric_body(100);
    const Trajectory trajectory = with_tolerance(scene, "odeint_fehlberg78", 1e-14, 100);
    ASSERT_EQ(trajectory.status, Status::ok);
    for (const Sample& sample : trajectory.samples)
        EXPECT_LT(attitude_error(sample.q, symmetric_attitude(scene, sample.t)), 1e-11);
}

TEST(Counts, AreExactForFixedSteps) {
    // two events inside the run make three segments; the steps of 1/128 s meet 0.5 and 1.25, so none is split
    Scene scene = free_body(2);
    scene.loads = {Torque{{0.1, 0, 0}, Frame::world, {0.5, 1.25}}};
    const auto count = [&](const char* method) { return with_step(scene, method, 1.0 / 128); };
    EXPECT_EQ(count("odeint_rk4").steps, 256);
    EXPECT_EQ(count("odeint_euler").rhs_evaluations, 256);
    EXPECT_EQ(count("odeint_cash_karp54").rhs_evaluations, 6 * 256);
    // five steps of Fehlberg's method at the start of each segment
    EXPECT_EQ(count("odeint_adams_bashforth_moulton").rhs_evaluations, 2 * 256 + 3 * 5 * (13 - 2));
    EXPECT_EQ(count("odeint_rk4").rhs_evaluations, 4 * 256);
    // first same as last: one extra evaluation at the start of each segment
    EXPECT_EQ(count("odeint_dopri5").rhs_evaluations, 6 * 256 + 3);
    EXPECT_EQ(count("odeint_fehlberg78").rhs_evaluations, 13 * 256);
    EXPECT_EQ(count("odeint_rosenbrock4").rhs_evaluations, 6 * 256);
}

TEST(Counts, AreWhatAUserTorqueSees) {
    for (const char* method : {"odeint_dopri5", "odeint_fehlberg78", "odeint_bulirsch_stoer"}) {
        long calls = 0;
        Scene scene = free_body(5);
        scene.loads = {UserTorque{"counting",
                                  [&calls](const LoadState& s) {
                                      ++calls;
                                      return -0.1 * s.angular_velocity_B;
                                  },
                                  {}}};
        const Problem problem = pose(scene);
        calls = 0;
        Settings settings;
        settings.tolerance = 1e-9, settings.record = false;
        const Trajectory trajectory = solve(problem, *find_method(method), settings);
        ASSERT_EQ(trajectory.status, Status::ok);
        EXPECT_EQ(trajectory.rhs_evaluations, calls) << method;
    }
}

TEST(Dopri5, DoesNotCarryItsDerivativeOverAnEvent) {
    // a large torque ends: a stale derivative would change the rates by torque x h = 1e-2
    Scene scene = free_body(2);
    scene.loads = {Torque{{0, 0, 30}, Frame::body, {0, 1}},
                   Impulse{{0, 3, 0}, Frame::body, {1, 0, 0}, Frame::body, 1.5}};
    const Trajectory fsal = with_step(scene, "odeint_dopri5", 1e-3);
    const Trajectory plain = with_step(scene, "odeint_fehlberg78", 1e-3);
    // order 5 at w h = 0.01: at most 1e-10 per step over a rotation of 15 rad
    EXPECT_LT(attitude_error(fsal.samples.back().q, plain.samples.back().q), 1e-9);
}

TEST(AdamsBashforthMoulton, StartsItsHistoryAgainAtAnEvent) {
    // An event inside a step splits it. The history must not contain rates from before the event or at another
    // spacing: a stale rate would cost torque x h = 1e-2
    Scene scene = free_body(2);
    scene.loads = {Torque{{0, 0, 30}, Frame::body, {0, 1.00037}},
                   Impulse{{0, 3, 0}, Frame::body, {1, 0, 0}, Frame::body, 1.50012}};
    const Trajectory multistep = with_step(scene, "odeint_adams_bashforth_moulton", 1e-3);
    const Trajectory plain = with_step(scene, "odeint_fehlberg78", 1e-3);
    // order 6 at w h = 0.01: at most 1e-12 per step over a rotation of 15 rad
    EXPECT_LT(attitude_error(multistep.samples.back().q, plain.samples.back().q), 1e-9);
}

// without rosenbrock4: uBLAS allocates once per factorisation
TEST(FixedSteps, AllocateNothing) {
    const Problem problem = pose(heavy_top(10));
    for (const char* method :
         {"odeint_euler", "odeint_rk4", "odeint_cash_karp54", "odeint_dopri5", "odeint_fehlberg78",
          "odeint_adams_bashforth_moulton", "odeint_rk4_projected", "odeint_fehlberg78_projected", "arkode_erk4",
          "arkode_erk4_relaxed", "article_as_written", "article_mended", "article_body_frame"}) {
        const auto allocated = [&](double steps) {
            Settings settings;
            settings.step = 10 / steps, settings.samples = 1;
            const long before = allocations;
            const Trajectory trajectory = solve(problem, *find_method(method), settings);
            EXPECT_EQ(trajectory.status, Status::ok);
            EXPECT_EQ(static_cast<double>(trajectory.steps), steps);
            return allocations - before;
        };
        const long few = allocated(1e4), many = allocated(1e5);
        EXPECT_EQ(few, many) << method;
        EXPECT_GT(few, 0) << "the count does not count";
    }
}

TEST(OdeintAlgebra, ANormThatIsNotANumberIsInfinite) {
    OdeintArray<3> s;
    EXPECT_EQ(OdeintAlgebra<3>::norm_inf(s), 0);
    s[0] = -3, s[1] = 2;
    EXPECT_EQ(OdeintAlgebra<3>::norm_inf(s), 3);
    s[2] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(OdeintAlgebra<3>::norm_inf(s), s[2]);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 3; ++i) {
        OdeintArray<3> one;
        one[i] = nan, one[(i + 1) % 3] = 5;
        EXPECT_EQ(OdeintAlgebra<3>::norm_inf(one), std::numeric_limits<double>::infinity()) << i;
    }
}

/// The Prothero-Robinson problem y' = -1000 (y - c) with c' = -s and s' = c, so that c = cos t.
struct Prothero {
    static void rhs(void*, double, const double* y, double* dydt) {
        dydt[0] = -1000 * (y[0] - y[1]), dydt[1] = -y[2], dydt[2] = y[1];
    }
    static void jacobian(void*, double, const double*, double* J) {
        const double rows[9] = {-1000, 1000, 0, 0, 0, -1, 0, 1, 0};
        std::copy(rows, rows + 9, J);
    }
    /// y = (10^6 cos t + 10^3 sin t) / (10^6 + 1) after the transient e^-1000t.
    static double solution(double t) { return (1e6 * std::cos(t) + 1e3 * std::sin(t)) / (1e6 + 1); }
};

TEST(Rosenbrock4, SolvesAStiffEquation) {
    Rosenbrock4 stepper({3, Prothero::rhs, Prothero::jacobian}, 1e-10, 1e-10);
    double y[3] = {0, 1, 0}, t = 0, h = 1e-4;
    int steps = 0;
    while (t < 2 && ++steps < 100000) {
        double next[3], proposed = std::min(h, 2 - t);
        const double tried = proposed;
        if (stepper.attempt(nullptr, t, y, next, proposed)) std::copy(next, next + 3, y), t += tried;
        h = proposed;
    }
    EXPECT_NEAR(y[0], Prothero::solution(2), 1e-8);
    // stability would limit an explicit method to h < 3 / 1000, so to thousands of steps at order 4
    EXPECT_LT(steps, 700);
}

TEST(Rosenbrock4, CopiesGoOnIndependently) {
    Rosenbrock4 one({3, Prothero::rhs, Prothero::jacobian}, 1e-6, 1e-6);
    const double start[3] = {0, 1, 0};
    double y[3], aside[3], h = 1e-3;
    one.attempt(nullptr, 0, start, y, h);
    Rosenbrock4 two = one, three = one;
    double a = h, b = h, c = h;
    for (int i = 0; i < 5; ++i) two.attempt(nullptr, 0.5, y, aside, b);
    double first[3], second[3];
    one.attempt(nullptr, 1e-3, y, first, a);
    three.attempt(nullptr, 1e-3, y, second, c);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(first[i], second[i]);
    EXPECT_EQ(a, c);
    EXPECT_NE(a, b);
}

TEST(Rosenbrock4, AStiffDragCostsFarFewerStepsThanAnExplicitMethod) {
    Scene scene = free_body(10);
    scene.loads = {Drag{{1000, 1000, 1000}, 0, {}}, Torque{{1, 2, 3}, Frame::world, {}}};
    const Trajectory implicit = with_tolerance(scene, "odeint_rosenbrock4", 1e-8);
    const Trajectory explicit_one = with_tolerance(scene, "odeint_dopri5", 1e-8);
    ASSERT_EQ(implicit.status, Status::ok) << implicit.message;
    ASSERT_EQ(explicit_one.status, Status::ok) << explicit_one.message;
    EXPECT_LT(implicit.steps, explicit_one.steps / 10);
    EXPECT_LT(attitude_error(implicit.samples.back().q, explicit_one.samples.back().q), 1e-6);
}

}  // namespace
}  // namespace polhode
