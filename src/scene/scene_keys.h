// All keys of a scene file.
#pragma once

#include "text/file_key.h"

namespace polhode {

/// All keys by object: "scene", "initial", "load gravity", .., "plane", "tolerated", "body", .., "shape box", ..
std::span<const FileKey> scene_keys();

}  // namespace polhode
