// A picture of more curves than can be told apart, as several.
#pragma once

#include <string>
#include <vector>

#include "figure/figure.h"

namespace polhode {

/// A picture and the name of its file, without extension.
struct NamedFigure {
    std::string name;
    Figure figure;
};

/// So many curves of one picture are told apart.
inline constexpr std::size_t most_curves = 12;

/// The figure itself where it has no more than `most` labels of curves, or its curves have no groups. Else a picture of
/// the best first, under the figure's own name, and behind it one a group with all its curves, NAME_GROUP; a group of
/// more than `most` becomes NAME_GROUP_1, NAME_GROUP_2, .. of about the same size. The best: of each group the one that
/// is best by Figure::best, and then the next best of all, `most` together; the note says so. A group that the first
/// picture has whole gets none of its own. Curves without a label or a group are in all of them; those without a point
/// that can be drawn are not counted, and in none.
std::vector<NamedFigure> split_figure(const NamedFigure& whole, std::size_t most = most_curves);

}  // namespace polhode
