// The drivers: events, samples, limits, and failing methods.
#include "integrators/run/march.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "integrators/run/march_controlled.h"
#include "integrators/scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// A method with a step or a tolerance.
struct Run {
    const char* method;
    std::optional<double> step, tolerance;

    Settings settings(long samples) const {
        Settings s;
        s.step = step, s.tolerance = tolerance, s.samples = samples;
        return s;
    }
    Trajectory on(const Scene& scene, long samples = 1) const {
        return solve(scene, *find_method(method), settings(samples));
    }
};
std::ostream& operator<<(std::ostream& out, const Run& run) {
    return out << run.method << (run.step ? " step " : " tolerance ") << (run.step ? *run.step : *run.tolerance);
}

const Run every_run[] = {{"odeint_rk4", 1e-3, {}},
                         {"odeint_cash_karp54", 1e-3, {}},
                         {"odeint_dopri5", 1e-3, {}},
                         {"odeint_fehlberg78", 1e-2, {}},
                         {"odeint_adams_bashforth_moulton", 1e-3, {}},
                         {"odeint_rosenbrock4", 1e-3, {}},
                         {"arkode_erk4", 1e-3, {}},
                         {"arkode_erk8", 1e-2, {}},
                         {"arkode_dirk5", 2e-3, {}},
                         {"odeint_cash_karp54", {}, 1e-11},
                         {"odeint_dopri5", {}, 1e-11},
                         {"odeint_fehlberg78", {}, 1e-11},
                         {"odeint_rosenbrock4", {}, 1e-11},
                         {"odeint_bulirsch_stoer", {}, 1e-11},
                         {"arkode_erk5", {}, 1e-11},
                         {"arkode_erk8", {}, 1e-11},
                         {"arkode_dirk5", {}, 1e-11}};

class March : public ::testing::TestWithParam<Run> {};

void expect_same_bits(const Sample& a, const Sample& b) {
    EXPECT_EQ(a.t, b.t);
    EXPECT_EQ(a.q, b.q);
    EXPECT_EQ(a.angular_velocity_B, b.angular_velocity_B);
    EXPECT_EQ(a.position_W, b.position_W);
    EXPECT_EQ(a.velocity_W, b.velocity_W);
}

double distance(const Vector3<double>& a, const Vector3<double>& b) { return std::sqrt(dot(a - b, a - b)); }

/// The largest difference of all parts of the state, each in its own unit.
double difference(const Sample& a, const Sample& b) {
    return std::max({attitude_error(a.q, b.q), distance(a.angular_velocity_B, b.angular_velocity_B),
                     distance(a.position_W, b.position_W), distance(a.velocity_W, b.velocity_W)});
}

/// Evaluations of the steps, without those for samples between steps.
long of_steps(const Trajectory& t) { return t.rhs_evaluations - t.sample_evaluations; }

TEST_P(March, TakesTheSameStepsWithAndWithoutSamples) {
    const Problem problem = pose(everything(3));
    const Method& method = *find_method(GetParam().method);
    Settings settings = GetParam().settings(30);
    const Trajectory recorded = solve(problem, method, settings);
    settings.record = false;
    const Trajectory timed = solve(problem, method, settings);
    settings.repetitions = 3;
    const Trajectory repeated = solve(problem, method, settings);
    ASSERT_EQ(recorded.status, Status::ok) << recorded.message;
    ASSERT_EQ(recorded.samples.size(), 31u);
    for (const Trajectory* other : {&timed, &repeated}) {
        ASSERT_EQ(other->status, Status::ok) << other->message;
        ASSERT_EQ(other->samples.size(), 1u);
        expect_same_bits(other->samples[0], recorded.samples.back());
        EXPECT_EQ(other->steps, recorded.steps);
        EXPECT_EQ(of_steps(*other), of_steps(recorded));
    }
}

TEST_P(March, ToleranceDrivenStepsDoNotDependOnTheSampling) {
    if (GetParam().step) {
        // a fixed step is fitted so that whole steps meet every sample, and the run reports this step
        const Trajectory t = GetParam().on(everything(3), 7);
        EXPECT_LE(t.step, *GetParam().step);
        EXPECT_EQ(t.steps, std::lround(3 / t.step));
        return;
    }
    const Trajectory one = GetParam().on(everything(3), 1), many = GetParam().on(everything(3), 301);
    EXPECT_EQ(one.steps, many.steps);
    EXPECT_EQ(of_steps(one), of_steps(many));
    expect_same_bits(one.samples.back(), many.samples.back());
}

