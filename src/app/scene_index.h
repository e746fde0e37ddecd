// The catalogue of scenes as a table.
#pragma once

#include "table/table.h"

namespace polhode {

/// One row a built-in scene: name, about, duration, body (principal moments, symmetry), what it turns about, loads, the
/// system posed, what makes its truth, source.
Table scene_index();

}  // namespace polhode
