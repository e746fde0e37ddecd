// Reader and writer of a body's initial state in scene files.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Parses "body" or "world". Throws InputError.
Frame parse_frame(const JsonNode& node);
/// The frame as a JSON string.
std::string write_frame(Frame frame);

/// Applies the members of the object at `node` to `start`. A pivoted body has neither position nor velocity. Throws
/// InputError.
Initial parse_initial(const JsonNode& node, bool pivoted, Initial start = {});
/// The members as canonical JSON, each followed by `separator`; without position and velocity if pivoted.
std::string write_initial(const Initial& initial, bool pivoted, const char* separator);

}  // namespace polhode
