#include "scene/mjcf_actuators.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "text/message.h"

namespace polhode {
namespace {

// Attributes that are read, or that do not affect forces. An actuator with others is reported as omitted.
constexpr std::string_view known_attributes[] = {
    "name",         "class",     "group",      "user",         "joint",       "jointinparent", "gear",    "ctrllimited",
    "forcelimited", "ctrlrange", "forcerange", "kp",           "kv",          "gaintype",      "gainprm", "biastype",
    "biasprm",      "dyntype",   "dynprm",     "inheritrange", "lengthrange", "actlimited",    "actrange"};

class ActuatorReader {
  public:
    ActuatorReader(const RobotXml& xml, const XMLElement& root, const std::vector<Wide>& references, Robot& robot)
        : xml_(xml), references_(references), robot_(robot) {
        for (const XMLElement* o = root.FirstChildElement("option"); o; o = o->NextSiblingElement("option"))
            if (const char* groups = o->Attribute("actuatorgroupdisable"))
                for (const double group : xml.numbers(*o, "actuatorgroupdisable", groups, 0, 31))
                    disabled_groups_.push_back(group);
    }

    void read(const XMLElement& at) {
        const std::size_t index = joint_of(at);
        if (index == robot_.joints.size() || !has_known_attributes(at)) return;
        if (is_disabled(at)) return remove_notes(robot_, "actuators", {robot_note_name(xml_, at)});
        Robot::Actuator one;
        one.name = robot_note_name(xml_, at), one.joint = robot_.joints[index].name;
        one.reference = double(references_[index]);
        if (const char* gear = at.Attribute("gear")) one.gear = xml_.numbers(at, "gear", gear, 1, 6)[0];
        if (!read_law(at, one)) return;
        read_ranges(at, robot_.joints[index].limits[0], one);
        robot_.actuators.push_back(std::move(one));
    }

  private:
    const RobotXml& xml_;
    const std::vector<Wide>& references_;
    Robot& robot_;
    std::vector<double> disabled_groups_;

    // the hinge or slide that the actuator drives; the number of joints if there is none
    std::size_t joint_of(const XMLElement& at) const {
        const char* name = at.Attribute("joint") ? at.Attribute("joint") : at.Attribute("jointinparent");
        std::size_t i = 0;
        for (; name && i < robot_.joints.size(); ++i)
            if (robot_.joints[i].name == name) break;
        if (!name) return robot_.joints.size();
        if (i == robot_.joints.size())
            xml_.fail(at, fmt::format("names the joint \"{}\", which does not exist", one_line(name, 60)),
                      "give the name of a joint");
        const RobotMotion motion = robot_.joints[i].motion;
        return motion == RobotMotion::revolute || motion == RobotMotion::prismatic ? i : robot_.joints.size();
    }

    static bool has_known_attributes(const XMLElement& at) {
        for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next())
            if (std::ranges::find(known_attributes, a->Name()) == std::end(known_attributes)) return false;
        return at.FirstChildElement() == nullptr;
    }

    bool is_disabled(const XMLElement& at) const {
        const double group = xml_.attribute_or(at, "group", 0);
        return std::ranges::find(disabled_groups_, group) != disabled_groups_.end();
    }

    static bool has_value(const XMLElement& at, const char* attribute, std::initializer_list<std::string_view> values) {
        const char* text = at.Attribute(attribute);
        return !text || std::ranges::find(values, std::string_view(text)) != values.end();
    }

    // Gain and bias. Returns false for laws that are not affine in length and velocity.
    bool read_law(const XMLElement& at, Robot::Actuator& one) const {
        const std::string_view type = at.Name();
        if (type == "general") return read_general(at, one);
        const double kp = xml_.attribute_or(at, "kp", 1), kv = xml_.attribute_or(at, "kv", type == "position" ? 0 : 1);
        if (type == "position")
            one.gain = {kp, 0, 0}, one.bias = {0, -kp, -kv};
        else if (type == "velocity")
            one.gain = {kv, 0, 0}, one.bias = {0, 0, -kv};
        else if (type == "damper")
            one.gain = {0, 0, -kv};
        return true;
    }
    bool read_general(const XMLElement& at, Robot::Actuator& one) const {
        if (!has_value(at, "dyntype", {"none"}) || !has_value(at, "gaintype", {"fixed", "affine"}) ||
            !has_value(at, "biastype", {"none", "affine"}))
            return false;
        const auto is_affine = [&](const char* attribute) {
            return at.Attribute(attribute) && std::string_view(at.Attribute(attribute)) == "affine";
        };
        one.gain = {1, 0, 0}, one.bias = {};
        read_coefficients(at, "gainprm", is_affine("gaintype") ? 3 : 1, one.gain);
        read_coefficients(at, "biasprm", is_affine("biastype") ? 3 : 0, one.bias);
        return true;
    }
    void read_coefficients(const XMLElement& at, const char* attribute, std::size_t count,
                           std::array<double, 3>& coefficients) const {
        const char* text = at.Attribute(attribute);
        if (!text) return;
        constexpr std::size_t most = 100;
        const std::vector<double> given = xml_.numbers(at, attribute, text, 0, most);
        for (std::size_t i = 0; i < std::min(count, given.size()); ++i) coefficients[i] = given[i];
    }

    JointLimits range_of(const XMLElement& at, const char* limited, const char* range) const {
        if (!at.Attribute(range) || !has_mjcf_range(at, limited, range)) return {};
        const std::vector<double> ends = xml_.attribute(at, range, 2);
        if (!(ends[0] <= ends[1]))
            xml_.fail(at, fmt::format("has a {} that is not increasing", range), "give LOW HIGH");
        return {ends[0], ends[1], 0};
    }

    void read_ranges(const XMLElement& at, const JointLimits& joint, Robot::Actuator& one) const {
        one.control = range_of(at, "ctrllimited", "ctrlrange"), one.force = range_of(at, "forcelimited", "forcerange");
        const double inherits = xml_.attribute_or(at, "inheritrange", 0);
        if (!(inherits > 0) || !std::isfinite(joint.lower) || !std::isfinite(joint.upper)) return;
        // the joint's range, scaled about its middle; <velocity> uses it for a filtered position
        const double middle = (joint.lower + joint.upper) / 2 + one.reference,
                     half = inherits * (joint.upper - joint.lower) / 2;
        if (std::string_view(at.Name()) == "position") one.control = {middle - half, middle + half, 0};
    }
};

}  // namespace

void add_mjcf_actuators(const RobotXml& xml, const XMLElement& root, const std::vector<Wide>& references,
                        Robot& robot) {
    ActuatorReader reader(xml, root, references, robot);
    for (const XMLElement* section = root.FirstChildElement("actuator"); section;
         section = section->NextSiblingElement("actuator"))
        for (const char* type : {"general", "motor", "position", "velocity", "damper"})
            for (const XMLElement* at = section->FirstChildElement(type); at; at = at->NextSiblingElement(type))
                reader.read(*at);
}

}  // namespace polhode
