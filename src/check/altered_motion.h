// A scene's motion as an engine with a known fault would have it.
#pragma once

#include <vector>

#include "check/diagnosis.h"

namespace polhode {

/// By Dormand and Prince's pair of orders 5 and 4 (1980) at a tolerance of 1e-9, in body axes with the full tensor; the
/// limit on |w| is applied after each step. `times` as in AlteredMotion; a run of more than 20,000 steps stops short.
/// Throws InputError on an invalid scene.
std::vector<Sample> altered_motion(const Scene& scene, const Alteration& alteration, const std::vector<double>& times);

}  // namespace polhode
