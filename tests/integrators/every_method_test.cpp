// Requirements on every method.
#include <gtest/gtest.h>

#include "integrators/method.h"
#include "integrators/scenes.h"

namespace polhode {
namespace {

class EveryMethod : public ::testing::TestWithParam<const Method*> {};

std::string name_of_method(const ::testing::TestParamInfo<const Method*>& info) {
    return std::string(info.param->name);
}

/// Samples are at exactly the times of the contract, because errors are formed sample by sample.
TEST_P(EveryMethod, SamplesAtTheTimesOfTheContract) {
    for (const Scene& scene : {polhode::testing::free_body(10), polhode::testing::heavy_top(2.3)})
        for (const bool step : {true, false}) {
            if (step ? !takes_step(*GetParam()) : !takes_tolerance(*GetParam())) continue;
            for (const double setting : step ? std::vector<double>{0.03, 0.0131} : std::vector<double>{1e-4, 1e-7}) {
                Settings settings;
                settings.samples = 25;
                (step ? settings.step : settings.tolerance) = setting;
                const Trajectory trajectory = solve(scene, *GetParam(), settings);
                if (trajectory.status != Status::ok) continue;  // other tests check the status
                ASSERT_EQ(trajectory.samples.size(), 26U);
                for (long k = 0; k <= 25; ++k)
                    ASSERT_EQ(trajectory.samples[static_cast<std::size_t>(k)].t, sample_time(scene.duration, k, 25));
            }
        }
}

/// A timed run, which keeps only the end, ends in the same state as a run that records every sample.
TEST_P(EveryMethod, EndsTheSameWhetherItRecordsOrNot) {
    const Scene scene = polhode::testing::heavy_top(2);
    Settings settings;
    settings.samples = 7;
    if (takes_step(*GetParam()))
        settings.step = 0.004;
    else if (takes_tolerance(*GetParam()))
        settings.tolerance = 1e-7;
    const Trajectory whole = solve(scene, *GetParam(), settings);
    settings.record = false;
    const Trajectory end = solve(scene, *GetParam(), settings);
    ASSERT_EQ(whole.status, end.status);
    if (whole.status != Status::ok) return;
    EXPECT_EQ(whole.samples.back().q, end.samples.back().q);
    EXPECT_EQ(whole.samples.back().angular_velocity_B, end.samples.back().angular_velocity_B);
    EXPECT_EQ(whole.steps, end.steps);
    EXPECT_EQ(whole.rhs_evaluations - whole.sample_evaluations, end.rhs_evaluations - end.sample_evaluations);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, ::testing::ValuesIn(methods().begin(), methods().end()), name_of_method);

}  // namespace
}  // namespace polhode
