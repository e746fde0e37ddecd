// The fastest method at given accuracies.
#pragma once

#include <string>
#include <vector>

#include "experiment/run/result.h"

namespace polhode {

/// Accuracies for tables of the fastest method: largest attitude error, rad.
inline constexpr double accuracy_levels[] = {1e-3, 1e-6, 1e-9, 1e-12};

/// For each method, the row of the scene with the smallest median time among those with a largest attitude error of at
/// most `wanted` (rad). Sorted by time, fastest first.
std::vector<const Result*> sort_by_time(const std::vector<Result>& results, const std::string& scene, double wanted);

struct RunTable {
    int width = 100;     ///< characters per line, at least 80
    bool color = false;  ///< uses the escape sequences of a terminal
};

/// A table for a terminal: the fastest method for each scene and accuracy, its time, and the ratio of the runner-up's
/// time to it. Empty if the results have only one method or no times.
std::string run_table(const std::vector<Result>& results, const RunTable& table);

/// Formats a time with three digits and a unit prefix: "12.3 us", "4.50 ms", "1.25 s".
std::string format_seconds(double seconds);

/// Shortens the text to at most `most` characters; ".." replaces the middle of a longer text.
std::string shorten(const std::string& text, std::size_t most);

}  // namespace polhode
