#include "motion/contact.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

Scene over_floor(const Shape& shape) {
    Scene scene;
    scene.name = "over the floor", scene.duration = 1;
    scene.body = body_of(body_source(ShapedBody{shape, {1, false}}));
    scene.planes = {{{0, 0, 1}, 0, 1, 0}};
    return scene;
}

ContactGeometry<double> geometry_of(const Scene& scene, const Quaternion<double>& q_BP = {}) {
    return contact_geometry(scene, scene.body.center_of_mass, q_BP);
}

Placement<double> moderate_placement() {
    return {moderate_orientation(), moderate_vector(), moderate_vector(), moderate_vector()};
}

/// The placement after the short time h at constant velocities.
Placement<double> moved(const Placement<double>& from, double h) {
    const Vector3<double> turn = 0.5 * h * from.angular_velocity_W;
    Placement<double> to = from;
    to.q = normalized(Quaternion<double>{1, turn[0], turn[1], turn[2]} * from.q);
    to.position_W = from.position_W + h * from.velocity_W;
    return to;
}

/// The rate of a gap agrees with the central difference of its distance, for corners, spheres and discs.
RC_GTEST_PROP(Gap, HasTheRateOfItsDistance, ()) {
    Scene scene = over_floor(Capsule{0.3, 0.5});
    switch (*rc::gen::inRange(0, 3)) {
        case 0:
            scene = over_floor(Box{{0.3, 0.5, 0.8}});
            break;
        case 1:
            scene = over_floor(Frustum{0.6, 0.3, 0.9});
            break;
        default:
            break;
    }
    scene.planes[0].normal_W = moderate_vector() + Vector3<double>(0, 0, 3);
    scene.planes[0].offset = moderate(-1, 1);
    const ContactGeometry<double> geometry = geometry_of(scene);
    const Placement<double> at = moderate_placement();
    const double h = 1e-4;
    for (std::size_t k = 0; k < geometry.size(); ++k) {
        const double slope =
            (geometry.gap(k, moved(at, h)).distance - geometry.gap(k, moved(at, -h)).distance) / (2 * h);
        // the gap of a disc nearly parallel to the plane has unbounded curvature
        const Vector3<double> a =
            transposed(geometry.pieces[k].semi_axes) * rotate_back(at.q, geometry.planes[0].normal_W);
        if (geometry.pieces[k].extended && length(a) < 0.05) continue;
        RC_ASSERT(std::abs(geometry.gap(k, at).rate - slope) < 1e-5);
        RC_ASSERT(std::abs(geometry.gap(k, at).distance - geometry.distances(at)[k]) < 1e-14);
    }
}

/// Distances to planes do not depend on the body axes.
RC_GTEST_PROP(ContactGeometry, DoesNotDependOnTheAxesItIsPosedIn, ()) {
    Scene scene = over_floor(Box{{0.3, 0.5, 0.8}});
    scene.planes.push_back({{1, 2, 0}, -3, 0.5, 0});
    const Quaternion<double> q_BP = moderate_orientation();
    Placement<double> at = moderate_placement(), posed = at;
    posed.q = at.q * q_BP;
    const ContactGeometry<double> a = geometry_of(scene), b = geometry_of(scene, q_BP);
    for (std::size_t plane = 0; plane < 2; ++plane)
        RC_ASSERT(std::abs(a.distance(plane, at) - b.distance(plane, posed)) < 1e-13);
    RC_ASSERT(std::abs(a.distance(at) - std::min(a.distance(0, at), a.distance(1, at))) == 0);
}

TEST(ContactGeometry, TakesTheNormalAtAnyLength) {
    Scene scene = over_floor(SolidSphere{0.5});
    scene.planes = {{{0, 0, 2}, 1, 1, 0}};  // 2 z > 1
    EXPECT_NEAR(geometry_of(scene).distance({{}, {0, 0, 3}, {}, {}}), 2, 1e-15);
}

