// The table of MJCF constructs: complete for all versions, and each row's verdict is verified with a document.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "places.h"
#include "scene/robot_schema.h"
#include "scene/robot_tree.h"
#include "scene/scene_file.h"

namespace polhode::mjcf_constructs_test {
namespace {

using enum RobotVerdict;

const RobotConstruct* find_row(std::string_view parent, std::string_view element, std::string_view attribute) {
    for (const std::string_view over : {parent, std::string_view("*")})
        for (const RobotConstruct& row : mjcf_constructs())
            if (row.parent == over && row.element == element && row.attribute == attribute) return &row;
    return nullptr;
}

struct SchemaLine {
    std::string parent, element;
    std::vector<std::string> attributes;
};
std::vector<SchemaLine> schema_lines() {
    std::ifstream file(source_dir() + "/tests/scene/mjcf_schema.txt");
    std::vector<SchemaLine> lines;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream words(line);
        SchemaLine one;
        words >> one.parent >> one.element;
        if (one.parent == "-") one.parent.clear();
        for (std::string word; words >> word;) one.attributes.push_back(word);
        lines.push_back(one);
    }
    return lines;
}

bool is_covered(const std::vector<SchemaLine>& lines, const std::string& parent, const std::string& element, int depth);

// Whether elements with this tag are always irrelevant or omitted as a whole, including their contents.
bool is_covered_parent(const std::vector<SchemaLine>& lines, const std::string& parent, int depth) {
    bool any = false;
    for (const SchemaLine& line : lines) {
        if (line.element != parent || line.parent == parent) continue;
        if (!is_covered(lines, line.parent, line.element, depth + 1)) return false;
        any = true;
    }
    return any;
}

bool is_covered(const std::vector<SchemaLine>& lines, const std::string& parent, const std::string& element,
                int depth) {
    if (depth > 6) return false;
    if (is_covered_parent(lines, parent, depth)) return true;
    const RobotConstruct* row = find_row(parent, element, "");
    return row && row->verdict != modelled;
}

TEST(MjcfConstructs, ListEveryElementAndAttributeOfAllVersions) {
    const std::vector<SchemaLine> lines = schema_lines();
    ASSERT_GT(lines.size(), 200u);
    for (const SchemaLine& line : lines) {
        // MuJoCo's table calls the world a body and prints "required" for the element of optional plugins
        if (line.parent == "required" || line.element == "required") continue;
        if (is_covered(lines, line.parent, line.element, 0)) continue;
        EXPECT_TRUE(find_row(line.parent, line.element, "")) << line.parent << " " << line.element;
        if (line.parent == "default") continue;  // these attributes are those of the element itself
        for (const std::string& attribute : line.attributes)
            EXPECT_TRUE(find_row(line.parent, line.element, attribute))
                << line.parent << " " << line.element << " " << attribute;
    }
}

TEST(MjcfConstructs, AreEachListedOnceWithANote) {
    std::set<std::tuple<std::string_view, std::string_view, std::string_view>> seen;
    for (const RobotConstruct& row : mjcf_constructs()) {
        EXPECT_TRUE(seen.insert({row.parent, row.element, row.attribute}).second) << row.element << row.attribute;
        EXPECT_FALSE(row.note.empty()) << row.element << " " << row.attribute;
    }
}

// The result of importing a document: the scene with its notes, or the refusal.
struct Outcome {
    std::string text;
    std::vector<std::string> omitted;
};
Outcome outcome(const std::string& document) {
    try {
        Scene scene;
        scene.name = "robot", scene.duration = 1;
        const Robot robot = parse_robot(document, "robot.xml");
        add_robot(robot, {}, "robot.xml", scene);
        Outcome result{write_scene(scene), {}};
        for (const auto& [heading, names] : robot.omitted) result.omitted.push_back(heading);
        for (const auto& list : {scene.omitted, scene.assumed})
            for (const std::string& one : list) result.text += "\n" + one;
        return result;
    } catch (const InputError& error) {
        return {std::string("refused: ") + error.what(), {}};
    }
}

const std::string unit_inertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
const std::string world =
    "<worldbody><body name='b0'><joint name='j0' axis='0 1 0'/>" + unit_inertial + "</body></worldbody>";

// A document with `xml` as a child of `parent`.
std::string document_with(const std::string& parent, const std::string& xml) {
    const auto in_world = [](const std::string& inside) {
        return "<mujoco><worldbody>" + inside + "<body name='b0'><joint name='j0'/>" + unit_inertial +
               "</body></worldbody></mujoco>";
    };
    if (parent == "mujoco") return "<mujoco>" + xml + world + "</mujoco>";
    if (parent == "*" || parent == "geom") {
        const std::string inside = parent == "*" ? xml : "<geom size='0.1'>" + xml + "</geom>";
        return in_world("<body name='p'><joint name='jp'/>" + inside + "<body name='c'>" + unit_inertial +
                        "</body></body>");
    }
    if (parent == "mesh" || parent == "plugin") {
        const std::string inside = parent == "mesh" ? xml : "<plugin>" + xml + "</plugin>";
        return "<mujoco><asset><mesh name='m' vertex='0'>" + inside + "</mesh></asset>" + world + "</mujoco>";
    }
    if (parent == "default") return "<mujoco><default>" + xml + "</default>" + world + "</mujoco>";
    return "<mujoco><" + parent + ">" + xml + "</" + parent + ">" + world + "</mujoco>";
}

// A document with an element that has these attributes, where they have an effect.
std::string document_of(const std::string& parent, const std::string& element, const std::string& attributes) {
    const std::string open = "<" + element + " " + attributes;
    if (element == "mujoco") return open + ">" + world + "</mujoco>";
    const auto lone = [](const std::string& body, const std::string& sections = "") {
        return "<mujoco>" + sections + "<worldbody>" + body + "</worldbody></mujoco>";
    };
    if (parent == "equality") {
        const auto missing = [&](const char* name, const char* value) {
            return attributes.starts_with(name) ? std::string() : fmt::format(" {}='{}'", name, value);
        };
        const std::string given = element == "joint"  ? missing("joint1", "h") + missing("joint2", "k")
                                  : element == "weld" ? missing("body1", "q") + missing("body2", "r")
                                                      : missing("body1", "q") + missing("anchor", "0 0 0.5");
        const std::string other = element == "joint" ? "<joint name='k'/>" : "<freejoint/>";
        return "<mujoco><worldbody><body name='q'><joint name='h'/>" + unit_inertial + "</body><body name='r'>" +
               other + unit_inertial + "</body></worldbody><equality>" + open + given + "/></equality></mujoco>";
    }
    if (element == "body") return lone(open + "><joint damping='1'/>" + unit_inertial + "</body>");
    if (element == "frame")
        return lone(open + "><body name='q'><joint/>" + unit_inertial + "</body></frame>",
                    "<default><default class='k'><joint damping='3'/></default></default>");
    if (element == "replicate") {
        const std::string count = attributes.find("count") == std::string::npos ? " count='2'" : "";
        return lone(open + count + "><body name='q'><joint/>" + unit_inertial + "</body></replicate>");
    }
    if (element == "inertial") {
        const auto missing = [&](const char* name, const char* value) {
            return attributes.find(name) == std::string::npos ? std::string(" ") + value : std::string();
        };
        return lone("<body name='q'><joint/>" + open + missing("pos", "pos='0 0 0'") + missing("mass", "mass='2'") +
                    (attributes.find("fullinertia") == std::string::npos
                         ? missing("diaginertia", "diaginertia='1 2 2.5'")
                         : std::string()) +
                    "/></body>");
    }
    if (element == "joint" || element == "freejoint") {
        const bool springs = attributes.starts_with("ref") || attributes.starts_with("springref");
        return lone("<body name='q'>" + open + (springs ? " stiffness='2'" : "") +
                    "/><inertial pos='0 0 0.5' mass='1' diaginertia='1 1 1'/></body>");
    }
    if (element == "geom") {
        const bool is_field = attributes.starts_with("hfield"), fits = attributes.starts_with("fitscale"),
                   spans = attributes.starts_with("fromto");
        std::string more = attributes.starts_with("type") ? "" : " type='box'";
        if (is_field) more = " type='hfield'";
        if (attributes.starts_with("conaffinity")) more += " contype='0'";
        if (spans) more = " type='capsule'";
        if (fits) more += " mesh='m'";
        if (!attributes.starts_with("size")) more += " size='0.1 0.2 0.3'";
        return lone("<body name='q'><joint/>" + open + more + "/></body>",
                    "<asset><mesh name='m' vertex='0 0 0 2 0 0 0 1 0 0 0 3'/></asset>"
                    "<compiler inertiagrouprange='0 3'/>");
    }
    if (element == "mesh" && parent == "asset") {
        const auto missing = [&](const char* name, const char* value) {
            return attributes.find(name) == std::string::npos ? std::string(" ") + value : std::string();
        };
        const bool is_file = attributes.starts_with("file");
        return lone("<body name='q'><joint/><geom type='mesh' mesh='m'/></body>",
                    "<asset>" + open + missing("name=", "name='m'") +
                        (is_file ? "" : missing("vertex", "vertex='0 0 0 2 0 0 0 1 0 0 0 3 0.1 0.1 0.1'")) +
                        "/></asset>");
    }
    if (element == "hfield") {
        const std::string size = attributes.find("size") == std::string::npos ? " size='1 1 1 1'" : "";
        const std::string name = attributes.find("name") == std::string::npos ? " name='h'" : "";
        return lone("<body name='q'><joint/><geom type='hfield' hfield='h'/></body>",
                    "<asset>" + open + name + size + "/></asset>");
    }
    if (element == "compiler") {
        const std::string sections = open + "/><asset><mesh name='m' vertex='0 0 0 2 0 0 0 1 0 0 0 3'/></asset>";
        return lone("<body name='s'>" + unit_inertial +
                        "</body><body name='q' pos='1 0 0' euler='30 20 10'><joint "
                        "type='free' damping='1'/><geom size='0.1' pos='0 1 0' group='0'/></body><body name='r'><joint "
                        "range='-1 1'/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1.9'/><geom size='0.1'/></body>",
                    sections);
    }
    if (element == "flag")
        return lone("<body name='q'><joint damping='1' stiffness='2'/>" + unit_inertial + "</body>",
                    "<option>" + open + "/></option>");
    if (element == "option") return "<mujoco>" + open + "/>" + world + "</mujoco>";
    return document_with(parent, open + "/>");
}

// Rows that need other files or classes; mjcf_import_test.cpp tests them.
bool is_shown_elsewhere(const RobotConstruct& row) {
    if (row.element == "include" || row.element == "attach" || row.element == "default" || row.element == "model")
        return true;
    static const std::set<std::pair<std::string_view, std::string_view>> keys{
        {"compiler", "assetdir"},
        {"compiler", "meshdir"},
        {"compiler", "strippath"},
        {"compiler", "fusestatic"},
        {"compiler", "discardvisual"},
        {"compiler", "fitaabb"},
        {"compiler", "exactmeshinertia"},
        {"frame", "name"},
        {"mesh", "params"},
        {"geom", "fitscale"},
        {"replicate", "childclass"},
        {"body", "childclass"},
        {"freejoint", "name"},
    };
    return keys.contains({row.element, row.attribute});
}

// A value for which an omitted attribute would have an effect.
std::string acting_value(std::string_view attribute) {
    static const std::map<std::string_view, std::string> values{
        {"wind", "wind='1 0 0' density='1'"}, {"conflict", "conflict='merge'"}, {"sleep", "sleep='enable'"},
        {"limited", "limited='true'"},        {"range", "range='-1 1'"},
    };
    const auto found = values.find(attribute);
    return found != values.end() ? found->second : std::string(attribute) + "='1'";
}

bool has(const std::vector<std::string>& headings, std::string_view heading) {
    return std::find(headings.begin(), headings.end(), heading) != headings.end();
}

TEST(MjcfConstructs, AttributesActAsTheTableSays) {
    for (const RobotConstruct& row : mjcf_constructs()) {
        if (row.attribute.empty() || is_shown_elsewhere(row)) continue;
        const std::string parent(row.parent), element(row.element), attribute(row.attribute);
        const std::string place = parent + " " + element + " " + attribute;
        if (element == "plugin") continue;
        const Outcome without = outcome(document_of(parent, element, ""));
        ASSERT_EQ(without.text.find("refused"), std::string::npos) << place << without.text;
        if (row.verdict == irrelevant) {
            EXPECT_EQ(outcome(document_of(parent, element, attribute + "='1'")).text, without.text) << place;
        } else if (row.verdict == omitted) {
            EXPECT_FALSE(has(without.omitted, row.note)) << place;
            const Outcome with = outcome(document_of(parent, element, acting_value(attribute)));
            EXPECT_TRUE(has(with.omitted, row.note)) << place << with.text;
            if (row.neutral.empty()) continue;
            const std::string neutral(row.neutral.substr(0, row.neutral.find('|')));
            EXPECT_EQ(outcome(document_of(parent, element, attribute + "='" + neutral + "'")).text, without.text)
                << place;
        } else {
            // another value changes the scene or its notes, or an invalid value is refused
            bool reacts = false;
            for (const char* value : {"no value", "0", "2", "true", "false", "3 2 1"})
                reacts = reacts ||
                         outcome(document_of(parent, element, attribute + "='" + value + "'")).text != without.text;
            EXPECT_TRUE(reacts) << place;
        }
    }
}

TEST(MjcfConstructs, ElementsActAsTheTableSays) {
    for (const RobotConstruct& row : mjcf_constructs()) {
        if (!row.attribute.empty() || row.element == "mujoco" || row.verdict == modelled) continue;
        const std::string parent(row.parent), element(row.element), place = parent + " " + element;
        // the parent alone
        const Outcome without = outcome(document_with(parent, ""));
        ASSERT_EQ(without.text.find("refused"), std::string::npos) << place << without.text;
        const std::string refused = element == "composite" || element == "flexcomp" ? "which is not supported" : "";
        const std::string xml = "<" + element + " name='n' stiffness='1'><x y='z'/></" + element + ">";
        const Outcome with = outcome(document_with(parent, xml));
        if (!refused.empty()) {
            EXPECT_NE(with.text.find(refused), std::string::npos) << place << with.text;
        } else if (row.verdict == irrelevant) {
            EXPECT_EQ(with.text, without.text) << place;
        } else {
            EXPECT_TRUE(has(with.omitted, row.note)) << place << with.text;
        }
    }
    // values without effect
    const std::string quiet =
        "<mujoco><tendon><spatial/><fixed limited='false' range='0 1'/></tendon><equality><weld active='false'/>"
        "</equality>" +
        world + "</mujoco>";
    EXPECT_EQ(outcome(quiet).text, outcome("<mujoco>" + world + "</mujoco>").text);
    // values from a class
    const std::string by_class =
        "<mujoco><default><tendon stiffness='2'/><equality active='false'/></default><tendon><spatial name='t'/>"
        "</tendon><equality><weld name='w'/></equality>" +
        world + "</mujoco>";
    EXPECT_EQ(outcome(by_class).omitted,
              (std::vector<std::string>{"tendons with springs, dampers, friction, armature or limits"}));
}

TEST(MjcfConstructs, UnknownNamesAreNamed) {
    const auto omitted_of = [](const std::string& document) { return outcome(document).omitted; };
    EXPECT_EQ(omitted_of("<mujoco><muscles/>" + world + "</mujoco>"),
              (std::vector<std::string>{"unknown element <muscles>"}));
    EXPECT_EQ(omitted_of("<mujoco><default><engine/></default>" + world + "</mujoco>"),
              (std::vector<std::string>{"unknown element <engine>"}));
    EXPECT_EQ(omitted_of("<mujoco><worldbody><body name='q'><joint name='j' magnet='1'/>" + unit_inertial +
                         "<spring/></body></worldbody></mujoco>"),
              (std::vector<std::string>{"unknown attribute magnet of <joint>", "unknown element <spring>"}));
    EXPECT_EQ(omitted_of("<mujoco><default><joint magnet='1'/></default>" + world + "</mujoco>"),
              (std::vector<std::string>{"unknown attribute magnet of <joint>"}));
}

}  // namespace
}  // namespace polhode::mjcf_constructs_test
