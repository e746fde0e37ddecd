// Reader and writer of the members "parameters", "tables" and "let" of scene files.
#pragma once

#include <string>

#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// Parses the three members of the scene at `root`. Files of tables are relative to `directory`. Throws InputError.
void parse_formula_members(const JsonNode& root, const std::string& directory, Scene& scene);

/// The values of the three members as canonical JSON; empty for a member without entries.
std::string write_parameters(const Scene& scene);
std::string write_tables(const Scene& scene);
std::string write_let(const Scene& scene);

}  // namespace polhode
