// Every key of an experiment file.
#pragma once

#include "text/file_key.h"

namespace polhode {

/// All, object by object: "experiment", "settings", "range".
std::span<const FileKey> experiment_keys();

}  // namespace polhode
