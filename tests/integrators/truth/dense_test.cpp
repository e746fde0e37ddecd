#include "integrators/truth/dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "build_kind.h"
#include "catalogue.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

double length(const Vector3<Pair>& v) { return std::hypot(v[0].high, v[1].high, v[2].high); }
double distance(const Vector3<Pair>& a, const Vector3<Pair>& b) {
    double square = 0;
    for (int i = 0; i < 3; ++i) {
        const double d = (a[i].high - b[i].high) - b[i].low;
        square += d * d;
    }
    return std::sqrt(square);
}

// every built-in scene, at arbitrary times and at its events
TEST(DenseTruth, IsTheReferenceRoundedOnce) {
    const FreshCache cache;
    int compared = 0;
    constexpr std::size_t every = optimised_build ? 1 : 8;
    std::vector<std::string> names = scenes_in();
    // one scene of each extreme family, for a few radians
    std::string last;
    for (const std::string& name : scenes_in("extreme"))
        if (family_member(name).family != last) last = family_member(name).family, names.push_back(name);
    for (std::size_t number = 0; number < names.size(); number += every) {
        const std::string& name = names[number];
        Scene scene = find_scene(name);
        const bool plain = family_member(name).folder.empty();
        scene.duration = std::min(scene.duration, plain ? 1.0 : 3 / pose(scene).scales.angular_velocity);
        std::vector<double> times = event_times(scene);
        for (int k = 1; k < 40; ++k) times.push_back(scene.duration * std::fmod(0.6180339887498949 * k, 1.0));
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        const DenseTruth dense = dense_reference(scene, scene.duration);
        if (!dense.available) continue;
        const Reference truth = reference(scene, times);
        ASSERT_TRUE(truth.available) << name << truth.message;
        EXPECT_LT(dense.bound, 2e-15) << name;
        double w = 0, p = 0, v = 0, L = 0;
        for (const ReferenceSample& s : truth.samples) {
            w = std::max(w, length(s.angular_velocity_B)), p = std::max(p, length(s.position_W));
            v = std::max(v, length(s.velocity_W)), L = std::max(L, length(s.angular_momentum_W));
        }
        for (const ReferenceSample& s : truth.samples) {
            const ReferenceSample d = dense.at(s.t);
            const Quaternion<double> q{d.q.w.high, d.q.x.high, d.q.y.high, d.q.z.high};
            EXPECT_LE(attitude_error(q, s.q), dense.bound) << name << ", t = " << s.t;
            EXPECT_GT(q.w * s.q.w.high + q.x * s.q.x.high + q.y * s.q.y.high + q.z * s.q.z.high, 0) << "a flip";
            EXPECT_LE(distance(d.angular_velocity_B, s.angular_velocity_B), dense.bound * w) << name << s.t;
            EXPECT_LE(distance(d.position_W, s.position_W), dense.bound * p) << name << ", t = " << s.t;
            EXPECT_LE(distance(d.velocity_W, s.velocity_W), dense.bound * v) << name << ", t = " << s.t;
            // products of the other values in binary64
            EXPECT_LE(distance(d.angular_momentum_W, s.angular_momentum_W), 4 * dense.bound * L) << name << s.t;
        }
        ++compared;
    }
    EXPECT_GT(compared, static_cast<int>(40 / every) - 1);
}

TEST(DenseTruth, SaysWhyThereIsNone) {
    Scene scene = find_scene("symmetric");
    scene.loads.push_back(UserTorque{"own", [](const LoadState&) { return Vector3<double>(); }, {}});
    const DenseTruth dense = dense_reference(scene, scene.duration);
    EXPECT_FALSE(dense.available);
    EXPECT_NE(dense.message, "");
}

}  // namespace
}  // namespace polhode
