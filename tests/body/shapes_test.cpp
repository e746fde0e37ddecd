// Mass properties of shapes from closed forms, compared with integrals over slices, cubature, each other and mesh sums.
#include "body/shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "body/mesh.h"

namespace polhode {
namespace {

using std::numbers::pi;

double largest(const Matrix3<double>& m) {
    double size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) size = std::max(size, std::abs(m[i][j]));
    return size;
}

void expect_near(const MassProperties<double>& a, const MassProperties<double>& b, double tolerance) {
    EXPECT_NEAR(a.mass, b.mass, tolerance * std::abs(b.mass));
    const double size = largest(b.inertia);
    const double length = std::sqrt(size / std::abs(b.mass));
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a.center[i], b.center[i], tolerance * (length + std::abs(b.center[i])));
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(a.inertia[i][j], b.inertia[i][j], tolerance * size) << i << ' ' << j;
    }
}

// Contribution of one slice perpendicular to z: its area and the integrals of x^2 and y^2 over it.
struct Slice {
    double area, x2, y2;
};
Slice ring(double outer, double inner) {
    const auto fourth = [](double r) { return pi / 4 * r * r * r * r; };
    return {pi * (outer * outer - inner * inner), fourth(outer) - fourth(inner), fourth(outer) - fourth(inner)};
}

// Mass properties at density 3, integrated over z by composite five-point Gauss-Legendre quadrature. `bounds`
// separates the intervals on which the slices are smooth.
MassProperties<double> by_slices(const std::vector<double>& bounds, const std::function<Slice(double)>& slice) {
    constexpr double density = 3;
    constexpr double x[] = {0, 0.5384693101056831, 0.906179845938664},
                     w[] = {128.0 / 225, 0.4786286704993665, 0.23692688505618908};
    double volume = 0, xx = 0, yy = 0, z1 = 0, zz = 0;
    for (std::size_t b = 0; b + 1 < bounds.size(); ++b) {
        constexpr int pieces = 2000;
        // nodes cluster at both ends, where the slices of a sphere shrink to a point: z = (1 - cos) / 2
        const auto at = [&](double u) { return bounds[b] + (bounds[b + 1] - bounds[b]) * (1 - std::cos(pi * u)) / 2; };
        const auto slope = [&](double u) { return (bounds[b + 1] - bounds[b]) * pi / 2 * std::sin(pi * u); };
        for (int i = 0; i < pieces; ++i)
            for (int k = -2; k <= 2; ++k) {
                const double u = (i + 0.5 + (k < 0 ? -0.5 : 0.5) * x[std::abs(k)]) / pieces;
                const double z = at(u), dz = 0.5 / pieces * w[std::abs(k)] * slope(u);
                const Slice s = slice(z);
                volume += s.area * dz, xx += s.x2 * dz, yy += s.y2 * dz, z1 += z * s.area * dz,
                    zz += z * z * s.area * dz;
            }
    }
    const double center = z1 / volume, z2 = zz - center * center * volume;
    return {density * volume, {0, 0, center}, diagonal(density * Vector3<double>(yy + z2, xx + z2, xx + yy))};
}

double round(double radius, double z) { return std::sqrt(std::max(0.0, radius * radius - z * z)); }

TEST(Shapes, AreTheIntegralsOverTheirSlices) {
    const auto expect = [](const Shape& shape, const std::vector<double>& bounds,
                           const std::function<Slice(double)>& f) {
        expect_near(body_from_density<double>(shape, 3), by_slices(bounds, f), 1e-11);
    };
    expect(Box{{0.5, 1.25, 2}}, {-2, 2}, [](double) { return Slice{2.5, 2.5 * 0.25 / 3, 2.5 * 1.5625 / 3}; });
    expect(SolidSphere{1.5}, {-1.5, 1.5}, [](double z) { return ring(round(1.5, z), 0); });
    expect(HollowSphere{1.5, 0.75}, {-1.5, -0.75, 0.75, 1.5},
           [](double z) { return ring(round(1.5, z), round(0.75, z)); });
    expect(Cylinder{0.75, 2}, {-2, 2}, [](double) { return ring(0.75, 0); });
    expect(HollowCylinder{0.75, 0.25, 2}, {-2, 2}, [](double) { return ring(0.75, 0.25); });
    expect(Capsule{0.5, 2}, {-2.5, -2, 2, 2.5},
           [](double z) { return ring(std::abs(z) < 2 ? 0.5 : round(0.5, std::abs(z) - 2), 0); });
    expect(Cone{0.5, 2}, {-0.5, 1.5}, [](double z) { return ring(0.5 * (1.5 - z) / 2, 0); });
    expect(Ellipsoid{{0.5, 1.25, 2}}, {-2, 2}, [](double z) {
        const double shrunk = round(2, z) / 2, a = 0.5 * shrunk, b = 1.25 * shrunk;
        return Slice{pi * a * b, pi * a * a * a * b / 4, pi * a * b * b * b / 4};
    });
    expect(Torus{2, 0.5}, {-0.5, 0.5}, [](double z) { return ring(2 + round(0.5, z), 2 - round(0.5, z)); });
    // these slices are measured from the base, the frustum from its centre of mass: only the centres may differ
    const MassProperties<double> from_base = by_slices({0, 2}, [](double z) { return ring(0.75 - 0.25 * z, 0); });
    MassProperties<double> frustum = body_from_density<double>(Frustum{0.75, 0.25, 2}, 3);
    EXPECT_EQ(frustum.center[2], 0);
    frustum.center = from_base.center;
    expect_near(frustum, from_base, 1e-11);
}

