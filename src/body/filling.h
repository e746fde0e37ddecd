// Approximates a solid shape by point masses.
#pragma once

#include <vector>

#include "body/mass_properties.h"
#include "body/shapes.h"

namespace polhode {

/// Whether the point (m, from the shape's origin) is inside the shape. Always false for a rod, disc or plate.
bool contains(const Shape& shape, const Vector3<double>& point);

/// The corners of the axis-aligned bounding box of the shape (m).
struct Bounds {
    Vector3<double> low, high;
};
/// The axis-aligned bounding box of the shape, in its own axes (m).
Bounds bounds(const Shape& shape);

/// The cell centres of an n x n x n grid over the bounds that are inside the shape. The mass (kg) is shared equally.
/// Empty if no centre is inside.
std::vector<PointMass<double>> grid_points(const Shape& shape, double mass, int n);

/// `count` points inside the shape, drawn uniformly from the bounds and rejected outside. The generator is SplitMix64
/// with this seed and gives the same points on every machine. The mass (kg) is shared equally. Throws
/// std::invalid_argument for a shape without volume.
std::vector<PointMass<double>> random_points(const Shape& shape, double mass, long count, unsigned long seed);

}  // namespace polhode
