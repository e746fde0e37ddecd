// Reduces curves with more points than a picture has columns.
#pragma once

#include <cstddef>

#include "figure/figure.h"

namespace polhode {

/// Reduces a curve with ascending x to the points that are visible at a width of `columns`: the first, lowest,
/// highest and last point of each column. Curves of at most 4 points per column are unchanged.
void thin(Curve& curve, std::size_t columns);

}  // namespace polhode
