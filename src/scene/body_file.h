// Reader and writer of a body in scene files.
#pragma once

#include <string>

#include "scene/body_source.h"
#include "text/json_document.h"

namespace polhode {

/// Parses the body at `node`. Files named in it are relative to `directory`. Throws InputError.
Body parse_body(const JsonNode& node, const std::string& directory);

/// The members of the body's object as canonical JSON, "\"key\": value, ..". parse_body() reads them back.
std::string write_body(const Body& body);

}  // namespace polhode
