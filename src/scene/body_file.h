// The body of a scene file: given as numbers or by what it is made of.
#pragma once

#include <string>

#include "scene/body_source.h"
#include "text/json_document.h"

namespace polhode {

/// The body that the object at `node` describes; the files it names are relative to `directory`. Throws InputError.
Body parse_body(const JsonNode& node, const std::string& directory);

/// The object's members as canonical JSON, "\"key\": value, ..": what parse_body reads back.
std::string write_body(const Body& body);

}  // namespace polhode
