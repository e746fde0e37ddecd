// What the kind `stability` is made of beside its runs: pictures and tables of their own.
#pragma once

#include <span>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"

namespace polhode {

/// Where |growth| <= 1 in the plane of z = h lambda, a panel a family of methods, with the eigenvalues of some of the
/// scenes' Jacobians at t = 0 times a step that the legend names; and in the plane of h gamma and h omega for methods
/// that know motion of second order only.
std::vector<NamedFigure> draw_stability_regions(std::span<const PlannedScene> scenes);

/// Runs every fixed-step method of these on a grid of step x stiffness and on one of step x spin. Tables: `maps` (a row
/// for steps in sequence with one outcome), `maps_shares` (how many of a map's runs ended how), `gyroscopic` (the
/// updates of game engines: where they blow up, where they damp, where only the attitude is wrong). Figures: a panel a
/// method, a page sixteen. `jobs` threads; `quick`: every fourth column and row.
Findings run_step_maps(std::span<const Method* const> methods, int jobs, bool quick);

/// What becomes of a method's order where a torque jumps, or its derivative does, or it acts for less than a step:
/// stepped onto, as an event of the scene, and stepped over, as a function of time that nobody knows to jump. A row for
/// each case, method and way. `quick`: coarser steps and tolerances only.
NamedTable measure_discontinuities(bool quick);

}  // namespace polhode
