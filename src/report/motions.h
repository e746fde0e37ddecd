// The motions that the page draws: of each scene the truth and what every method makes of it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "check/convention.h"
#include "motion/trajectory.h"
#include "report/folder.h"
#include "report/json_numbers.h"

namespace polhode {

/// A trajectory of the user's own to be drawn beside the methods.
struct DrawnFile {
    std::string label;            ///< its file's name
    int scene = 0;                ///< the place of its scene's name
    std::vector<Sample> samples;  ///< by time and then by body
    int bodies = 1;
};

/// What became of the motions.
struct Motions {
    Json list = Json::array();          ///< Motion[] of src/report/page/source/data.ts
    std::map<int, int> of_scene;        ///< place in the list by the scene's place
    std::vector<int> of_file;           ///< of each file its place among the methods of its scene's motion, or -1
    std::vector<std::string> left_out;  ///< scenes without one and why, a sentence each
};

/// Solves each scene by every method that the folder has rows of it by, over at most some 15 revolutions, and thins
/// what comes out; of a method's settings at the one nearest to what people take: a tenth of a radian of turning a
/// step, a tolerance of 1e-6. Scenes that are the same but for their duration share a motion. `jobs` threads.
Motions make_motions(const ResultFolder& folder, const std::map<std::string, Scene>& scenes,
                     const std::vector<DrawnFile>& files, int jobs);

}  // namespace polhode
