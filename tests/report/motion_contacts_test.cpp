// Tests what the page shows of contacts and joints, against closed forms.
#include "report/motion_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/analysis/contact_history.h"
#include "integrators/truth/reference.h"
#include "motion/problem.h"
#include "report/motion_joints.h"
#include "report/timeline.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr Tolerance loose{1e-2, 1e-2};

Scene scene_of(const std::string& text) { return parse_scene(R"({"name": "s", )" + text + "}", "s.json"); }

Reference truth_of(const Scene& scene) { return reference(scene, sample_times(scene.duration, 40), 17, 30); }

MotionDetails contacts_in(const std::string& text) {
    const Scene scene = scene_of(text);
    return contacts_of_motion(scene, truth_of(scene), loose);
}

MotionDetails joints_in(const std::string& text) {
    const Scene scene = scene_of(text);
    return joints_of_motion(scene, truth_of(scene), loose);
}

std::vector<std::string> modes_of(const Json& row) {
    std::vector<std::string> modes;
    for (const Json& mode : row["modes"]) modes.push_back(mode["mode"]);
    return modes;
}

// a ball falls by 1.25 m in 0.5 s and bounces with e = 1/2: impacts at 0.5 s, 1 s, 1.25 s, ..; it rests from 1.5 s on
const std::string bouncing_ball = R"("duration": 2,
    "body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 2}, "initial": {"position": [0, 0, 1.375]},
    "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
    "planes": [{"name": "floor", "normal": [0, 0, 1], "offset": 0, "restitution": 0.5, "friction": 0.25}])";

TEST(MotionContacts, OfABouncingBallHaveItsImpactsAndItsWeight) {
    const MotionDetails details = contacts_in(bouncing_ball);
    EXPECT_EQ(details.remark, "");
    ASSERT_EQ(details.timeline["rows"].size(), 1u);
    const Json& row = details.timeline["rows"][0];
    EXPECT_EQ(row["name"], "floor");
    EXPECT_EQ(row["unit"], "N s");
    // flights between impacts are one interval
    ASSERT_EQ(row["modes"].size(), 2u);
    EXPECT_EQ(row["modes"][0]["mode"], "flight");
    EXPECT_EQ(row["modes"][0]["from"], 0);
    EXPECT_NEAR(row["modes"][0]["to"], 1.5, 1e-7);
    EXPECT_NEAR(row["modes"][1]["from"], 1.5, 1e-7);
    EXPECT_EQ(row["modes"][1]["to"], 2);
    const Json& events = details.timeline["events"];
    EXPECT_EQ(details.timeline["total"], events.size());
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(events[k]["kind"], "impact");
        EXPECT_NEAR(events[k]["t"], 1.5 - std::pow(0.5, static_cast<double>(k)), 1e-7);
        // m (1 + e) v with v = 5, 2.5, 1.25 m/s
        EXPECT_NEAR(events[k]["normal"], 2 * 1.5 * 5 * std::pow(0.5, static_cast<double>(k)), 1e-3);
    }
    ASSERT_EQ(details.contacts.size(), 1u);
    const Json& contact = details.contacts[0];
    EXPECT_EQ(contact["starts"], Json::array({0}));
    EXPECT_EQ(contact["friction"], 0.25);
    const std::size_t count = contact["t"].size();
    // constant forces: few samples suffice
    EXPECT_GE(count, 2u);
    EXPECT_LE(count, 5u);
    EXPECT_EQ(contact["point"].size(), 3 * count);
    EXPECT_EQ(contact["slip"].size(), 3 * count);
    for (std::size_t k = 0; k < count; ++k) {
        EXPECT_TRUE(contact["t"][k] >= 1.5 - 1e-6 && contact["t"][k] <= 2);
        EXPECT_NEAR(contact["normal_force"][k], 20, 1e-2);
        EXPECT_NEAR(contact["friction_force"][3 * k], 0, 1e-9);
    }
    EXPECT_TRUE(details.coordinates.is_null());
}