// thin shapes are the limits of thick ones
TEST(Shapes, ThinOnesAreLimits) {
    constexpr double thin = 1e-6;
    const auto expect = [](const Shape& limit, const Shape& near, double tolerance) {
        expect_near(body_from_mass<double>(near, 2), body_from_mass<double>(limit, 2), tolerance);
    };
    expect(ThinRod{3}, Cylinder{thin, 1.5}, 1e-11);
    expect(ThinDisc{1.5}, Cylinder{1.5, thin}, 1e-11);
    expect(ThinPlate{{0.5, 1.5}}, Box{{0.5, 1.5, thin}}, 1e-11);
    expect(HollowSphere{1.5, 1.5}, HollowSphere{1.5, 1.5 - thin}, 2e-6);
    EXPECT_NEAR(body_from_mass<double>(HollowSphere{1.5, 1.5}, 2).inertia[0][0], 2 * 2 * 1.5 * 1.5 / 3, 1e-15);
    EXPECT_EQ(body_from_mass<double>(Frustum{0.5, 0, 2}, 1).inertia, body_from_mass<double>(Cone{0.5, 2}, 1).inertia);
    expect(Cylinder{0.5, 1}, Frustum{0.5, 0.5, 2}, 1e-15);
    expect(SolidSphere{0.5}, Capsule{0.5, 0}, 1e-15);
}

