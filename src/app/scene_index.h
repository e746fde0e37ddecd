// The index of scenes.
#pragma once

#include <string>

namespace polhode {

/// Returns Markdown: a table with one row per built-in scene (name, about, duration, principal moments, symmetry, point
/// of reference, loads, the system posed, method of the truth, source). One section per directory of scenes follows,
/// with one table per family, ordered by its parameter.
std::string scene_index();

}  // namespace polhode
