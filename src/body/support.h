// Convex hulls by their support function: the furthest point of a body in a direction.
//
// A hull is the convex hull of finitely many pieces. Each piece is an ellipsoid of any rank (a point, a disc, a solid
// ellipsoid) plus a ball:
//   { c + A u + r b : |u| <= 1, |b| <= 1 }.
// For a unit vector n, its furthest point along -n is c - A A^T n / |A^T n| - r n, at n.x = n.c - |A^T n| - r.
#pragma once

#include <variant>
#include <vector>

#include "body/algebra.h"
#include "body/elementary.h"
#include "body/mesh.h"
#include "body/shapes.h"

namespace polhode {

/// A piece { c + A u + r b : |u| <= 1, |b| <= 1 } of a convex hull.
template <class S>
struct SupportPiece {
    Vector3<S> center;      ///< m
    bool extended = false;  ///< A is not zero
    Matrix3<S> semi_axes;   ///< A, in columns, m
    S radius = S(0);        ///< r, m

    /// n.x of the furthest point along -n, where n is a unit vector in the piece's axes (m).
    S lowest(const Vector3<S>& n) const {
        S height = dot(n, center) - radius;
        if (extended) {
            const Vector3<S> a = transposed(semi_axes) * n;
            height = height - square_root(dot(a, a));
        }
        return height;
    }
    /// The furthest point along -n (m). For a disc that lies flat, its centre.
    Vector3<S> lowest_point(const Vector3<S>& n) const {
        Vector3<S> point = center - radius * n;
        if (!extended) return point;
        const Vector3<S> a = transposed(semi_axes) * n;
        const S length = square_root(dot(a, a));
        S size = S(0);
        for (int i = 0; i < 3; ++i) size = size + dot(semi_axes[i], semi_axes[i]);
        if (!(length > S(16) * Elementary<S>::epsilon() * square_root(size))) return point;
        return point - (S(1) / length) * (semi_axes * a);
    }
    /// Upper bound of the distance of all points from the origin (m).
    S reach() const {
        S size = S(0);
        for (int i = 0; i < 3; ++i) size = size + dot(semi_axes[i], semi_axes[i]);
        return square_root(dot(center, center)) + square_root(size) + radius;
    }
};

/// The piece rotated by the unit quaternion q about the origin and then translated by `position` (m).
template <class S>
SupportPiece<S> placed(const SupportPiece<S>& piece, const Vector3<S>& position, const Quaternion<S>& q) {
    SupportPiece<S> moved = piece;
    moved.center = position + rotate(q, piece.center);
    if (piece.extended) moved.semi_axes = rotation_matrix(q) * piece.semi_axes;
    return moved;
}

/// Pieces whose convex hull is that of the shape, relative to the shape's origin.
template <class S>
struct SupportOf {
    using Pieces = std::vector<SupportPiece<S>>;

    static SupportPiece<S> ball(const S& x, const S& y, const S& z, const S& radius) {
        SupportPiece<S> piece;
        piece.center = {x, y, z}, piece.radius = radius;
        return piece;
    }
    static SupportPiece<S> point(const S& x, const S& y, const S& z) { return ball(x, y, z, S(0)); }
    /// A disc perpendicular to the z axis.
    static SupportPiece<S> disc(const S& radius, const S& z) {
        SupportPiece<S> piece = point(S(0), S(0), z);
        piece.extended = !(radius == S(0));
        piece.semi_axes = diagonal(Vector3<S>(radius, radius, S(0)));
        return piece;
    }

    Pieces operator()(const Box& s) const {
        Pieces corners;
        const Vector3<S> a = cast<S>(s.half_extents);
        for (int i = 0; i < 8; ++i)
            corners.push_back(point(i & 1 ? a[0] : S(-a[0]), i & 2 ? a[1] : S(-a[1]), i & 4 ? a[2] : S(-a[2])));
        return corners;
    }
    Pieces operator()(const SolidSphere& s) const { return {ball(S(0), S(0), S(0), S(s.radius))}; }
    Pieces operator()(const HollowSphere& s) const { return {ball(S(0), S(0), S(0), S(s.outer_radius))}; }
    Pieces operator()(const Cylinder& s) const {
        return {disc(S(s.radius), S(-s.half_height)), disc(S(s.radius), S(s.half_height))};
    }
    Pieces operator()(const HollowCylinder& s) const {
        return {disc(S(s.outer_radius), S(-s.half_height)), disc(S(s.outer_radius), S(s.half_height))};
    }
    Pieces operator()(const Capsule& s) const {
        return {ball(S(0), S(0), S(-s.half_height), S(s.radius)), ball(S(0), S(0), S(s.half_height), S(s.radius))};
    }
    Pieces operator()(const Cone& s) const {
        const S quarter = S(s.height) / S(4);
        return {disc(S(s.radius), S(-quarter)), point(S(0), S(0), S(3) * quarter)};
    }
    Pieces operator()(const Ellipsoid& s) const {
        SupportPiece<S> piece;
        piece.extended = true, piece.semi_axes = diagonal(cast<S>(s.semi_axes));
        return {piece};
    }
    Pieces operator()(const Torus& s) const {
        SupportPiece<S> piece = disc(S(s.major_radius), S(0));
        piece.radius = S(s.minor_radius);
        return {piece};
    }
    Pieces operator()(const ThinRod& s) const {
        const S half = S(s.length) / S(2);
        return {point(S(0), S(0), S(-half)), point(S(0), S(0), half)};
    }
    Pieces operator()(const ThinDisc& s) const { return {disc(S(s.radius), S(0))}; }
    Pieces operator()(const ThinPlate& s) const {
        const S a(s.half_extents[0]), b(s.half_extents[1]);
        return {point(a, b, S(0)), point(a, S(-b), S(0)), point(S(-a), b, S(0)), point(S(-a), S(-b), S(0))};
    }
    Pieces operator()(const Tetrahedron& s) const {
        Pieces corners;
        for (const Vector3<double>& v : s.vertices) corners.push_back(point(S(v[0]), S(v[1]), S(v[2])));
        return corners;
    }
    Pieces operator()(const Frustum& s) const {
        // the centre of mass lies above the base by h (R^2 + 2 R r + 3 r^2) / (4 (R^2 + R r + r^2))
        const S R(s.bottom_radius), r(s.top_radius), h(s.height);
        const S base = -h * (R * R + S(2) * R * r + S(3) * r * r) / (S(4) * (R * R + R * r + r * r));
        return {disc(R, base), disc(r, base + h)};
    }
};

/// Pieces whose convex hull is that of the shape, from its origin (m).
template <class S>
std::vector<SupportPiece<S>> support(const Shape& shape) {
    return std::visit(SupportOf<S>{}, shape);
}

/// The hull of a mesh is the hull of its vertices.
template <class S>
std::vector<SupportPiece<S>> support(const Mesh& mesh) {
    std::vector<SupportPiece<S>> pieces;
    pieces.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vector3<S> v = mesh.vertex<S>(i);
        pieces.push_back(SupportOf<S>::point(v[0], v[1], v[2]));
    }
    return pieces;
}

}  // namespace polhode
