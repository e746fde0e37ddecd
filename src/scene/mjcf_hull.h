// The convex hull of points, for meshes whose mass is that of their hull.
#pragma once

#include <array>
#include <vector>

#include "body/algebra.h"

namespace polhode {

/// Triangles of the hull by the indices of their points, counter-clockwise as seen from outside; none where the points
/// lie in one plane, or are more than the algorithm handles within its limit of work.
std::vector<std::array<int, 3>> convex_hull(const std::vector<Vector3<double>>& points);

}  // namespace polhode
