// State of a mechanism in maximal coordinates: every body with six degrees of freedom in world axes, and the joints and
// loops between them. Numbers are rounded once to the scalar S, double or float.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "body/orientation.h"
#include "integrators/game/gyroscopic_term.h"
#include "integrators/maximal/mechanism.h"
#include "motion/finite.h"

namespace polhode::multibody {

/// A body. The world and bodies fixed to it have zero inverse mass and zero inverse inertia.
template <class S>
struct MovingBody {
    bool movable = false;
    S mass = S(0), inverse_mass = S(0);
    BodyInertia<S> inertia;  ///< about the centre of mass, body axes

    Quaternion<S> q;         ///< body to world
    Vector3<S> x, v;         ///< centre of mass
    Vector3<S> w;            ///< world axes
    Matrix3<S> R;            ///< of q
    Matrix3<S> inverse_I_W;  ///< R I^-1 R^T

    /// Updates the quantities that depend on q.
    void update_rotation() {
        R = rotation_matrix(q);
        if (movable) inverse_I_W = R * inertia.inverse * transposed(R);
    }
    Vector3<S> velocity_at(const Vector3<S>& arm_W) const { return v + cross(w, arm_W); }
    /// Rotates q by a rotation vector in world axes and normalises it.
    void rotate_by(const Vector3<S>& rotation_W) { q = normalized(quaternion_from_rotation_vector(rotation_W) * q); }
    /// q += 1/2 (0, rotation_W) q, then normalises it.
    void rotate_first_order(const Vector3<S>& rotation_W) {
        const Vector3<S> half = S(0.5) * rotation_W;
        const Quaternion<S> change = Quaternion<S>{0, half[0], half[1], half[2]} * q;
        q = normalized(Quaternion<S>{q.w + change.w, q.x + change.x, q.y + change.y, q.z + change.z});
    }
};

/// A joint or loop between two bodies, given by their numbers. The members are documented in maximal::Link.
template <class S>
struct JointPair {
    maximal::Kind kind = maximal::Kind::revolute;
    std::size_t link = 0;  ///< in the order of joints, then loops
    std::size_t from = 0, to = 0;
    Vector3<S> arm_from, arm_to;  ///< from the centres of mass, body axes
    Quaternion<S> orientation;
    std::array<Vector3<S>, 2> axes_to;
    Vector3<S> axis_from;
    std::array<Vector3<S>, 2> across_from;
    S between = S(0), length = S(0);
    std::array<S, 2> stiffness{}, rest{}, damping{};
    Quaternion<S> rest_orientation;
    bool has_spring = false, has_damper = false;
    int coordinates = 0;
};

template <class S>
JointPair<S> make_joint_pair(const maximal::Link<double>& link, std::size_t number) {
    JointPair<S> pair;
    pair.kind = link.kind, pair.link = number;
    pair.from = static_cast<std::size_t>(link.from.body), pair.to = static_cast<std::size_t>(link.to.body);
    pair.arm_from = cast<S>(link.from.arm_B), pair.arm_to = cast<S>(link.to.arm_B);
    pair.orientation = cast<S>(link.orientation);
    for (std::size_t i = 0; i < 2; ++i) {
        pair.axes_to[i] = cast<S>(link.axes_to[i]), pair.across_from[i] = cast<S>(link.across_from[i]);
        pair.stiffness[i] = S(link.stiffness[i]), pair.rest[i] = S(link.rest[i]), pair.damping[i] = S(link.damping[i]);
    }
    pair.axis_from = cast<S>(link.axis_from);
    pair.between = S(link.between), pair.length = S(link.length);
    pair.rest_orientation = cast<S>(link.rest_orientation);
    pair.has_spring = link.has_spring(), pair.has_damper = link.has_damper();
    pair.coordinates = link.coordinates();
    return pair;
}

/// A pair with the current state of its bodies; world axes.
template <class S>
struct PairView {
    const JointPair<S>& pair;
    const MovingBody<S>&from, &to;

    Vector3<S> arm_from() const { return from.R * pair.arm_from; }
    Vector3<S> arm_to() const { return to.R * pair.arm_to; }
    /// Vector from the point on `from` to the point on `to`.
    Vector3<S> gap() const { return (to.x + arm_to()) - (from.x + arm_from()); }
    /// Attitude of the child relative to a fixed joint, as a rotation vector in world axes to first order: 2 vec.
    Vector3<S> twist() const {
        const Quaternion<S> turn = to.q * conjugate(from.q * pair.orientation);
        return (turn.w < 0 ? S(-2) : S(2)) * vector_part(turn);
    }
    /// J: attitude of the child relative to the parent.
    Quaternion<S> joint() const { return conjugate(from.q * pair.orientation) * to.q; }
    Vector3<S> first_axis() const { return from.R * pair.axis_from; }
    Vector3<S> axis_to(std::size_t i) const { return to.R * pair.axes_to[i]; }
};

}  // namespace polhode::multibody
