// A solid shape as many point masses: sums in place of an integral.
#pragma once

#include <vector>

#include "body/mass_properties.h"
#include "body/shapes.h"

namespace polhode {

/// Whether the point (m, from the shape's origin) is inside. A rod, disc or plate holds no point.
bool contains(const Shape& shape, const Vector3<double>& point);

/// The corners of the smallest box around the shape, along its axes (m).
struct Bounds {
    Vector3<double> low, high;
};
Bounds bounds(const Shape& shape);

/// The centres of those cells of an n x n x n grid over the bounds whose centre is inside, the mass (kg) shared
/// equally. Empty where no centre is.
std::vector<PointMass<double>> grid_points(const Shape& shape, double mass, int n);

/// Points inside, drawn evenly from the bounds by a generator of this seed (SplitMix64: the same on every machine),
/// until there are `count`; the mass (kg) shared equally. Throws std::invalid_argument for a shape without volume.
std::vector<PointMass<double>> random_points(const Shape& shape, double mass, long count, unsigned long seed);

}  // namespace polhode