/// A body that rotates about one axis under a torque for 1 <= t < 2, with angular impulses at 2.5 s and at the end.
Scene pushed_about_one_axis() {
    Scene scene;
    scene.name = "pushed", scene.duration = 4;
    scene.body.inertia_B = diagonal(Vector3<double>(2, 3, 2.5));
    scene.initial.angular_velocity = {0, 0, 0.5};
    scene.loads = {Torque{{0, 0, 1.25}, Frame::body, {1, 2}},
                   Impulse{{0, 0.5, 0}, Frame::body, {1, 0, 0}, Frame::body, 2.5},
                   Impulse{{0, 1, 0}, Frame::body, {1, 0, 0}, Frame::body, 4}};
    return scene;
}
/// I3 = 2.5: the rate is 0.5 until 1 s, then grows by 0.5 (t - 1) until 2 s, by 0.5 / 2.5 at 2.5 s and by 1 / 2.5 at 4
/// s.
double pushed_rate(double t) {
    double w = 0.5 + 0.5 * std::min(std::max(t - 1, 0.0), 1.0);
    if (t >= 2.5) w += 0.2;
    if (t >= 4) w += 0.4;
    return w;
}
double pushed_angle(double t) {
    const double pushed = std::min(std::max(t - 1, 0.0), 1.0);
    return 0.5 * t + 0.25 * pushed * pushed + 0.5 * std::max(t - 2, 0.0) + 0.2 * std::max(t - 2.5, 0.0);
}

TEST_P(March, MeetsWindowsAndImpulsesExactly) {
    // samples at every event (1, 2, 2.5, 4 s) and between; a sample at an event shows the motion after it
    const Trajectory trajectory = GetParam().on(pushed_about_one_axis(), 16);
    ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
    ASSERT_EQ(trajectory.samples.size(), 17u);
    for (const Sample& sample : trajectory.samples) {
        const double half = pushed_angle(sample.t) / 2;
        // errors of the methods: R = 1e-11 per step, or h^4 = 1e-12; a wrongly split step would give 1e-3
        EXPECT_NEAR(sample.angular_velocity_B[2], pushed_rate(sample.t), 1e-9) << "t = " << sample.t;
        EXPECT_LT(attitude_error(sample.q, {std::cos(half), 0, 0, std::sin(half)}), 1e-9) << "t = " << sample.t;
    }
}

/// The scene from time `begin` to `end`, started at `from`, with shifted windows. Impulses at `begin` count only in
/// the first piece, because a sample at an event shows the motion after it.
Scene piece(const Scene& whole, double begin, double end, const Sample* from) {
    Scene scene = whole;
    scene.duration = end - begin;
    scene.loads.clear();
    for (const Load& load : whole.loads) {
        if (std::holds_alternative<Impulse>(load)) continue;
        const Window window = window_of(load);
        if (!(window.from <= begin && begin < window.until)) continue;
        scene.loads.push_back(load);
        std::visit(
            [](auto& l) {
                if constexpr (requires { l.window; }) l.window = Window{};
            },
            scene.loads.back());
    }
    if (from) {
        const double scale = 1 / std::sqrt(squared_norm(from->q));
        scene.initial.orientation = {scale * from->q.w, scale * from->q.x, scale * from->q.y, scale * from->q.z};
        scene.initial.angular_velocity = from->angular_velocity_B;
        scene.initial.position_W = from->position_W, scene.initial.velocity_W = from->velocity_W;
    }
    return scene;
}

/// An impulse by the textbook equations in body axes: I dw = r x J, m dv = J.
void kick(const Scene& scene, const Impulse& impulse, Sample& s) {
    const Vector3<double> J_W = impulse.frame == Frame::world ? impulse.vector : rotate(s.q, impulse.vector);
    const Vector3<double> point_W = impulse.point_frame == Frame::world
                                        ? impulse.point
                                        : s.position_W + rotate(s.q, impulse.point - scene.body.center_of_mass);
    const Vector3<double> dL_B = rotate_back(s.q, cross(point_W - s.position_W, J_W));
    s.angular_velocity_B = s.angular_velocity_B + inverse(scene.body.inertia_B) * dL_B;
    s.velocity_W = s.velocity_W + (1 / scene.body.mass) * J_W;
}

