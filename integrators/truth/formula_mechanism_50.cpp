#include "integrators/truth/formula_mechanism_attempt.h"

namespace polhode::truth {

template Attempt attempt_by_formula_mechanism<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
