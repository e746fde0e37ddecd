// The errors of a file over time, drawn (`check --picture`).
#pragma once

#include "check/limits.h"
#include "check/report.h"
#include "figure/figure.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// A panel for each block that the file has: its error at some hundred of its samples, what is allowed, in the
/// attitude's panel the float64 and float32 floors, and the errors of an engine update of the catalogue for comparison:
/// the one that the file follows, or else gyroscopic_explicit at the file's own rate where its rows are evenly spaced.
/// Throws std::invalid_argument where the scene has no truth at these times.
Figure error_picture(const Scene& scene, const TrajectoryFile& file, const ErrorLimits& limits,
                     const CheckedFile& checked);

}  // namespace polhode
