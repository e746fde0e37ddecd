// The keys of experiment files.
#pragma once

#include "text/file_key.h"

namespace polhode {

/// All keys, grouped by object: "experiment", "settings", "range".
std::span<const FileKey> experiment_keys();

}  // namespace polhode
