// Converts joints of MJCF.
//
// - hinge and slide become revolute and prismatic, with linear springs and dampers.
// - ball becomes spherical with a linear damper. Its spring is omitted: MuJoCo's torque grows with the angle, a
//   scene's with its sine.
// - free becomes a free body; its damping is linear drag. <joint type="free"> takes the values of <default>,
//   <freejoint> does not.
#include "scene/mjcf_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "text/message.h"

namespace polhode {
namespace {

RobotMotion motion_of(const RobotXml& xml, const XMLElement& at) {
    if (std::string_view(at.Name()) == "freejoint") return RobotMotion::free;
    const std::string_view type = at.Attribute("type") ? at.Attribute("type") : "hinge";
    if (type == "free") return RobotMotion::free;
    if (type == "hinge") return RobotMotion::revolute;
    if (type == "slide") return RobotMotion::prismatic;
    if (type == "ball") return RobotMotion::spherical;
    xml.fail(at, fmt::format("has the type \"{}\"", one_line(type, 40)), "give hinge, slide, ball or free");
}

}  // namespace

std::size_t MjcfJoints::add_link(const XMLElement& at, const std::string& name) {
    robot_.links.push_back({name, xml_.place_of(at), {}});
    return robot_.links.size() - 1;
}

RobotJoint& MjcfJoints::add(const XMLElement& at, const std::string& name, bool is_given, RobotMotion motion,
                            std::size_t parent, std::size_t child, const RobotPose& place) {
    if (is_given) {
        names_.add(at, name, robot_.joints.size());
    } else {
        generated_.push_back(robot_.joints.size());
    }
    RobotJoint joint;
    joint.name = name, joint.place = xml_.place_of(at), joint.motion = motion;
    joint.parent = parent, joint.child = child, joint.placement = place;
    robot_.joints.push_back(std::move(joint));
    armature_.push_back(0), references_.push_back(0);
    return robot_.joints.back();
}

void MjcfJoints::hold(const XMLElement& at, const std::string& name, std::size_t link, const RobotPose& place) {
    add(at, name + "_hold", false, RobotMotion::fixed, RobotJoint::world, link, place);
}

std::size_t MjcfJoints::add_body(const XMLElement& at, const std::string& name, std::size_t parent,
                                 const RobotPose& place, const MjcfParts& parts) {
    const std::vector<MjcfParts::Part>& joints = parts.joints;
    std::vector<std::size_t> links;
    for (std::size_t k = 0; k + 1 < joints.size(); ++k)
        links.push_back(add_link(*joints[k].at, fmt::format("{} (joint {})", name, k + 1)));
    const std::size_t body = add_link(at, name);
    links.push_back(body);
    if (joints.empty() && parent != RobotJoint::world) {
        add(at, name + "_weld", false, RobotMotion::fixed, parent, body, place);
    } else if (joints.empty()) {
        robot_.places.resize(robot_.links.size());
        robot_.places[body] = place;
    }
    for (std::size_t k = 0; k < joints.size(); ++k)
        add_joint(joints[k], name, k == 0 ? parent : links[k - 1], links[k], k == 0 ? place : RobotPose{},
                  joints.size());
    return body;
}

void MjcfJoints::add_joint(const MjcfParts::Part& part, const std::string& body, std::size_t from, std::size_t to,
                           const RobotPose& place, std::size_t count) {
    const XMLElement& at = *part.at;
    const RobotMotion motion = motion_of(xml_, at);
    const char* given = at.Attribute("name");
    const bool is_given = given && *given;
    const std::string name = is_given     ? part.scope.name(given)
                             : count == 1 ? body + "_joint"
                                          : fmt::format("{}_joint{}", body, ++unnamed_);
    if (motion == RobotMotion::free && (from != RobotJoint::world || count != 1))
        xml_.fail(
            at,
            fmt::format("is a free joint of the body \"{}\", which is not a child of the world or has other joints",
                        one_line(body, 60)),
            "a free joint must be the only joint of a child of the world");
    RobotJoint& joint = add(at, name, is_given, motion, from, to, place);
    if (motion == RobotMotion::revolute || motion == RobotMotion::prismatic) {
        Vector3<Wide> axis{Wide(0), Wide(0), Wide(1)};
        if (at.Attribute("axis")) axis = cast<Wide>(three_of(xml_.attribute(at, "axis", 3)));
        if (axis == Vector3<Wide>()) xml_.fail(at, "has a zero axis", "give a direction");
        joint.axes[0] = rotate(part.scope.pose.turn, axis);
    }
    if (motion != RobotMotion::free) {
        Vector3<Wide> point;
        if (at.Attribute("pos")) point = cast<Wide>(three_of(xml_.attribute(at, "pos", 3)));
        joint.point = part.scope.pose * point;
    }
    if (std::string_view(at.Name()) == "joint") read_forces(at, part.scope.model->compiler, robot_.joints.size() - 1);
}

// The linear coefficient. MuJoCo 3 accepts two more, for the square and the cube.
double MjcfJoints::leading(const XMLElement& at, const char* name, const std::string& joint) {
    const char* text = at.Attribute(name);
    if (!text) return 0;
    const std::vector<double> v = xml_.numbers(at, name, text, 1, 3);
    if (std::any_of(v.begin() + 1, v.end(), [](double x) { return x != 0; }))
        omit("nonlinear terms of joint springs and dampers", joint);
    return v[0];
}

void MjcfJoints::read_forces(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index) {
    const std::string name = robot_.joints[index].name;
    armature_[index] = xml_.attribute_or(at, "armature", 0);
    if (armature_[index] < 0) xml_.fail(at, "has a negative armature", "give an inertia >= 0");
    if (robot_.joints[index].motion != RobotMotion::free)
        robot_.joints[index].armature[0] = Wide(armature_[index]);
    else if (armature_[index] != 0)
        omit("armature of free joints", name);
    const bool in_degrees = compiler.in_degrees && robot_.joints[index].motion == RobotMotion::revolute;
    references_[index] = in_radians(xml_.attribute_or(at, "ref", 0), in_degrees);
    const double stiffness = leading(at, "stiffness", name), damping = leading(at, "damping", name);
    read_laws(at, compiler, index);
    if (at.Attribute("springdamper")) {
        const std::vector<double> v = xml_.attribute(at, "springdamper", 2);
        if (v[0] != 0 || v[1] != 0) {
            if (!(v[0] > 0 && v[1] > 0))
                xml_.fail(at, "has a springdamper that is not positive", "give two numbers > 0, or 0 0");
            springdampers_.push_back({&at, index, Wide(v[0]), Wide(v[1]), Wide(0), Wide(0)});
            compilers_.push_back(&compiler);
            return;
        }
    }
    set_forces(at, compiler, index, Wide(stiffness), Wide(damping));
}

void MjcfJoints::read_laws(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index) {
    RobotJoint& joint = robot_.joints[index];
    if (joint.motion != RobotMotion::revolute && joint.motion != RobotMotion::prismatic) return;
    joint.friction[0] = xml_.attribute_or(at, "frictionloss", 0);
    if (!at.Attribute("range") || !has_mjcf_limits(at)) return;
    const std::vector<double> range = xml_.attribute(at, "range", 2);
    const bool in_degrees = compiler.in_degrees && joint.motion == RobotMotion::revolute;
    const Wide& ref = references_[index];
    joint.limits[0] = {double(in_radians(range[0], in_degrees) - ref), double(in_radians(range[1], in_degrees) - ref),
                       0};
}

void MjcfJoints::set_forces(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index,
                            const Wide& stiffness, const Wide& damping) {
    RobotJoint& joint = robot_.joints[index];
    const bool pulls = springs_ && !(stiffness == Wide(0));
    if (dampers_) joint.damping[0] = damping;
    if (joint.motion == RobotMotion::free) {
        joint.damping[0] = Wide(0);
        if (dampers_ && !(damping == Wide(0)))
            robot_.free_damping.push_back({joint.child, double(damping), double(damping)});
        if (pulls) omit("springs of free joints", joint.name);
    } else if (joint.motion == RobotMotion::spherical) {
        if (pulls) omit("springs of ball joints", joint.name);
    } else if (pulls) {
        const bool in_degrees = compiler.in_degrees && joint.motion == RobotMotion::revolute;
        joint.stiffness[0] = stiffness;
        joint.rest[0] = in_radians(xml_.attribute_or(at, "springref", 0), in_degrees) - references_[index];
    }
}

void MjcfJoints::align(std::size_t link) {
    const std::optional<MassProperties<Wide>>& mass = robot_.links[link].mass;
    for (RobotJoint& joint : robot_.joints) {
        if (joint.child != link || joint.motion != RobotMotion::free || !mass) continue;
        if (std::none_of(robot_.free_damping.begin(), robot_.free_damping.end(),
                         [&](const Robot::FreeDamping& one) { return one.link == link; }))
            continue;
        joint.placement.position = joint.placement * mass->center;
        robot_.links[link].mass->center = {};
    }
}

void MjcfJoints::finish() {
    compute_springdampers(xml_, robot_, armature_, springdampers_);
    for (std::size_t i = 0; i < springdampers_.size(); ++i) {
        const MjcfSpringDamper& one = springdampers_[i];
        set_forces(*one.at, *compilers_[i], one.joint, one.stiffness, one.damping);
    }
    std::set<std::string> taken;
    for (const RobotJoint& joint : robot_.joints) taken.insert(joint.name);
    std::set<std::string> generated;
    for (const std::size_t i : generated_) {
        std::string& name = robot_.joints[i].name;
        if (names_.has(name) || !generated.insert(name).second) {
            while (taken.contains(name)) name += "_";
            taken.insert(name), generated.insert(name);
        }
    }
}

}  // namespace polhode
