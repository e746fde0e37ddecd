#include "integrators/tape/tape_interpreting.h"

namespace polhode {

void expand_tape_avx2(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    expand(program, layout, careful, memory);
}

void sum_tape_avx2(const double* coefficients, int states, int order, int from, double h, double* sums) {
    sum_states(coefficients, states, order, from, h, sums);
}

void find_rates_avx2(const TapeProgram& program, double* memory, const double* y, double* rates) {
    find_rates_of(program, memory, y, rates);
}

}  // namespace polhode
