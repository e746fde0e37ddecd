// Lines along which a function of two variables has one value.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "figure/figure.h"

namespace polhode {

/// The points of one line in order; the last is the first again where it is closed.
struct ContourLine {
    std::vector<double> x, y;
};

/// f = 0 in a rectangle, on a grid of `columns` by `rows` cells, each cell's edges cut where f changes its sign, found
/// to 1e-9 of the edge by halving (marching squares; W. E. Lorensen & H. E. Cline 1987, in the plane). Infinite values
/// of f count by their sign, NaN as positive.
std::vector<ContourLine> contour(const std::function<double(double, double)>& f, Limits x, Limits y, int columns,
                                 int rows);

}  // namespace polhode
