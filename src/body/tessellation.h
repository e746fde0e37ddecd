// Shapes as closed triangle meshes that face outward.
#pragma once

#include "body/mesh.h"
#include "body/shapes.h"

namespace polhode {

/// Twelve triangles; exact.
Mesh tessellate(const Box& box);

/// An icosahedron whose triangles are split into four `subdivisions` times, with all vertices on the sphere: 20 4^s
/// triangles, inscribed.
Mesh tessellate(const SolidSphere& sphere, int subdivisions);

/// 2 n n triangles with vertices on the torus, n around each circle.
Mesh tessellate(const Torus& torus, int n);

}  // namespace polhode
