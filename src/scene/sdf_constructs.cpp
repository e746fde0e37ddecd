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
constexpr std::string_view contact_alone = "acts in contact alone, which the import names";
constexpr std::string_view not_seen = "appearance";
constexpr std::string_view by_refusal = "of a joint type that is refused";
constexpr std::string_view solver_setting = "setting of an engine's solver";
constexpr std::string_view no_volume = "acts in contact alone; refused where inertia is computed";

constexpr RobotConstruct sdf_rows[] = {
    {"", "sdf", "", modelled, "the root element"},
    {"", "sdf", "version", modelled, "the rules for axes, frames and names"},
    {"sdf", "world", "", modelled, "frames, models, joints and gravity"},
    {"sdf", "world", "name", irrelevant, "a name"},
    {"sdf", "actor", "", irrelevant, "moves by a script and acts in contact alone"},
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
    {"physics", "magnetic_field", "", irrelevant, "acts on sensors alone"},
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
    {"world", "actor", "", irrelevant, "moves by a script and acts in contact alone"},
    {"world", "atmosphere", "", irrelevant, "acts on plugins alone"},
    {"world", "audio", "", irrelevant, "sound"},
    {"world", "gui", "", irrelevant, not_seen},
    {"world", "light", "", irrelevant, not_seen},
    {"world", "magnetic_field", "", irrelevant, "acts on sensors alone"},
    {"world", "road", "", irrelevant, not_seen},
    {"world", "scene", "", irrelevant, not_seen},
    {"world", "spherical_coordinates", "", irrelevant, "acts on sensors alone"},
    {"*", "plugin", "", omitted, "<plugin>"},
    // models
    {"*", "model", "", modelled, "links and joints"},
    {"*", "model", "name", modelled, "the model's name"},
    {"*", "model", "namespace", irrelevant, "of messages"},
    {"*", "model", "canonical_link", modelled, "what the model's frame moves with"},
    {"*", "model", "placement_frame", modelled, "the frame that the model's pose places"},
    {"model", "static", "", modelled, "links that are part of the world"},
    {"model", "self_collide", "", irrelevant, contact_alone},
    {"model", "allow_auto_disable", "", irrelevant, solver_setting},
    {"model", "enable_wind", "", omitted, "links in the wind", no},
    {"model", "gripper", "", omitted, "<gripper>"},
    {"*", "model_state", "", omitted, "<model_state>"},
    {"*", "include", "", modelled, "a model of another file"},
    {"*", "include", "merge", modelled, "a model without a scope of its own"},
    {"include", "uri", "", modelled, "the file"},
    {"include", "name", "", modelled, "the model's name"},
    {"include", "namespace", "", irrelevant, "of messages"},
    {"include", "static", "", modelled, "links that are part of the world"},
    {"include", "placement_frame", "", modelled, "the frame that the pose places"},
    // links
    {"model", "link", "", modelled, "a link"},
    {"model", "link", "name", modelled, "the link's name"},
    {"link", "gravity", "", omitted, "links without gravity", "true|True|TRUE|1"},
    {"link", "enable_wind", "", omitted, "links in the wind", no},
    {"link", "self_collide", "", irrelevant, contact_alone},
    {"link", "kinematic", "", omitted, "kinematic links", no},
    {"link", "must_be_base_link", "", irrelevant, solver_setting},
    {"link", "velocity_decay", "", modelled, "decay of velocity"},
    {"velocity_decay", "linear", "", omitted, "decay of velocity of links", "0"},
    {"velocity_decay", "angular", "", omitted, "decay of velocity of links", "0"},
    {"link", "audio_sink", "", irrelevant, "sound"},
    {"link", "audio_source", "", irrelevant, "sound"},
    {"link", "battery", "", irrelevant, "acts on plugins alone"},
    {"link", "light", "", irrelevant, not_seen},
    {"link", "particle_emitter", "", irrelevant, not_seen},
    {"link", "projector", "", irrelevant, not_seen},
    {"*", "sensor", "", omitted, "plugins of sensors", "", has_plugin},
    {"link", "visual", "", irrelevant, not_seen},
    {"link", "inertial", "", modelled, "mass properties"},
    {"link", "inertial", "auto", modelled, "mass properties from collisions"},
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
    {"link", "collision", "", modelled, "a shape for computed inertia; contact is named as omitted"},
    {"link", "collision", "name", irrelevant, "a name"},
    {"collision", "density", "", modelled, "the density of the shape"},
    {"collision", "laser_retro", "", irrelevant, "acts on sensors alone"},
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
    {"*", "joint", "type", modelled, "the joint's type; revolute2, screw and gearbox are refused"},
    {"joint", "parent", "", modelled, "what the joint ties"},
    {"joint", "child", "", modelled, "what the joint ties"},
    {"joint", "gearbox_ratio", "", irrelevant, by_refusal},
    {"joint", "gearbox_reference_body", "", irrelevant, by_refusal},
    {"joint", "thread_pitch", "", irrelevant, by_refusal},
    {"joint", "screw_thread_pitch", "", irrelevant, by_refusal},
    {"joint", "axis", "", modelled, "the first axis"},
    {"joint", "axis2", "", modelled, "the second axis"},
    {"*", "xyz", "", modelled, "the axis"},
    {"*", "xyz", "expressed_in", modelled, "the frame of the axis"},
    {"*", "use_parent_model_frame", "", modelled, "the frame of the axis in 1.5 and 1.6"},
    {"*", "initial_position", "", omitted, "initial_position of joints", "0"},
    {"*", "mimic", "", omitted, "mimicry of joints"},
    {"*", "dynamics", "", modelled, "springs and dampers"},
    {"dynamics", "damping", "", modelled, "a damper"},
    {"dynamics", "friction", "", omitted, "friction of joints", "0"},
    {"dynamics", "spring_reference", "", modelled, "a spring"},
    {"dynamics", "spring_stiffness", "", modelled, "a spring"},
    {"*", "limit", "", modelled, "limits"},
    {"limit", "lower", "", omitted, "limits of joints", "", bounds_a_joint},
    {"limit", "upper", "", omitted, "limits of joints", "", bounds_a_joint},
    {"limit", "velocity", "", omitted, "velocity limits of joints", "", bounds_a_rate},
    {"limit", "effort", "", irrelevant, "limits actuators, which are not modelled"},
    {"limit", "stiffness", "", irrelevant, "acts at limits alone, which are omitted"},
    {"limit", "dissipation", "", irrelevant, "acts at limits alone, which are omitted"},
    {"limit", "cfm", "", irrelevant, "a parameter of ODE's solver"},
    {"limit", "erp", "", irrelevant, "a parameter of ODE's solver"},
    {"joint", "physics", "", modelled, "settings of joints in ODE"},
    {"physics", "provide_feedback", "", irrelevant, "measures"},
    {"ode", "provide_feedback", "", irrelevant, "measures"},
    {"ode", "cfm_damping", "", irrelevant, solver_setting},
    {"ode", "implicit_spring_damper", "", irrelevant, solver_setting},
    {"ode", "fudge_factor", "", irrelevant, solver_setting},
    {"ode", "cfm", "", omitted, "softness of joints (cfm)", "0"},
    {"ode", "erp", "", irrelevant, solver_setting},
    {"ode", "bounce", "", irrelevant, "acts at limits alone, which are omitted"},
    {"ode", "max_force", "", omitted, "motors of joints (max_force)", "0"},
    {"ode", "velocity", "", irrelevant, "acts with max_force alone, which is named"},
    {"ode", "limit", "", irrelevant, "acts at limits alone, which are omitted"},
    {"ode", "suspension", "", irrelevant, by_refusal},
};

}  // namespace

std::span<const RobotConstruct> sdf_constructs() { return sdf_rows; }

}  // namespace polhode
