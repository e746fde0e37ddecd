// The kernels of lane_math.h, compiled for every instruction set.
#pragma once

#include <cstddef>

#include "integrators/lanes/lanes.h"
#include "integrators/own/free_octet.h"
#include "integrators/own/loaded_octet.h"

namespace polhode {

/// advance_free() of each.
void advance_free_octets(FreeOctet* octets, std::size_t count, double t, InstructionSet set);

/// advance_loaded() at the order that costs least; `symmetric`: the bodies are loaded_octet::SymmetricSeries'.
void advance_loaded_lanes(LoadedLane* bodies, std::size_t count, const LoadTerms& terms, bool symmetric,
                          const LaneSteps& steps, InstructionSet set);

}  // namespace polhode
