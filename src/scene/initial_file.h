// How a body starts, in scene files.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// "body" or "world". Throws InputError.
Frame parse_frame(const JsonNode& node);
/// The frame as a JSON string.
std::string write_frame(Frame frame);

/// What the object at `node` alters in `start`; of a pivoted body neither position nor velocity. Throws InputError.
Initial parse_initial(const JsonNode& node, bool pivoted, Initial start = {});
/// The members as canonical JSON, each behind `separator`; without position and velocity if pivoted.
std::string write_initial(const Initial& initial, bool pivoted, const char* separator);

}  // namespace polhode
