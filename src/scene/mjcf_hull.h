// The convex hull of points, for meshes whose mass is defined by their hull.
#pragma once

#include <array>
#include <vector>

#include "body/algebra.h"

namespace polhode {

/// The triangles of the hull as indices of points, counter-clockwise as seen from outside. Empty if the points are
/// coplanar or exceed the algorithm's work limit.
std::vector<std::array<int, 3>> convex_hull(const std::vector<Vector3<double>>& points);

}  // namespace polhode
