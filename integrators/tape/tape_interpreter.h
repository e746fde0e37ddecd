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

/// sums = y_from + y_{from+1} h + .. + y_order h^(order - from), each state's, in whole lines; from < order. The same
/// bits by all instructions.
using SumTape = void(const double* coefficients, int states, int order, int from, double h, double* sums);

SumTape sum_tape_plain;
SumTape sum_tape_avx2;    ///< with fused multiplication and addition
SumTape sum_tape_avx512;  ///< likewise

/// What both they and code take for sines.
void sine_cosine_of(double x, double& sine, double& cosine);

/// The one for these instructions.
ExpandTape* expand_tape(InstructionSet set);
/// Likewise.
SumTape* sum_tape(InstructionSet set);

}  // namespace polhode
