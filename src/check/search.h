// Searches for the known faults that explain a file, singly and in pairs, with every kind of update.
#pragma once

#include <vector>

#include "check/evidence.h"

namespace polhode {

/// Decades over all questions: required gain of a fault without and with a fitted number, and the largest difference
/// between indistinguishable explanations.
inline constexpr double fixed_gain = 0.9, fitted_gain = 1.1, alike_within = 0.15;

/// A fault with the number fitted to it.
struct FittedFault {
    const Hypothesis* hypothesis = nullptr;
    double x = 1;
};

/// A set of faults, possibly empty, with the update that fits the file best.
struct Explanation {
    std::vector<FittedFault> faults;
    const UpdateRule* rule = nullptr;
    int steps = 1;  ///< steps of the rule per row
    Residual residual;
};

/// The result of a search.
struct FaultSearch {
    Explanation sound;                 ///< no fault, best update
    Explanation best;                  ///< each of its faults is needed; no faults if nothing explains the file
    std::vector<Explanation> alike;    ///< other explanations that are indistinguishable from the best
    std::vector<Explanation> singles;  ///< all single faults, the best first
};

/// Tests all known faults on the file. A fault is needed if omitting it makes the prediction about ten times worse,
/// summed over the questions (0.9 decades, or 1.1 with a fitted number). `all`: test them even if the prediction
/// without a fault is already as good as possible.
FaultSearch search_faults(const FileEvidence& evidence, bool all = false);

}  // namespace polhode
