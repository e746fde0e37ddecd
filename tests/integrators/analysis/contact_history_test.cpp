// Contact points, forces and slips against closed forms: a ball that slides and rolls, a block on a ramp, two balls.
#include "integrators/analysis/contact_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "scene/scene_file.h"
#include "scene/sphere_contacts.h"

namespace polhode {
namespace {

ContactHistory history_of(const std::string& body, const std::string& more, double duration, std::size_t samples) {
    const Scene scene =
        parse_scene(R"({"name": "s", "duration": )" + std::to_string(duration) + ", " + body +
                        R"(, "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}], )" + more + "}",
                    "s.json");
    return contact_history(pose(scene), {0, duration / 2, duration}, samples);
}

void expect_equal(const Vector3<double>& found, const Vector3<double>& expected, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << "component " << i;
}

// A solid ball on level ground without rotation at first: its slip is u - 7/2 mu g t until it rolls.
TEST(ContactHistory, OfASlidingBallIsTheClosedForm) {
    const double u = 3.5, mu = 0.25, g = 9.8, mass = 2, rolls = 2 * u / (7 * mu * g), duration = 1;
    const ContactHistory history = history_of(
        R"("body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 2},
           "initial": {"position": [0, 0, 0.125], "velocity": [3.5, 0, 0]})",
        R"("planes": [{"normal": [0, 0, 2], "offset": 0, "restitution": 0, "friction": 0.25}])", duration, 100);
    EXPECT_EQ(history.fault, "");
    ASSERT_EQ(history.record.intervals.size(), 2u);
    ASSERT_EQ(history.motions.size(), 3u);
    EXPECT_NEAR(history.record.intervals[0].to, rolls, 1e-10);
    // samples in proportion to the lengths of the intervals
    EXPECT_EQ(history.of_interval[0].size(), static_cast<std::size_t>(std::lround(100 * rolls / duration)));
    EXPECT_EQ(history.of_interval[1].size(), static_cast<std::size_t>(std::lround(100 * (1 - rolls / duration))));
    for (const ContactSample& sample : history.of_interval[0]) {
        const double t = sample.t;
        EXPECT_TRUE(t > 0 && t < rolls);
        expect_equal(sample.point_W, {u * t - mu * g * t * t / 2, 0, 0}, 1e-10);
        expect_equal(sample.force_W, {-mu * mass * g, 0, mass * g}, 1e-9);
        expect_equal(sample.slip_W, {u - 3.5 * mu * g * t, 0, 0}, 1e-10);
    }
    for (const ContactSample& sample : history.of_interval[1]) {
        EXPECT_TRUE(sample.t > rolls && sample.t < duration);
        expect_equal(sample.force_W, {0, 0, mass * g}, 1e-9);
        expect_equal(sample.slip_W, {}, 1e-10);
    }
}

// The force of a plane on a block that slides without rotation has no moment about the centre of mass.
TEST(ContactHistory, OfAFaceHasThePointWhereThePressureActs) {
    const ContactHistory history = history_of(
        R"("body": {"shape": {"type": "box", "half_extents": [0.5, 0.25, 0.125]}, "mass": 2},
           "initial": {"position": [0, 0, 0.125], "velocity": [-5, 0, 0]})",
        R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.5}])", 0.5, 20);
    ASSERT_EQ(history.of_interval.size(), 1u);
    ASSERT_EQ(history.of_interval[0].size(), 20u);
    for (const ContactSample& sample : history.of_interval[0]) {
        const double x = -5 * sample.t + 0.5 * 9.8 * sample.t * sample.t / 2;
        expect_equal(sample.force_W, {0.5 * 2 * 9.8, 0, 2 * 9.8}, 1e-9);
        // the height 0.125 m times the ratio 0.5 of the forces
        expect_equal(sample.point_W, {x - 0.0625, 0, 0}, 1e-10);
        expect_equal(sample.slip_W, {-5 + 0.5 * 9.8 * sample.t, 0, 0}, 1e-10);
    }
}

// Two balls on a floor: one slides, hits the other, which then slides too. Both carry their own weight.
TEST(ContactHistory, OfSeveralBallsHasTheForcesOfEach) {
    const std::string ball = R"("body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": )";
    const ContactHistory history = history_of(
        R"("bodies": [{"name": "a", )" + ball + R"( 1}, "initial": {"position": [0, 0, 0.125], "velocity": [2, 0, 0]}},
                      {"name": "b", )" +
            ball + R"( 3}, "initial": {"position": [1, 0, 0.125]}}])",
        R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.25}],
           "contacts": [{"first": "a", "second": "b", "restitution": 0.5, "friction": 0}])",
        1, 60);
    EXPECT_EQ(history.fault, "");
    ASSERT_EQ(history.record.intervals.size(), history.of_interval.size());
    std::size_t seen[2] = {};
    for (std::size_t i = 0; i < history.of_interval.size(); ++i)
        for (const ContactSample& sample : history.of_interval[i]) {
            const contact::Interval<double>& interval = history.record.intervals[i];
            const std::size_t body = interval.plane / 3;
            const double weight = (body == 0 ? 1 : 3) * 9.8;
            ++seen[body];
            EXPECT_NEAR(sample.force_W[2], weight, 1e-9);
            EXPECT_NEAR(std::abs(sample.force_W[0]), interval.mode == contact::Mode::sliding ? 0.25 * weight : 0, 1e-9);
            EXPECT_NEAR(sample.point_W[2], 0, 1e-12);
        }
    EXPECT_GT(seen[0], 20u);
    EXPECT_GT(seen[1], 20u);
}

TEST(ContactHistory, OfAFlightHasNoSamples) {
    const ContactHistory history =
        history_of(R"("body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 2},
                      "initial": {"position": [0, 0, 1.125]})",
                   R"("planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 1, "friction": 0}])", 2, 60);
    EXPECT_GT(history.record.events.size(), 1u);
    EXPECT_TRUE(std::ranges::all_of(history.of_interval, [](const auto& samples) { return samples.empty(); }));
}

TEST(ContactHistory, PartsOfContactsAreThoseOfTheirNames) {
    Scene scene;
    scene.planes.resize(2), scene.bodies.resize(3);
    for (std::size_t body = 0; body < 3; ++body) {
        const ContactParts floor = parts_of_contact(scene, contact_with_plane(scene, body, 1));
        EXPECT_EQ(floor.body, body);
        EXPECT_EQ(floor.plane, 1u);
        EXPECT_FALSE(floor.other);
        const ContactParts pair = parts_of_contact(scene, contact_with_body(scene, body, 2));
        EXPECT_EQ(pair.body, body);
        EXPECT_EQ(pair.other, 2u);
        EXPECT_FALSE(pair.plane);
    }
    scene.bodies.clear();
    EXPECT_EQ(parts_of_contact(scene, 1).plane, 1u);
}

}  // namespace
}  // namespace polhode
