// All tolerance-driven runs check the energy at the same places and report divergence with the same message.
#include "integrators/run/watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "integrators/run/march_controlled.h"
#include "integrators/run/solver_run.h"
#include "integrators/scenes.h"

namespace polhode {
namespace {

constexpr double step = 0.01;

// The rate of a body after n steps, each of which multiplies it by `factor`.
struct Growth {
    double factor;
    long n = 0;

    Sample at(double t) const {
        Sample sample;
        sample.t = t, sample.q = {1, 0, 0, 0}, sample.angular_velocity_B = {std::pow(factor, n), 0, 0};
        return sample;
    }
};

struct GrowingSession {
    Growth growth;
    double t = 0;

    void restart() { t = 0, growth.n = 0; }
    int enter(const Segment&) { return 0; }
    int step() {
        t += polhode::step, ++growth.n;
        return 0;
    }
    double time() const { return t; }
    Sample sample() const { return growth.at(t); }
    std::optional<Sample> sample_inside(double at) const { return growth.at(at); }
    int inside_flag() const { return 0; }
    SolverFailure failure(int) const { return {Status::failed, {}}; }
    long steps() const { return growth.n; }
    long rhs_evaluations() const { return growth.n; }
};

struct GrowingStepper {
    Growth growth;

    void restart() { growth.n = 0; }
    void enter(const Segment&) {}
    double first_step(double) const { return step; }
    Attempt attempt(double& t, double& h) {
        t += h, h = step, ++growth.n;
        return Attempt::accepted;
    }
    Sample sample(double t) const { return growth.at(t); }
    long rhs_evaluations() const { return growth.n; }
};

struct Runs {
    Trajectory by_session, by_steps;
};

Runs runs_of(double factor, double duration, const Settings& settings) {
    const Problem problem = pose(testing::free_body(duration));
    GrowingSession session{{factor}};
    return {SolverRun(problem, settings, session).solve(),
            march_controlled(problem, settings, GrowingStepper{{factor}})};
}

TEST(Watch, EnergyBeyondBoundsIsSeenWithinSixteenStepsWhoeverSteps) {
    for (const bool record : {true, false}) {
        Settings settings;
        settings.samples = 1, settings.record = record;
        // the energy exceeds 10^6 times the scene's after 4 steps; the next sample is 1000 steps away
        const Runs runs = runs_of(10, 1000 * step, settings);
        for (const Trajectory* trajectory : {&runs.by_session, &runs.by_steps}) {
            EXPECT_EQ(trajectory->status, Status::diverged);
            EXPECT_EQ(trajectory->steps, 16);
            EXPECT_NE(trajectory->message.find("at t = 0.16 s, more than 10^6 times the scene's estimated maximum"),
                      std::string::npos)
                << trajectory->message;
            EXPECT_EQ(trajectory->samples.size(), record ? 1u : 0u);
        }
        EXPECT_EQ(runs.by_session.message, runs.by_steps.message);
    }
}

TEST(Watch, AndAtASampleBefore) {
    Settings settings;
    settings.samples = 10;
    // a sample every 5 steps
    const Runs runs = runs_of(10, 50 * step, settings);
    for (const Trajectory* trajectory : {&runs.by_session, &runs.by_steps}) {
        EXPECT_EQ(trajectory->status, Status::diverged);
        EXPECT_LE(trajectory->steps, 6);
        EXPECT_EQ(trajectory->samples.size(), 1u);
        EXPECT_NE(trajectory->message.find("the last state, at t = 0 s"), std::string::npos) << trajectory->message;
    }
    EXPECT_EQ(runs.by_session.message, runs.by_steps.message);
}

TEST(Watch, AMotionThatKeepsItsEnergyIsLeftAlone) {
    Settings settings;
    settings.samples = 2, settings.repetitions = 3;
    const Runs runs = runs_of(1, 100 * step, settings);
    for (const Trajectory* trajectory : {&runs.by_session, &runs.by_steps}) {
        EXPECT_EQ(trajectory->status, Status::ok) << trajectory->message;
        EXPECT_EQ(trajectory->samples.size(), 3u);
    }
}

TEST(Watch, RepeatsUntilARunEndsEarlyAndRecordsTheLast) {
    Settings settings;
    settings.repetitions = 3;
    Trajectory trajectory;
    std::string calls;
    EXPECT_TRUE(repeat(settings, trajectory, [&](bool recording) {
        calls += recording ? "r" : "-";
        return true;
    }));
    EXPECT_EQ(calls, "--r");
    EXPECT_FALSE(repeat(settings, trajectory, [&](bool) {
        calls += "x";
        return false;
    }));
    EXPECT_EQ(calls, "--rx");
}

}  // namespace
}  // namespace polhode
