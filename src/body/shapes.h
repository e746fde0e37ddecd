// Mass properties of bodies of uniform density in closed form.
//
// Each shape (Box, Cylinder, ..) is centred on its origin with its axis along z; lengths are in m. ExtentOf<S>
// evaluates size, mean and second central moment of each shape in the scalar S; uniform_body() turns them into mass
// properties. All formulas are the standard moment integrals, arranged as sums of positive terms to avoid
// cancellation.
#pragma once

#include <array>
#include <iterator>
#include <variant>

#include "body/elementary.h"
#include "body/mass_properties.h"

namespace polhode {

struct Box {
    Vector3<double> half_extents;
};
struct SolidSphere {
    double radius = 0;
};
struct HollowSphere {
    double outer_radius = 0, inner_radius = 0;  ///< equal radii: a thin shell
};
struct Cylinder {
    double radius = 0, half_height = 0;
};
struct HollowCylinder {
    double outer_radius = 0, inner_radius = 0, half_height = 0;
};
struct Capsule {
    double radius = 0, half_height = 0;  ///< half height of the cylinder between the hemispheres
};
/// The base is at -height/4: the origin is the centre of mass.
struct Cone {
    double radius = 0, height = 0;
};
struct Ellipsoid {
    Vector3<double> semi_axes;
};
struct Torus {
    double major_radius = 0, minor_radius = 0;
};
struct ThinRod {
    double length = 0;
};
struct ThinDisc {
    double radius = 0;
};
struct ThinPlate {
    std::array<double, 2> half_extents{};
};
/// Vertices in any position. The centre of mass is their mean.
struct Tetrahedron {
    std::array<Vector3<double>, 4> vertices;  ///< not coplanar
};
/// A truncated cone. The origin is its centre of mass.
struct Frustum {
    double bottom_radius = 0, top_radius = 0, height = 0;
};

using Shape = std::variant<Box, SolidSphere, HollowSphere, Cylinder, HollowCylinder, Capsule, Cone, Ellipsoid, Torus,
                           ThinRod, ThinDisc, ThinPlate, Tetrahedron, Frustum>;

/// The geometry of a uniform shape, independent of its mass: its size (volume in m^3; area in m^2 of a disc or plate;
/// length in m of a rod), the mean of r (m) and the mean of (r - mean)(r - mean)^T (m^2).
template <class S>
struct Extent {
    S size = S(0);
    Vector3<S> mean;
    Matrix3<S> spread;
};

/// Six times the signed volume of a tetrahedron (m^3), by the order of its vertices.
inline Wide six_volumes(const Tetrahedron& s) {
    const auto edge = [&](int i) { return cast<Wide>(s.vertices[i]) - cast<Wide>(s.vertices[0]); };
    return dot(edge(1), cross(edge(2), edge(3)));
}
/// Whether the signed volume is negative.
inline bool is_left_handed(const Tetrahedron& s) { return six_volumes(s) < 0; }

// Only sums of positive terms, so that nothing cancels, even in a thin shell.
template <class S>
struct ExtentOf {
    static S pi() { return Elementary<S>::pi(); }
    static Extent<S> centred(const S& size, const S& x, const S& y, const S& z) {
        return {size, {}, diagonal(Vector3<S>(x, y, z))};
    }

