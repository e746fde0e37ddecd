// The table of the elements and attributes of URDF, and how the importer treats each (ROS 1 and 2, urdfdom's schema,
// and tags of Gazebo, Drake and MoveIt found in such files).
#include <tinyxml2.h>

#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

bool is_joint_type(const XMLElement& at, std::string_view one, std::string_view other) {
    const tinyxml2::XMLElement* joint = at.Parent()->ToElement();
    const char* type = joint ? joint->Attribute("type") : nullptr;
    return type && (type == one || type == other);
}
bool limits_motion(const XMLElement& limit) { return is_joint_type(limit, "revolute", "prismatic"); }
bool is_floating(const XMLElement& dynamics) { return is_joint_type(dynamics, "floating", "planar"); }
bool has_friction(const XMLElement& dynamics) {
    return dynamics.DoubleAttribute("friction") != 0 && !is_floating(dynamics) && !is_joint_type(dynamics, "fixed", "");
}

constexpr RobotConstruct urdf_rows[] = {
    {"", "robot", "", modelled, "links and joints"},
    {"", "robot", "name", irrelevant, "a name"},
    {"", "robot", "version", irrelevant, "1.0 and 1.1 differ in nothing that is read"},
    {"robot", "material", "", irrelevant, "looks"},
    {"robot", "link", "", modelled, "a body"},
    {"robot", "link", "name", modelled, "the body's name"},
    {"robot", "link", "type", irrelevant, "a remark without meaning in the format"},
    {"link", "visual", "", irrelevant, "looks"},
    {"link", "collision", "", omitted, "shapes for contact of links"},
    {"link", "self_collision_checking", "", irrelevant, "contact is omitted as a whole"},
    {"link", "inertial", "", modelled, "mass properties; none: a link without mass"},
    {"inertial", "origin", "", modelled, "centre of mass, and axes of the tensor"},
    {"inertial", "origin", "xyz", modelled, "centre of mass, default 0"},
    {"inertial", "origin", "rpy", modelled, "axes of the tensor: roll, pitch, yaw about fixed axes"},
    {"inertial", "mass", "", modelled, "mass"},
    {"inertial", "mass", "value", modelled, "mass; 0: a link without mass"},
    {"inertial", "inertia", "", modelled, "tensor about the centre of mass"},
    {"inertial", "inertia", "ixx", modelled, "tensor"},
    {"inertial", "inertia", "iyy", modelled, "tensor"},
    {"inertial", "inertia", "izz", modelled, "tensor"},
    {"inertial", "inertia", "ixy", modelled, "tensor, the entry itself"},
    {"inertial", "inertia", "ixz", modelled, "tensor, the entry itself"},
    {"inertial", "inertia", "iyz", modelled, "tensor, the entry itself"},
    {"robot", "joint", "", modelled, "a joint"},
    {"robot", "joint", "name", modelled, "the joint's name"},
    {"robot", "joint", "type", modelled, "revolute, continuous, prismatic, fixed, floating; planar is refused"},
    {"joint", "origin", "", modelled, "place of the child in the parent at coordinate zero"},
    {"joint", "origin", "xyz", modelled, "position, default 0"},
    {"joint", "origin", "rpy", modelled, "roll, pitch, yaw about fixed axes, default 0"},
    {"joint", "parent", "", modelled, "the parent link"},
    {"joint", "parent", "link", modelled, "a link, or \"world\""},
    {"joint", "child", "", modelled, "the child link"},
    {"joint", "child", "link", modelled, "a link"},
    {"joint", "axis", "", modelled, "axis in the child's frame"},
    {"joint", "axis", "xyz", modelled, "direction, default (1, 0, 0)"},
    {"joint", "dynamics", "", modelled, "damping"},
    {"joint", "dynamics", "damping", modelled, "viscous damping of revolute and prismatic joints"},
    {"joint", "dynamics", "friction", omitted, "friction of joints", "0", has_friction},
    {"joint", "limit", "", omitted, "limits of joints", "", limits_motion},
    {"joint", "mimic", "", omitted, "mimic of joints"},
    {"joint", "calibration", "", irrelevant, "of a real machine's encoders"},
    {"joint", "safety_controller", "", irrelevant, "of a controller, which no file holds"},
    {"joint", "hardwareInterface", "", irrelevant, "of a controller, which no file holds"},
    {"robot", "gazebo", "", irrelevant, "extensions of Gazebo: the reader names their kinds as omitted, but for looks"},
    {"robot", "transmission", "", omitted, "transmissions"},
    {"robot", "ros2_control", "", irrelevant, "of a controller, which no file holds"},
    {"robot", "sensor", "", irrelevant, "measures, and does not act"},
    {"robot", "model_state", "", omitted, "states of the model"},
    {"robot", "group", "", irrelevant, "of a planner (SRDF)"},
    {"robot", "group_state", "", irrelevant, "of a planner (SRDF)"},
    {"robot", "end_effector", "", irrelevant, "of a planner (SRDF)"},
    {"robot", "disable_collisions", "", irrelevant, "of a planner (SRDF)"},
    {"robot", "mujoco", "", omitted, "settings of MuJoCo"},
};

}  // namespace

std::span<const RobotConstruct> urdf_constructs() { return urdf_rows; }

}  // namespace polhode
