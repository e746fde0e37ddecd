// The attempts for scenes with formula loads. Each working precision is instantiated in its own file.
#pragma once

#include <vector>

#include "integrators/truth/attempt.h"

namespace polhode::truth {

/// Both formulations by Taylor series, with switching points located as events. Digits: see attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_formula_series(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

extern template Attempt attempt_by_formula_series<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_formula_series<100>(const Problem&, const std::vector<double>&, double);

/// Several bodies: joint coordinates and maximal coordinates.
template <unsigned working>
Attempt attempt_by_formula_mechanism(const Problem& problem, const std::vector<double>& sample_times,
                                     double local_digits);

extern template Attempt attempt_by_formula_mechanism<50>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
