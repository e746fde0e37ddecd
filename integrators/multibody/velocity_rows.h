// Velocity constraints of joints and loops: scalar rows J v = f . (v_to - v_from) + t_to . w_to + t_from . w_from = 0,
// and their position errors C with dC/dt = J v.
#pragma once

#include <array>
#include <cstddef>

#include "integrators/multibody/moving_bodies.h"

namespace polhode::multibody {

template <class S>
struct VelocityRow {
    Vector3<S> force, to, from;  ///< f, t_to, t_from: world axes, about the centres of mass
    S error = S(0);              ///< C, m or rad

    S velocity(const MovingBody<S>& a, const MovingBody<S>& b) const {
        return dot(force, b.v - a.v) + dot(to, b.w) + dot(from, a.w);
    }
    /// Applies an impulse along the row to both bodies.
    void apply_impulse(S impulse, MovingBody<S>& a, MovingBody<S>& b) const {
        a.v = a.v - (impulse * a.inverse_mass) * force;
        a.w = a.w + impulse * (a.inverse_I_W * from);
        b.v = b.v + (impulse * b.inverse_mass) * force;
        b.w = b.w + impulse * (b.inverse_I_W * to);
    }
    /// Moves both bodies along the row; rotations to first order.
    void displace(S multiplier, MovingBody<S>& a, MovingBody<S>& b) const {
        const auto move = [](MovingBody<S>& body, const Vector3<S>& change, const Vector3<S>& rotation_W) {
            if (!body.movable) return;
            body.x = body.x + change;
            body.rotate_first_order(rotation_W);
            body.update_rotation();
        };
        move(a, -(multiplier * a.inverse_mass) * force, multiplier * (a.inverse_I_W * from));
        move(b, (multiplier * b.inverse_mass) * force, multiplier * (b.inverse_I_W * to));
    }
};

/// J M^-1 J^T of two rows of one pair.
template <class S>
S coupling(const VelocityRow<S>& one, const VelocityRow<S>& other, const MovingBody<S>& a, const MovingBody<S>& b) {
    return (a.inverse_mass + b.inverse_mass) * dot(one.force, other.force) + dot(one.to, b.inverse_I_W * other.to) +
           dot(one.from, a.inverse_I_W * other.from);
}

/// The row whose J v is the rate of the coordinate of a revolute or prismatic joint.
template <class S>
VelocityRow<S> coordinate_row(const PairView<S>& at) {
    const Vector3<S> axis = at.first_axis();
    if (at.pair.kind != maximal::Kind::prismatic) return {{}, axis, -axis, S(0)};
    // the force on both bodies acts at the child's point
    return {axis, cross(at.arm_to(), axis), cross(axis, at.arm_from() + at.gap()), S(0)};
}

/// The rows of a pair: first those that constrain points, then those that constrain axes.
template <class S>
struct PairRows {
    std::array<VelocityRow<S>, 6> row;
    std::size_t count = 0, points = 0;

