// Mass, centre of mass and inertia of bodies composed of placed and rotated parts, over any scalar.
#pragma once

#include <vector>

#include "body/algebra.h"
#include "body/elementary.h"
#include "body/rigid_body.h"

namespace polhode {

/// The mass properties of a body in its own axes. A negative mass represents a hole.
template <class S>
struct MassProperties {
    S mass = S(0);       ///< kg
    Vector3<S> center;   ///< centre of mass, from the origin, m
    Matrix3<S> inertia;  ///< about the centre of mass, kg m^2
};

/// q / |q|. q must not be zero.
template <class S>
Quaternion<S> normalized(const Quaternion<S>& q) {
    const S norm = square_root(squared_norm(q));
    return {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
}

/// The inertia tensor after rotation by the unit quaternion q: R I R^T.
template <class S>
Matrix3<S> rotated(const Matrix3<S>& inertia, const Quaternion<S>& q) {
    const Matrix3<S> R = rotation_matrix(q);
    return R * inertia * transposed(R);
}

/// The inertia tensor about `point` (m, from the body's origin), by the parallel axis (Steiner's) theorem.
template <class S>
Matrix3<S> about_point(const MassProperties<S>& body, const Vector3<S>& point) {
    return body.inertia + parallel_axis(body.mass, Vector3<S>(body.center - point));
}

/// The body rotated by the unit quaternion q about its origin and then translated by `position` (m).
template <class S>
MassProperties<S> placed(const MassProperties<S>& body, const Vector3<S>& position, const Quaternion<S>& q) {
    return {body.mass, position + rotate(q, body.center), rotated(body.inertia, q)};
}

/// The mass properties of all parts as one rigid body: m = sum m_i, c = sum m_i c_i / m, I = sum (I_i + Steiner's
/// term of c_i - c). If the total mass is zero, the centre of mass is the origin.
template <class S>
MassProperties<S> composite(const std::vector<MassProperties<S>>& parts) {
    MassProperties<S> whole;
    Vector3<S> moment;
    for (const MassProperties<S>& part : parts) {
        whole.mass = whole.mass + part.mass;
        moment = moment + part.mass * part.center;
    }
    if (!(whole.mass == S(0)))
        whole.center = Vector3<S>(moment[0] / whole.mass, moment[1] / whole.mass, moment[2] / whole.mass);
    for (const MassProperties<S>& part : parts) whole.inertia = whole.inertia + about_point(part, whole.center);
    return whole;
}

/// A point mass.
template <class S>
struct PointMass {
    S mass = S(0);        ///< kg
    Vector3<S> position;  ///< m
};

/// The mass properties of point masses. The tensor is sum m_i (|r_i|^2 1 - r_i r_i^T), with r_i from their centre of
/// mass.
template <class S>
MassProperties<S> body_from_points(const std::vector<PointMass<S>>& points) {
    std::vector<MassProperties<S>> parts;
    parts.reserve(points.size());
    for (const PointMass<S>& point : points) parts.push_back({point.mass, point.position, {}});
    return composite(parts);
}

}  // namespace polhode
