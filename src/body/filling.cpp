#include "body/filling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace polhode {
namespace {

double square(double x) { return x * x; }

struct Contains {
    double x, y, z;

    double across2() const { return x * x + y * y; }

    bool operator()(const Box& s) const {
        return std::abs(x) <= s.half_extents[0] && std::abs(y) <= s.half_extents[1] && std::abs(z) <= s.half_extents[2];
    }
    bool operator()(const SolidSphere& s) const { return across2() + z * z <= square(s.radius); }
    bool operator()(const HollowSphere& s) const {
        const double r2 = across2() + z * z;
        return r2 <= square(s.outer_radius) && r2 >= square(s.inner_radius);
    }
    bool operator()(const Cylinder& s) const { return across2() <= square(s.radius) && std::abs(z) <= s.half_height; }
    bool operator()(const HollowCylinder& s) const {
        return across2() <= square(s.outer_radius) && across2() >= square(s.inner_radius) &&
               std::abs(z) <= s.half_height;
    }
    bool operator()(const Capsule& s) const {
        return across2() + square(std::max(std::abs(z) - s.half_height, 0.0)) <= square(s.radius);
    }
    bool operator()(const Cone& s) const {
        const double share = 0.75 - z / s.height;  // fraction of the base radius at this height
        return share >= 0 && share <= 1 && across2() <= square(share * s.radius);
    }
    bool operator()(const Ellipsoid& s) const {
        return square(x / s.semi_axes[0]) + square(y / s.semi_axes[1]) + square(z / s.semi_axes[2]) <= 1;
    }
    bool operator()(const Torus& s) const {
        return square(std::sqrt(across2()) - s.major_radius) + z * z <= square(s.minor_radius);
    }
    bool operator()(const ThinRod&) const { return false; }
    bool operator()(const ThinDisc&) const { return false; }
    bool operator()(const ThinPlate&) const { return false; }
    bool operator()(const Tetrahedron& s) const {
        // inside: on the same side of each face as the opposite vertex
        const Vector3<double> p(x, y, z);
        for (int i = 0; i < 4; ++i) {
            const Vector3<double>&a = s.vertices[(i + 1) % 4], &b = s.vertices[(i + 2) % 4],
                  &c = s.vertices[(i + 3) % 4];
            const Vector3<double> normal = cross(b - a, c - a);
            if (dot(normal, p - a) * dot(normal, s.vertices[i] - a) < 0) return false;
        }
        return true;
    }
    bool operator()(const Frustum& s) const {
        const double share = (z - bottom_of(s)) / s.height;
        return share >= 0 && share <= 1 &&
               across2() <= square(s.bottom_radius + share * (s.top_radius - s.bottom_radius));
    }
    // the centre of mass is h (R^2 + 2 R r + 3 r^2) / (4 (R^2 + R r + r^2)) above the bottom
    static double bottom_of(const Frustum& s) {
        const double R = s.bottom_radius, r = s.top_radius;
        return -s.height * (R * R + 2 * R * r + 3 * r * r) / (4 * (R * R + R * r + r * r));
    }
};

struct BoundsOf {
    static Bounds around(double x, double y, double z) { return {{-x, -y, -z}, {x, y, z}}; }

    Bounds operator()(const Box& s) const { return {-s.half_extents, s.half_extents}; }
    Bounds operator()(const SolidSphere& s) const { return around(s.radius, s.radius, s.radius); }
    Bounds operator()(const HollowSphere& s) const { return around(s.outer_radius, s.outer_radius, s.outer_radius); }
    Bounds operator()(const Cylinder& s) const { return around(s.radius, s.radius, s.half_height); }
    Bounds operator()(const HollowCylinder& s) const { return around(s.outer_radius, s.outer_radius, s.half_height); }
    Bounds operator()(const Capsule& s) const { return around(s.radius, s.radius, s.half_height + s.radius); }
    Bounds operator()(const Cone& s) const {
        return {{-s.radius, -s.radius, -s.height / 4}, {s.radius, s.radius, 0.75 * s.height}};
    }
    Bounds operator()(const Ellipsoid& s) const { return {-s.semi_axes, s.semi_axes}; }
    Bounds operator()(const Torus& s) const {
        const double outer = s.major_radius + s.minor_radius;
        return around(outer, outer, s.minor_radius);
    }
    Bounds operator()(const ThinRod& s) const { return around(0, 0, s.length / 2); }
    Bounds operator()(const ThinDisc& s) const { return around(s.radius, s.radius, 0); }
    Bounds operator()(const ThinPlate& s) const { return around(s.half_extents[0], s.half_extents[1], 0); }
    Bounds operator()(const Tetrahedron& s) const {
        Bounds b{s.vertices[0], s.vertices[0]};
        for (const Vector3<double>& v : s.vertices)
            for (int i = 0; i < 3; ++i) b.low[i] = std::min(b.low[i], v[i]), b.high[i] = std::max(b.high[i], v[i]);
        return b;
    }
    Bounds operator()(const Frustum& s) const {
        const double r = std::max(s.bottom_radius, s.top_radius), bottom = Contains::bottom_of(s);
        return {{-r, -r, bottom}, {r, r, bottom + s.height}};
    }
};

void share(std::vector<PointMass<double>>& points, double mass) {
    for (PointMass<double>& point : points) point.mass = mass / static_cast<double>(points.size());
}

// SplitMix64 (Steele, Lea & Flood 2014, OOPSLA).
struct SplitMix64 {
    std::uint64_t state;

    /// uniform in [0, 1)
    double next() {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
};

}  // namespace

bool contains(const Shape& shape, const Vector3<double>& point) {
    return std::visit(Contains{point[0], point[1], point[2]}, shape);
}

Bounds bounds(const Shape& shape) { return std::visit(BoundsOf{}, shape); }

std::vector<PointMass<double>> grid_points(const Shape& shape, double mass, int n) {
    const Bounds box = bounds(shape);
    const auto at = [&](int axis, int i) { return box.low[axis] + (box.high[axis] - box.low[axis]) * ((i + 0.5) / n); };
    std::vector<PointMass<double>> points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                const Vector3<double> p(at(0, i), at(1, j), at(2, k));
                if (contains(shape, p)) points.push_back({0, p});
            }
    share(points, mass);
    return points;
}

std::vector<PointMass<double>> random_points(const Shape& shape, double mass, long count, unsigned long seed) {
    const auto [low, high] = bounds(shape);
    if (std::holds_alternative<ThinRod>(shape) || std::holds_alternative<ThinDisc>(shape) ||
        std::holds_alternative<ThinPlate>(shape))
        throw std::invalid_argument("a rod, disc or plate has no points inside");
    SplitMix64 dice{seed};
    std::vector<PointMass<double>> points;
    points.reserve(static_cast<std::size_t>(count));
    while (static_cast<long>(points.size()) < count) {
        Vector3<double> p;
        for (int i = 0; i < 3; ++i) p[i] = low[i] + (high[i] - low[i]) * dice.next();
        if (contains(shape, p)) points.push_back({0, p});
    }
    share(points, mass);
    return points;
}

}  // namespace polhode
