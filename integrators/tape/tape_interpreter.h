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

/// The rates of eight states side by side, of a program for rates: of the i-th variable from 8 i on, as of the states
/// y; likewise eight numbers a slot in memory. All from the beginning of a cache line on.
using FindRates = void(const TapeProgram& program, double* memory, const double* y, double* rates);

FindRates find_rates_plain;
FindRates find_rates_avx2;    ///< with fused multiplication and addition
FindRates find_rates_avx512;  ///< likewise

/// What both they and code take for sines.
void sine_cosine_of(double x, double& sine, double& cosine);
/// Likewise, of numbers side by side.
void sines_cosines_of_eight(const double* x, double* sines, double* cosines);
void sines_cosines_of_four(const double* x, double* sines, double* cosines);

/// The one for these instructions.
ExpandTape* expand_tape(InstructionSet set);
/// Likewise.
SumTape* sum_tape(InstructionSet set);
FindRates* find_rates(InstructionSet set);

}  // namespace polhode
