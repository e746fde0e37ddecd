// Reads SDFormat joints and directs them as a forest.
//
// read_sdf_joint() computes the joint's frames from SdfTree and its axes by the rules of the file's version.
// SdfForest walks breadth-first from the world and then from the remaining roots, reverses joints that point towards
// the root, and rejects loops.

#include "scene/sdf_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <queue>
#include <utility>

#include "scene/sdf_gears.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

struct SdfJointType {
    const char* name;
    RobotMotion motion;
    std::size_t axes;
};
constexpr SdfJointType sdf_joint_types[] = {
    {"revolute", RobotMotion::revolute, 1},   {"continuous", RobotMotion::revolute, 1},
    {"prismatic", RobotMotion::prismatic, 1}, {"ball", RobotMotion::spherical, 0},
    {"universal", RobotMotion::universal, 2}, {"fixed", RobotMotion::fixed, 0},
    {"revolute2", RobotMotion::universal, 2}, {"screw", RobotMotion::screw, 1},
};
constexpr const char* known_types = "revolute, continuous, prismatic, ball, universal, revolute2, screw or fixed";

const SdfJointType& type_of(const RobotXml& xml, const XMLElement& at, const std::string& name) {
    const std::string type = xml.name(at, "type", known_types);
    for (const SdfJointType& one : sdf_joint_types)
        if (type == one.name) return one;
    xml.fail(at, fmt::format("joint \"{}\" has the type \"{}\"", one_line(name, 60), one_line(type, 40)),
             fmt::format("give {}", known_types));
}

struct JointFrames {
    RobotPose child, joint;  // in the world
};

// Orientation of the frame of <xyz>. Up to 1.4: the model's frame. 1.5 and 1.6: the joint's, unless
// use_parent_model_frame. From 1.7: by expressed_in.
Quaternion<Wide> axis_frame(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const XMLElement& axis,
                            const XMLElement* xyz, const JointFrames& frames, Robot& robot) {
    const SdfScope& scope = tree.scope_of(entity);
    const bool by_switch = sdf_flag(xml, xml.optional_child(axis, "use_parent_model_frame"));
    if (by_switch && scope.version >= 7)
        robot.omitted["use_parent_model_frame, which SDFormat 1.7 replaced by expressed_in"].push_back(
            robot_note_name(xml, axis));
    if (scope.version < 5 || (by_switch && scope.version < 7)) return tree.pose_in_world(scope.frame).turn;
    const char* name = xyz ? xyz->Attribute("expressed_in") : nullptr;
    if (!name || !*name) return frames.joint.turn;
    return tree.pose_in_world(tree.find(*xyz, name, entity.scope)).turn;
}

// Limits and friction of an axis. 1e16 or more means no limit.
void read_laws(const RobotXml& xml, const XMLElement& axis, std::size_t i, RobotJoint& joint) {
    if (const XMLElement* dynamics = xml.optional_child(axis, "dynamics"))
        joint.friction[i] = xml.content_or(xml.optional_child(*dynamics, "friction"), 0);
    const XMLElement* limit = xml.optional_child(axis, "limit");
    const char* type = axis.Parent()->ToElement()->Attribute("type");
    if (!limit || (type && std::string_view(type) == "continuous")) return;
    constexpr double none = 1e16;
    // texts such as "inf" mean no limit
    const auto bound = [&](const char* name) {
        const XMLElement* at = xml.optional_child(*limit, name);
        return at ? parse_decimal(sdf_text(*at)) : std::nullopt;
    };
    if (const std::optional<double> lower = bound("lower"); lower && *lower > -none) joint.limits[i].lower = *lower;
    if (const std::optional<double> upper = bound("upper"); upper && *upper < none) joint.limits[i].upper = *upper;
}

// The direction of an <axis> in the world.
Vector3<Wide> direction_of(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const XMLElement& at,
                           const JointFrames& frames, const std::string& name, Robot& robot) {
    Vector3<Wide> axis(Wide(0), Wide(0), Wide(1));
    const XMLElement* xyz = xml.optional_child(at, "xyz");
    if (xyz && !sdf_text(*xyz).empty()) {
        axis = cast<Wide>(three_of(xml.content(*xyz, 3)));
        if (axis == Vector3<Wide>()) xml.fail(*xyz, "is zero", "give a direction");
    } else {
        robot.assumed["axes 0 0 1, SDFormat's default"].push_back(name);
    }
    return rotate(axis_frame(xml, tree, entity, at, xyz, frames, robot), axis);
}