    Extent<S> operator()(const Box& s) const {
        const Vector3<S> a = cast<S>(s.half_extents);
        return centred(S(8) * a[0] * a[1] * a[2], a[0] * a[0] / S(3), a[1] * a[1] / S(3), a[2] * a[2] / S(3));
    }
    Extent<S> operator()(const SolidSphere& s) const {
        const S r(s.radius), square = r * r / S(5);
        return centred(S(4) * pi() * r * r * r / S(3), square, square, square);
    }
    Extent<S> operator()(const HollowSphere& s) const {
        // (R^5 - r^5) / (5 (R^3 - r^3)), with R - r divided out
        const S R(s.outer_radius), r(s.inner_radius);
        const S second = R * R + R * r + r * r;
        const S fourth = R * R * R * R + R * R * R * r + R * R * r * r + R * r * r * r + r * r * r * r;
        const S square = fourth / (S(5) * second);
        return centred(S(4) * pi() * (R - r) * second / S(3), square, square, square);
    }
    Extent<S> operator()(const Cylinder& s) const {
        const S r(s.radius), h(s.half_height), square = r * r / S(4);
        return centred(S(2) * pi() * r * r * h, square, square, h * h / S(3));
    }
    Extent<S> operator()(const HollowCylinder& s) const {
        const S R(s.outer_radius), r(s.inner_radius), h(s.half_height), square = (R * R + r * r) / S(4);
        return centred(S(2) * pi() * (R - r) * (R + r) * h, square, square, h * h / S(3));
    }
    Extent<S> operator()(const Capsule& s) const {
        // beyond z = h, each hemisphere has mean 3 r / 8 of z - h and mean r^2 / 5 of its square; sizes are in units
        // of pi r^2
        const S r(s.radius), h(s.half_height), tube = S(2) * h, caps = S(4) * r / S(3), whole = tube + caps;
        const S across = (tube * r * r / S(4) + caps * r * r / S(5)) / whole;
        const S along = (tube * h * h / S(3) + caps * (h * h + S(3) * h * r / S(4) + r * r / S(5))) / whole;
        return centred(pi() * r * r * whole, across, across, along);
    }
    Extent<S> operator()(const Cone& s) const {
        const S r(s.radius), h(s.height), across = S(3) * r * r / S(20);
        return centred(pi() * r * r * h / S(3), across, across, S(3) * h * h / S(80));
    }
    Extent<S> operator()(const Ellipsoid& s) const {
        const Vector3<S> a = cast<S>(s.semi_axes);
        return centred(S(4) * pi() * a[0] * a[1] * a[2] / S(3), a[0] * a[0] / S(5), a[1] * a[1] / S(5),
                       a[2] * a[2] / S(5));
    }
    Extent<S> operator()(const Torus& s) const {
        const S R(s.major_radius), r(s.minor_radius), across = R * R / S(2) + S(3) * r * r / S(8);
        return centred(S(2) * pi() * pi() * R * r * r, across, across, r * r / S(4));
    }
    Extent<S> operator()(const ThinRod& s) const {
        const S l(s.length);
        return centred(l, S(0), S(0), l * l / S(12));
    }
    Extent<S> operator()(const ThinDisc& s) const {
        const S r(s.radius), square = r * r / S(4);
        return centred(pi() * r * r, square, square, S(0));
    }
    Extent<S> operator()(const ThinPlate& s) const {
        const S a(s.half_extents[0]), b(s.half_extents[1]);
        return centred(S(4) * a * b, a * a / S(3), b * b / S(3), S(0));
    }
    Extent<S> operator()(const Tetrahedron& s) const {
        std::array<Vector3<S>, 4> v;
        Vector3<S> mean;
        for (int i = 0; i < 4; ++i) v[i] = cast<S>(s.vertices[i]), mean = mean + v[i];
        mean = Vector3<S>(mean[0] / S(4), mean[1] / S(4), mean[2] / S(4));
        // six times the volume, signed by the order of the vertices
        const S six = dot(Vector3<S>(v[1] - v[0]), cross(Vector3<S>(v[2] - v[0]), Vector3<S>(v[3] - v[0])));
        Extent<S> e{(is_left_handed(s) ? S(-six) : six) / S(6), mean, {}};
        for (int i = 0; i < 4; ++i) {
            const Vector3<S> d = v[i] - mean;
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) e.spread[j][k] = e.spread[j][k] + d[j] * d[k] / S(20);
        }
        return e;
    }
    Extent<S> operator()(const Frustum& s) const {
        const S R(s.bottom_radius), r(s.top_radius), h(s.height);
        const S second = R * R + R * r + r * r;
        const S fourth = R * R * R * R + R * R * R * r + R * R * r * r + R * r * r * r + r * r * r * r;
        const S along =
            S(3) * h * h *
            (R * R * R * R + S(4) * R * R * R * r + S(10) * R * R * r * r + S(4) * R * r * r * r + r * r * r * r) /
            (S(80) * second * second);
        const S across = S(3) * fourth / (S(20) * second);
        return centred(pi() * h * second / S(3), across, across, along);
    }
};

/// The shape's name in scene files.
inline const char* name_of(const Shape& shape) {
    constexpr const char* names[] = {"box",     "sphere", "hollow_sphere", "cylinder", "hollow_cylinder",
                                     "capsule", "cone",   "ellipsoid",     "torus",    "rod",
                                     "disc",    "plate",  "tetrahedron",   "frustum"};
    static_assert(std::size(names) == std::variant_size_v<Shape>);
    return names[shape.index()];
}

/// The geometry of a shape, in the scalar S.
template <class S>
Extent<S> extent(const Shape& shape) {
    return std::visit(ExtentOf<S>{}, shape);
}

/// The mass properties of a uniform body of this mass (kg): I = m (trace(C) 1 - C), where C is the spread.
template <class S>
MassProperties<S> uniform_body(const Extent<S>& e, const S& mass) {
    MassProperties<S> body{mass, e.mean, {}};
    const S trace = e.spread[0][0] + e.spread[1][1] + e.spread[2][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            body.inertia[i][j] = mass * (i == j ? S(trace - e.spread[i][i]) : S(S(0) - e.spread[i][j]));
    return body;
}

/// The mass properties of a uniform shape of this mass (kg).
template <class S>
MassProperties<S> body_from_mass(const Shape& shape, const S& mass) {
    return uniform_body(extent<S>(shape), mass);
}
/// Density in kg/m^3; in kg/m^2 for a disc or plate, in kg/m for a rod.
template <class S>
MassProperties<S> body_from_density(const Shape& shape, const S& density) {
    const Extent<S> e = extent<S>(shape);
    return uniform_body(e, S(density * e.size));
}

}  // namespace polhode
