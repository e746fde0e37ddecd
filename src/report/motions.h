// Motions for the page: the truth of each scene, and the solution by each method.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "check/convention.h"
#include "motion/trajectory.h"
#include "report/folder.h"
#include "report/json_numbers.h"

namespace polhode {

/// A user trajectory to be drawn beside the methods.
struct DrawnFile {
    std::string label;            ///< file name
    int scene = 0;                ///< index of the scene
    std::vector<Sample> samples;  ///< ordered by time, then by body
    int bodies = 1;
};

/// Result of make_motions().
struct Motions {
    Json list = Json::array();           ///< Motion[] of src/report/page/source/data.ts
    std::map<int, int> of_scene;         ///< index in the list, by index of the scene
    std::vector<int> of_file;            ///< index of each file in the `methods` of its scene's motion, or -1
    std::vector<std::string> omissions;  ///< one sentence per scene without a motion, with the reason
};

/// Solves each scene with every method that has rows for it in the directory, over at most about 15 revolutions (30 if
/// it has contacts, or joints with limits or friction), and reduces the motions to keyframes. Each method uses its
/// setting in the directory that is nearest to common use: a step of 0.1 rad of rotation, or a tolerance of 1e-6.
/// Scenes that differ only in duration share a motion. Uses `jobs` threads.
Motions make_motions(const ResultFolder& folder, const std::map<std::string, Scene>& scenes,
                     const std::vector<DrawnFile>& files, int jobs);

}  // namespace polhode
