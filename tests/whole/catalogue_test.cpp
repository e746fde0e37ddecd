// Every built-in scene: it can be read, has a source, survives writing and reading, can be posed, and its numerical
// motion conserves the invariants of the exact motion.
#include "catalogue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/method.h"
#include "motion/conserved.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

class Catalogue : public ::testing::TestWithParam<std::string> {};
class PlainCatalogue : public ::testing::TestWithParam<std::string> {};

double length(const Vector3<double>& v) { return std::hypot(v[0], v[1], v[2]); }

TEST(CatalogueSize, AtLeastTwentyFourScenes) { EXPECT_GE(scenes_in().size(), 24u); }

TEST_P(Catalogue, HasDescriptionsAndSources) {
    const Scene scene = find_scene(GetParam());
    EXPECT_GT(scene.about.size(), 40u);
    EXPECT_GT(scene.source.size(), 20u);
    // lists print these texts: one line each, without a full stop
    for (const std::string& text : {scene.about, scene.source}) {
        EXPECT_EQ(text.find('\n'), std::string::npos);
        EXPECT_NE(text.back(), '.');
    }
}

TEST_P(Catalogue, IsTheSameSceneWhenWrittenAndReadAgain) {
    const std::string text = write_scene(find_scene(GetParam()));
    EXPECT_EQ(write_scene(parse_scene(text, "written")), text);
}

// The scales of the changes: the largest value of a quantity in the run, or of its parts where these cancel.
struct Sizes {
    double energy = 0, angular = 0, linear = 0, rate = 0;
};

Sizes sizes_of(const Problem& problem, const Trajectory& run) {
    Sizes sizes;
    for (const Sample& s : run.samples) {
        const auto now = invariants(problem.scene, problem.body, s.t, normalized(s.q), s.angular_velocity_B,
                                    s.position_W, s.velocity_W);
        sizes.energy = std::max({sizes.energy, std::abs(now.energy), now.kinetic});
        sizes.angular = std::max(sizes.angular, length(now.angular_momentum_W));
        sizes.linear = std::max(sizes.linear, problem.body.mass * length(s.velocity_W));
        sizes.rate = std::max(sizes.rate, length(s.angular_velocity_B));
    }
    return sizes;
}

double size_of(const Conserved& one, const Sizes& sizes) {
    if (one.name == "energy") return sizes.energy;
    if (one.name.starts_with("linear")) return sizes.linear;
    if (one.name.starts_with("Kovalevskaya")) return std::pow(sizes.rate, 4);
    if (one.name.starts_with("Goryachev")) return std::pow(sizes.rate, 3);
    return sizes.angular;
}

// Checks that the largest change of each conserved quantity, relative to its scale, is below `bound`.
void expect_kept(const Scene& scene, const Method& method, double bound) {
    SCOPED_TRACE(std::string(method.name));
    Settings settings;
    settings.samples = 50;
    if (takes_tolerance(method)) settings.tolerance = 1e-12;
    const Problem problem = pose(scene);
    const Trajectory run = solve(problem, method, settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    ASSERT_EQ(run.samples.size(), 51u);
    const Sizes sizes = sizes_of(problem, run);
    for (const Conserved& one : conserved(problem)) {
        double change = 0;
        for (const Sample& sample : run.samples) {
            const std::vector<double> now = one.of(problem, one, sample);
            for (std::size_t i = 0; i < now.size(); ++i) change = std::max(change, std::abs(now[i] - one.value[i]));
        }
        const double size = size_of(one, sizes);
        EXPECT_LE(change, bound * (size > 0 ? size : 1)) << one.name;
    }
}

// The error of a step is 10^-12 of the state's size, and up to 10^4 errors accumulate mostly in one direction. The
// largest measured changes are 1.3e-9 with Fehlberg's pair and 6.2e-8 with the Adams formulas. A missing term in the
// equations would show as more than 1e-3.
TEST_P(PlainCatalogue, KeepsItsInvariants) {
    const Scene scene = find_scene(GetParam());
    const Choice best = choose_method(pose(scene));
    expect_kept(scene, *best.method, 1e-8);
    // Adams formulas take tiny steps where the motion is stiff, and do not support planes
    if (best.method->name != "radau" && scene.planes.empty()) expect_kept(scene, *find_method("cvode_adams"), 3e-7);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Catalogue, ::testing::ValuesIn(builtin_scene_names()),
                         [](const auto& tested) { return test_name(tested.param); });
INSTANTIATE_TEST_SUITE_P(Scenes, PlainCatalogue, ::testing::ValuesIn(scenes_in()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace polhode
