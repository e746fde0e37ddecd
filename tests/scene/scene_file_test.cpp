// Scene files of one body: keys, defaults, limits, messages, built-in scenes.
#include "scene/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bad_files.h"
#include "places.h"
#include "scene/scene_family.h"
#include "text/named_file.h"

namespace polhode {
namespace {

std::string message_of(const std::string& path, Scene (*read)(const std::string&) = read_scene) {
    try {
        read(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string fault_of(const std::string& text) {
    try {
        parse_scene(text, "file.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string scene_with(const std::string& members) {
    return R"({"name": "s", "duration": 1, "body": {"mass": 1, "inertia": [1, 2, 3]}, )" + members + "}";
}

TEST(BadScenes, EachIsRefusedInOneLineThatNamesFilePlaceAndRemedy) {
    allow_outside_files(true);  // these scenes refer to files in ../bodies
    for (const BadFile& bad : bad_files("scene", ".json")) expect_one_line(bad, message_of(bad.path));
    allow_outside_files(false);
    EXPECT_GE(bad_files("scene", ".json").size(), 380u);
    expect_whole_catalogue("scene", ".json");
}

TEST(SceneFile, ReadsEveryKey) {
    const Scene s = parse_scene(R"({
        // all keys at once
        "name": "all", "about": "a", "source": "b", "duration": 20,
        "body": {"mass": 2, "inertia": [[2, 0.1, 0], [0.1, 2, 0], [0, 0, 2.5]], "center_of_mass": [0, 0, 0.5]},
        "initial": {"orientation": [0, 1, 0, 0], "angular_velocity": [1, 2, 3], "angular_velocity_frame": "world"},
        "pivot": [0.25, 0, 0], /* held */
        "loads": [
            {"type": "gravity", "acceleration": [0, 0, -10], "from": 1, "until": 2},
            {"type": "torque", "vector": [1, 2, 3], "frame": "world"},
            {"type": "force", "vector": [4, 5, 6], "frame": "body", "point": [7, 8, 9], "point_frame": "world"},
            {"type": "impulse", "vector": [1, 0, 0], "frame": "body", "point": [0, 1, 0], "at": 1.5},
            {"type": "drag", "rotational": [0.1, 0.2, 0.3], "translational": 0.4},
            {"type": "spring", "stiffness": 10, "rest_orientation": [0, 0, 0, 1]}
        ],
        "tolerated": {"attitude": 1e-3}
    })",
                                "all.json");
    EXPECT_EQ(s.name, "all");
    EXPECT_EQ(s.about, "a");
    EXPECT_EQ(s.source, "b");
    EXPECT_EQ(s.duration, 20);
    EXPECT_EQ(s.body.mass, 2);
    EXPECT_EQ(s.body.inertia_B[0], Vector3<double>(2, 0.1, 0));
    EXPECT_EQ(s.body.center_of_mass, Vector3<double>(0, 0, 0.5));
    EXPECT_EQ(s.initial.orientation, (Quaternion<double>{0, 1, 0, 0}));
    EXPECT_EQ(s.initial.angular_velocity, Vector3<double>(1, 2, 3));
    EXPECT_EQ(s.initial.angular_velocity_frame, Frame::world);
    EXPECT_EQ(s.pivot, Vector3<double>(0.25, 0, 0));
    ASSERT_EQ(s.loads.size(), 6u);
    EXPECT_EQ(std::get<Gravity>(s.loads[0]).acceleration_W, Vector3<double>(0, 0, -10));
    EXPECT_EQ(window_of(s.loads[0]).from, 1);
    EXPECT_EQ(window_of(s.loads[0]).until, 2);
    EXPECT_EQ(std::get<Torque>(s.loads[1]).frame, Frame::world);
    EXPECT_EQ(window_of(s.loads[1]).until, std::numeric_limits<double>::infinity());
    EXPECT_EQ(std::get<Force>(s.loads[2]).point, Vector3<double>(7, 8, 9));
    EXPECT_EQ(std::get<Force>(s.loads[2]).frame, Frame::body);
    EXPECT_EQ(std::get<Force>(s.loads[2]).point_frame, Frame::world);
    EXPECT_EQ(std::get<Impulse>(s.loads[3]).at, 1.5);
    EXPECT_EQ(std::get<Impulse>(s.loads[3]).point_frame, Frame::body);
    EXPECT_EQ(std::get<Drag>(s.loads[4]).rotational, Vector3<double>(0.1, 0.2, 0.3));
    EXPECT_EQ(std::get<Drag>(s.loads[4]).translational, 0.4);
    EXPECT_EQ(std::get<Spring>(s.loads[5]).rest_orientation, (Quaternion<double>{0, 0, 0, 1}));
    EXPECT_EQ(tolerated_error(s, "attitude"), 1e-3);
}

TEST(SceneFile, DefaultsAreTheContracts) {
    const Scene s = parse_scene(scene_with(R"("loads": [{"type": "spring", "stiffness": 1}])"), "f");
    EXPECT_EQ(s.initial.orientation, (Quaternion<double>{1, 0, 0, 0}));
    EXPECT_EQ(s.initial.angular_velocity, Vector3<double>());
    EXPECT_EQ(s.initial.angular_velocity_frame, Frame::body);
    EXPECT_EQ(s.body.center_of_mass, Vector3<double>());
    EXPECT_FALSE(s.pivot);
    EXPECT_TRUE(s.tolerated.empty());
    EXPECT_EQ(std::get<Spring>(s.loads[0]).rest_orientation, (Quaternion<double>{1, 0, 0, 0}));
}

// values just inside the limits
TEST(SceneFile, AcceptsWhatTheRulesAllow) {
    const char* allowed[] = {
        R"("initial": {"orientation": [1.0000009, 0, 0, 0]})",
        R"("pivot": [0, 0, 0], "initial": {}, "loads": [])",
        R"("loads": [{"type": "drag", "translational": 1}])",
        R"("loads": [{"type": "impulse", "vector": [0, 0, 0], "frame": "body", "point": [0, 0, 0], "at": 0}])",
        R"("loads": [{"type": "gravity", "acceleration": [0, 0, 0], "from": -5, "until": 100}])",
        R"("about": "\u00e9\ud83d\ude00\n", "source": "é")",
    };
    for (const char* members : allowed) EXPECT_EQ(fault_of(scene_with(members)), "") << members;
    const char* inertias[] = {"[1, 1, 2]", "[1, 1, 2.000000000001]", "[1e-3, 1, 1]",
                              "[[2, 0.1, 0], [0.100000000001, 2, 0], [0, 0, 2]]", "[[1, 0, 0], [0, 1, 0], [0, 0, 2]]"};
    for (const char* inertia : inertias)
        EXPECT_EQ(
            fault_of(std::string(R"({"name": "s", "duration": 1, "body": {"mass": 1, "inertia": )") + inertia + "}}"),
            "")
            << inertia;
    EXPECT_EQ(fault_of("\xef\xbb\xbf" + scene_with(R"("pivot": [0, 0, 0])")), "") << "byte order mark";
}

// each number is the binary64 nearest to its decimal
TEST(SceneFile, NumbersAreTheNearestBinary64) {
    const auto duration = [](const std::string& decimal) {
        return parse_scene(
                   R"({"name": "s", "duration": )" + decimal + R"(, "body": {"mass": 1, "inertia": [1, 2, 3]}})", "f")
            .duration;
    };
    EXPECT_EQ(duration("0.1"), 0x1.999999999999ap-4);
    EXPECT_EQ(duration("9007199254740993"), 0x1p53);  // half-way: rounded to even
    EXPECT_EQ(duration("9007199254740993.0000000000000000000001"), 0x1p53 + 2);
    EXPECT_EQ(duration("18446744073709551617"), 0x1p64);
    EXPECT_EQ(duration("123456789012345678901234567890e-29"), 1.2345678901234567890123456789);
    EXPECT_EQ(duration("1E+2"), 100);
}

TEST(SceneFile, MessagesSuggestNames) {
    EXPECT_EQ(
        fault_of(scene_with(R"("load": [])")),
        "file.json: /load: is an unknown key; did you mean loads? known keys: name, about, source, duration, body, "
        "initial, pivot, bodies, joints, import, loops, couplings, loads, parameters, tables, let, planes, contacts, "
        "tolerated");
    EXPECT_EQ(fault_of(scene_with(R"("pivot": [0, "1", 0])")),
              "file.json: /pivot/1: is the string \"1\"; give a number");
    EXPECT_EQ(fault_of(R"({"name": "s", "duration": 1, "body": {"mass": 1, "inertia": [1, -1, 3]}})"),
              "file.json: /body/inertia/1: is -1; a moment of inertia must be > 0");
    EXPECT_EQ(fault_of(R"({"name": "s", "duration": 1, "body": {"mass": 1e999, "inertia": [1, 1, 3]}})"),
              "file.json: /body/mass: is too large for binary64; give a finite number");
}

TEST(SceneFile, FilesThatCannotBeReadAreNamed) {
    EXPECT_NE(message_of("/nowhere/scene.json").find("/nowhere/scene.json: cannot be opened: No such file"),
              std::string::npos);
    EXPECT_NE(message_of(source_dir()).find("Is a directory"), std::string::npos);
    EXPECT_NE(message_of("/dev/zero").find("is a device, not a regular file"), std::string::npos);
    const std::string message = message_of("no\nsuch\x1b[31m file \xff.json");
    EXPECT_NE(message.find("no\\nsuch\\x1b[31m file \\xff.json"), std::string::npos) << message;
}

TEST(FindScene, KnowsNamesAndPathsAndNearMisses) {
    EXPECT_EQ(find_scene("free_asymmetric").name, "free_asymmetric");
    EXPECT_EQ(find_scene(source_dir() + "/experiments/scenes/dzhanibekov.json").name, "dzhanibekov");
    try {
        find_scene("lagrange_tpo");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "lagrange_tpo: is neither a built-in scene nor a file; did you mean lagrange_top?");
    }
    EXPECT_EQ(find_scene("extreme/drag_1e6").name, "extreme/drag_1e6");
    EXPECT_EQ(message_of("spring_1e6", find_scene),
              "spring_1e6: is neither a built-in scene nor a file; did you mean extreme/spring_1e6?");
    EXPECT_EQ(
        message_of("extreme/gimbal_lok_0", find_scene)
            .find("extreme/gimbal_lok_0: is neither a built-in scene nor a file; did you mean extreme/gimbal_lock_0"),
        0u);
    EXPECT_NE(message_of("extremes/drag_1", find_scene).find("cannot be opened"), std::string::npos);
}

TEST(BuiltinScenes, AreTheFilesAndValid) {
    const std::vector<std::string> names = builtin_scene_names();
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
    for (const char* expected : {"free_asymmetric", "dzhanibekov", "symmetric", "lagrange_top", "kovalevskaya",
                                 "nasa_brick", "damped_spin", "stiff_drag"})
        EXPECT_NE(std::find(names.begin(), names.end(), expected), names.end()) << expected;
    for (const std::string& name : names) {
        std::ifstream file(source_dir() + "/experiments/scenes/" + name + ".json");
        std::stringstream text;
        text << file.rdbuf();
        EXPECT_EQ(builtin_scene_text(name), text.str());
        const Scene s = find_scene(name);
        EXPECT_EQ(s.name, name);
        EXPECT_FALSE(s.about.empty()) << name;
        EXPECT_FALSE(s.source.empty()) << name;
    }
    EXPECT_EQ(builtin_scene_text("no such scene"), "");
}

TEST(SceneFamily, IsDerivedFromTheName) {
    const FamilyMember drag = family_member("extreme/drag_torque_1e6");
    EXPECT_EQ(drag.folder, "extreme");
    EXPECT_EQ(drag.family, "drag_torque");
    EXPECT_EQ(drag.parameter, "1e6");
    EXPECT_EQ(drag.value, 1e6);
    EXPECT_EQ(family_member("extreme/flat_-9e-13").value, -9e-13);
    EXPECT_EQ(family_member("extreme/some_words").family, "some_words");
    EXPECT_EQ(family_member("extreme/some_words").parameter, "");
    EXPECT_EQ(family_member("explorer_1").family, "explorer_1");
    EXPECT_EQ(family_member("explorer_1").folder, "");
    const std::vector<std::string> members = scene_family("extreme", "drag");
    ASSERT_GE(members.size(), 3u);
    for (std::size_t i = 1; i < members.size(); ++i)
        EXPECT_LT(family_member(members[i - 1]).value, family_member(members[i]).value);
}

}  // namespace
}  // namespace polhode
