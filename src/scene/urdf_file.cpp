// Whole robots of URDF.
#include <fmt/format.h>

#include "scene/robot_parts.h"
#include "text/message.h"

namespace polhode {
namespace {

struct UrdfJointType {
    const char* name;
    RobotMotion motion;
};
constexpr UrdfJointType urdf_joint_types[] = {
    {"revolute", RobotMotion::revolute}, {"continuous", RobotMotion::revolute}, {"prismatic", RobotMotion::prismatic},
    {"fixed", RobotMotion::fixed},       {"floating", RobotMotion::free},
};

RobotMotion urdf_motion(const RobotXml& xml, const XMLElement& joint) {
    const std::string type = xml.name(joint, "type", "revolute, continuous, prismatic, fixed or floating");
    for (const UrdfJointType& one : urdf_joint_types)
        if (type == one.name) return one.motion;
    if (type == "planar")
        xml.fail(joint, "is a planar joint",
                 "give two prismatic joints and a revolute one, with links of some mass between");
    xml.fail(joint, fmt::format("has the type \"{}\"", one_line(type, 40)),
             "give revolute, continuous, prismatic, fixed or floating");
}

RobotPose urdf_origin(const RobotXml& xml, const XMLElement& of) {
    RobotPose pose;
    const XMLElement* origin = xml.optional_child(of, "origin");
    if (!origin) return pose;
    if (origin->Attribute("xyz")) pose.position = cast<Wide>(three_of(xml.attribute(*origin, "xyz", 3)));
    if (origin->Attribute("rpy"))
        pose.turn = unit_quaternion<Wide>(roll_pitch_yaw(three_of(xml.attribute(*origin, "rpy", 3)), false));
    return pose;
}

Vector3<Wide> urdf_axis(const RobotXml& xml, const XMLElement& joint) {
    const XMLElement* given = xml.optional_child(joint, "axis");
    if (!given) return {Wide(1), Wide(0), Wide(0)};
    const Vector3<Wide> axis = cast<Wide>(three_of(xml.attribute(*given, "xyz", 3)));
    if (axis == Vector3<Wide>()) xml.fail(*given, "is zero", "give a direction");
    return axis;
}

void urdf_left_out(const XMLElement& joint, const std::string& name, RobotNotes& left_out) {
    if (const XMLElement* limit = joint.FirstChildElement("limit"); limit) left_out["limits of joints"].push_back(name);
    if (joint.FirstChildElement("mimic")) left_out["mimicry of joints"].push_back(name);
    if (const XMLElement* dynamics = joint.FirstChildElement("dynamics");
        dynamics && dynamics->DoubleAttribute("friction") != 0)
        left_out["friction of joints"].push_back(name);
}

}  // namespace

LinkInertial urdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link) {
    return urdf_inertial(xml, xml.child(named_element(xml, root, "link", link), "inertial"));
}

Robot urdf_robot(const RobotXml& xml, const XMLElement& root) {
    Robot robot;
    RobotNames links(xml, "link"), joints(xml, "joint");
    for (const XMLElement* at = root.FirstChildElement("link"); at; at = at->NextSiblingElement("link")) {
        RobotLink link;
        link.name = xml.name(*at, "name", "the link's name"), link.place = xml.place_of(*at);
        links.add(*at, link.name, robot.links.size());
        if (at->FirstChildElement("collision")) robot.omitted["shapes for contact of links"].push_back(link.name);
        if (const XMLElement* inertial = xml.optional_child(*at, "inertial")) {
            // some exporters write a mass of zero where there is none
            const XMLElement* mass = xml.optional_child(*inertial, "mass");
            if (!mass || xml.attribute(*mass, "value", 1)[0] != 0) link.mass = mass_of(urdf_inertial(xml, *inertial));
        }
        robot.links.push_back(std::move(link));
    }
    std::vector<bool> carried(robot.links.size());
    for (const XMLElement* at = root.FirstChildElement("joint"); at; at = at->NextSiblingElement("joint")) {
        RobotJoint joint;
        joint.name = xml.name(*at, "name", "the joint's name"), joint.place = xml.place_of(*at);
        joints.add(*at, joint.name, robot.joints.size());
        joint.motion = urdf_motion(xml, *at);
        const XMLElement &parent = xml.child(*at, "parent"), &child = xml.child(*at, "child");
        joint.parent = links.find(parent, xml.name(parent, "link", "a link's name"));
        joint.child = links.find(child, xml.name(child, "link", "a link's name"));
        if (carried[joint.child])
            xml.fail(
                child,
                fmt::format("is a second joint's that carries \"{}\"", one_line(robot.links[joint.child].name, 60)),
                "a robot is a tree: give each link one joint, and close chains by \"loops\" in the scene");
        carried[joint.child] = true;
        joint.placement = urdf_origin(xml, *at);
        if (joint.motion == RobotMotion::revolute || joint.motion == RobotMotion::prismatic)
            joint.axes[0] = urdf_axis(xml, *at);
        if (const XMLElement* dynamics = xml.optional_child(*at, "dynamics"))
            joint.damping[0] = Wide(xml.attribute_or(*dynamics, "damping", 0));
        urdf_left_out(*at, joint.name, robot.omitted);
        robot.joints.push_back(std::move(joint));
    }
    for (const XMLElement* at = root.FirstChildElement(); at; at = at->NextSiblingElement()) {
        const std::string_view tag = at->Name();
        if (tag != "link" && tag != "joint" && tag != "material")
            robot.omitted[fmt::format("<{}>", one_line(tag, 40))].push_back(name_or(*at, ""));
    }
    return robot;
}

}  // namespace polhode
