// What matters most in a folder of results, in sentences made from its numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/folder.h"

namespace polhode {

/// One finding.
struct Finding {
    std::string title;  ///< a sentence
    std::string text;   ///< the numbers behind it
    std::string link;   ///< the page's state that shows it, "#section=..&scene=.."
};

/// The fastest run within an attitude error of a scene, and of the other methods the next.
struct Fastest {
    std::optional<std::size_t> row, runner_up;  ///< places in the folder's rows
};

/// Of the rows of one scene (their places), the fastest whose largest attitude error is within `error`, by the median
/// time; reduced formulations only.
Fastest fastest_within(const ResultFolder& folder, const std::vector<std::size_t>& rows, double error);

/// The places of each scene's rows, by the scene's place.
std::vector<std::vector<std::size_t>> rows_by_scene(const ResultFolder& folder);

/// At most three findings, the weightiest first: who is fastest; whose energy hides a lost attitude; how errors grow;
/// whether orders are as claimed; what failed; who reaches the floor of rounding; what leaving out gains. Those that
/// the folder has no numbers for are left out.
std::vector<Finding> findings_of(const ResultFolder& folder);

/// The growth exponent of each measure of a series and its uncertainty, where a fit holds.
std::vector<std::optional<std::pair<double, double>>> growth_of(const FolderSeries& series);

/// A fitted order of one curve.
struct FittedOrder {
    int experiment = 0, scene = 0, method = 0;
    SettingKind kind = SettingKind::none;
    int claimed = 0;                    ///< 0: none
    std::optional<double> observed;     ///< empty: nothing converges
    int points = 0;                     ///< that it was fitted to
    double from = absent, to = absent;  ///< their settings
};

/// The orders of all curves of at least four settings that ended well above the floor of rounding (a hundred times it)
/// and that the folder's experiments are to show orders of (those of the kind `convergence`, or all where there is
/// none).
std::vector<FittedOrder> orders_of(const ResultFolder& folder);

}  // namespace polhode
