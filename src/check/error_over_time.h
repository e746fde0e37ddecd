// One error of a trajectory file at each of its times.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// The error of a measure over a file's times.
struct ErrorOverTime {
    std::vector<double> t;      ///< s
    std::vector<double> error;  ///< as the measure has it; of several bodies the worst one's, where it is one body's
    std::string fault;          ///< empty, or why there is no truth to measure against
};

/// The error of `file`, which is in our conventions, in the measure of that name (measures(), one that `check` tells).
/// Single bodies' files of more than some thousand rows are measured in binary64, which resolves 1e-15, and where no
/// truth can be had at so many times or the bodies are several at 2000 times spread evenly; all else in 128 bits.
/// Throws InputError, with `name` for the file, where its columns do not tell what the measure is made of.
ErrorOverTime error_over_time(const Scene& scene, const TrajectoryFile& file, std::string_view measure,
                              const std::string& name);

}  // namespace polhode
