// A user's own trajectories: judged as `polhode check` does, and made ready to be drawn.
#pragma once

#include <string>
#include <vector>

#include "check/convention.h"
#include "report/json_numbers.h"
#include "report/motions.h"
#include "scene/scene.h"

namespace polhode {

/// What became of the files.
struct CheckedTrajectories {
    Json list = Json::array();     ///< Check[] of src/report/page/source/data.ts
    std::vector<DrawnFile> drawn;  ///< the motions, one a file
};

/// Judges files of the scene, whose place among the folder's is given. Throws InputError where a file is at fault, and
/// NoTruth where there is none to judge by.
CheckedTrajectories check_trajectories(const Scene& scene, int place, const std::vector<std::string>& files,
                                       const Convention& convention);

}  // namespace polhode
