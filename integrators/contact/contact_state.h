// What a formulation reports about one contact, and the sizes by which its errors are measured.
#pragma once

#include <cstddef>
#include <vector>

#include "body/algebra.h"
#include "body/elementary.h"
#include "motion/contact.h"

namespace polhode::contact {

/// A pair of a plane and a piece of the hull.
struct Pair {
    std::size_t plane = 0, piece = 0;
    bool operator==(const Pair&) const = default;
};

/// Axes at a plane: two tangents and the normal, unit vectors in world axes.
template <class P>
struct ContactAxes {
    Vector3<P> first_W, second_W, normal_W;

    ContactAxes() = default;
    explicit ContactAxes(const Vector3<P>& normal) : normal_W(normal) {
        // the world axis that is least along the normal
        std::size_t least = 0;
        for (std::size_t i = 1; i < 3; ++i)
            if (Elementary<P>::magnitude(normal[i]) < Elementary<P>::magnitude(normal[least])) least = i;
        Vector3<P> axis;
        axis[least] = P(1);
        const Vector3<P> tangent = axis - dot(axis, normal) * normal;
        first_W = (P(1) / length(tangent)) * tangent;
        second_W = cross(normal, first_W);
    }
    const Vector3<P>& operator[](std::size_t i) const { return i == 0 ? first_W : i == 1 ? second_W : normal_W; }
    Vector3<P> to_world(const Vector3<P>& v) const { return v[0] * first_W + v[1] * second_W + v[2] * normal_W; }
    Vector3<P> from_world(const Vector3<P>& v) const { return {dot(v, first_W), dot(v, second_W), dot(v, normal_W)}; }
};

/// Velocity and accelerations of the body's point at a contact, in the contact's axes: a force f there adds K f to the
/// acceleration c that it has without a contact force.
template <class P>
struct ContactResponse {
    Vector3<P> velocity;      ///< u, m/s
    Vector3<P> acceleration;  ///< c, m/s^2
    Matrix3<P> matrix;        ///< K, 1/kg
};

/// Largest lengths of the motion so far.
struct Sizes {
    double angular_velocity = 0;  ///< rad/s
    double position = 0;          ///< m
    double velocity = 0;          ///< m/s
};

/// The direction of the slip after it starts: it starts along `direction` and turns towards `across` by the angle
/// sum of angle[k] (t - start)^(k + 1), rad.
template <class P>
struct SlipPath {
    Vector3<P> direction_W, across_W;  ///< unit tangents
    std::vector<P> angle;
    P start{0};  ///< s

    /// The angle at the time t, rad.
    template <class S>
    S angle_at(const S& t) const {
        S sum(0);
        for (std::size_t k = angle.size(); k-- > 0;) sum = (sum + angle[k]) * (t - start);
        return sum;
    }
    /// The direction at the time t.
    template <class S>
    Vector3<S> at(const S& t) const {
        S sine(0), cosine(1);
        sine_cosine(angle_at(t), sine, cosine);
        return cosine * direction_W + sine * across_W;
    }
    /// The direction rotated by a quarter, at the time t.
    template <class S>
    Vector3<S> across_at(const S& t) const {
        S sine(0), cosine(1);
        sine_cosine(angle_at(t), sine, cosine);
        return cosine * across_W - sine * direction_W;
    }
};

/// The rotation that a contact permits: any; about the line of an edge or the normal of a smooth face; none on a face
/// with friction.
template <class P>
struct PermittedRotation {
    enum class Kind { any, about_axis, none } kind = Kind::any;
    Vector3<P> axis_B{};  ///< unit, a principal axis of inertia
    P moment{0};          ///< about this axis, kg m^2

    /// The angular acceleration by a torque in body axes, if it is restricted.
    template <class S>
    Vector3<S> response(const Vector3<S>& torque_B) const {
        if (kind == Kind::none) return {};
        const S share = (P(1) / moment) * dot(axis_B, torque_B);
        return share * axis_B;
    }
};

/// Variables of a state with a common scale.
struct Block {
    int first, size;
    double scale;
};

/// The system that a formulation integrates.
enum class System {
    flight,
    sliding,
    onset,  ///< sliding in a direction that is known as a function of time
    rolling,
    two_contacts,  ///< a ball that touches two planes (two_contacts.h)
    shock,         ///< an impact with slip, over the normal impulse
};

}  // namespace polhode::contact
