// Figure of the errors of a file over time (`check --picture`).
#pragma once

#include "check/limits.h"
#include "check/report.h"
#include "figure/figure.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// Draws one panel per block of the file: its error at up to 400 samples, its limit, and the errors of an update of
/// the catalogue for comparison. This update is the one that the file follows, or gyroscopic_explicit at the file's
/// own rate; it is drawn only if the rows are evenly spaced. The attitude's panel also shows the float64 and float32
/// floors. Throws std::invalid_argument if the scene has no truth at these times.
Figure error_picture(const Scene& scene, const TrajectoryFile& file, const ErrorLimits& limits,
                     const CheckedFile& checked);

}  // namespace polhode
