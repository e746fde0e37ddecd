// The table of the elements and attributes of SDFormat 1.3 to 1.12, and how the importer treats each.
//
// Rules that depend on the version, and the shapes refused for computed inertia, are in the reader. Elements below an
// irrelevant or omitted one share its verdict.
#include <tinyxml2.h>

#include <cmath>
#include <optional>
#include <string_view>

#include "scene/robot_schema.h"
#include "text/decimal.h"

namespace polhode {
namespace {

using enum RobotVerdict;

// <lower>, <upper> of joints: only some joint types have limits, and 1e16 or more means no limit
bool bounds_a_joint(const XMLElement& at) {
    const XMLElement* joint = &at;
    while (joint && std::string_view(joint->Name()) != "joint")
        joint = joint->Parent() ? joint->Parent()->ToElement() : nullptr;
    const char* type = joint ? joint->Attribute("type") : nullptr;
    for (const char* without : {"continuous", "fixed", "ball"})
        if (type && std::string_view(type) == without) return false;
    const std::string_view text = at.GetText() ? at.GetText() : "";
    const std::size_t first = text.find_first_not_of(" \t\r\n"), last = text.find_last_not_of(" \t\r\n");
    if (first == std::string_view::npos) return false;
    const std::string_view word = text.substr(first, last - first + 1);
    if (word.ends_with("inf") || word.ends_with("Inf") || word.ends_with("INF")) return false;
    const std::optional<double> bound = parse_decimal(word);
    return !bound || std::abs(*bound) < 1e16;
}
// <velocity> of limits: a negative value means no limit
bool bounds_a_rate(const XMLElement& at) {
    const std::string_view text = at.GetText() ? at.GetText() : "";
    return text.find('-') == std::string_view::npos && bounds_a_joint(at);
}
bool has_plugin(const XMLElement& at) { return at.FirstChildElement("plugin"); }
bool has_children(const XMLElement& at) { return at.FirstChildElement(); }

constexpr std::string_view no = "false|False|FALSE|0";
constexpr std::string_view contact_alone = "affects only contact, which is reported as omitted";
constexpr std::string_view not_seen = "appearance";
constexpr std::string_view by_refusal = "belongs to a joint type that is refused";
constexpr std::string_view solver_setting = "solver setting of an engine";
constexpr std::string_view no_volume = "affects only contact; refused where inertia is computed";

constexpr RobotConstruct sdf_rows[] = {
    {"", "sdf", "", modelled, "the root element"},
    {"", "sdf", "version", modelled, "the rules for axes, frames and names"},
    {"sdf", "world", "", modelled, "frames, models, joints and gravity"},
    {"sdf", "world", "name", irrelevant, "a name"},
    {"sdf", "actor", "", irrelevant, "moves by a script and affects only contact"},
    {"sdf", "light", "", irrelevant, not_seen},
    // poses
    {"*", "pose", "", modelled, "the pose of a frame"},
    {"*", "pose", "relative_to", modelled, "the frame of a pose"},
    {"*", "pose", "frame", modelled, "the frame of a pose before 1.7"},
    {"*", "pose", "degrees", modelled, "the unit of angles"},
    {"*", "pose", "rotation_format", modelled, "angles or a quaternion"},
    {"*", "frame", "", omitted, "frames of elements other than models and worlds"},
    {"model", "frame", "", modelled, "a frame"},
    {"model", "frame", "name", modelled, "the frame's name"},
    {"model", "frame", "attached_to", modelled, "what the frame moves with"},
    {"world", "frame", "", modelled, "a frame"},
    {"world", "frame", "name", modelled, "the frame's name"},
    {"world", "frame", "attached_to", modelled, "what the frame moves with"},
    // worlds
    {"world", "gravity", "", modelled, "gravity"},
    {"world", "physics", "", modelled, "gravity before 1.6"},
    {"world", "physics", "type", irrelevant, "the engine"},
    {"world", "physics", "name", irrelevant, "a name"},
    {"world", "physics", "default", modelled, "which <physics> gives gravity before 1.6"},
    {"physics", "gravity", "", modelled, "gravity before 1.6"},
    {"physics", "magnetic_field", "", irrelevant, "affects only sensors"},
    {"physics", "update_rate", "", irrelevant, solver_setting},
    {"physics", "max_step_size", "", irrelevant, solver_setting},
    {"physics", "real_time_factor", "", irrelevant, solver_setting},
    {"physics", "real_time_update_rate", "", irrelevant, solver_setting},
    {"physics", "max_contacts", "", irrelevant, contact_alone},
    {"physics", "bullet", "", irrelevant, solver_setting},
    {"physics", "dart", "", irrelevant, solver_setting},
    {"physics", "simbody", "", irrelevant, solver_setting},
    {"physics", "ode", "", modelled, "settings of joints in ODE"},
    {"ode", "solver", "", irrelevant, solver_setting},
    {"ode", "constraints", "", irrelevant, solver_setting},
    {"world", "wind", "", modelled, "wind"},
    {"wind", "linear_velocity", "", omitted, "wind", "0"},
    {"world", "state", "", omitted, "<state> of worlds"},
    {"world", "population", "", omitted, "populations of models"},
    {"world", "actor", "", irrelevant, "moves by a script and affects only contact"},
    {"world", "atmosphere", "", irrelevant, "affects only plugins"},
    {"world", "audio", "", irrelevant, "sound"},
    {"world", "gui", "", irrelevant, not_seen},
    {"world", "light", "", irrelevant, not_seen},
    {"world", "magnetic_field", "", irrelevant, "affects only sensors"},
    {"world", "road", "", irrelevant, not_seen},
    {"world", "scene", "", irrelevant, not_seen},
    {"world", "spherical_coordinates", "", irrelevant, "affects only sensors"},
    {"*", "plugin", "", omitted, "<plugin>"},
    // models
    {"*", "model", "", modelled, "links and joints"},
    {"*", "model", "name", modelled, "the model's name"},
    {"*", "model", "namespace", irrelevant, "namespace of messages"},
    {"*", "model", "canonical_link", modelled, "what the model's frame moves with"},
    {"*", "model", "placement_frame", modelled, "the frame that the model's pose places"},
    {"model", "static", "", modelled, "the links become part of the world"},
    {"model", "self_collide", "", irrelevant, contact_alone},
    {"model", "allow_auto_disable", "", irrelevant, solver_setting},
    {"model", "enable_wind", "", omitted, "links in the wind", no},
    {"model", "gripper", "", omitted, "<gripper>"},
    {"*", "model_state", "", omitted, "<model_state>"},
    {"*", "include", "", modelled, "a model from another file"},
    {"*", "include", "merge", modelled, "a model merged into the enclosing scope"},
    {"include", "uri", "", modelled, "the file"},
    {"include", "name", "", modelled, "the model's name"},
    {"include", "namespace", "", irrelevant, "namespace of messages"},
    {"include", "static", "", modelled, "the links become part of the world"},
    {"include", "placement_frame", "", modelled, "the frame that the pose places"},
    // links
    {"model", "link", "", modelled, "a link"},
    {"model", "link", "name", modelled, "the link's name"},
    {"link", "gravity", "", partial, "links without gravity", "true|True|TRUE|1"},
    {"link", "enable_wind", "", omitted, "links in the wind", no},
    {"link", "self_collide", "", irrelevant, contact_alone},
    {"link", "kinematic", "", omitted, "kinematic links", no},
    {"link", "must_be_base_link", "", irrelevant, solver_setting},
    {"link", "velocity_decay", "", modelled, "velocity decay"},
    {"velocity_decay", "linear", "", omitted, "velocity decay of links", "0"},
    {"velocity_decay", "angular", "", omitted, "velocity decay of links", "0"},
    {"link", "audio_sink", "", irrelevant, "sound"},
    {"link", "audio_source", "", irrelevant, "sound"},
    {"link", "battery", "", irrelevant, "affects only plugins"},
    {"link", "light", "", irrelevant, not_seen},
    {"link", "particle_emitter", "", irrelevant, not_seen},
    {"link", "projector", "", irrelevant, not_seen},
    {"*", "sensor", "", omitted, "plugins of sensors", "", has_plugin},
    {"link", "visual", "", irrelevant, not_seen},
    {"link", "inertial", "", modelled, "mass properties"},
    {"link", "inertial", "auto", modelled, "whether mass properties are computed from collisions"},
    {"inertial", "mass", "", modelled, "the mass"},
    {"inertial", "density", "", modelled, "the density of collisions"},
    {"*", "auto_inertia_params", "", omitted, "parameters of an inertia calculator", "", has_children},
    {"inertial", "fluid_added_mass", "", omitted, "added mass of links", "", has_children},
    {"inertial", "inertia", "", modelled, "the inertia tensor"},
    {"inertia", "ixx", "", modelled, "the inertia tensor"},
    {"inertia", "ixy", "", modelled, "the inertia tensor"},
    {"inertia", "ixz", "", modelled, "the inertia tensor"},
    {"inertia", "iyy", "", modelled, "the inertia tensor"},
    {"inertia", "iyz", "", modelled, "the inertia tensor"},
    {"inertia", "izz", "", modelled, "the inertia tensor"},
    // collisions
    {"link", "collision", "", modelled, "a shape for computed inertia; contact is reported as omitted"},
    {"link", "collision", "name", irrelevant, "a name"},
    {"collision", "density", "", modelled, "the density of the shape"},
    {"collision", "laser_retro", "", irrelevant, "affects only sensors"},
    {"collision", "max_contacts", "", irrelevant, contact_alone},
    {"collision", "surface", "", irrelevant, contact_alone},
    {"collision", "geometry", "", modelled, "a shape for computed inertia"},
    {"geometry", "box", "", modelled, "a shape"},
    {"geometry", "capsule", "", modelled, "a shape"},
    {"geometry", "cone", "", modelled, "a shape"},
    {"geometry", "cylinder", "", modelled, "a shape"},
    {"geometry", "ellipsoid", "", modelled, "a shape"},
    {"geometry", "sphere", "", modelled, "a shape"},
    {"geometry", "empty", "", irrelevant, no_volume},
    {"geometry", "heightmap", "", irrelevant, no_volume},
    {"geometry", "image", "", irrelevant, no_volume},
    {"geometry", "plane", "", irrelevant, no_volume},
    {"geometry", "polyline", "", irrelevant, no_volume},
    {"geometry", "mesh", "", modelled, "a shape"},
    {"geometry", "mesh", "optimization", irrelevant, contact_alone},
    {"box", "size", "", modelled, "lengths"},
    {"*", "radius", "", modelled, "a length"},
    {"*", "length", "", modelled, "a length"},
    {"ellipsoid", "radii", "", modelled, "lengths"},
    {"mesh", "uri", "", modelled, "the file"},
    {"mesh", "scale", "", modelled, "lengths"},
    {"mesh", "submesh", "", modelled, "refused where inertia is computed"},
    {"submesh", "name", "", modelled, "refused where inertia is computed"},
    {"submesh", "center", "", modelled, "refused where inertia is computed"},
    {"mesh", "convex_decomposition", "", irrelevant, contact_alone},
    // joints
    {"*", "joint", "", modelled, "a joint"},
    {"*", "joint", "name", modelled, "the joint's name"},
    {"*", "joint", "type", modelled, "the joint's type"},
    {"joint", "parent", "", modelled, "the link, frame or model that the joint connects"},
    {"joint", "child", "", modelled, "the link, frame or model that the joint connects"},
    {"joint", "gearbox_ratio", "", modelled, "the ratio of a coupling of two hinges of the reference body"},
    {"joint", "gearbox_reference_body", "", modelled, "the body that both hinges belong to"},
    {"joint", "thread_pitch", "", modelled, "-2 pi / this is the pitch of a screw, m per revolution"},
    {"joint", "screw_thread_pitch", "", modelled, "the pitch of a screw, m per revolution, default 1"},
    {"joint", "axis", "", modelled, "the first axis"},
    {"joint", "axis2", "", modelled, "the second axis"},
    {"*", "xyz", "", modelled, "the axis"},
    {"*", "xyz", "expressed_in", modelled, "the frame of the axis"},
    {"*", "use_parent_model_frame", "", modelled, "the frame of the axis in 1.5 and 1.6"},
    {"*", "initial_position", "", modelled, "the coordinate at t = 0"},
    {"*", "mimic", "", modelled, "a coupling of revolute and prismatic joints"},
    {"*", "mimic", "joint", modelled, "the first joint of the coupling"},
    {"*", "mimic", "axis", modelled, "axis; mimic joints of axis2 are reported as omitted"},
    {"mimic", "multiplier", "", modelled, "ratio, default 1"},
    {"mimic", "offset", "", modelled, "offset, default 0"},
    {"mimic", "reference", "", modelled, "coordinate of the first joint at the offset, default 0"},
    {"*", "dynamics", "", modelled, "springs and dampers"},
    {"dynamics", "damping", "", modelled, "a damper"},
    {"dynamics", "friction", "", partial, "joint friction", "0"},
    {"dynamics", "spring_reference", "", modelled, "a spring"},
    {"dynamics", "spring_stiffness", "", modelled, "a spring"},
    {"*", "limit", "", modelled, "limits"},
    {"limit", "lower", "", partial, "joint limits", "", bounds_a_joint},
    {"limit", "upper", "", partial, "joint limits", "", bounds_a_joint},
    {"limit", "velocity", "", omitted, "joint velocity limits", "", bounds_a_rate},
    {"limit", "effort", "", irrelevant, "limits actuators, which are not part of the file"},
    {"limit", "stiffness", "", irrelevant, "softness of joint limits"},
    {"limit", "dissipation", "", irrelevant, "softness of joint limits"},
    {"limit", "cfm", "", irrelevant, "a parameter of ODE's solver"},
    {"limit", "erp", "", irrelevant, "a parameter of ODE's solver"},
    {"joint", "physics", "", modelled, "settings of joints in ODE"},
    {"physics", "provide_feedback", "", irrelevant, "measures"},
    {"ode", "provide_feedback", "", irrelevant, "measures"},
    {"ode", "cfm_damping", "", irrelevant, solver_setting},
    {"ode", "implicit_spring_damper", "", irrelevant, solver_setting},
    {"ode", "fudge_factor", "", irrelevant, solver_setting},
    {"ode", "cfm", "", omitted, "joint softness (cfm)", "0"},
    {"ode", "erp", "", irrelevant, solver_setting},
    {"ode", "bounce", "", irrelevant, "softness of joint limits"},
    {"ode", "max_force", "", omitted, "joint motors (max_force)", "0"},
    {"ode", "velocity", "", irrelevant, "affects only max_force, which is reported as omitted"},
    {"ode", "limit", "", irrelevant, "softness of joint limits"},
    {"ode", "suspension", "", irrelevant, by_refusal},
};

}  // namespace

std::span<const RobotConstruct> sdf_constructs() { return sdf_rows; }

}  // namespace polhode
