// polhode's own integrators close to the limit of binary64: errors of 10^-12 rad at a tolerance of 10^-14.
#include <gtest/gtest.h>

#include "integrators/run/march.h"
#include "integrators/scenes.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

struct Tight {
    const char *scene, *method;
    friend std::ostream& operator<<(std::ostream& out, const Tight& c) { return out << c.scene << " by " << c.method; }
};

class TightTolerance : public ::testing::TestWithParam<Tight> {};

// Over hundreds of radians of fast tops, rounding of the time or an incomplete Newton iteration would show.
TEST_P(TightTolerance, IsWorthTwelveDigits) {
    const Scene scene = find_scene(GetParam().scene);
    constexpr long samples = 4;
    const Reference truth = reference(scene, samples);
    ASSERT_TRUE(truth.available);
    Settings settings;
    settings.samples = samples, settings.tolerance = 1e-14;
    const Trajectory run = solve(pose(scene), *find_method(GetParam().method), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    for (std::size_t k = 0; k <= samples; ++k)
        EXPECT_LT(testing::attitude_error(run.samples[k].q, truth.samples[k].rounded().q), 5e-13) << "sample " << k;
}

std::vector<Tight> cases() {
    std::vector<Tight> all;
    for (const char* scene : {"simo_wong_top", "lagrange_top", "heavy_asymmetric_top", "free_asymmetric", "nasa_brick"})
        for (const char* method : {"taylor", "extrapolation", "dop853", "radau"}) all.push_back({scene, method});
    return all;
}

INSTANTIATE_TEST_SUITE_P(OwnIntegrators, TightTolerance, ::testing::ValuesIn(cases()),
                         [](const auto& each) { return std::string(each.param.scene) + "_" + each.param.method; });

}  // namespace
}  // namespace polhode
