// The truth used as a method.
#include <gtest/gtest.h>

#include "integrators/method.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

TEST(TruthMethod, IsTheReferenceRounded) {
    const FreshCache cache;
    Scene scene = find_scene("free_asymmetric");
    scene.duration = 1;
    Settings settings;
    settings.samples = 4;
    const Method& truth = *find_method("truth");
    const Trajectory all = solve(scene, truth, settings);
    ASSERT_EQ(all.status, Status::ok) << all.message;
    ASSERT_EQ(all.samples.size(), 5U);
    const Reference reference_of_it = reference(scene, 4);
    for (std::size_t k = 0; k < 5; ++k) {
        EXPECT_EQ(all.samples[k].t, reference_of_it.samples[k].t);
        EXPECT_EQ(all.samples[k].q.y, reference_of_it.samples[k].q.y.high);
    }
    EXPECT_GT(all.steps, 0);
    // at user-defined times, and only the end
    settings.times = {0.125, 0.5};
    const Trajectory timed = solve(scene, truth, settings);
    ASSERT_EQ(timed.samples.size(), 2U);
    EXPECT_EQ(timed.samples[1].t, 0.5);
    EXPECT_EQ(timed.samples[1].q.y, all.samples[2].q.y);
    settings.times.clear(), settings.record = false;
    const Trajectory last = solve(scene, truth, settings);
    ASSERT_EQ(last.samples.size(), 1U);
    EXPECT_EQ(last.samples[0].t, 1);
}

TEST(TruthMethod, SaysWhatItCannotDoAndWhatItDidNotReach) {
    const FreshCache cache;
    Scene scene = find_scene("free_asymmetric");
    Settings settings;
    settings.seconds_limit = 1e-9;
    const Trajectory late = solve(scene, *find_method("truth"), settings);
    EXPECT_EQ(late.status, Status::failed);
    EXPECT_TRUE(late.limit_reached);
    EXPECT_NE(late.message.find("within the limit of 1e-09 s"), std::string::npos) << late.message;
    scene.loads.push_back(UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    EXPECT_EQ(solve(scene, *find_method("truth"), Settings()).status, Status::unsupported);
}

}  // namespace
}  // namespace polhode
