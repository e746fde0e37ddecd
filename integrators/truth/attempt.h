// One attempt at the truth: the motion computed twice, in two formulations by two orders and steps, and compared.
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/reference.h"
#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode::truth {

/// A reference with its decimals and what it cost.
struct Truth {
    Reference reference;
    long steps = 0;                                   ///< of both runs
    double seconds = 0;                               ///< wall clock, when it was computed
    bool limit_reached = false;                       ///< there is none because the time allowed was spent
    std::vector<DecimalColumns> decimals;             ///< one a sample, to more digits than agree
    std::vector<std::string> impact_decimals;         ///< Reference::impact_times, to more digits than agree
    std::vector<ReactionDecimals> reaction_decimals;  ///< Reference::reactions, to more digits than agree
};

/// The truth from the cache, or else computed within the limit and kept there; throws as reference() does.
Truth find_truth(const Scene& scene, long samples, int digits, double seconds_limit = truth_seconds);
/// The same at times of the caller's own (s).
Truth find_truth(const Scene& scene, const std::vector<double>& times, int digits,
                 double seconds_limit = truth_seconds);

/// MPFR keeps pi and its like for the thread that asked for them. This gives them back where it ends.
class KeptConstants {
  public:
    KeptConstants() = default;
    KeptConstants(const KeptConstants&) = delete;
    KeptConstants& operator=(const KeptConstants&) = delete;
    ~KeptConstants();
};

/// Two runs of the truth, compared.
struct Attempt {
    std::string fault;         ///< why a run did not reach the end; empty if both did
    double agreed_digits = 0;  ///< -log10 of the largest difference
    Truth truth;
};

/// The truth by Taylor series in both formulations. `working` is the number of decimal digits of the arithmetic, 50 or
/// 100; `local_digits` that of each step.
template <unsigned working>
Attempt attempt_by_taylor(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// The truth by Radau collocation in both formulations, for stiff scenes; the digits are as for the Taylor series.
template <unsigned working>
Attempt attempt_by_collocation(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// The truth of several bodies by Taylor series, in joint coordinates and in maximal ones; the digits are as for one.
template <unsigned working>
Attempt attempt_at_mechanism(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// Whether the motion has a closed form throughout: no events, principal axes as given.
bool closed_form_serves(const Problem& problem);

/// The truth by closed form, at any time; its beginning is also made by Taylor series and compared.
Attempt attempt_by_closed_form(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// The truth by Taylor series of Euler's equations and by closed form, compared: for motions that hang on a component
/// of w so small beside the others that momenta in world axes cannot hold it.
Attempt attempt_by_series_and_closed_form(const Problem& problem, const std::vector<double>& sample_times,
                                          double local_digits);

extern template Attempt attempt_by_taylor<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_taylor<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_at_mechanism<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_at_mechanism<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_collocation<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_collocation<100>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
