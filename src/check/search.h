// Which known faults explain a file: a search through them, one at a time and in pairs, by every kind of update.
#pragma once

#include <vector>

#include "check/evidence.h"

namespace polhode {

/// What a fault has to gain, in decades over all questions; and how far apart two explanations are that are alike.
inline constexpr double gain_of_fixed = 0.9, gain_of_fitted = 1.1, alike_within = 0.15;

/// A fault with the number fitted to it.
struct Supposed {
    const Hypothesis* hypothesis = nullptr;
    double x = 1;
};

/// Some faults together, none or more, with the update under which they explain a file best.
struct Explanation {
    std::vector<Supposed> faults;
    const UpdateRule* rule = nullptr;
    int steps = 1;  ///< of the rule, from one row to the next
    Residual residual;
};

/// What a search has found.
struct FaultSearch {
    Explanation sound;               ///< no fault, the best update
    Explanation best;                ///< its faults are needed, each of them; none where nothing explains the file
    std::vector<Explanation> alike;  ///< others that explain it as well as the best: they cannot be told apart
    std::vector<Explanation> tried;  ///< every single fault with what it leaves, the best first
};

/// Tries all known faults on the file. A fault is needed where without it the file is ten times (0.9 decades, one that
/// was fitted 1.1) further from what is predicted, summed over the questions. `all`: tries them also where the file is
/// as near as can be to what is predicted without any.
FaultSearch search_faults(const FileEvidence& evidence, bool all = false);

}  // namespace polhode
