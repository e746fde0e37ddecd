// Bodies with names, joints and loops, in scene files.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// What the members "bodies" and "joints", or "import", and "loops" of a scene's object say goes into `scene`, whose
/// directory is that of the files that bodies name. Throws InputError, also at the start of a body that a joint
/// carries.
void parse_mechanism(const JsonNode& root, Scene& scene);

/// The start that the object at `node` gives a joint: coordinate and rate, or orientation and angular velocity of a
/// spherical one, or `dependent`. Throws InputError.
void parse_joint_start(const JsonNode& node, Joint& joint);

/// The members "bodies", "joints" and "loops" as canonical JSON: lists in square brackets; empty ones as "".
std::string write_bodies(const Scene& scene);
std::string write_joints(const Scene& scene);
std::string write_loops(const Scene& scene);

/// "revolute", .., "fixed"; "spherical", .., "distance".
const char* name_of(JointType type);
const char* name_of(LoopType type);

}  // namespace polhode
