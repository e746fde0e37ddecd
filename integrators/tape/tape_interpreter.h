// Interpreter for tape programs: executes them operation by operation.
#pragma once

#include "integrators/lanes/lanes.h"
#include "integrators/tape/tape_layout.h"

namespace polhode {

/// One substep of eight states side by side: change += scale f(start + now). Variable i occupies elements 8 i to 8 i
/// + 7. All arrays are aligned to a cache line. Variables whose rate is identically zero are parameters and do not
/// change.
struct TapeSubstep {
    const double *start, *now, *scale;
    double* change;
};

/// Tape kernels for one instruction set. All instruction sets give the same bits.
struct TapeInterpreter {
    /// Computes all Taylor coefficients from the states in their slots (TapeProgram::values). `memory` has the given
    /// layout. With `careful`, coefficients are divided by k + 1; otherwise they are multiplied by the rounded 1/(k +
    /// 1).
    void (*expand)(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory);
    /// Computes, for each state, y_from + y_{from+1} h + .. + y_order h^(order - from). Writes whole lines; from <
    /// order.
    void (*sum)(const double* coefficients, int states, int order, int from, double h, double* sums);
    /// Performs the substep with a program for rates. `memory` holds eight numbers per slot.
    void (*add_rates)(const TapeProgram& program, double* memory, const TapeSubstep& substep);
    /// Sine and cosine of eight or of four numbers. The outputs must not overlap the input. Compiled code calls these
    /// too.
    void (*sines_cosines)(const double* x, double* sines, double* cosines);
    void (*four_sines_cosines)(const double* x, double* sines, double* cosines);
};
extern const TapeInterpreter tape_interpreter_plain, tape_interpreter_avx2, tape_interpreter_avx512;
/// Returns the interpreter for an instruction set.
const TapeInterpreter& tape_interpreter(InstructionSet set);

/// The scalar sine and cosine used by the interpreter and by compiled code.
void scalar_sine_cosine(double x, double& sine, double& cosine);

}  // namespace polhode
