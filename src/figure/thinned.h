// Curves of more points than a picture has columns.
#pragma once

#include <cstddef>

#include "figure/figure.h"

namespace polhode {

/// Leaves of a curve whose x ascends what is to be seen in a picture so many columns wide: of each column the first,
/// the lowest, the highest and the last point. Curves of few points stay as they are.
void thin(Curve& curve, std::size_t columns);

}  // namespace polhode
