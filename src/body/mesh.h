// Bodies bounded by triangles: exact sums over tetrahedra.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "body/shapes.h"

namespace polhode {

/// Triangles by the indices of their vertices (m), counter-clockwise as seen from outside.
struct Mesh {
    std::vector<Vector3<double>> vertices;
    std::vector<std::array<int, 3>> triangles;
};

/// Why the triangles do not bound a body, in a few words, or empty: a vertex that is not there, a degenerate triangle
/// (a corner twice), an edge that is open, shared by more than two triangles, or run through twice in one direction
/// (orientations that disagree). Vertices at the same place count as one.
std::string mesh_fault(const Mesh& mesh);

/// The volume (m^3) that a faultless mesh encloses, negative where its triangles face inward, 0 where it is no more
/// than what rounding of the coordinates would leave.
double enclosed_volume(const Mesh& mesh);

/// Volume (m^3), centroid and the mean of (r - centroid)(r - centroid)^T of what a faultless mesh that faces outward
/// bounds, as a sum over the tetrahedra from one point to each triangle (exact: B. Mirtich 1996, J. Graphics Tools 1;
/// M. Kallay 2006, J. Graphics Tools 11).
template <class S>
Extent<S> mesh_extent(const Mesh& mesh) {
    // from near the middle, so that little cancels
    Vector3<S> origin;
    for (const Vector3<double>& v : mesh.vertices) origin = origin + cast<S>(v);
    const S count(static_cast<double>(mesh.vertices.size()));
    origin = Vector3<S>(origin[0] / count, origin[1] / count, origin[2] / count);

    S six = S(0);            // times the volume
    Vector3<S> twenty_four;  // times the integral of r
    Matrix3<S> one_twenty;   // times the integral of r r^T: per tetrahedron 6 V (sum v v^T + s s^T), s = sum v
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
    return extent;
}

}  // namespace polhode
