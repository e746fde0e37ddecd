// Programs of tapes done operation by operation.
#pragma once

#include "integrators/lanes/lanes.h"
#include "integrators/tape/tape_layout.h"

namespace polhode {

/// One substep of eight states side by side: change += scale f(start + now), of the i-th variable from 8 i on. All from
/// the beginning of a cache line on. Nothing is added where a rate is zero always: such a variable is a parameter.
struct TapeSubstep {
    const double *start, *now, *scale;
    double* change;
};

/// Programs done by the instructions of one set; the same bits by all.
struct TapeInterpreter {
    /// From the states in their slots (TapeProgram::values) to all their coefficients, in memory of that layout.
    /// `careful`: coefficients are divided by k + 1; else the rounded 1/(k + 1) multiplies them.
    void (*expand)(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory);
    /// sums = y_from + y_{from+1} h + .. + y_order h^(order - from), each state's, in whole lines; from < order.
    void (*sum)(const double* coefficients, int states, int order, int from, double h, double* sums);
    /// The substep, of a program for rates; eight numbers a slot in memory.
    void (*add_rates)(const TapeProgram& program, double* memory, const TapeSubstep& substep);
    /// Of eight numbers and of four, written to where none of them stands: what code calls too.
    void (*sines_cosines)(const double* x, double* sines, double* cosines);
    void (*four_sines_cosines)(const double* x, double* sines, double* cosines);
};
extern const TapeInterpreter tape_interpreter_plain, tape_interpreter_avx2, tape_interpreter_avx512;
/// The one for these instructions.
const TapeInterpreter& tape_interpreter(InstructionSet set);

/// What both they and code take for one sine.
void sine_cosine_of(double x, double& sine, double& cosine);

}  // namespace polhode
