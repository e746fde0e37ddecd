// Contour lines of a function of two variables.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "figure/figure.h"

namespace polhode {

/// The points of one line in order. The last point of a closed line repeats the first.
struct ContourLine {
    std::vector<double> x, y;
};

/// The contour f = 0 in a rectangle, by marching squares on a grid of `columns` by `rows` cells (W. E. Lorensen & H.
/// E. Cline 1987, in the plane). Each sign change on a cell edge is located by bisection to 1e-9 of the edge.
/// Infinite values of f count by their sign, NaN as positive.
std::vector<ContourLine> contour(const std::function<double(double, double)>& f, Limits x, Limits y, int columns,
                                 int rows);

}  // namespace polhode
