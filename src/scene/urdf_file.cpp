// Reads the links and joints of a URDF file.
#include <fmt/format.h>

#include <algorithm>

#include "scene/robot_parts.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

struct UrdfJointType {
    const char* name;
    RobotMotion motion;
};
constexpr UrdfJointType urdf_joint_types[] = {
    {"revolute", RobotMotion::revolute}, {"continuous", RobotMotion::revolute}, {"prismatic", RobotMotion::prismatic},
    {"fixed", RobotMotion::fixed},       {"floating", RobotMotion::free},       {"planar", RobotMotion::planar},
};

RobotMotion urdf_motion(const RobotXml& xml, const XMLElement& joint) {
    constexpr const char* types = "revolute, continuous, prismatic, planar, fixed or floating";
    const std::string type = xml.name(joint, "type", types);
    for (const UrdfJointType& one : urdf_joint_types)
        if (type == one.name) return one.motion;
    xml.fail(joint, fmt::format("has the type \"{}\"", one_line(type, 40)), fmt::format("give {}", types));
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

// Notes the kinds of elements inside <gazebo>, except those that affect only the appearance.
void note_gazebo(const XMLElement& gazebo, RobotNotes& omitted) {
    static constexpr std::string_view looks[] = {"material", "visual"};
    for (const XMLElement* one = gazebo.FirstChildElement(); one; one = one->NextSiblingElement())
        if (std::ranges::find(looks, one->Name()) == std::end(looks))
            omitted["<gazebo>"].push_back(one_line(one->Name(), 40));
}

// Exporters write a mass of zero for massless links, often without a tensor.
std::optional<MassProperties<Wide>> urdf_mass(const RobotXml& xml, const XMLElement& link) {
    const XMLElement* inertial = xml.optional_child(link, "inertial");
    if (!inertial) return {};
    const bool has_mass = xml.attribute(xml.child(*inertial, "mass"), "value", 1)[0] != 0;
    if (!has_mass && !inertial->FirstChildElement("inertia")) return {};
    return mass_of(urdf_inertial(xml, *inertial));
}

class UrdfReader {
  public:
    explicit UrdfReader(const RobotXml& xml) : xml_(xml), links_(xml, "link"), joints_(xml, "joint") {}

    Robot read(const XMLElement& root) {
        for (const XMLElement* at = root.FirstChildElement("link"); at; at = at->NextSiblingElement("link"))
            read_link(*at);
        carrier_.resize(robot_.links.size());
        for (const XMLElement* at = root.FirstChildElement("joint"); at; at = at->NextSiblingElement("joint"))
            read_joint(*at);
        for (const XMLElement* at = root.FirstChildElement(); at; at = at->NextSiblingElement()) {
            const std::string_view tag = at->Name();
            if (tag == "gazebo") note_gazebo(*at, robot_.omitted);
            // without this joint its child would be fixed to the world, or free
            if (tag.ends_with(":joint"))
                xml_.fail(*at, fmt::format("\"{}\" is a joint type that is not part of URDF", name_or(*at, "")),
                          "use a joint type of URDF, or write the scene with \"bodies\" and \"joints\"");
        }
        survey_robot(xml_, root, urdf_constructs(), robot_.omitted);
        return std::move(robot_);
    }

  private:
    void read_link(const XMLElement& at) {
        RobotLink link;
        link.name = xml_.name(at, "name", "the link's name"), link.place = xml_.place_of(at);
        links_.add(at, link.name, robot_.links.size());
        link.mass = urdf_mass(xml_, at);
        robot_.links.push_back(std::move(link));
    }

    std::size_t parent_of(const XMLElement& at, const std::string& joint) {
        const XMLElement& parent = xml_.child(at, "parent");
        const std::string name = xml_.name(parent, "link", "a link's name");
        if (name == "world" && !links_.has(name)) {
            robot_.assumed["joints with parent \"world\" but no link of that name, connected to the world"].push_back(
                joint);
            return RobotJoint::world;
        }
        return links_.find(parent, name);
    }

    void read_joint(const XMLElement& at) {
        RobotJoint joint;
        joint.name = xml_.name(at, "name", "the joint's name"), joint.place = xml_.place_of(at);
        joints_.add(at, joint.name, robot_.joints.size());
        joint.motion = urdf_motion(xml_, at);
        joint.parent = parent_of(at, joint.name);
        const XMLElement& child = xml_.child(at, "child");
        joint.child = links_.find(child, xml_.name(child, "link", "a link's name"));
        if (!carrier_[joint.child].empty())
            xml_.fail(child,
                      fmt::format("makes \"{}\" the child of joint \"{}\", but it is already the child of \"{}\"",
                                  one_line(robot_.links[joint.child].name, 60), one_line(joint.name, 60),
                                  one_line(carrier_[joint.child], 60)),
                      "make each link the child of one joint, and close chains by \"loops\" in the scene");
        carrier_[joint.child] = joint.name;
        joint.placement = urdf_origin(xml_, at);
        const bool has_axis = joint.motion == RobotMotion::revolute || joint.motion == RobotMotion::prismatic;
        if (has_axis || joint.motion == RobotMotion::planar) joint.axes[0] = urdf_axis(xml_, at);
        if (const XMLElement* dynamics = xml_.optional_child(at, "dynamics")) {
            const double damping = xml_.attribute_or(*dynamics, "damping", 0);
            const double friction = xml_.attribute_or(*dynamics, "friction", 0);
            if (has_axis) joint.damping[0] = Wide(damping), joint.friction[0] = friction;
            // the format does not define them for several degrees of freedom
            if ((joint.motion == RobotMotion::free || joint.motion == RobotMotion::planar) &&
                (damping != 0 || friction != 0))
                robot_.omitted["damping and friction of floating and planar joints"].push_back(joint.name);
        }
        const std::string_view type = at.Attribute("type") ? at.Attribute("type") : "";
        if (const XMLElement* limit = xml_.optional_child(at, "limit"); limit && has_axis && type != "continuous") {
            const auto bound = [&](const char* name) {
                const char* text = limit->Attribute(name);
                return text ? parse_decimal(text).value_or(0) : 0;
            };
            const double lower = bound("lower"), upper = bound("upper");
            if (lower < upper) joint.limits[0] = {lower, upper, 0};
        }
        if (const XMLElement* mimic = xml_.optional_child(at, "mimic"); mimic && has_axis)
            robot_.couplings.push_back({xml_.name(*mimic, "joint", "a joint's name"), joint.name,
                                        xml_.attribute_or(*mimic, "multiplier", 1),
                                        xml_.attribute_or(*mimic, "offset", 0)});
        robot_.joints.push_back(std::move(joint));
    }

    const RobotXml& xml_;
    RobotNames links_, joints_;
    std::vector<std::string> carrier_;  // name of the joint that carries each link
    Robot robot_;
};

}  // namespace

LinkInertial urdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link) {
    return urdf_inertial(xml, xml.child(named_element(xml, root, "link", link), "inertial"));
}

Robot urdf_robot(const RobotXml& xml, const XMLElement& root) { return UrdfReader(xml).read(root); }

}  // namespace polhode
