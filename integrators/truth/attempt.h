// One attempt at the reference: two formulations, with different orders and steps, are computed and compared.
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/reference.h"
#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode::truth {

/// A reference with its decimals and its cost.
struct Truth {
    Reference reference;
    long steps = 0;                                   ///< total of both runs
    double seconds = 0;                               ///< wall clock of the computation, s
    bool limit_reached = false;                       ///< unavailable because the time limit was reached
    std::vector<DecimalColumns> decimals;             ///< one row per sample and body, with more digits than agree
    std::vector<std::string> impact_decimals;         ///< Reference::impact_times, with more digits than agree
    std::vector<ReactionDecimals> reaction_decimals;  ///< Reference::reactions, with more digits than agree
    std::vector<DecimalContactEvent> contact_events;  ///< with more digits than agree
    std::vector<DecimalContactInterval> contact_intervals;  ///< with more digits than agree
};

/// Returns the reference from the cache, or computes it within the limit and caches it. Throws as reference() does.
Truth find_truth(const Scene& scene, long samples, int digits, double seconds_limit = truth_seconds);
/// Returns the reference at the given times, s.
Truth find_truth(const Scene& scene, const std::vector<double>& times, int digits,
                 double seconds_limit = truth_seconds);

/// Frees the constants (such as pi) that MPFR caches for this thread, at the end of its lifetime.
class MpfrConstants {
  public:
    MpfrConstants() = default;
    MpfrConstants(const MpfrConstants&) = delete;
    MpfrConstants& operator=(const MpfrConstants&) = delete;
    ~MpfrConstants();
};

/// Comparison of two runs of the reference.
struct Attempt {
    std::string fault;         ///< why a run did not reach the end; empty if both did
    double agreed_digits = 0;  ///< -log10 of the largest difference
    Truth truth;
};

/// Both formulations by Taylor series. `working` is the number of decimal digits of the arithmetic, 50 or 100;
/// `local_digits` sets the local error 10^-local_digits of each step.
template <unsigned working>
Attempt attempt_by_taylor(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// Both formulations by Radau IIA collocation, for stiff scenes. Digits: see attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_collocation(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// Several bodies by Taylor series, in joint coordinates and in maximal coordinates. Digits: see attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_mechanism_series(const Problem& problem, const std::vector<double>& sample_times,
                                    double local_digits);

/// Several bodies whose joints have limits or friction, from event to event, in joint coordinates and in maximal
/// coordinates. Digits: see attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_joint_events(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// One body that touches planes, by its contact modes, in reduced coordinates and with multipliers. Digits: see
/// attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_contact_modes(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// Several free spheres that touch planes and each other, by the contact modes of each. Digits: see
/// attempt_by_taylor().
template <unsigned working>
Attempt attempt_by_sphere_contacts(const Problem& problem, const std::vector<double>& sample_times,
                                   double local_digits);

/// True if the whole motion has a closed form: no events, and the given axes are principal.
bool has_single_closed_form(const Problem& problem);

/// Evaluates the closed form at all times. Compares the start of the motion with a Taylor series as well.
Attempt attempt_by_closed_form(const Problem& problem, const std::vector<double>& sample_times, double local_digits);

/// Compares a Taylor series of Euler's equations with the closed form. For motions that depend on a component of w that
/// is too small, compared with the others, for momenta in world axes to represent it.
Attempt attempt_by_series_and_closed_form(const Problem& problem, const std::vector<double>& sample_times,
                                          double local_digits);

extern template Attempt attempt_by_taylor<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_taylor<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_mechanism_series<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_mechanism_series<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_joint_events<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_joint_events<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_contact_modes<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_contact_modes<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_sphere_contacts<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_sphere_contacts<100>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_collocation<50>(const Problem&, const std::vector<double>&, double);
extern template Attempt attempt_by_collocation<100>(const Problem&, const std::vector<double>&, double);

}  // namespace polhode::truth
