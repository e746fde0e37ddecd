// Mass properties of bodies bounded by triangles, by exact sums over tetrahedra.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "body/shapes.h"

namespace polhode {

/// A triangle mesh. The vertices of each triangle are counter-clockwise as seen from outside.
struct Mesh {
    std::vector<Vector3<double>> vertices;  ///< in the file's units
    std::vector<std::array<int, 3>> triangles;
    Vector3<double> scale{1, 1, 1};  ///< m per unit along each axis; negative values mirror the mesh

    /// Vertex i in m, as the scalar S.
    template <class S>
    Vector3<S> vertex(std::size_t i) const {
        const Vector3<double>& v = vertices[i];
        return {S(scale[0]) * S(v[0]), S(scale[1]) * S(v[1]), S(scale[2]) * S(v[2])};
    }
};

/// Why the triangles do not bound a body, or an empty string if they do. Faults are: no triangles, a vertex index out
/// of range, or an unbalanced edge. Every edge must occur equally often in both directions. Then the triangles form
/// one or several closed surfaces and the divergence theorem is exact, even with triangles of zero area and with
/// edges shared by several closed parts. The message names up to five unbalanced edges. Vertices at the same place
/// count as one.
std::string mesh_fault(const Mesh& mesh);

/// The volume (in cubed file units) enclosed by a mesh without faults. Negative if its triangles face inward; 0 if it
/// is within the rounding error of the coordinates.
double enclosed_volume(const Mesh& mesh);

/// The extent of a body whose coordinates are multiplied by these nonzero factors.
template <class S>
Extent<S> scaled(const Extent<S>& extent, const Vector3<double>& scale) {
    Extent<S> e = extent;
    for (int i = 0; i < 3; ++i) {
        e.size = e.size * S(scale[i] < 0 ? -scale[i] : scale[i]);
        e.mean[i] = e.mean[i] * S(scale[i]);
        for (int j = 0; j < 3; ++j) e.spread[i][j] = e.spread[i][j] * S(scale[i]) * S(scale[j]);
    }
    return e;
}

/// Volume (m^3), centroid (m) and mean of (r - centroid)(r - centroid)^T (m^2) of the body bounded by a mesh without
/// faults that faces outward. It is an exact sum over the tetrahedra from one point to each triangle (B. Mirtich
/// 1996, J. Graphics Tools 1; M. Kallay 2006, J. Graphics Tools 11).
template <class S>
Extent<S> mesh_extent(const Mesh& mesh) {
    // the apex is near the middle, to limit cancellation
    Vector3<S> origin;
    for (const Vector3<double>& v : mesh.vertices) origin = origin + cast<S>(v);
    const S count(static_cast<double>(mesh.vertices.size()));
    origin = Vector3<S>(origin[0] / count, origin[1] / count, origin[2] / count);

    S six = S(0);            // 6 times the volume
    Vector3<S> twenty_four;  // 24 times the integral of r
    Matrix3<S> one_twenty;   // 120 times the integral of r r^T: per tetrahedron 6 V (sum v v^T + s s^T), s = sum v
    for (const std::array<int, 3>& triangle : mesh.triangles) {
        std::array<Vector3<S>, 3> v;
        for (int k = 0; k < 3; ++k) v[k] = cast<S>(mesh.vertices[triangle[k]]) - origin;
        const S volume = dot(v[0], cross(v[1], v[2]));
        const Vector3<S> sum = v[0] + v[1] + v[2];
        six = six + volume;
        twenty_four = twenty_four + volume * sum;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j <= i; ++j)
                one_twenty[i][j] = one_twenty[i][j] + volume * (v[0][i] * v[0][j] + v[1][i] * v[1][j] +
                                                                v[2][i] * v[2][j] + sum[i] * sum[j]);
    }
    const S four = S(4) * six, twenty = S(20) * six;
    const Vector3<S> mean(twenty_four[0] / four, twenty_four[1] / four, twenty_four[2] / four);
    Extent<S> extent{S(six / S(6)), origin + mean, {}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
            extent.spread[i][j] = extent.spread[j][i] = one_twenty[i][j] / twenty - mean[i] * mean[j];
    return scaled(extent, mesh.scale);
}

}  // namespace polhode
