// Free bodies with locked degrees of freedom, as chains of joints to the world.
#pragma once

#include "scene/joint_chains.h"

namespace polhode {

/// Converts a free body with the member "locked" to the child of joints that leave the other degrees of freedom:
/// prismatic joints along world axes, then a spherical, revolute or fixed joint at the centre of mass. `locked`: the
/// list of "x", "y", "z" (world axes) and "rx", "ry", "rz" (body axes). Moves the initial state of the body to the
/// joints. Throws InputError, also if the initial velocity has a locked component.
JointChain lock_free_body(const JsonNode& locked, const std::string& place, NamedBody& body);

}  // namespace polhode
