// Which method reaches an accuracy in the least time.
#pragma once

#include <string>
#include <vector>

#include "experiment/run/result.h"

namespace polhode {

/// The accuracies that tables of the fastest go by: the largest attitude error, rad.
inline constexpr double accuracy_levels[] = {1e-3, 1e-6, 1e-9, 1e-12};

/// Of the rows of a scene the fastest of each method whose largest attitude error is at most `wanted` (rad), by its
/// median time; the fastest method first.
std::vector<const Result*> fastest_first(const std::vector<Result>& results, const std::string& scene, double wanted);

struct RunTable {
    int width = 100;     ///< columns, 80 at least
    bool color = false;  ///< with the escape sequences of a terminal
};

/// For people at a terminal: for each scene and accuracy the fastest method, its time and the runner-up's time as its
/// multiple. Empty where there is no choice: one method alone, or none that was timed.
std::string run_table(const std::vector<Result>& results, const RunTable& table);

/// A time with a prefix and three digits: "12.3 us", "4.50 ms", "1.25 s".
std::string prefixed_seconds(double seconds);

/// The text in so many characters at most, its middle an ellipsis where it is longer.
std::string shortened(const std::string& text, std::size_t most);

}  // namespace polhode
