// The reference for conditioning: motion and derivative by multiprecision Taylor series.
#pragma once

#include <vector>

#include "integrators/analysis/conditioning.h"
#include "motion/problem.h"

namespace polhode {

/// kappa as conditioning() has it, from another side: the variational equation of the one right-hand side, with the
/// full tensor in body axes, in 50 digits, by Taylor series to a local error of 10^-digits. It follows motions that
/// binary64 cannot (until kappa comes near 10^digits), and takes seconds where conditioning() takes milliseconds.
/// Translation is integrated wherever the centre of mass moves. Not for a torque of the user's own, nor stiff scenes:
/// `available` is then false. Throws std::invalid_argument on bad times.
Conditioning reference_conditioning(const Problem& problem, const std::vector<double>& times, int digits = 20,
                                    long max_steps = 20'000);

}  // namespace polhode