// An ellipsoid that rolls has forces that oscillate; between the samples of the page they are within 1 % of a
// four times finer record.
TEST(MotionContacts, OfARollingEllipsoidAreInterpolatedAccurately) {
    const Scene scene = parse_scene(R"({"name": "s", "duration": 1.5,
        "body": {"shape": {"type": "ellipsoid", "semi_axes": [0.2, 0.1, 0.1]}, "mass": 1},
        "initial": {"position": [0, 0, 0.1], "velocity": [0, -0.4, 0], "angular_velocity": [4, 0.5, 0]},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}],
        "planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 2}]})",
                                    "s.json");
    const MotionDetails details = contacts_of_motion(scene, truth_of(scene), loose);
    EXPECT_EQ(details.remark, "");
    ASSERT_EQ(details.contacts.size(), 1u);
    const Json& contact = details.contacts[0];
    const ContactHistory fine = contact_history(pose(scene), {0, scene.duration}, 3200);
    double largest = 0, off = 0;
    std::size_t k = 0;
    for (const ContactSample& sample : fine.of_interval[0]) {
        largest = std::max(largest, length(sample.force_W));
        while (k + 2 < contact["t"].size() && contact["t"][k + 1].get<double>() < sample.t) ++k;
        const double from = contact["t"][k], to = contact["t"][k + 1], s = (sample.t - from) / (to - from);
        const double N =
            (1 - s) * contact["normal_force"][k].get<double>() + s * contact["normal_force"][k + 1].get<double>();
        off = std::max(off, std::abs(N - sample.force_W[2]));
    }
    EXPECT_LT(off, 1e-2 * largest);
    EXPECT_LT(contact["t"].size(), 400u);
    EXPECT_GT(largest, 9.8 * 1.05);
}

TEST(MotionContacts, AreNotShownOfAnotherMotionThanTheTruth) {
    const Scene scene = scene_of(bouncing_ball);
    Reference truth = truth_of(scene);
    truth.samples[20].position_W[2].high += 0.02;
    const MotionDetails details = contacts_of_motion(scene, truth, loose);
    EXPECT_TRUE(details.timeline.is_null());
    EXPECT_TRUE(details.contacts.empty());
    EXPECT_NE(details.remark.find("too sensitive"), std::string::npos);
}

TEST(MotionContacts, OfSeveralBallsHaveARowForEachContactThatOccurs) {
    const std::string ball = R"("body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 1})";
    const MotionDetails details = contacts_in(
        R"("duration": 1, "bodies": [
            {"name": "a", )" +
        ball + R"(, "initial": {"position": [0, 0, 0.125], "velocity": [2, 0, 0]}},
            {"name": "b", )" +
        ball + R"(, "initial": {"position": [1, 0, 0.125]}},
            {"name": "c", )" +
        ball + R"(, "initial": {"position": [9, 0, 5], "velocity": [0, 0, 1]}}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}],
        "planes": [{"name": "floor", "normal": [0, 0, 1], "offset": 0, "restitution": 0, "friction": 0.25}],
        "contacts": [{"all": true, "restitution": 1, "friction": 0}])");
    std::vector<std::string> names;
    for (const Json& row : details.timeline["rows"]) names.push_back(row["name"]);
    std::ranges::sort(names);
    EXPECT_EQ(names, (std::vector<std::string>{"a, b", "a, floor", "b, floor"}));
    EXPECT_EQ(details.contacts.size(), 2u);
    // the slider stops, the other ball slides on with its speed
    for (const Json& row : details.timeline["rows"]) EXPECT_EQ(row["modes"].empty(), row["name"] == "a, b");
}

// a slider of 2 kg between limits at 0 and 1 m, without loads: each impact halves its speed of 1 m/s
const std::string slider = R"("duration": 6, "bodies": [{"name": "slider", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
    "joints": [{"name": "rail", "type": "prismatic", "parent": "world", "child": "slider", "axis": [1, 0, 0],
                "initial": {"displacement": 0.5, "speed": 1},
                "limits": {"lower": 0, "upper": 1, "restitution": 0.5}}])";

