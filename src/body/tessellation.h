// Shapes as closed surfaces of triangles that face outward.
#pragma once

#include "body/mesh.h"
#include "body/shapes.h"

namespace polhode {

/// Twelve triangles: the box itself.
Mesh tessellated(const Box& box);

/// An icosahedron, each triangle split into four `subdivisions` times, corners on the sphere: 20 4^s triangles inside
/// it.
Mesh tessellated(const SolidSphere& sphere, int subdivisions);

/// 2 n n triangles with corners on the torus, n around either circle.
Mesh tessellated(const Torus& torus, int n);

}  // namespace polhode
