// Settings at which different methods cost the same.
#pragma once

#include <string>

#include "experiment/plan/experiment.h"

namespace polhode {

struct Calibration {
    bool found = false;
    double setting = 0;   ///< a step (s) or a tolerance
    std::string message;  ///< why none was found
};

/// The finest setting that spends at most `evaluations` right-hand sides a revolution, the revolution being
/// 2 pi / |w(0)|: found from short runs, by counts alone, so that it is the same on every machine. None where the
/// method costs more than that at every tolerance.
Calibration calibrate(const Scene& scene, const Method& method, SettingKind kind, double evaluations);

/// The time of a revolution at the start, 2 pi / |w(0)|, s; infinite for a body at rest.
double revolution_time(const Scene& scene);

}  // namespace polhode
