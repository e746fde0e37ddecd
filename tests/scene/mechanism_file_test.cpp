// Scenes of several bodies: reading, writing and messages.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <sstream>

#include "places.h"
#include "scene/random_mechanism.h"
#include "scene/scene_file.h"
#include "scene/scene_keys.h"

namespace polhode {
namespace {

std::string mechanism_with(const std::string& joints, const std::string& more = "") {
    return R"({"name": "m", "duration": 1, "bodies": [{"name": "upper", "body": {"mass": 1, "inertia": [1, 2, 3]}},
        {"name": "lower", "body": {"mass": 2, "inertia": [2, 2, 3]}}], "joints": [)" +
           joints + "]" + more + "}";
}

std::string mechanism_fault(const std::string& joints, const std::string& more = "") {
    try {
        parse_scene(mechanism_with(joints, more), "file.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string fault_of_bodies(const std::string& list) {
    try {
        parse_scene(R"({"name": "m", "duration": 1, "bodies": [)" + list + "]}", "file.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string golden_text(const std::string& name) {
    std::ifstream file(source_dir() + "/tests/scene/" + name);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

bool same_start(const Initial& a, const Initial& b) {
    return a.orientation == b.orientation && a.angular_velocity == b.angular_velocity &&
           a.angular_velocity_frame == b.angular_velocity_frame && a.position_W == b.position_W &&
           a.velocity_W == b.velocity_W;
}

bool same_joint(const Joint& a, const Joint& b) {
    return a.name == b.name && a.type == b.type && a.parent == b.parent && a.child == b.child &&
           a.parent_point == b.parent_point && a.child_point == b.child_point &&
           a.parent_orientation == b.parent_orientation && a.axes == b.axes && a.coordinate == b.coordinate &&
           a.rate == b.rate && a.orientation == b.orientation && a.angular_velocity == b.angular_velocity &&
           a.dependent == b.dependent && a.stiffness == b.stiffness && a.rest == b.rest &&
           a.rest_orientation == b.rest_orientation && a.damping == b.damping;
}

bool same_loop(const Loop& a, const Loop& b) {
    return a.name == b.name && a.type == b.type && a.first == b.first && a.second == b.second &&
           a.first_point == b.first_point && a.second_point == b.second_point && a.first_axis == b.first_axis &&
           a.second_axis == b.second_axis && a.length == b.length;
}

RC_GTEST_PROP(WriteMechanism, ReadsBackToTheSameScene, ()) {
    const Scene a = random_mechanism();
    const std::string text = write_scene(a);
    const Scene b = parse_scene(text, "written");
    RC_ASSERT(a.bodies.size() == b.bodies.size());
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
        RC_ASSERT(a.bodies[i].name == b.bodies[i].name);
        RC_ASSERT(a.bodies[i].body.mass == b.bodies[i].body.mass);
        RC_ASSERT(a.bodies[i].body.inertia_B == b.bodies[i].body.inertia_B);
        RC_ASSERT(a.bodies[i].body.center_of_mass == b.bodies[i].body.center_of_mass);
        RC_ASSERT(same_start(a.bodies[i].initial, b.bodies[i].initial));
    }
    RC_ASSERT(a.joints.size() == b.joints.size());
    for (std::size_t i = 0; i < a.joints.size(); ++i) RC_ASSERT(same_joint(a.joints[i], b.joints[i]));
    RC_ASSERT(a.loops.size() == b.loops.size());
    for (std::size_t i = 0; i < a.loops.size(); ++i) RC_ASSERT(same_loop(a.loops[i], b.loops[i]));
    RC_ASSERT(a.loads.size() == b.loads.size());
    for (std::size_t i = 0; i < a.loads.size(); ++i) {
        RC_ASSERT(a.loads[i].index() == b.loads[i].index());
        RC_ASSERT(load_body(a.loads[i]) == load_body(b.loads[i]));
        RC_ASSERT(window_of(a.loads[i]).from == window_of(b.loads[i]).from);
        if (const auto* one = std::get_if<Motor>(&a.loads[i])) {
            const Motor& two = std::get<Motor>(b.loads[i]);
            RC_ASSERT(one->joint == two.joint && one->force == two.force);
        }
        if (const auto* one = std::get_if<PointSpring>(&a.loads[i])) {
            const PointSpring& two = std::get<PointSpring>(b.loads[i]);
            RC_ASSERT(one->first == two.first && one->second == two.second && one->first_point == two.first_point &&
                      one->second_point == two.second_point && one->stiffness == two.stiffness &&
                      one->rest_length == two.rest_length);
        }
    }
    RC_ASSERT(write_scene(b) == text);
}

// The golden file is written by hand and omits defaults; it agrees with what the program writes.
TEST(MechanismFile, ReadsEveryKey) {
    const Scene s = parse_scene(golden_text("mechanism.json"), "mechanism.json");
    ASSERT_TRUE(is_mechanism(s));
    ASSERT_EQ(s.bodies.size(), 7u);
    EXPECT_EQ(s.bodies[0].name, "base");
    EXPECT_EQ(s.bodies[0].initial.position_W, Vector3<double>(0, 0, 2));
    EXPECT_EQ(s.bodies[0].initial.angular_velocity_frame, Frame::world);
    ASSERT_EQ(s.joints.size(), 6u);
    const Joint &turning = s.joints[0], &sliding = s.joints[1], &ball = s.joints[2], &cardan = s.joints[3];
    EXPECT_EQ(turning.type, JointType::revolute);
    EXPECT_EQ(turning.parent, "base");
    EXPECT_EQ(turning.child, "upper");
    EXPECT_EQ(turning.parent_point, Vector3<double>(1, 2, 3));
    EXPECT_EQ(turning.child_point, Vector3<double>(4, 5, 6));
    EXPECT_EQ(turning.parent_orientation, (Quaternion<double>{0, 1, 0, 0}));
    EXPECT_EQ(turning.axes[0], Vector3<double>(0, 2, 0));
    EXPECT_EQ(turning.coordinate[0], 0.5);
    EXPECT_EQ(turning.rate[0], -0.25);
    EXPECT_TRUE(turning.dependent);
    EXPECT_EQ(turning.stiffness[0], 10);
    EXPECT_EQ(turning.rest[0], 0.125);
    EXPECT_EQ(turning.damping[0], 0.0625);
    EXPECT_EQ(sliding.type, JointType::prismatic);
    EXPECT_EQ(sliding.coordinate[0], 0.75);
    EXPECT_EQ(sliding.rate[0], 3);
    EXPECT_FALSE(sliding.dependent);
    EXPECT_EQ(ball.type, JointType::spherical);
    EXPECT_EQ(ball.orientation, (Quaternion<double>{0, 0, 1, 0}));
    EXPECT_EQ(ball.angular_velocity, Vector3<double>(7, 8, 9));
    EXPECT_EQ(ball.rest_orientation, (Quaternion<double>{0, 0, 0, 1}));
    EXPECT_EQ(ball.stiffness[0], 2);
    EXPECT_EQ(ball.damping[0], 4);
    EXPECT_EQ(cardan.type, JointType::universal);
    EXPECT_EQ(cardan.axes[0], Vector3<double>(1, 0, 0));
    EXPECT_EQ(cardan.axes[1], Vector3<double>(0, 1, 1));
    EXPECT_EQ(cardan.coordinate, (std::array<double, 2>{0.1, 0.2}));
    EXPECT_EQ(cardan.rate, (std::array<double, 2>{0.3, 0.4}));
    EXPECT_EQ(cardan.stiffness, (std::array<double, 2>{5, 6}));
    EXPECT_EQ(cardan.rest, (std::array<double, 2>{0.5, 0.6}));
    EXPECT_EQ(cardan.damping, (std::array<double, 2>{0.7, 0.8}));
    EXPECT_EQ(s.joints[4].type, JointType::fixed);
    // defaults of omitted keys
    EXPECT_EQ(s.joints[5].parent_orientation, Quaternion<double>{});
    EXPECT_EQ(s.joints[5].parent_point, Vector3<double>());
    EXPECT_EQ(s.joints[5].coordinate[0], 0);
    EXPECT_EQ(s.joints[5].stiffness[0], 0);
    ASSERT_EQ(s.loops.size(), 3u);
    EXPECT_EQ(s.loops[0].type, LoopType::spherical);
    EXPECT_EQ(s.loops[0].first_point, Vector3<double>(1, 0, 0));
    EXPECT_EQ(s.loops[1].first_axis, Vector3<double>(0, 0, 1));
    EXPECT_EQ(s.loops[1].second_axis, Vector3<double>(0, 1, 0));
    EXPECT_EQ(s.loops[2].length, 0.5);
    EXPECT_EQ(s.loops[2].second, "world");
    ASSERT_EQ(s.loads.size(), 8u);
    EXPECT_EQ(load_body(s.loads[0]), "");
    for (int i : {1, 2, 3, 4, 5}) EXPECT_EQ(load_body(s.loads[static_cast<std::size_t>(i)]), "upper") << i;
    EXPECT_EQ(std::get<Motor>(s.loads[6]).joint, "shoulder");
    EXPECT_EQ(std::get<Motor>(s.loads[6]).force, 1.5);
    EXPECT_EQ(window_of(s.loads[6]).until, 2);
    EXPECT_EQ(std::get<PointSpring>(s.loads[7]).first, "upper");
    EXPECT_EQ(std::get<PointSpring>(s.loads[7]).second_point, Vector3<double>(0, 0, 3));
    EXPECT_EQ(std::get<PointSpring>(s.loads[7]).rest_length, 0.25);
    EXPECT_EQ(write_scene(s), golden_text("golden_mechanism.json"));
}

TEST(MechanismFile, AcceptsWhatTheRulesAllow) {
    const char* joint = R"({"name": "a", "type": "revolute", "parent": "lower", "child": "upper", "axis": [0, 0, 5]})";
    // valid: a child before its parent, a free body, the same name for a body and a joint, a motor on a prismatic joint
    EXPECT_EQ(mechanism_fault(""), "");
    EXPECT_EQ(mechanism_fault(joint), "");
    EXPECT_EQ(mechanism_fault(
                  R"({"name": "upper", "type": "prismatic", "parent": "world", "child": "upper", "axis": [0, 0, 1]})",
                  R"(, "loads": [{"type": "motor", "joint": "upper", "force": 1}])"),
              "");
    EXPECT_EQ(mechanism_fault(joint, R"(, "loops": [], "loads": [], "planes": [], "tolerated": {"attitude": 1})"), "");
    EXPECT_EQ(mechanism_fault(R"({"name": "u", "type": "universal", "parent": "world", "child": "upper",
                                  "axes": [[1, 0, 0], [1, 2e-6, 0]]})"),
              "");
    const Scene alone = parse_scene(
        R"({"name": "m", "duration": 1, "bodies": [{"name": "x", "body": {"mass": 1, "inertia": [1, 2, 3]}}]})", "f");
    EXPECT_TRUE(is_mechanism(alone));
}

// The reader accepts every key of the reference: with an additional unknown key "zzz", the message is about "zzz".
TEST(MechanismFile, EveryKeyOfTheReferenceIsRead) {
    int keys = 0;
    for (const FileKey& key : scene_keys()) {
        const std::size_t space = key.object.find(' ');
        const std::string kind(key.object.substr(0, space)), type(key.object.substr(space + 1));
        const std::string members =
            fmt::format(R"("{}": {}, "zzz": 1)", key.key, key.key == "type" ? key.example : "0");
        const std::string with_type = key.key == "type" ? members : fmt::format(R"("type": "{}", {})", type, members);
        const std::string ends = R"("name": "j", "parent": "world", "child": "upper")";
        std::string message;
        if (kind == "joint")
            message = mechanism_fault("{" + with_type + "}");
        else if (kind == "start")
            message = mechanism_fault(fmt::format(R"({{{}, "type": "{}", "initial": {{{}}}}})", ends, type, members));
        else if (kind == "loop")
            message = mechanism_fault("", ", \"loops\": [{" + with_type + "}]");
        else if (key.object == "one of bodies")
            message = fault_of_bodies("{" + members + "}");
        else
            continue;
        EXPECT_NE(message.find("zzz"), std::string::npos) << key.object << " " << key.key << ": " << message;
        ++keys;
    }
    EXPECT_GT(keys, 80);
}

TEST(MechanismFile, MessagesSuggestNames) {
    EXPECT_EQ(mechanism_fault(R"({"name": "a", "type": "fixed", "parent": "world", "child": "uper"})"),
              "file.json: /joints/0/child: is \"uper\", which is not the name of a body; did you mean upper?");
    EXPECT_EQ(mechanism_fault(R"({"name": "a", "type": "revolut", "parent": "world", "child": "upper"})"),
              "file.json: /joints/0/type: is the string \"revolut\"; did you mean revolute? give one of revolute, "
              "prismatic, spherical, universal, fixed, compound, cylindrical, screw, planar, free");
    EXPECT_EQ(mechanism_fault(R"({"name": "a", "type": "fixed", "parent": "world", "child": "upper"},
                                 {"name": "b", "type": "fixed", "parent": "lower", "child": "upper"})"),
              "file.json: /joints/1/child: is \"upper\", which is already the child of joint \"a\"; a body can be the "
              "child of "
              "only one joint: close the chain by one of \"loops\"");
    EXPECT_EQ(
        mechanism_fault(R"({"name": "a", "type": "fixed", "parent": "upper", "child": "lower"},
                                 {"name": "b", "type": "fixed", "parent": "lower", "child": "upper"})"),
        "file.json: /joints/0: closes a cycle of joints at body \"upper\"; joints must form trees: close the chain "
        "by one of \"loops\"");
    EXPECT_EQ(mechanism_fault("", R"(, "body": {"mass": 1, "inertia": [1, 1, 1]})"),
              "file.json: /body: is given together with \"bodies\"; give \"body\", \"initial\" and \"pivot\" for one "
              "body, or "
              "\"bodies\", \"joints\" and \"loops\" for several");
}

// Errors that a mechanism made in C++ can have but a file cannot.
TEST(Validate, ChecksMechanismsMadeInCode) {
    const auto fault = [](auto&& change) -> std::string {
        Scene s;
        s.name = "made", s.duration = 1;
        s.bodies = {{"a", {}, {}}, {"b", {}, {}}};
        Joint j;
        j.name = "j", j.child = "a", j.axes[0] = {0, 0, 1};
        s.joints = {j};
        change(s);
        try {
            validate(s, "made.cpp");
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto place = [&](auto&& change) {
        const std::string message = fault(change);
        const std::size_t begin = message.find(": /"), end = message.find(": ", begin + 2);
        return begin == message.npos ? message : message.substr(begin + 2, end - begin - 2);
    };
    EXPECT_EQ(fault([](Scene&) {}), "");
    EXPECT_EQ(place([](Scene& s) { s.bodies[0].initial.velocity_W[0] = 1; }), "/bodies/0/initial");
    EXPECT_EQ(place([&](Scene& s) { s.bodies[1].initial.velocity_W[0] = nan; }), "/bodies/1/initial/velocity/0");
    EXPECT_EQ(place([](Scene& s) { s.bodies[1].name = "\xff"; }), "/bodies/1/name");
    EXPECT_EQ(place([](Scene& s) { s.bodies[1].body.mass = -1; }), "/bodies/1/body/mass");
    EXPECT_EQ(place([&](Scene& s) { s.joints[0].coordinate[0] = nan; }), "/joints/0/initial/angle");
    EXPECT_EQ(place([&](Scene& s) { s.joints[0].damping[0] = nan; }), "/joints/0/damping");
    EXPECT_EQ(place([](Scene& s) { s.pivot = Vector3<double>(); }), "/pivot");
    EXPECT_EQ(place([](Scene& s) { s.planes = {Plane{}}; }), "/planes");
    EXPECT_EQ(place([](Scene& s) {
                  s.loads = {UserTorque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}}};
              }),
              "/loads/0");
    EXPECT_EQ(place([&](Scene& s) { s.loads = {Motor{"j", nan, {}}}; }), "/loads/0/torque");
    EXPECT_EQ(place([](Scene& s) { s.bodies.clear(); }), "/joints");
}

}  // namespace
}  // namespace polhode
