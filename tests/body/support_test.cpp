#include "body/support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;
using std::numbers::pi;

double lowest(const std::vector<SupportPiece<double>>& pieces, const Vector3<double>& n) {
    double least = pieces.front().lowest(n);
    for (const SupportPiece<double>& piece : pieces) least = std::min(least, piece.lowest(n));
    return least;
}

/// The smallest n.x over many points of the surface: an upper bound of the support, and close to it.
template <class Surface>
double sampled(const Vector3<double>& n, const Surface& surface) {
    constexpr int count = 400;
    double least = 1e300;
    for (int i = 0; i <= count; ++i)
        for (int j = 0; j < count; ++j)
            least = std::min(least, dot(n, surface(double(i) / count, 2 * std::numbers::pi * j / count)));
    return least;
}

Vector3<double> around(double radius, double angle, double z) {
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Each shape's support agrees with the minimum over surface points from an independent parametrisation: s runs along
/// a meridian from end to end, and the second parameter is the angle about the axis.
RC_GTEST_PROP(Support, IsTheLowestPointOfTheSurface, ()) {
    const Vector3<double> v = moderate_vector();
    const double size = length(v);
    const Vector3<double> n = size > 1e-3 ? (1 / size) * v : Vector3<double>(0, 0, 1);
    const double a = moderate(0.3, 2), b = moderate(0.1, 0.3), h = moderate(0.2, 2);
    struct Case {
        Shape shape;
        std::function<Vector3<double>(double, double)> surface;
    };
    const auto sphere = [&](double radius) {
        return [=](double s, double phi) { return around(radius * std::sin(pi * s), phi, radius * std::cos(pi * s)); };
    };
    const auto band = [](double bottom, double top, double from, double to) {
        return [=](double s, double phi) { return around(bottom + s * (top - bottom), phi, from + s * (to - from)); };
    };
    const double centroid = h * (a * a + 2 * a * b + 3 * b * b) / (4 * (a * a + a * b + b * b));
    const std::vector<Case> cases = {
        {SolidSphere{a}, sphere(a)},
        {HollowSphere{a, b}, sphere(a)},
        {Cylinder{a, h}, band(a, a, -h, h)},
        {HollowCylinder{a, b, h}, band(a, a, -h, h)},
        {Capsule{b, h},
         [&](double s, double phi) { return sphere(b)(s, phi) + Vector3<double>(0, 0, s < 0.5 ? h : -h); }},
        {Cone{a, h}, band(a, 0, -h / 4, 3 * h / 4)},
        {Ellipsoid{{a, b, h}},
         [&](double s, double phi) {
             const Vector3<double> u = sphere(1)(s, phi);
             return Vector3<double>(a * u[0], b * u[1], h * u[2]);
         }},
        {Torus{a, b},
         [&](double s, double phi) { return around(a + b * std::cos(2 * pi * s), phi, b * std::sin(2 * pi * s)); }},
        {ThinRod{h}, band(0, 0, -h / 2, h / 2)},
        {ThinDisc{a}, band(0, a, 0, 0)},
        {Frustum{a, b, h}, band(a, b, -centroid, h - centroid)},
    };
    const Case& one = cases[*rc::gen::inRange<std::size_t>(0, cases.size())];
    const double found = lowest(support<double>(one.shape), n), seen = sampled(n, one.surface);
    // the grid misses the lowest point by half a cell, (2 pi / 400)^2 / 8 times the radius of curvature
    RC_ASSERT(found <= seen + 1e-12);
    RC_ASSERT(seen - found < 2e-3 * (a + h));
}

RC_GTEST_PROP(Support, OfFlatSidedShapesIsTheirLowestCorner, ()) {
    const Vector3<double> v = moderate_vector();
    const Vector3<double> n = (1 / (length(v) + 1e-9)) * v;
    const Vector3<double> a(moderate(0.1, 2), moderate(0.1, 2), moderate(0.1, 2));
    const double box = -(a[0] * std::abs(n[0]) + a[1] * std::abs(n[1]) + a[2] * std::abs(n[2]));
    RC_ASSERT(std::abs(lowest(support<double>(Box{a}), n) - box) < 1e-14);
    const double plate = -(a[0] * std::abs(n[0]) + a[1] * std::abs(n[1]));
    RC_ASSERT(std::abs(lowest(support<double>(ThinPlate{{a[0], a[1]}}), n) - plate) < 1e-14);
    Tetrahedron tetrahedron;
    Mesh mesh;
    double corner = 1e300;
    for (Vector3<double>& vertex : tetrahedron.vertices) {
        vertex = moderate_vector();
        mesh.vertices.push_back(vertex);
        corner = std::min(corner, dot(n, vertex));
    }
    RC_ASSERT(lowest(support<double>(tetrahedron), n) == corner);
    RC_ASSERT(lowest(support<double>(mesh), n) == corner);
}

/// The lowest point has the lowest height, rotated or not, and lies within `reach`.
RC_GTEST_PROP(SupportPiece, HasItsLowestPointWhereItSays, ()) {
    SupportPiece<double> piece;
    piece.center = moderate_vector(), piece.radius = moderate(0, 1);
    piece.extended = *rc::gen::arbitrary<bool>();
    if (piece.extended)
        for (int i = 0; i < 3; ++i) piece.semi_axes[i] = moderate_vector();
    const Quaternion<double> q = moderate_orientation();
    const Vector3<double> shift = moderate_vector(), n = rotate(moderate_orientation(), Vector3<double>(0, 0, 1));
    const SupportPiece<double> moved = placed(piece, shift, q);
    RC_ASSERT(std::abs(dot(n, moved.lowest_point(n)) - moved.lowest(n)) < 1e-13);
    const Vector3<double> before = shift + rotate(q, piece.lowest_point(rotate_back(q, n)));
    RC_ASSERT(distance(moved.lowest_point(n), before) < 1e-9);
    RC_ASSERT(length(moved.lowest_point(n)) <= moved.reach() + 1e-14);
}

TEST(SupportPiece, OfADiscThatLiesFlatIsItsMiddle) {
    const SupportPiece<double> disc = support<double>(ThinDisc{0.7}).front();
    EXPECT_EQ(disc.lowest({0, 0, 1}), 0);
    EXPECT_EQ(disc.lowest_point({0, 0, 1}), Vector3<double>());
    EXPECT_EQ(disc.lowest({1, 0, 0}), -0.7);
}

}  // namespace
}  // namespace polhode
