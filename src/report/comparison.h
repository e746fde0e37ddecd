// Compares two result directories of the same experiments, e.g. from two machines or two versions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/folder.h"

namespace polhode {

/// A mean ratio and its 95 % confidence interval.
struct RatioInterval {
    double ratio = absent;            ///< geometric mean
    std::optional<double> low, high;  ///< empty for fewer than three groups
    int groups = 0;                   ///< number of groups (scenes)
};

/// Geometric mean of the groups' geometric means, with Student's 95 % interval of their logarithms. A group contains
/// the runs of one scene, which are not independent samples; scenes are treated as independent. Ratios must be
/// positive. Empty groups are ignored.
RatioInterval ratio_interval(const std::vector<std::vector<double>>& groups);

/// Two rows with the same experiment, scene, method, setting and formulation.
struct MatchedPair {
    std::size_t row = 0, other = 0;  ///< indices into the rows of the two directories
};

/// Result of a comparison of two directories.
struct FolderComparison {
    std::vector<MatchedPair> pairs;
    std::size_t only_here = 0, only_there = 0;
    std::size_t same_bits = 0;  ///< pairs whose largest attitude errors are equal, or absent in both
    struct MethodComparison {
        int method = 0;
        std::size_t pairs = 0;
        RatioInterval seconds;         ///< run time in the other directory over that in this one
        std::optional<double> errors;  ///< geometric mean of the ratios of attitude errors
    };
    std::vector<MethodComparison> methods;  ///< methods with at least one timed pair, by index
    RatioInterval all;                      ///< over all methods, one group per scene
};

/// Compares two directories row by row.
FolderComparison compare_folders(const ResultFolder& here, const ResultFolder& there);

}  // namespace polhode
