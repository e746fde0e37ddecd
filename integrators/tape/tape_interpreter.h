// Programs of tapes done operation by operation.
#pragma once

#include "integrators/lanes/lanes.h"
#include "integrators/tape/tape_layout.h"

namespace polhode {

/// From the states in their slots (TapeProgram::values) to all their coefficients, in memory of that layout. `careful`:
/// coefficients are divided by k + 1; else the rounded 1/(k + 1) multiplies them.
using ExpandTape = void(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory);

ExpandTape expand_tape_plain;
ExpandTape expand_tape_avx2;    ///< with fused multiplication and addition
ExpandTape expand_tape_avx512;  ///< the same bits

/// What both they and code take for sines.
void sine_cosine_of(double x, double& sine, double& cosine);

/// The one for these instructions.
ExpandTape* expand_tape(InstructionSet set);

}  // namespace polhode