TEST(ContactGeometry, OfPartsIsAboutTheirCommonCentreWithoutHoles) {
    // a box, a sphere beside it, and a hole that does not touch anything
    PartsBody parts;
    const auto add = [&](const Shape& shape, double density, const Vector3<double>& position) {
        parts.parts.push_back({body_source(ShapedBody{shape, {density, true}}), position, {}});
    };
    add(Box{{1, 1, 1}}, 1, {});
    add(SolidSphere{0.5}, 2, {3, 0, 0});
    add(SolidSphere{0.25}, -1, {0, 0, -2});
    Scene scene = over_floor(SolidSphere{1});
    scene.body = body_of(body_source(parts));
    scene.planes = {{{-1, 0, 0}, -10, 1, 0}, {{0, 0, 1}, 0, 1, 0}};
    const ContactGeometry<double> geometry = geometry_of(scene);
    const double center = scene.body.center_of_mass[0];
    // the sphere extends 3.5 from the centre of the box towards the wall at x = 10
    EXPECT_NEAR(geometry.distance(0, {{}, {0, 0, 5}, {}, {}}), 10 - (3.5 - center), 1e-14);
    EXPECT_NEAR(geometry.distance(1, {{}, {0, 0, 5}, {}, {}}), 4 - scene.body.center_of_mass[2], 1e-14);
}

/// A point thrown upward: z = h + v t - g t^2 / 2.
struct Throw {
    double h, v, g;
    Placement<double> operator()(double t) const {
        return {{}, {0, 0, h + t * (v - g * t / 2)}, {0, 0, v - g * t}, {}};
    }
};

TEST(FirstContact, IsTheRootOfTheParabola) {
    const ContactGeometry<double> geometry = geometry_of(over_floor(SolidSphere{0.25}));
    const Throw flight{1.25, 2, 10};  // to the floor: 1 + 2 t - 5 t^2 = 0
    const auto found = first_contact(geometry, flight, 0.0, 2.0, 20.0);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, (2 + std::sqrt(24.0)) / 10, 1e-15);
    EXPECT_FALSE(first_contact(geometry, flight, 0.0, 0.68, 20.0));
}

/// A throw from the floor: the contact at the start does not count, the return does.
TEST(FirstContact, AfterAnImpactIsTheNext) {
    const ContactGeometry<double> geometry = geometry_of(over_floor(SolidSphere{0.25}));
    for (double off : {0.0, 1e-16, -1e-16}) {
        const Throw flight{0.25 + off, 2, 10};
        const auto found = first_contact(geometry, flight, 0.0, 1.0, 12.0);
        ASSERT_TRUE(found);
        EXPECT_NEAR(*found, 0.4, 1e-15);
        EXPECT_FALSE(first_contact(geometry, flight, 0.0, 0.3, 12.0));
    }
}

TEST(FirstContact, FindsADipThatLeavesNoSignAtTheEnds) {
    // the end of a rod grazes the floor: its height is 1 - 1.0001 cos(t)
    const ContactGeometry<double> geometry = geometry_of(over_floor(ThinRod{2}));
    const auto at = [](double t) {
        const double angle = t - 1.2345;
        return Placement<double>{{std::cos(angle / 2), std::sin(angle / 2), 0, 0}, {0, 0, 0.99995}, {}, {1, 0, 0}};
    };
    const auto found = first_contact(geometry, at, 0.0, 2.0, 1.0);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, 1.2345 - std::acos(0.99995), 1e-12);
}

TEST(FirstContact, OfABodyThatIsPressedDownIsNow) {
    const ContactGeometry<double> geometry = geometry_of(over_floor(SolidSphere{0.25}));
    const auto found = first_contact(geometry, Throw{0.25, 0, 10}, 0.0, 1.0, 10.0);
    ASSERT_TRUE(found);
    EXPECT_LT(*found, 1e-2);  // at the start, or when the parabola leaves the floor
}

TEST(FirstContact, OfNaNIsNothing) {
    const ContactGeometry<double> geometry = geometry_of(over_floor(SolidSphere{0.25}));
    const double nan = std::nan("");
    const auto at = [&](double) { return Placement<double>{{}, {0, 0, nan}, {0, 0, nan}, {}}; };
    EXPECT_FALSE(first_contact(geometry, at, 0.0, 1.0, 10.0));
}

}  // namespace
}  // namespace polhode
