// The kernels of free_octet.h, compiled for each instruction set.
#pragma once

#include <cstddef>

#include "integrators/lanes/lanes.h"
#include "integrators/own/free_octet.h"

namespace polhode {

/// Calls advance_free() for each octet.
void advance_free_octets(FreeOctet* octets, std::size_t count, double t, InstructionSet set);

}  // namespace polhode