TEST_P(March, EqualsTheSolutionComposedOfItsPieces) {
    const Scene scene = everything(3);
    const std::vector<double> times = event_times(scene);
    ASSERT_EQ(times.size(), 5u);
    Sample state;
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        const Trajectory part = GetParam().on(piece(scene, times[i], times[i + 1], i == 0 ? nullptr : &state));
        ASSERT_EQ(part.status, Status::ok) << part.message;
        state = part.samples.back();
        for (const Load& load : scene.loads)
            if (const auto* impulse = std::get_if<Impulse>(&load); impulse && impulse->at == times[i + 1])
                kick(scene, *impulse, state);
    }
    const Trajectory whole = GetParam().on(scene, 1);
    ASSERT_EQ(whole.status, Status::ok) << whole.message;
    // the pieces have other steps; the difference is the error of the method at these settings
    EXPECT_LT(difference(whole.samples.back(), state), 2e-9);
}

TEST_P(March, ALastSegmentOfNoLengthShowsTheMotionAfterItsImpulse) {
    Scene scene = everything(2), without = scene;
    const Impulse last{{0.3, 0.2, -0.5}, Frame::world, {0.2, -0.1, 0.4}, Frame::body, 2};
    scene.loads.push_back(last);
    const Trajectory with = GetParam().on(scene, 5), before = GetParam().on(without, 5);
    ASSERT_EQ(with.status, Status::ok) << with.message;
    ASSERT_EQ(with.samples.size(), 6u);
    Sample expected = before.samples.back();
    kick(scene, last, expected);
    EXPECT_LT(difference(with.samples.back(), expected), 1e-9);
    EXPECT_GT(difference(with.samples.back(), before.samples.back()), 0.1);
    for (int i = 0; i < 5; ++i) EXPECT_LT(difference(with.samples[i], before.samples[i]), 1e-9);
}

Scene with_user_torque(Vector3<double> (*torque)(const LoadState&)) {
    Scene scene = free_body(2);
    scene.loads = {UserTorque{"test", torque, {}}};
    return scene;
}

/// Checks that the run soon ends with an allowed failure and finite numbers, or as `unsupported` without derivatives.
void expect_named_failure(const Run& run, const Scene& scene, std::initializer_list<Status> allowed) {
    const auto start = std::chrono::steady_clock::now();
    const Trajectory trajectory = run.on(scene, 20);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    if (std::string(run.method) == "odeint_rosenbrock4" || std::string(run.method) == "arkode_dirk5") {
        EXPECT_EQ(trajectory.status, Status::unsupported);
        return;
    }
    EXPECT_NE(std::find(allowed.begin(), allowed.end(), trajectory.status), allowed.end())
        << name_of(trajectory.status) << ": " << trajectory.message;
    EXPECT_FALSE(trajectory.message.empty());
    EXPECT_LT(elapsed.count(), 20);
    EXPECT_LT(trajectory.samples.size(), 21u);
    for (const Sample& sample : trajectory.samples)
        EXPECT_TRUE(std::isfinite(squared_norm(sample.q) + dot(sample.angular_velocity_B, sample.angular_velocity_B)));
}

TEST_P(March, NamesATorqueThatIsNotANumber) {
    const auto later = [](const LoadState& s) {
        return Vector3<double>(0, s.t > 0.7 ? std::numeric_limits<double>::quiet_NaN() : 0, 0);
    };
    const auto at_once = [](const LoadState&) {
        return Vector3<double>(std::numeric_limits<double>::infinity(), 0, 0);
    };
    expect_named_failure(GetParam(), with_user_torque(later), {Status::diverged});
    expect_named_failure(GetParam(), with_user_torque(at_once), {Status::diverged});
}

TEST_P(March, NamesABlowUp) {
    // dw/dt ~ w^3: infinite after 0.5 s
    const auto growing = [](const LoadState& s) {
        const Vector3<double>& w = s.angular_velocity_B;
        return dot(w, w) * w;
    };
    expect_named_failure(GetParam(), with_user_torque(growing), {Status::diverged, Status::tolerance_not_met});
}

