// Settings at which different methods need the same number of right-hand-side evaluations.
#pragma once

#include <string>

#include "experiment/plan/experiment.h"

namespace polhode {

struct Calibration {
    bool found = false;
    double setting = 0;   ///< a step (s) or a tolerance
    std::string message;  ///< the reason, if no setting was found
};

/// Finds the finest setting with which the method needs at most `evaluations` right-hand-side evaluations per
/// revolution, 2 pi / |w(0)|. Uses counts of short runs, so the result is the same on every machine. Finds nothing if
/// the method needs more evaluations at every tolerance.
Calibration calibrate(const Scene& scene, const Method& method, SettingKind kind, double evaluations);

/// Duration of a revolution at the start, 2 pi / |w(0)|, in s; infinite for a body at rest.
double revolution_time(const Scene& scene);

}  // namespace polhode
