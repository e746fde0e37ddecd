// The kernels of lane_math.h, compiled for every instruction set.
#pragma once

#include <cstddef>

#include "integrators/lanes/lanes.h"
#include "integrators/own/free_octet.h"

namespace polhode {

/// advance_free() of each.
void advance_free_octets(FreeOctet* octets, std::size_t count, double t, InstructionSet set);

}  // namespace polhode
