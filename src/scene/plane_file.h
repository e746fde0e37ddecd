// Reader and writer of the planes of a scene.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Parses one element of "planes". Throws InputError.
Plane parse_plane(const JsonNode& node);

/// The plane as canonical JSON. Coefficients that have their default value 0, the default law and an empty name are
/// omitted.
std::string write_plane(const Plane& plane);

/// The name of the plane with this index for messages and tables: its own, or "plane 1" for the first.
std::string plane_name(const Scene& scene, std::size_t index);

/// The name of a law of restitution in scene files.
const char* name_of(RestitutionLaw law);

}  // namespace polhode
