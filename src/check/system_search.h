// Searches for the faults that explain a file of several bodies. Each fault is tested by predicting rows with it.
#pragma once

#include <string>
#include <vector>

#include "check/diagnosis.h"

namespace polhode {

/// Diagnoses a file of several bodies. Tests the faults of check/system_faults.h singly and in pairs, on a few dozen
/// steps without impulses or load changes. Needs the attitudes of all bodies. Missing
/// velocities and positions are computed from the joints if these connect all bodies to the world. `all`: test the
/// faults on a sound file too.
FileDiagnosis diagnose_system(const Scene& scene, const TrajectoryFile& file, bool all = false);

}  // namespace polhode
