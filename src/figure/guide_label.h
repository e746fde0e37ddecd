// Where a guide's name stands in its panel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figure/figure_layout.h"

namespace polhode {

/// On the page, in points; or in a panel, in its axes' units.
struct Point {
    double x = 0, y = 0;
};

struct GuideLabel {
    double x = 0, y = 0;      ///< of the text's end or beginning, and its middle line
    bool ends_there = false;  ///< the text ends at x; else it begins there
    long covered = 0;         ///< how much of the curves lies beneath it: points along them
};

/// At the right or the left end of the guide, or else between them, above or below it: the first place where it covers
/// none of the curves, or the one where it covers least. None where it
/// would leave the frame. `guide` and `curves`: points on the page; `size`: of the text.
std::optional<GuideLabel> guide_label(const std::string& text, double size, const std::vector<Point>& guide,
                                      const std::vector<std::vector<Point>>& curves, const Rectangle& plot);

}  // namespace polhode
