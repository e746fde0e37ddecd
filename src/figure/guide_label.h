// Placement of a guide's label in its panel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figure/figure_layout.h"

namespace polhode {

/// A point on the page (points), or in a panel (units of its axes).
struct Point {
    double x = 0, y = 0;
};

/// The position of a label.
struct GuideLabel {
    double x = 0, y = 0;      ///< start or end of the text, and its middle line
    bool ends_there = false;  ///< the text ends at x; otherwise it begins there
    long covered_points = 0;  ///< overlap: the number of sampled curve points below the label
};

/// Places a label at the right or left end of the guide, or else between them, above or below it. Chooses the first
/// position that covers no curve, or the one that covers least. Returns nothing if every position would leave the
/// frame. `guide` and `curves` are points on the page; `size` is the text size (points).
std::optional<GuideLabel> guide_label(const std::string& text, double size, const std::vector<Point>& guide,
                                      const std::vector<std::vector<Point>>& curves, const Rectangle& plot);

}  // namespace polhode
