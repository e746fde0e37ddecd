// Every key of a scene file.
#pragma once

#include "text/file_key.h"

namespace polhode {

/// All, object by object: "scene", "initial", "load gravity", .., "plane", "tolerated", "body", .., "shape box", ..
std::span<const FileKey> scene_keys();

}  // namespace polhode
