// User-defined sample times: every method meets them, with the same motion as at equal intervals.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "integrators/run/march.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr long intervals = 20;

Scene sampled_scene() {
    Scene scene = find_scene("every_load");
    scene.duration = 2;  // impulses and load windows are inside
    return scene;
}

std::vector<double> some_of_the_usual() {
    std::vector<double> times;
    for (const long k : {3L, 7L, 8L, 19L}) times.push_back(sample_time(2, k, intervals));
    return times;
}

class SampleTimes : public ::testing::TestWithParam<const Method*> {};

/// With a tolerance the steps do not depend on the samples. A fixed step is fitted into other intervals.
TEST_P(SampleTimes, ShowTheSameMotion) {
    const Method& method = *GetParam();
    const Problem problem = pose(sampled_scene());
    Settings settings;
    if (takes_tolerance(method))
        settings.tolerance = 1e-6;
    else if (takes_step(method))
        settings.step = 2e-3;
    settings.samples = intervals;
    const Trajectory usual = solve(problem, method, settings);
    if (usual.status == Status::unsupported) GTEST_SKIP() << usual.message;
    settings.times = some_of_the_usual();
    const Trajectory chosen = solve(problem, method, settings);
    ASSERT_EQ(chosen.status, usual.status) << chosen.message;
    if (usual.status != Status::ok) return;
    ASSERT_EQ(chosen.moments(), settings.times.size());
    const bool fixed = settings.step.has_value();
    std::size_t k = 0;
    for (const Sample& sample : chosen.samples) {
        while (usual.samples[k].t < sample.t) ++k;
        ASSERT_EQ(usual.samples[k].t, sample.t);
        const double off = std::abs(usual.samples[k].q.w - sample.q.w) + std::abs(usual.samples[k].q.z - sample.q.z);
        // fixed steps: the rounding of h; tolerances: consecutive samples inside one step start from each other
        const double most = method.precision == Precision::binary32 ? 1e-2
                            : fixed                                 ? 1e-6
                                                                    : 100 * settings.tolerance.value_or(1e-14);
        EXPECT_LT(off, most) << method.name << " at " << sample.t;
    }
    if (!fixed && method.family != Family::closed_form) {
        EXPECT_EQ(chosen.steps, usual.steps);
    }
}

std::vector<const Method*> sampled_methods() {
    std::vector<const Method*> all;
    for (const Method* method : methods())
        if (method->family != Family::reference) all.push_back(method);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Of, SampleTimes, ::testing::ValuesIn(sampled_methods()),
                         [](const auto& one) { return std::string(one.param->name); });

TEST(SampleTimesOfARun, AreRefusedOutOfOrderOrRange) {
    const Problem problem = pose(sampled_scene());
    const Method& method = *find_method("dop853");
    const std::vector<std::vector<double>> wrong{{1, 0.5}, {0.5, 0.5}, {-0.1}, {2.1}, {std::nan("")}};
    for (const std::vector<double>& times : wrong) {
        Settings settings;
        settings.times = times;
        const Trajectory none = solve(problem, method, settings);
        EXPECT_EQ(none.status, Status::failed);
        EXPECT_NE(none.message.find("sample time"), std::string::npos) << none.message;
        EXPECT_TRUE(none.samples.empty());
    }
}

/// The intervals cover the run, each by whole steps not longer than the given step.
TEST(SampleTimesOfARun, AreMetByWholeSteps) {
    const Problem problem = pose(sampled_scene());
    Settings settings;
    settings.step = 0.3;
    settings.times = {0.1, 0.7, 1.9};
    const SampleIntervals intervals_of(problem, settings);
    ASSERT_EQ(intervals_of.count(), 4);
    EXPECT_FALSE(intervals_of.has_initial_sample());
    double end = 0;
    long steps = 0;
    for (long k = 0; k < intervals_of.count(); ++k) {
        const SampleIntervals::Interval at = intervals_of[k];
        EXPECT_EQ(at.begin, end);
        EXPECT_EQ(at.sampled, k < 3);
        EXPECT_LE(at.h, 0.3);
        EXPECT_EQ(at.time(at.steps), at.end);
        end = at.end, steps += at.steps;
    }
    EXPECT_EQ(end, 2);
    EXPECT_EQ(steps, 1 + 2 + 4 + 1);
    EXPECT_EQ(intervals_of.steps(), steps);
    EXPECT_DOUBLE_EQ(intervals_of.longest_step(), 0.3);
    const Trajectory motion = solve(problem, *find_method("odeint_rk4"), settings);
    EXPECT_EQ(motion.steps, steps);
    EXPECT_EQ(motion.moments(), 3U);
    settings.max_steps = steps - 1;
    EXPECT_TRUE(solve(problem, *find_method("odeint_rk4"), settings).limit_reached);
}

}  // namespace
}  // namespace polhode