    /// Computes the rows at the current state.
    explicit PairRows(const PairView<S>& at) {
        using maximal::Kind;
        const JointPair<S>& pair = at.pair;
        const Vector3<S> arm_to = at.arm_to(), arm_from = at.arm_from(), gap = at.gap();
        const auto add_point_row = [&](const Vector3<S>& f, const Vector3<S>& arm, S error) {
            row[count++] = {f, cross(arm_to, f), cross(f, arm), error};
        };
        const auto add_axis_row = [&](const Vector3<S>& t, S error) { row[count++] = {{}, t, -t, error}; };
        if (pair.kind == Kind::prismatic) {
            // across the axis; the force on both bodies acts at the child's point
            const Vector3<S> arm = arm_from + gap;
            for (const Vector3<S>& across : pair.across_from) {
                const Vector3<S> f = at.from.R * across;
                add_point_row(f, arm, dot(f, gap));
            }
        } else if (pair.kind == Kind::distance) {
            const S distance = length(gap);
            const Vector3<S> f = (1 / distance) * gap;
            add_point_row(f, arm_from, distance - pair.length);
        } else {
            for (std::size_t i = 0; i < 3; ++i) {
                Vector3<S> f;
                f[i] = 1;
                add_point_row(f, arm_from, gap[i]);
            }
        }
        points = count;
        if (pair.kind == Kind::prismatic || pair.kind == Kind::fixed) {
            const Vector3<S> twist = at.twist();
            for (std::size_t i = 0; i < 3; ++i) {
                Vector3<S> t;
                t[i] = 1;
                add_axis_row(t, twist[i]);
            }
        } else if (pair.kind == Kind::revolute) {
            // u1, u2 across the parent's axis e, e x u1 = u2; the child's axis a near e: d(u1 . a)/dt = (w2 - w1) . u2
            const Vector3<S> a = at.axis_to(0), u1 = at.from.R * pair.across_from[0],
                             u2 = at.from.R * pair.across_from[1];
            add_axis_row(u1, -dot(u2, a));
            add_axis_row(u2, dot(u1, a));
        } else if (pair.kind == Kind::universal) {
            // d(e1 . e2)/dt = -(e1 x e2) . (w2 - w1)
            const Vector3<S> e1 = at.first_axis(), e2 = at.axis_to(1);
            add_axis_row(cross(e1, e2), pair.between - dot(e1, e2));
        }
    }
};

/// Softness of a block. Rigid: mass_scale 1, impulse_scale 0, bias_rate 0.
template <class S>
struct Softness {
    S bias_rate = S(0);      ///< 1/s: rate at which C is corrected
    S mass_scale = S(1);     ///< fraction of the required impulse that is applied at once
    S impulse_scale = S(0);  ///< fraction of the accumulated impulse that is removed
};

/// Up to three rows of a pair that are solved together: K^-1, K = J M^-1 J^T.
template <class S>
struct RowBlock {
    std::size_t first = 0, count = 0;
    Matrix3<S> inverse;

    RowBlock() = default;
    RowBlock(const PairRows<S>& rows, std::size_t begin, std::size_t end, const MovingBody<S>& a,
             const MovingBody<S>& b)
        : first(begin), count(end - begin) {
        // unused rows are decoupled
        Matrix3<S> K = diagonal(Vector3<S>(1, 1, 1));
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j) K[i][j] = coupling(rows.row[begin + i], rows.row[begin + j], a, b);
        inverse = polhode::inverse(K);
    }
    /// d = -s K^-1 (J v + bias C) - (1 - s) lambda, added to lambda and to the velocities.
    void solve(const PairRows<S>& rows, const Softness<S>& softness, std::array<S, 6>& impulses, MovingBody<S>& a,
               MovingBody<S>& b) const {
        if (count == 0) return;
        Vector3<S> residual;
        for (std::size_t i = 0; i < count; ++i) {
            const VelocityRow<S>& row = rows.row[first + i];
            residual[i] = row.velocity(a, b) + softness.bias_rate * row.error;
        }
        const Vector3<S> correction = inverse * residual;
        for (std::size_t i = 0; i < count; ++i) {
            S& impulse = impulses[first + i];
            const S change = -softness.mass_scale * correction[i] - softness.impulse_scale * impulse;
            impulse += change;
            rows.row[first + i].apply_impulse(change, a, b);
        }
    }
};

/// The rows of a pair with their two blocks.
template <class S>
struct BlockedPair {
    PairRows<S> rows;
    RowBlock<S> points, axes;

    BlockedPair(const PairView<S>& at)
        : rows(at), points(rows, 0, rows.points, at.from, at.to), axes(rows, rows.points, rows.count, at.from, at.to) {}
    /// Solves axes before points, as Box2D's joints do.
    void solve(const Softness<S>& softness, std::array<S, 6>& impulses, MovingBody<S>& a, MovingBody<S>& b) const {
        axes.solve(rows, softness, impulses, a, b);
        points.solve(rows, softness, impulses, a, b);
    }
};

}  // namespace polhode::multibody