double any(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1 << 30)) / (1 << 30); }
Vector3<double> any_vector(double size) { return {any(-size, size), any(-size, size), any(-size, size)}; }
Quaternion<double> any_turn() {
    Quaternion<double> q{any(-1, 1), any(-1, 1), any(-1, 1), any(0.1, 1)};
    const double norm = std::sqrt(squared_norm(q));
    return {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
}

// Keast's four-point rule integrates every quadratic polynomial over a tetrahedron exactly.
RC_GTEST_PROP(Shapes, TetrahedronIsItsCubature, ()) {
    Tetrahedron t;
    for (Vector3<double>& v : t.vertices) v = any_vector(2);
    const MassProperties<double> found = body_from_mass<double>(t, 1.5);
    const double near = (5 + 3 * std::sqrt(5)) / 20, far = (5 - std::sqrt(5)) / 20;
    std::vector<PointMass<double>> points;
    for (int i = 0; i < 4; ++i) {
        Vector3<double> p;
        for (int j = 0; j < 4; ++j) p = p + (i == j ? near : far) * t.vertices[j];
        points.push_back({1.5 / 4, p});
    }
    expect_near(body_from_points(points), found, 1e-13);
}

Mesh mesh_of(const Tetrahedron& t) {
    Mesh mesh{{t.vertices.begin(), t.vertices.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
    return mesh;
}

Mesh mesh_of(const Box& box) {
    Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.vertices.push_back({(k & 1 ? 1 : -1) * box.half_extents[0], (k & 2 ? 1 : -1) * box.half_extents[1],
                                 (k & 4 ? 1 : -1) * box.half_extents[2]});
    for (const std::array<int, 4>& side :
         {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        mesh.triangles.push_back({side[0], side[1], side[2]}), mesh.triangles.push_back({side[0], side[2], side[3]});
    return mesh;
}

MassProperties<double> of_mesh(const Mesh& mesh, double density) {
    const Extent<double> extent = mesh_extent<double>(mesh);
    return uniform_body(extent, density * extent.size);
}

RC_GTEST_PROP(Mesh, IsTheBodyThatItBounds, ()) {
    const Box box{{any(0.1, 2), any(0.1, 2), any(0.1, 2)}};
    const Vector3<double> position = any_vector(5);
    const Quaternion<double> turn = any_turn();
    Mesh mesh = mesh_of(box);
    RC_ASSERT(mesh_fault(mesh).empty());
    for (Vector3<double>& v : mesh.vertices) v = position + rotate(turn, v);
    const MassProperties<double> expected = placed(body_from_density<double>(box, 2.5), position, turn);
    expect_near(of_mesh(mesh, 2.5), expected, 1e-13);
    const double volume = enclosed_volume(mesh);
    RC_ASSERT(std::abs(volume * 2.5 - expected.mass) <= 1e-14 * expected.mass);
    // inside out: the enclosed volume is negative
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    RC_ASSERT(mesh_fault(mesh).empty());
    RC_ASSERT(enclosed_volume(mesh) == -volume);

    Tetrahedron t;
    for (Vector3<double>& v : t.vertices) v = any_vector(2);
    const MassProperties<double> whole = body_from_density<double>(t, 2);
    if (is_left_handed(t)) std::swap(t.vertices[0], t.vertices[1]);
    if (whole.mass > 0.01) expect_near(of_mesh(mesh_of(t), 2), whole, 1e-11);
}

TEST(Mesh, SaysWhyItBoundsNoBody) {
    Mesh mesh = mesh_of(Box{{1, 1, 1}});
    const auto fault = [&](const auto& change) {
        Mesh changed = mesh;
        change(changed);
        return mesh_fault(changed);
    };
    EXPECT_EQ(mesh_fault(mesh), "");
    EXPECT_NE(fault([](Mesh& m) { m.triangles.pop_back(); }).find("3 edges are not traversed"), std::string::npos);
    EXPECT_NE(fault([](Mesh& m) { std::swap(m.triangles[3][0], m.triangles[3][1]); }).find("not a closed surface"),
              std::string::npos);
    EXPECT_NE(fault([](Mesh& m) { m.triangles[2] = {1, 8, 2}; }).find("does not exist"), std::string::npos);
    EXPECT_NE(fault([](Mesh& m) { m.triangles.push_back(m.triangles[0]); }).find("not a closed surface"),
              std::string::npos);
    EXPECT_NE(fault([](Mesh& m) { m.triangles.clear(); }).find("no triangles"), std::string::npos);
    // separate corners for each triangle, as in a file of bare triangles (STL)
    Mesh apart;
    for (const auto& triangle : mesh.triangles) {
        const int n = static_cast<int>(apart.vertices.size());
        for (const int corner : triangle) apart.vertices.push_back(mesh.vertices[corner]);
        apart.triangles.push_back({n, n + 1, n + 2});
    }
    EXPECT_EQ(mesh_fault(apart), "");
}

// Degenerate triangles and edges shared by two closed parts do not change the volume integrals.
TEST(Mesh, BalancedEdgesAreEnough) {
    const Mesh box = mesh_of(Box{{1, 1, 1}});
    Mesh with_slivers = box;
    with_slivers.triangles.push_back({1, 1, 2});
    with_slivers.triangles.push_back({0, 3, 5}), with_slivers.triangles.push_back({0, 5, 3});
    EXPECT_EQ(mesh_fault(with_slivers), "");
    expect_near(of_mesh(with_slivers, 2), of_mesh(box, 2), 1e-15);
    // two boxes that share an edge
    Mesh two = box;
    const int n = static_cast<int>(box.vertices.size());
    for (const Vector3<double>& v : box.vertices) two.vertices.push_back(v + Vector3<double>(2, 2, 0));
    for (const std::array<int, 3>& t : box.triangles) two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    EXPECT_EQ(mesh_fault(two), "");
    const MassProperties<double> one = of_mesh(box, 2);
    const Quaternion<double> none{1, 0, 0, 0};
    expect_near(of_mesh(two, 2), composite<double>({one, placed(one, {2, 2, 0}, none)}), 1e-14);
}

// Scaling the mesh equals scaling its coordinates.
RC_GTEST_PROP(Mesh, ScaleMultipliesCoordinates, ()) {
    const Vector3<double> scale(any(0.1, 3), -any(0.1, 3), any(0.1, 3));
    Mesh mesh = mesh_of(Box{{any(0.1, 2), any(0.1, 2), any(0.1, 2)}}), scaled = mesh;
    for (Vector3<double>& v : scaled.vertices)
        for (int i = 0; i < 3; ++i) v[i] *= scale[i];
    for (std::array<int, 3>& t : scaled.triangles)
        std::swap(t[0], t[1]);  // a mirrored mesh has the opposite orientation
    mesh.scale = scale;
    expect_near(of_mesh(mesh, 2), of_mesh(scaled, 2), 1e-13);
}

// A box equals two half boxes, one of them rotated by pi. A sphere with a spherical hole equals a hollow sphere.
RC_GTEST_PROP(Composite, PartsMakeTheWhole, ()) {
    const double a = any(0.1, 1), b = any(0.1, 1), c = any(0.2, 1);
    const Quaternion<double> none{1, 0, 0, 0}, about_x{0, 1, 0, 0};
    const auto box = [&](double half) { return body_from_density<double>(Box{{a, b, half}}, 3); };
    const MassProperties<double> halves =
        composite<double>({placed(box(c / 2), {0, 0, c / 2}, none), placed(box(c / 2), {0, 0, -c / 2}, about_x)});
    expect_near(halves, box(c), 1e-14);
    const MassProperties<double> cored = composite<double>(
        {body_from_density<double>(SolidSphere{1.5}, 2), body_from_density<double>(SolidSphere{0.75}, -2)});
    expect_near(cored, body_from_density<double>(HollowSphere{1.5, 0.75}, 2), 1e-14);
    // rotating the whole equals rotating each part
    const Vector3<double> position = any_vector(3);
    const Quaternion<double> turn = any_turn();
    expect_near(placed(halves, position, turn), placed(box(c), position, turn), 1e-13);
}

}  // namespace
}  // namespace polhode