void read_axis(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const XMLElement& at, std::size_t i,
               const JointFrames& frames, RobotJoint& joint, Robot& robot) {
    joint.axes[i] = rotate_back(frames.child.turn, direction_of(xml, tree, entity, at, frames, joint.name, robot));
    read_laws(xml, at, i, joint);
    joint.start[i] = xml.content_or(xml.optional_child(at, "initial_position"), 0);
    const XMLElement* dynamics = xml.optional_child(at, "dynamics");
    if (!dynamics) return;
    const auto number = [&](const char* name) { return xml.content_or(xml.optional_child(*dynamics, name), 0); };
    joint.damping[i] = Wide(number("damping")), joint.stiffness[i] = Wide(number("spring_stiffness"));
    const double rest = number("spring_reference");
    if (joint.stiffness[i] != 0) joint.rest[i] = Wide(rest);
}

// Notes axes of ball and fixed joints, which have no coordinate along an axis.
void note_unused_axes(const RobotXml& xml, const XMLElement& at, const SdfJointType& type, const std::string& name,
                      Robot& robot) {
    const XMLElement* first = at.FirstChildElement("axis");
    const XMLElement* dynamics = first ? first->FirstChildElement("dynamics") : nullptr;
    for (const char* part : {"damping", "spring_stiffness"})
        if (type.motion == RobotMotion::spherical && dynamics &&
            xml.content_or(dynamics->FirstChildElement(part), 0) != 0)
            robot.omitted["springs and dampers of ball joints"].push_back(name);
    if (type.axes == 1 && at.FirstChildElement("axis2")) robot.omitted["axis2 of joints with one axis"].push_back(name);
}

// The displacement of a screw per rotation, m/rad. <thread_pitch> is in rad/m, positive for left-handed threads;
// <screw_thread_pitch> in m per revolution, positive for right-handed ones, 1 by default.
Wide pitch_of(const RobotXml& xml, const XMLElement& at) {
    const XMLElement *pitch = xml.optional_child(at, "screw_thread_pitch"),
                     *former = xml.optional_child(at, "thread_pitch");
    if (pitch || !former) return Wide(xml.content_or(pitch, 1)) / (Wide(2) * Elementary<Wide>::pi());
    const double turns = xml.content_or(former, 1);
    if (turns == 0) xml.fail(*former, "is 0", "give a number other than 0, in rad/m");
    return Wide(-1) / Wide(turns);
}

// The joint with parent and child exchanged: the inverse of R(a, q) is R(-a, q), and the order of two axes is
// reversed.
RobotJoint reversed(const RobotJoint& from) {
    RobotJoint to = from;
    to.parent = from.child, to.child = from.parent;
    to.placement = inverse(from.placement);
    to.point = from.placement * from.point;
    const auto back = [&](const Vector3<Wide>& axis) { return -rotate(from.placement.turn, axis); };
    if (from.motion == RobotMotion::universal) {
        to.axes = {back(from.axes[1]), back(from.axes[0])};
        std::swap(to.stiffness[0], to.stiffness[1]);
        std::swap(to.rest[0], to.rest[1]);
        std::swap(to.damping[0], to.damping[1]);
        std::swap(to.friction[0], to.friction[1]);
        std::swap(to.limits[0], to.limits[1]);
        std::swap(to.start[0], to.start[1]);
    } else {
        to.axes[0] = back(from.axes[0]);
    }
    return to;
}

// Walks each tree from its root. Nodes are links; the last node is the world.
class SdfForest {
  public:
    SdfForest(const RobotXml& xml, std::vector<SdfJoint> joints, Robot& robot)
        : xml_(xml),
          joints_(std::move(joints)),
          robot_(robot),
          at_(robot.links.size() + 1),
          visited_(robot.links.size() + 1),
          carrier_(robot.links.size() + 1, none),
          used_(joints_.size()) {
        for (std::size_t j = 0; j < joints_.size(); ++j)
            for (const std::size_t end : {joints_[j].joint.parent, joints_[j].joint.child}) at_[node(end)].push_back(j);
    }