TEST_P(March, StopsAtTheLimits) {
    const Problem problem = pose(free_body(1000));
    const Method& method = *find_method(GetParam().method);
    for (bool record : {true, false}) {
        Settings settings = GetParam().settings(10);
        settings.record = record;
        settings.max_steps = 10;
        const Trajectory stepped = solve(problem, method, settings);
        EXPECT_EQ(stepped.status, Status::failed);
        EXPECT_TRUE(stepped.limit_reached);
        // with a fixed step the limit is checked before the run
        EXPECT_EQ(stepped.steps, GetParam().step ? 0 : 10);
        EXPECT_NE(stepped.message.find("10 steps"), std::string::npos) << stepped.message;

        settings = GetParam().settings(10);
        settings.record = record;
        settings.seconds_limit = 1e-7;
        const Trajectory timed = solve(problem, method, settings);
        EXPECT_EQ(timed.status, Status::failed);
        EXPECT_TRUE(timed.limit_reached);
        EXPECT_NE(timed.message.find(" s"), std::string::npos) << timed.message;
    }
}

INSTANTIATE_TEST_SUITE_P(All, March, ::testing::ValuesIn(every_run), [](const auto& of) {
    return std::string(of.param.method) + (of.param.step ? "_fixed" : "_controlled");
});

TEST(MarchControlled, ATooSmallToleranceIsNotMet) {
    for (const char* method :
         {"odeint_cash_karp54", "odeint_dopri5", "odeint_fehlberg78", "odeint_bulirsch_stoer", "odeint_rosenbrock4"})
        for (double tolerance : {1e-17, 1e-30, 1e-300}) {
            const Trajectory trajectory = with_tolerance(everything(3), method, tolerance);
            EXPECT_EQ(trajectory.status, Status::tolerance_not_met) << method;
            EXPECT_NE(trajectory.message.find("binary64"), std::string::npos) << trajectory.message;
        }
}

/// A stepper with a prescribed outcome, which does not change the state.
struct Puppet {
    const Problem* problem;
    Attempt outcome;
    double proposal;  ///< the length of every step
    double shrinkage;

    void restart() {}
    void enter(const Segment&) {}
    double first_step(double) { return proposal; }
    Attempt attempt(double& t, double& h) {
        if (outcome == Attempt::accepted)
            t += h, h = proposal;
        else
            h *= shrinkage;
        return outcome;
    }
    Sample sample(double t) const {
        Sample s;
        s.t = t;
        return s;
    }
    long rhs_evaluations() const { return 0; }
};

Trajectory pull(const Puppet& like) {
    const Problem problem = pose(free_body(2));
    Settings settings;
    settings.samples = 4;
    Puppet puppet = like;
    puppet.problem = &problem;
    return march_controlled(problem, settings, puppet);
}

TEST(MarchControlled, EndsWhenNothingIsEverAccepted) {
    EXPECT_EQ(pull({nullptr, Attempt::rejected, 0.1, 0.2}).status, Status::tolerance_not_met);
    EXPECT_EQ(pull({nullptr, Attempt::rejected, 0.1, 0.999}).status, Status::tolerance_not_met);
    EXPECT_EQ(pull({nullptr, Attempt::rejected, 0.1, 1}).status, Status::tolerance_not_met);
    EXPECT_EQ(pull({nullptr, Attempt::not_finite, 0.1, 0.1}).status, Status::diverged);
    EXPECT_EQ(pull({nullptr, Attempt::not_finite, 0.1, std::numeric_limits<double>::quiet_NaN()}).status,
              Status::diverged);
}

TEST(MarchControlled, EndsWhenStepsAreAcceptedButTooShortToArrive) {
    const Trajectory crawling = pull({nullptr, Attempt::accepted, 1e-13, 1});
    EXPECT_EQ(crawling.status, Status::tolerance_not_met);
    EXPECT_NE(crawling.message.find("no progress"), std::string::npos) << crawling.message;
    EXPECT_LT(crawling.steps, 100000);
    // 2e5 steps are many, but the run reaches the end
    const Trajectory slow = pull({nullptr, Attempt::accepted, 1e-5, 1});
    EXPECT_EQ(slow.status, Status::ok) << slow.message;
    EXPECT_NEAR(static_cast<double>(slow.steps), 2e5, 1);
}

TEST(StepsPerSample, RoundsTheStepDown) {
    EXPECT_EQ(steps_per_sample(1, 0.3), 4);
    EXPECT_EQ(steps_per_sample(1, 0.25), 4);
    EXPECT_EQ(steps_per_sample(1, 2), 1);
    // 0.1 is not exactly a tenth: the ratio differs from 10 by rounding
    EXPECT_EQ(steps_per_sample(1, 0.1), 10);
    EXPECT_EQ(steps_per_sample(0.3, 0.1), 3);
}

}  // namespace
}  // namespace polhode
