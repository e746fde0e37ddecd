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
    {"", "robot", "version", irrelevant, "versions 1.0 and 1.1 are read in the same way"},
    {"robot", "material", "", irrelevant, "appearance"},
    {"robot", "link", "", modelled, "a body"},
    {"robot", "link", "name", modelled, "the body's name"},
    {"robot", "link", "type", irrelevant, "a comment; the format defines no meaning"},
    {"link", "visual", "", irrelevant, "appearance"},
    {"link", "collision", "", omitted, "contact shapes of links"},
    {"link", "self_collision_checking", "", irrelevant, "contact is omitted as a whole"},
    {"link", "inertial", "", modelled, "mass properties; if missing, the link has no mass"},
    {"inertial", "origin", "", modelled, "centre of mass and axes of the tensor"},
    {"inertial", "origin", "xyz", modelled, "centre of mass, default 0"},
    {"inertial", "origin", "rpy", modelled, "axes of the tensor: roll, pitch, yaw about fixed axes"},
    {"inertial", "mass", "", modelled, "mass"},
    {"inertial", "mass", "value", modelled, "mass; 0 means a link without mass"},
    {"inertial", "inertia", "", modelled, "tensor about the centre of mass"},
    {"inertial", "inertia", "ixx", modelled, "tensor"},
    {"inertial", "inertia", "iyy", modelled, "tensor"},
    {"inertial", "inertia", "izz", modelled, "tensor"},
    {"inertial", "inertia", "ixy", modelled, "off-diagonal tensor entry (not the product of inertia)"},
    {"inertial", "inertia", "ixz", modelled, "off-diagonal tensor entry (not the product of inertia)"},
    {"inertial", "inertia", "iyz", modelled, "off-diagonal tensor entry (not the product of inertia)"},
    {"robot", "joint", "", modelled, "a joint"},
    {"robot", "joint", "name", modelled, "the joint's name"},
    {"robot", "joint", "type", modelled, "revolute, continuous, prismatic, planar, fixed, floating"},
    {"joint", "origin", "", modelled, "pose of the child in the parent at coordinate zero"},
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
    {"joint", "dynamics", "friction", partial, "joint friction", "0", has_friction},
    {"joint", "limit", "", partial, "joint limits", "", limits_motion},
    {"joint", "mimic", "", modelled, "a coupling of revolute and prismatic joints"},
    {"joint", "mimic", "joint", modelled, "the first joint of the coupling"},
    {"joint", "mimic", "multiplier", modelled, "ratio, default 1"},
    {"joint", "mimic", "offset", modelled, "offset, default 0"},
    {"joint", "calibration", "", irrelevant, "encoder calibration of a real machine"},
    {"joint", "safety_controller", "", irrelevant, "controller setting; the controller is not part of the file"},
    {"joint", "hardwareInterface", "", irrelevant, "controller setting; the controller is not part of the file"},
    {"robot", "gazebo", "", irrelevant, "Gazebo extensions; all except appearance are reported as omitted, by kind"},
    {"robot", "transmission", "", omitted, "transmissions"},
    {"robot", "ros2_control", "", irrelevant, "controller setting; the controller is not part of the file"},
    {"robot", "sensor", "", irrelevant, "a sensor does not affect the motion"},
    {"robot", "model_state", "", omitted, "model states"},
    {"robot", "group", "", irrelevant, "used by motion planners (SRDF)"},
    {"robot", "group_state", "", irrelevant, "used by motion planners (SRDF)"},
    {"robot", "end_effector", "", irrelevant, "used by motion planners (SRDF)"},
    {"robot", "disable_collisions", "", irrelevant, "used by motion planners (SRDF)"},
    {"robot", "mujoco", "", omitted, "MuJoCo settings"},
};

}  // namespace

std::span<const RobotConstruct> urdf_constructs() { return urdf_rows; }

}  // namespace polhode
