// How far loops are open in a motion that is told in decimals, for certain.
#pragma once

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/reference.h"
#include "scene/scene.h"

namespace polhode::truth {

/// A bound, over all samples and loops, of the distance of a loop's points, of the error of a distance kept (m), and of
/// the sine of the angle between the axes of a revolute one. The decimals are taken exactly, with each q at unit
/// length.
Bound openness_of_loops(const Scene& scene, const DecimalReference& truth);

}  // namespace polhode::truth