TEST(MotionJoints, WithLimitsHaveTheirImpactsAndRatesThatJump) {
    const MotionDetails details = joints_in(slider);
    EXPECT_EQ(details.remark, "");
    const Json& events = details.timeline["events"];
    ASSERT_EQ(events.size(), 2u);
    // 0.5 m at 1 m/s, then 1 m at 1/2 m/s; the third impact would be at 6.5 s
    EXPECT_NEAR(events[0]["t"], 0.5, 1e-7);
    EXPECT_NEAR(events[1]["t"], 2.5, 1e-7);
    // m (1 + e) v
    EXPECT_NEAR(std::abs(events[0]["normal"].get<double>()), 2 * 1.5 * 1, 1e-3);
    EXPECT_NEAR(std::abs(events[1]["normal"].get<double>()), 2 * 1.5 * 0.5, 1e-3);
    EXPECT_EQ(modes_of(details.timeline["rows"][0]), std::vector<std::string>{"free"});
    const Json &t = details.coordinates["t"], &curve = details.coordinates["curves"][0];
    EXPECT_EQ(curve["name"], "rail");
    EXPECT_EQ(curve["unit"], "m");
    EXPECT_EQ(curve["lower"], 0);
    EXPECT_EQ(curve["upper"], 1);
    ASSERT_EQ(curve["x"].size(), t.size());
    for (std::size_t k = 0; k < t.size(); ++k) {
        const double at = t[k];
        if (std::abs(at - 0.5) < 1e-6 || std::abs(at - 2.5) < 1e-6) continue;
        EXPECT_NEAR(curve["x"][k], at < 0.5 ? 0.5 + at : at < 2.5 ? 1 - (at - 0.5) / 2 : (at - 2.5) / 4, 1e-4);
        EXPECT_NEAR(curve["rate"][k], at < 0.5 ? 1 : at < 2.5 ? -0.5 : 0.25, 1e-4);
    }
}

TEST(MotionJoints, WithFrictionSlideThenStickAndLimitsHold) {
    // 2 kg at 1 m/s against 4 N: sticks after 0.5 s
    const MotionDetails sticks =
        joints_in(R"("duration": 1, "bodies": [{"name": "slider", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
            "joints": [{"name": "rail", "type": "prismatic", "parent": "world", "child": "slider", "axis": [1, 0, 0],
                        "initial": {"displacement": 0, "speed": 1}, "friction": 4}])");
    const Json& rail = sticks.timeline["rows"][0];
    EXPECT_EQ(modes_of(rail), (std::vector<std::string>{"slides", "sticks"}));
    EXPECT_NEAR(rail["modes"][1]["from"], 0.5, 1e-7);
    EXPECT_TRUE(sticks.coordinates["curves"][0]["lower"].is_null());
    // a mass that falls by 1.25 m at 10 m/s^2 onto a limit without restitution
    const MotionDetails rests =
        joints_in(R"("duration": 1, "bodies": [{"name": "mass", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
            "joints": [{"name": "guide", "type": "prismatic", "parent": "world", "child": "mass", "axis": [0, 0, 1],
                        "initial": {"displacement": 1.25}, "limits": {"lower": 0}}],
            "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}])");
    const Json& guide = rests.timeline["rows"][0];
    EXPECT_EQ(modes_of(guide), (std::vector<std::string>{"free", "at lower limit"}));
    EXPECT_NEAR(guide["modes"][1]["from"], 0.5, 1e-7);
    EXPECT_EQ(rests.timeline["events"][0]["kind"], "rests");
}

