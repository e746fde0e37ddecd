// Expands <frame>, <replicate> and <attach>.
#include "scene/mjcf_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "scene/robot_parts.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t most_elements = 1'000'000;  // after expansion
constexpr int deepest_tree = 300;

MjcfScope inside(const MjcfScope& scope, const RobotPose& pose) {
    MjcfScope inner = scope;
    inner.pose = scope.pose * pose, inner.depth = scope.depth + 1;
    return inner;
}

// Pads the index of a copy: "07" of 12 copies.
std::string copy_number(int index, int count) {
    std::string text = std::to_string(index);
    const std::size_t digits = std::to_string(count).size();
    return std::string(digits - text.size(), '0') + text;
}

}  // namespace

MjcfParts MjcfCollector::collect(const XMLElement& of, const MjcfScope& scope) {
    MjcfParts parts;
    collect(of, scope, parts);
    return parts;
}

void MjcfCollector::count(const XMLElement& at, const MjcfScope& scope) {
    if (++visited_ > most_elements)
        xml_.fail(at, fmt::format("makes the robot larger than {} elements", most_elements), "replicate fewer");
    if (scope.depth > deepest_tree)
        xml_.fail(at, fmt::format("is nested deeper than {} bodies and frames", deepest_tree),
                  "give a flatter file that does not attach itself");
}

void MjcfCollector::collect(const XMLElement& of, const MjcfScope& scope, MjcfParts& parts) {
    for (const XMLElement* one = of.FirstChildElement(); one; one = one->NextSiblingElement())
        collect_one(*one, scope, parts);
}

void MjcfCollector::collect_one(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts) {
    count(at, scope);
    const std::string_view tag = at.Name();
    if (tag == "body") {
        parts.bodies.push_back({&at, scope});
    } else if (tag == "joint" || tag == "freejoint") {
        parts.joints.push_back({&at, scope});
    } else if (tag == "geom") {
        parts.geoms.push_back({&at, scope.model, scope.pose});
        if (xml_.attribute_or(at, "contype", 1) != 0 || xml_.attribute_or(at, "conaffinity", 1) != 0)
            parts.can_collide = true;
    } else if (tag == "inertial") {
        if (parts.inertial) xml_.fail(at, "is a second <inertial> of one body", "give one");
        parts.inertial = MjcfPlaced{&at, scope.model, scope.pose};
    } else if (tag == "frame") {
        collect(at, inside(scope, mjcf_pose(xml_, at, scope.model->compiler)), parts);
    } else if (tag == "replicate") {
        replicate(at, scope, parts);
    } else if (tag == "attach") {
        attach(at, scope, parts);
    } else if (tag == "flexcomp" && xml_.flag(at, "rigid")) {
        parts.can_collide = true;  // a rigid shape of this body, without mass
    } else if (tag == "composite" || tag == "flexcomp") {
        const char* label = at.Attribute("name") ? at.Attribute("name") : at.Attribute("prefix");
        xml_.fail(at,
                  fmt::format("makes bodies by <{}> \"{}\", which is not read", tag, one_line(label ? label : "", 60)),
                  "write the bodies out: save the model with MuJoCo (mj_saveLastXML)");
    }
}

// Copy i is rotated by i times the Euler angles. It is displaced by the offsets of all previous copies, each in the
// axes of its copy.
void MjcfCollector::replicate(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts) {
    const double given = xml_.attribute(at, "count", 1)[0];
    if (!(given >= 0 && given <= static_cast<double>(most_elements) && given == std::floor(given)))
        xml_.fail(at, fmt::format("has the count {}", given), fmt::format("give 0 to {}", most_elements));
    const int copies = static_cast<int>(given);
    Vector3<Wide> offset, position;
    Vector3<double> angles;
    if (at.Attribute("offset")) offset = cast<Wide>(three_of(xml_.attribute(at, "offset", 3)));
    if (at.Attribute("euler")) angles = three_of(xml_.attribute(at, "euler", 3));
    const std::string separator = at.Attribute("sep") ? at.Attribute("sep") : "";
    for (int i = 0; i < copies; ++i) {
        count(at, scope);
        const Quaternion<Wide> turn = mjcf_euler(double(i) * angles, scope.model->compiler);
        MjcfScope inner = inside(scope, {position, turn});
        inner.suffix = separator + copy_number(i, copies) + scope.suffix;
        collect(at, inner, parts);
        position = position + rotate(turn, offset);
    }
}

void MjcfCollector::attach(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts) {
    const char* prefix = at.Attribute("prefix");
    if (!prefix) xml_.fail(at, "has no \"prefix\"", "give the prefix of the attached names");
    MjcfScope inner = inside(scope, {});
    inner.prefix = scope.prefix + prefix;
    if (at.Attribute("model")) inner.model = &library_.attached(at, *scope.model, at.Attribute("model"));
    const XMLElement& root = *inner.model->root;
    if (at.Attribute("body")) {
        parts.bodies.push_back({&named_element(xml_, root, "body", at.Attribute("body")), inner});
    } else if (at.Attribute("frame")) {
        const XMLElement& frame = named_element(xml_, root, "frame", at.Attribute("frame"));
        collect(frame, inside(inner, mjcf_pose(xml_, frame, inner.model->compiler)), parts);
    } else {
        if (!at.Attribute("model"))
            xml_.fail(at, "has neither a model, nor a body or frame of this one", "give one of them");
        for (const XMLElement* world = root.FirstChildElement("worldbody"); world;
             world = world->NextSiblingElement("worldbody"))
            collect(*world, inner, parts);
    }
}

}  // namespace polhode
