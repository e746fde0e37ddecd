// Two folders of the same experiments held against each other: another machine's, another version's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/folder.h"

namespace polhode {

/// A mean ratio and its 95 % confidence interval.
struct RatioInterval {
    double ratio = absent;            ///< geometric mean
    std::optional<double> low, high;  ///< empty where there are too few to say
    int groups = 0;                   ///< how many scenes' means it is the mean of
};

/// The geometric mean of the groups' geometric means, with Student's interval of the logarithms of these: runs of one
/// scene are no independent samples, scenes are taken for such. Every ratio positive; empty groups do not count.
RatioInterval ratio_interval(const std::vector<std::vector<double>>& groups);

/// A row here and the same there.
struct MatchedPair {
    std::size_t row = 0, other = 0;  ///< places in the rows of the two folders
};

/// What of two folders compares.
struct FolderComparison {
    std::vector<MatchedPair> pairs;  ///< of the same experiment, scene, method, setting and formulation
    std::size_t only_here = 0, only_there = 0;
    std::size_t same_bits = 0;  ///< pairs whose largest attitude errors are equal, or absent in both
    struct OfMethod {
        int method = 0;
        std::size_t pairs = 0;
        RatioInterval seconds;         ///< the other's over this one's
        std::optional<double> errors;  ///< geometric mean of the ratios of attitude errors
    };
    std::vector<OfMethod> methods;  ///< those with at least one pair of times, by their place
    RatioInterval all;              ///< over all methods, a group a scene
};

/// Compares two folders row by row.
FolderComparison compared(const ResultFolder& here, const ResultFolder& there);

}  // namespace polhode
