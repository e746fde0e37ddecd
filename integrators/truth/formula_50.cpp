#include "integrators/truth/formula_attempt.h"

namespace polhode::truth {

template Attempt attempt_by_formula_series<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
