// What the motion of several bodies keeps, and whether it is planar, found from joints and loads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "motion/conserved.h"
#include "motion/problem.h"

namespace polhode {

/// Energy where nothing but potentials acts, all the time; of a system in flight the momentum p and the angular
/// momentum L about its centre of mass, or what is left of them across the one direction that loads change them in; of
/// one tied to the world L about the line u through the world's origin, where it hangs on hinges along that line or on
/// points of it, free of springs, dampers and motors, and gravity lies along it. Directions count as equal within
/// 1e-12. There may be others. `problem`: a posed mechanism.
std::vector<Conserved> conserved_by_mechanism(const Problem& problem);

/// The normal (unit, world axes) of the planes in which all bodies stay for whatever loads: all hinges are parallel to
/// it, all slides across it, and nothing else lets a body move. Empty where they need not stay in planes.
std::optional<Vector3<double>> plane_of_motion(const Problem& problem);

}  // namespace polhode
