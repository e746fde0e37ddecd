#include "body/point_kinematics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "body/orientation.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr double arm_roundings = 1e-13;

/// The component of w perpendicular to r.
Vector3<double> across(const Vector3<double>& w, const Vector3<double>& r) { return w - (dot(w, r) / dot(r, r)) * r; }

Vector3<double> moderate_arm() { return moderate_vector() + Vector3<double>(0, 0, 2.5); }

/// v = w x r and the acceleration agree with difference quotients of the position of a rotating point.
RC_GTEST_PROP(PointOfABody, MovesAsItTurns, ()) {
    const Vector3<double> w = moderate_vector(), alpha = moderate_vector(), r = moderate_arm();
    const double h = 1e-4;
    // rotation vector w t + alpha t^2 / 2 + O(t^3): central differences are accurate to O(h^2)
    const auto place = [&](double t) {
        return rotate(quaternion_from_rotation_vector(t * w + (t * t / 2) * alpha), r);
    };
    const Vector3<double> v = (1 / (2 * h)) * (place(h) - place(-h));
    const Vector3<double> a = (1 / (h * h)) * (place(h) - 2.0 * place(0) + place(-h));
    RC_ASSERT(distance(v, velocity_of_point(w, r)) < 1e-5);
    RC_ASSERT(distance(a, acceleration_of_point(w, alpha, r)) < 1e-4);
}

RC_GTEST_PROP(PointOfABody, TellsTheRateAcrossItsArm, ()) {
    const Vector3<double> w = moderate_vector(), r = moderate_arm();
    const Vector3<double> derived = angular_velocity_of_point(r, velocity_of_point(w, r));
    RC_ASSERT(distance(derived, across(w, r)) < arm_roundings);
    // the full angular velocity is recovered where the arm is perpendicular to the axis
    const Vector3<double> square = across(r, w + Vector3<double>(0, 0, 10));
    const Vector3<double> axis = w + Vector3<double>(0, 0, 10);
    RC_ASSERT(distance(angular_velocity_of_point(square, velocity_of_point(axis, square)), axis) < 100 * arm_roundings);
}

RC_GTEST_PROP(PointOfABody, TellsTheAccelerationOfTheTurn, ()) {
    const Vector3<double> w = moderate_vector(), alpha = moderate_vector(), r = moderate_arm();
    const Vector3<double> derived = angular_acceleration_of_point(r, acceleration_of_point(w, alpha, r));
    const Vector3<double> centripetal = (dot(w, r) / dot(r, r)) * cross(r, w);
    RC_ASSERT(distance(derived, across(alpha, r) + centripetal) < arm_roundings);
}

/// The sum of L = r x p over all points of a body about its centre of mass is I w.
RC_GTEST_PROP(PointOfABody, SumsToTheMomentumOfTheBody, ()) {
    const Vector3<double> w = moderate_vector();
    Matrix3<double> inertia;
    Vector3<double> L;
    for (int i = 0; i < 6; ++i) {
        const Vector3<double> r = moderate_vector();
        const double m = moderate(0.1, 2);
        inertia = inertia + parallel_axis(m, r);
        L = L + angular_momentum_of_point(r, m * velocity_of_point(w, r));
    }
    RC_ASSERT(distance(L, inertia * w) < 10 * arm_roundings);
}

/// Without the factor 1/r^2 the article's alpha is too large by the factor r^2: correct only at |r| = 1 m.
RC_GTEST_PROP(PointOfABody, AsTheArticleHasItsAccelerationIsRightAtOneMetreOnly, ()) {
    const double radius = moderate(0.1, 3);
    const Vector3<double> alpha(0, 0, moderate(0.5, 2)), r(radius, 0, 0), a = cross(alpha, r);
    RC_ASSERT(distance(angular_acceleration_of_point(r, a), alpha) < arm_roundings);
    RC_ASSERT(std::abs(angular_acceleration_as_written(r, a)[2] / alpha[2] - radius * radius) < arm_roundings);
}

}  // namespace
}  // namespace polhode
