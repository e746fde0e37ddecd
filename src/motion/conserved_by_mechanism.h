// The conserved quantities of several bodies, and whether their motion is planar, derived from joints and loads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "motion/conserved.h"
#include "motion/problem.h"

namespace polhode {

/// Finds conserved quantities of several bodies.
///
/// - The energy, if only potentials act, at all times.
/// - For a system without joints to the world: the momentum p and the angular momentum L about its centre of mass. If
///   the loads change one of them along a single direction, its component perpendicular to it.
/// - For a system tied to the world: L along a line u through the world's origin. The system must be attached only by
///   hinges along u or spherical joints at points of u, without springs, dampers and motors, and gravity must be
///   parallel to u.
///
/// Directions count as equal within 1e-12. There may be further conserved quantities. `problem`: a posed mechanism.
std::vector<Conserved> conserved_by_mechanism(const Problem& problem);

/// The normal (unit, world axes) of the planes in which all bodies move under any loads: all revolute joints are
/// parallel to it, all prismatic joints perpendicular to it, and there are no other moving joints or free bodies.
/// Empty if there is no such normal.
std::optional<Vector3<double>> plane_of_motion(const Problem& problem);

}  // namespace polhode