TEST(MotionJoints, ThatAreCoupledShareARow) {
    const MotionDetails details = joints_in(
        R"("duration": 1, "bodies": [{"name": "a", "body": {"mass": 1, "inertia": [1, 1, 1]}},
                                     {"name": "b", "body": {"mass": 1, "inertia": [1, 1, 1]}}],
            "joints": [{"name": "left", "type": "prismatic", "parent": "world", "child": "a", "axis": [1, 0, 0],
                        "initial": {"displacement": 0, "speed": 1}, "friction": 1},
                       {"name": "right", "type": "prismatic", "parent": "world", "child": "b", "axis": [1, 0, 0],
                        "initial": {"dependent": true}, "limits": {"lower": -0.25}}],
            "couplings": [{"first": "left", "second": "right", "ratio": -1}])");
    ASSERT_EQ(details.timeline["rows"].size(), 1u);
    EXPECT_EQ(details.timeline["rows"][0]["name"], "left, right");
    // 2 kg against 1 N, until the limit of the right joint stops both: x = t - t^2 / 4 = 1/4
    EXPECT_EQ(modes_of(details.timeline["rows"][0]), (std::vector<std::string>{"slides", "at upper limit"}));
    ASSERT_EQ(details.timeline["events"].size(), 1u);
    EXPECT_EQ(details.timeline["events"][0]["kind"], "rests");
    EXPECT_NEAR(details.timeline["events"][0]["t"], 2 - std::sqrt(3.0), 1e-7);
    ASSERT_EQ(details.coordinates["curves"].size(), 2u);
    const Json &left = details.coordinates["curves"][0]["x"], &right = details.coordinates["curves"][1]["x"];
    for (std::size_t k = 0; k < left.size(); ++k) EXPECT_NEAR(left[k].get<double>(), -right[k].get<double>(), 1e-6);
}

// Without limits and friction the coordinates are those of the truth. A rotor without loads: angle 3 t, with full
// revolutions.
TEST(MotionJoints, WithoutEventsHaveOnlyCoordinates) {
    const MotionDetails details =
        joints_in(R"("duration": 8, "bodies": [{"name": "rotor", "body": {"mass": 2, "inertia": [1, 1, 1]}}],
            "joints": [{"name": "axle", "type": "revolute", "parent": "world", "child": "rotor", "axis": [0, 0, 1],
                        "initial": {"angle": 0, "rate": 3}}])");
    EXPECT_TRUE(details.timeline.is_null());
    const Json &t = details.coordinates["t"], &curve = details.coordinates["curves"][0];
    EXPECT_EQ(curve["unit"], "rad");
    EXPECT_EQ(details.coordinates["total"], 1);
    ASSERT_EQ(t.size(), 41u);
    for (std::size_t k = 0; k < t.size(); ++k) EXPECT_NEAR(curve["x"][k], 3 * t[k].get<double>(), 1e-3);
}

TEST(Timeline, JoinsModesAndLimitsRowsAndEvents) {
    Timeline timeline;
    EXPECT_TRUE(timeline.json().is_null());
    const std::optional<std::size_t> first = timeline.row("floor", "N s");
    ASSERT_TRUE(first);
    EXPECT_EQ(timeline.row("floor", "N s"), first);
    timeline.add_mode(*first, 0, 1, "sliding");
    timeline.add_mode(*first, 1, 2, "sliding");
    timeline.add_mode(*first, 2, 3, "rolling");
    EXPECT_EQ(timeline.json()["rows"][0]["modes"].size(), 2u);
    EXPECT_EQ(timeline.json()["rows"][0]["modes"][0]["to"], 2);
    for (int i = 0; i < 10'000; ++i) {
        const double t = i;
        timeline.add_event(t, timeline.row(std::to_string(i), "N s"), "impact", 1, 0);
        timeline.add_mode(*first, 3 + t, 4 + t, i % 2 == 0 ? "sliding" : "rolling");
    }
    const Json json = timeline.json();
    EXPECT_EQ(json["total"], 10'000);
    EXPECT_LE(json["rows"].size(), 50u);
    EXPECT_LE(json["events"].size(), 500u);
    for (const Json& event : json["events"]) EXPECT_LT(event["row"].get<std::size_t>(), json["rows"].size());
    EXPECT_LT(json.dump().size(), 100'000u);
}

}  // namespace
}  // namespace polhode
