// Reader and writer of named bodies, joints and loops in scene files.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Parses the members "bodies" and "joints", or "import", and "loops" of a scene's object into `scene`. Files named
/// by bodies are relative to the scene's directory. Throws InputError, also if a body that is the child of a joint
/// has an initial state.
void parse_mechanism(const JsonNode& root, Scene& scene);

/// Parses the initial state of a joint: coordinate and rate, or orientation and angular velocity of a spherical
/// joint, or `dependent`. Throws InputError.
void parse_joint_start(const JsonNode& node, Joint& joint);

/// Parses what belongs to the coordinate of a revolute or prismatic joint, all optional: initial, stiffness, rest,
/// damping, armature, friction, limits, motion. Throws InputError.
void parse_coordinate(const JsonNode& node, Joint& joint);

/// The members "bodies", "joints" and "loops" as canonical JSON arrays; empty arrays as "".
std::string write_bodies(const Scene& scene);
std::string write_joints(const Scene& scene);
std::string write_couplings(const Scene& scene);
std::string write_loops(const Scene& scene);

/// The name in scene files: "revolute", .., "fixed" for joints; "spherical", .., "distance" for loops.
const char* name_of(JointType type);
const char* name_of(LoopType type);

}  // namespace polhode
