// What `polhode check` found, for people and for machines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/diagnosis.h"
#include "check/judge.h"
#include "check/limits.h"
#include "figure/figure.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// What rounding of the initial data alone does to the attitude, at most (rad).
struct RoundingFloor {
    double float64 = 0, float32 = 0;
};

/// One file and what came of it.
struct CheckedFile {
    std::string path;
    std::size_t samples = 0;
    double from = 0, until = 0;  ///< s, of its samples
    Judgement judgement;
    double truth_bound = 0;
    std::string truth;                           ///< how the truth was made
    std::optional<RoundingFloor> floor;          ///< the largest up to the file's end; empty where it is not known
    std::vector<RoundingFloor> floor_over_time;  ///< up to the end of each span of the judgement, or empty
    std::optional<double> float_judged_until;    ///< s: beyond it binary32 rounding alone exceeds what is allowed
    std::vector<std::string> remarks;            ///< whole sentences
    std::string lacks;                           ///< the columns that the file does not have: "w", "p and v", ..
    Diagnosed diagnosed;
    std::optional<Figure> picture;       ///< its errors over time, where they were asked for
    std::optional<TrajectoryFile> file;  ///< its rows in our conventions, likewise
};

std::string check_text(const ErrorLimits& limits, const std::vector<CheckedFile>& all);
std::string check_json(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all);
/// What was tried to explain each file and what it left, the nearest first (`check --explain`).
std::string explanation_text(const std::vector<CheckedFile>& all);
/// A test case for each file, as continuous integration reads them.
std::string check_junit(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all);

}  // namespace polhode
