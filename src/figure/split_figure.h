// Splits a figure with too many curves into several.
#pragma once

#include <string>
#include <vector>

#include "figure/figure.h"

namespace polhode {

/// A figure and its file name without extension.
struct NamedFigure {
    std::string name;
    Figure figure;
};

/// The maximum number of curves that readers can distinguish in one figure.
inline constexpr std::size_t most_curves = 12;

/// Returns the figure itself if it has at most `most` curve labels or its curves have no groups. Otherwise returns an
/// overview under the figure's own name, followed by one figure NAME_GROUP per group with all its curves. A group of
/// more than `most` curves becomes NAME_GROUP_1, NAME_GROUP_2, .. of about equal size. The overview has `most`
/// curves: the best of each group by Figure::best, then the next best of all; its note says so. A group that is
/// complete in the overview gets no figure. Curves without a label or a group appear in all figures. Curves without a
/// drawable point are not counted and appear in none.
std::vector<NamedFigure> split_figure(const NamedFigure& whole, std::size_t most = most_curves);

}  // namespace polhode
