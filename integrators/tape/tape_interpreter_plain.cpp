#include "integrators/tape/tape_interpreting.h"

namespace polhode {

const TapeInterpreter tape_interpreter_plain{expand, sum_states, add_rates_of, compute_sines_cosines,
                                             compute_four_sines_cosines};

}  // namespace polhode
