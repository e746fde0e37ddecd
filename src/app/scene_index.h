// The catalogue of scenes as a page.
#pragma once

#include <string>

namespace polhode {

/// Markdown: a table with one row a built-in scene: name, about, duration, body (principal moments, symmetry), what it
/// turns about, loads, the system posed, what makes its truth, source. Then for each folder of scenes a section, with
/// such a table a family, in order of its parameter.
std::string scene_index();

}  // namespace polhode
