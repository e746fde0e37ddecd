// User trajectories: compares them with the truth as `polhode check` does, and prepares them for drawing.
#pragma once

#include <string>
#include <vector>

#include "check/convention.h"
#include "report/json_numbers.h"
#include "report/motions.h"
#include "scene/scene.h"

namespace polhode {

/// Results of trajectory files.
struct CheckedTrajectories {
    Json list = Json::array();     ///< Check[] of src/report/page/source/data.ts
    std::vector<DrawnFile> drawn;  ///< motions, one per file
};

/// Compares trajectory files of `scene`, which has the index `place` in the directory's list, with the truth. Throws
/// InputError if a file is invalid, and TruthUnavailable if the truth is not available.
CheckedTrajectories check_trajectories(const Scene& scene, int place, const std::vector<std::string>& files,
                                       const Convention& convention);

}  // namespace polhode