    std::vector<RobotJoint> direct() {
        const std::size_t world = robot_.links.size();
        walk(world);
        std::vector<bool> is_child(world + 1);
        for (const SdfJoint& one : joints_) is_child[node(one.joint.child)] = true;
        for (const bool children : {false, true})
            for (std::size_t i = 0; i < world; ++i)
                if (is_child[i] == children && !visited_[i]) walk(i);
        std::vector<RobotJoint> all;
        for (SdfJoint& one : joints_) all.push_back(std::move(one.joint));
        return all;
    }

  private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    std::size_t node(std::size_t link) const { return link == RobotJoint::world ? robot_.links.size() : link; }
    std::string name_of(std::size_t node) const {
        return node == robot_.links.size() ? "the world"
                                           : fmt::format("link \"{}\"", one_line(robot_.links[node].name, 60));
    }

    void walk(std::size_t root) {
        std::queue<std::size_t> open;
        open.push(root), visited_[root] = true;
        for (; !open.empty(); open.pop())
            for (const std::size_t j : at_[open.front()]) {
                if (used_[j]) continue;
                used_[j] = true;
                RobotJoint& joint = joints_[j].joint;
                const bool is_reversed = node(joint.parent) != open.front();
                if (is_reversed) {
                    joint = reversed(joint);
                    robot_.assumed["joints with parent and child swapped, so that each link has one parent"].push_back(
                        joint.name);
                }
                const std::size_t child = node(joint.child);
                if (visited_[child]) fail_at_loop(j, open.front(), child);
                visited_[child] = true, carrier_[child] = j;
                open.push(child);
            }
    }

    [[noreturn]] void fail_at_loop(std::size_t j, std::size_t from, std::size_t to) const {
        const std::size_t other = carrier_[to] != none ? carrier_[to] : carrier_[from];
        const std::size_t held = carrier_[to] != none ? to : from;
        xml_.fail(
            *joints_[j].at,
            fmt::format("joint \"{}\" closes a loop: joint \"{}\" already connects {}",
                        one_line(joints_[j].joint.name, 60), one_line(joints_[other].joint.name, 60), name_of(held)),
            "joints must form a tree: remove one of the joints, and close the chain by \"loops\" in the scene");
    }

    const RobotXml& xml_;
    std::vector<SdfJoint> joints_;
    Robot& robot_;
    std::vector<std::vector<std::size_t>> at_;
    std::vector<bool> visited_;
    std::vector<std::size_t> carrier_;
    std::vector<bool> used_;
};

}  // namespace

RobotJoint read_sdf_joint(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const std::string& name,
                          std::size_t parent, std::size_t child, Robot& robot) {
    const XMLElement& at = *entity.at;
    RobotJoint joint;
    joint.name = name, joint.place = xml.place_of(at);
    const SdfJointType& type = type_of(xml, at, name);
    joint.motion = type.motion;
    const auto index = static_cast<std::size_t>(&entity - tree.entities().data());
    const JointFrames frames{tree.pose_in_world(child), tree.pose_in_world(index)};
    joint.placement = inverse(tree.pose_in_world(parent)) * frames.child;
    joint.point = inverse(frames.child) * frames.joint.position;
    for (std::size_t i = 0; i < type.axes; ++i)
        read_axis(xml, tree, entity, xml.child(at, i == 0 ? "axis" : "axis2"), i, frames, joint, robot);
    if (type.motion == RobotMotion::screw) joint.pitch = pitch_of(xml, at);
    note_unused_axes(xml, at, type, name, robot);
    add_sdf_mimic(xml, at, name, type.motion, robot);
    return joint;
}

Vector3<Wide> sdf_axis_in_world(const RobotXml& xml, SdfTree& tree, const SdfEntity& entity, const char* tag,
                                Robot& robot) {
    const auto index = static_cast<std::size_t>(&entity - tree.entities().data());
    const JointFrames frames{{}, tree.pose_in_world(index)};
    return direction_of(xml, tree, entity, xml.child(*entity.at, tag), frames, entity.name, robot);
}

std::vector<RobotJoint> direct_sdf_joints(const RobotXml& xml, std::vector<SdfJoint> joints, Robot& robot) {
    return SdfForest(xml, std::move(joints), robot).direct();
}

}  // namespace polhode
