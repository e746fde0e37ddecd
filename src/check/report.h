// Results of `polhode check` as text, JSON and JUnit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/diagnosis.h"
#include "check/file_errors.h"
#include "check/limits.h"
#include "figure/figure.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Largest attitude error caused by rounding the initial data, rad.
struct RoundingFloor {
    double float64 = 0, float32 = 0;
};

/// The result of one file.
struct CheckedFile {
    std::string path;
    std::size_t samples = 0;
    double from = 0, until = 0;  ///< times of the first and last sample, s
    FileErrors file_errors;
    double truth_bound = 0;
    std::string truth;                           ///< how the truth was computed
    std::optional<RoundingFloor> floor;          ///< largest up to the end of the file; empty if not available
    std::vector<RoundingFloor> floor_over_time;  ///< up to the end of each span of `file_errors`, or empty
    std::optional<double> float32_valid_until;   ///< last time with the float32 floor within the limit, s
    std::vector<std::string> remarks;            ///< remarks, one line each
    std::string missing_blocks;                  ///< blocks that the file lacks: "position; velocity"
    FileDiagnosis diagnosis;
    std::optional<Figure> picture;       ///< errors over time, if requested
    std::optional<TrajectoryFile> file;  ///< rows in polhode's conventions, if requested
};

std::string check_text(const ErrorLimits& limits, const std::vector<CheckedFile>& all);
std::string check_json(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all);
/// The hypotheses tested for each file with their prediction errors, the best first (`check --explain`).
std::string explanation_text(const std::vector<CheckedFile>& all);
/// JUnit XML with one test case per file, for continuous integration.
std::string check_junit(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all);

}  // namespace polhode
