// Rows of joints and loops: the directions in which they constrain two bodies, and in which their springs, dampers
// and motors act. A row is a force f and a torque g on the second body at its point, and the opposite on the first.
// The same row defines the component of the relative velocity, and thus of the acceleration, that must vanish:
//
//   f . (x2'' - x1'') + g . (w2' - w1') + bias = 0
//
// Placement holds the motion of a body, Row a direction, LinkView computes rows and errors of one link.
#pragma once

#include <array>
#include <vector>

#include "integrators/maximal/mechanism.h"

namespace polhode::maximal {

/// Position and motion of a body; constants for bodies that do not move.
template <class S>
struct Placement {
    Matrix3<S> axes;                ///< R(q), body to world
    Quaternion<S> q;                ///< body to world
    Vector3<S> position_W;          ///< centre of mass, m
    Vector3<S> velocity_W;          ///< centre of mass, m/s
    Vector3<S> angular_velocity_B;  ///< rad/s

    /// Transforms a body vector to world axes.
    template <class V>
    Vector3<Product<S, V>> world(const Vector3<V>& v_B) const {
        return axes * v_B;
    }
    /// Transforms a world vector to body axes.
    template <class V>
    Vector3<Product<S, V>> body(const Vector3<V>& v_W) const {
        return transposed(axes) * v_W;
    }
    /// Velocity of a body point, m/s.
    template <class V>
    Vector3<S> velocity_at(const Vector3<V>& arm_B) const {
        return velocity_W + world(cross(angular_velocity_B, arm_B));
    }
    /// Centripetal part of a body point's acceleration, body axes: w x (w x arm).
    template <class V>
    Vector3<S> centripetal_B(const Vector3<V>& arm_B) const {
        return cross(angular_velocity_B, cross(angular_velocity_B, arm_B));
    }
};

/// A direction: a force and a torque on `to`, and the resulting torques on both bodies about their centres of mass.
template <class S>
struct Row {
    Vector3<S> force_W;   ///< f, on `to` at its point; the opposite on `from`
    Vector3<S> torque_W;  ///< g, about that point; not set for rows of added inertias
    Vector3<S> to_B;      ///< torque about the centre of mass of `to`, in its axes
    Vector3<S> from_B;    ///< torque about the centre of mass of `from`, in its axes, sign included
    S bias = S(0);        ///< part of the acceleration along the row that is due to the current velocities
};

/// One link with the placements of its two bodies.
template <class P, class S>
class LinkView {
  public:
    LinkView(const Link<P>& link, const Placement<S>& from, const Placement<S>& to)
        : link_(link), from_(from), to_(to) {}

    /// All constraint rows of the link, including those that are not kept.
    std::vector<Row<S>> constraints() const {
        std::vector<Row<S>> rows;
        switch (link_.kind) {
            case Kind::prismatic:
                for (int i = 0; i < 2; ++i) rows.push_back(slide_row(link_.across_from[i], true));
                add_parallel(rows);
                break;
            case Kind::distance:
                rows.push_back(distance_row());
                break;
            case Kind::added_inertia:
                add_unit_wrenches(rows);
                break;
            case Kind::armature:
                add_coordinate_accelerations(rows);
                break;
            case Kind::coordinate:
                add_coordinate_accelerations(rows);
                for (Row<S>& row : rows)
                    row = {link_.factor * row.force_W, link_.factor * row.torque_W, link_.factor * row.to_B,
                           link_.factor * row.from_B, link_.factor * row.bias};
                break;
            default:
                add_points(rows);
                if (link_.kind == Kind::fixed) add_parallel(rows);
                if (link_.kind == Kind::revolute)
                    for (const Vector3<P>& u : link_.across_from) rows.push_back(hinge_row(u));
                if (link_.kind == Kind::universal) rows.push_back(cross_row());
        }
        return rows;
    }

    /// Position errors of these rows, m and rad. Where the constraints hold, their rates are the rows applied to the
    /// velocities.
    std::vector<S> gaps() const {
        std::vector<S> all;
        if (!link_.is_in_scene()) return std::vector<S>(6, S(P(0)));
        const auto add_turn = [&] {
            const Quaternion<S> base = from_.q * link_.orientation, turn = conjugate(base) * to_.q;
            const Vector3<S> turn_W = rotate(base, (turn.w + turn.w) * vector_part(turn));
            for (const S& x : turn_W.component) all.push_back(x);
        };
        if (link_.kind == Kind::prismatic) {
            const Vector3<S> slid = slide_arm_B() - cast<S>(link_.from.arm_B);
            for (const Vector3<P>& t : link_.across_from) all.push_back(dot(t, slid));
            add_turn();
            return all;
        }
        const Vector3<S> d = apart();
        if (link_.kind == Kind::distance) {
            all.push_back((P(1) / (link_.length + link_.length)) * (dot(d, d) - S(link_.length * link_.length)));
            return all;
        }
        const Vector3<S> along = link_.closes ? from_.body(d) : d;
        for (const S& x : along.component) all.push_back(x);
        if (link_.kind == Kind::fixed) add_turn();
        if (link_.kind == Kind::revolute) {
            // d(u . e)/dt = (e x u) . (w2 - w1), and the axis, u[0], u[1] are right-handed.
            const Vector3<S> e = to_.world(link_.axes_to[0]);
            all.push_back(-dot(from_.world(link_.across_from[1]), e));
            all.push_back(dot(from_.world(link_.across_from[0]), e));
        } else if (link_.kind == Kind::universal) {
            all.push_back(S(link_.between) - dot(from_.world(link_.axis_from), to_.world(link_.axes_to[1])));
        }
        return all;
    }

    /// Directions of the coordinates' generalized forces: a force Q_i in row i does work only on coordinate i.
    std::vector<Row<S>> coordinate_rows() const {
        std::vector<Row<S>> rows;
        if (link_.kind == Kind::prismatic) {
            rows.push_back(slide_row(link_.axis_from, false));
        } else if (link_.kind == Kind::revolute) {
            rows.push_back(torque_row(cast<S>(link_.axes_to[0]), cast<S>(link_.axis_from)));
        } else if (link_.kind == Kind::universal) {
            // For the current axes e1, e2: t = A e1 + B e2 with t . e1 = Q1, t . e2 = Q2.
            const Row<S> e1 = torque_row(to_.body(from_.world(link_.axis_from)), cast<S>(link_.axis_from));
            const Row<S> e2 = torque_row(cast<S>(link_.axes_to[1]), from_.body(to_.world(link_.axes_to[1])));
            const P c = link_.between, scale = P(1) / (P(1) - c * c);
            rows.push_back(combined(scale, e1, P(-scale * c), e2));
            rows.push_back(combined(P(-scale * c), e1, scale, e2));
        }
        return rows;
    }

    /// Rates of the coordinates, rad/s or m/s.
    std::array<S, 2> rates() const {
        std::array<S, 2> rate{S(0), S(0)};
        if (link_.kind == Kind::prismatic) {
            rate[0] = dot(link_.axis_from, sliding_B());
        } else if (link_.kind == Kind::revolute) {
            rate[0] = dot(link_.axes_to[0], to_.angular_velocity_B) - dot(link_.axis_from, from_.angular_velocity_B);
        } else if (link_.kind == Kind::universal) {
            // w2 - w1 = e1 x' + e2 y'.
            const Vector3<S> e1_to = to_.body(from_.world(link_.axis_from));
            const Vector3<S> e2_from = from_.body(to_.world(link_.axes_to[1]));
            const S along1 = dot(e1_to, to_.angular_velocity_B) - dot(link_.axis_from, from_.angular_velocity_B);
            const S along2 = dot(link_.axes_to[1], to_.angular_velocity_B) - dot(e2_from, from_.angular_velocity_B);
            const P c = link_.between, scale = P(1) / (P(1) - c * c);
            rate[0] = scale * (along1 - c * along2), rate[1] = scale * (along2 - c * along1);
        }
        return rate;
    }
    /// Sine and cosine of half the angle of a revolute joint, times the lengths of both quaternions. Their signs change
    /// with those of the quaternions.
    std::array<S, 2> half_angle() const {
        const Quaternion<S> turn = conjugate(from_.q * link_.orientation) * to_.q;
        return {dot(link_.axes_to[0], vector_part(turn)), turn.w};
    }
    /// Displacement of a prismatic joint, m.
    S displacement() const { return dot(link_.axis_from, slide_arm_B() - cast<S>(link_.from.arm_B)); }

    /// Torque of a spherical joint's spring and damper on `to`, in its axes, N m.
    Vector3<S> spherical_torque_B() const {
        const Quaternion<S> joint = conjugate(from_.q * link_.orientation) * to_.q;
        const Quaternion<S> r = conjugate(link_.rest_orientation) * joint;
        Vector3<S> torque;
        if (link_.has_spring()) torque = (P(-2) * link_.stiffness[0]) * (r.w * vector_part(r));
        if (link_.has_damper()) {
            const Vector3<S> base_B = to_.body(from_.world(from_.angular_velocity_B));
            torque = torque - link_.damping[0] * (to_.angular_velocity_B - base_B);
        }
        return torque;
    }

    /// A pure torque, given in the axes of `to` and in those of `from`.
    Row<S> torque_row(const Vector3<S>& to_B, const Vector3<S>& from_B) const {
        return {Vector3<S>(), to_.world(to_B), to_B, -from_B, S(0)};
    }
    /// A pure torque, given in the axes of `to` only.
    Row<S> torque_row(const Vector3<S>& to_B) const { return torque_row(to_B, from_.body(to_.world(to_B))); }

    /// Vector from the point of `from` to that of `to`, world axes, m.
    Vector3<S> apart() const {
        return (to_.position_W + to_.world(link_.to.arm_B)) - (from_.position_W + from_.world(link_.from.arm_B));
    }

  private:
    const Link<P>& link_;
    const Placement<S>&from_, &to_;

    static Row<S> combined(const P& a, const Row<S>& x, const P& b, const Row<S>& y) {
        return {Vector3<S>(), a * x.torque_W + b * y.torque_W, a * x.to_B + b * y.to_B, a * x.from_B + b * y.from_B,
                S(0)};
    }
    Vector3<S> point_bias_W() const {
        return to_.world(to_.centripetal_B(link_.to.arm_B)) - from_.world(from_.centripetal_B(link_.from.arm_B));
    }
    // Two points coincide. The rows of a loop are fixed in `from`, so that redundant rows remain redundant.
    void add_points(std::vector<Row<S>>& rows) const {
        const Vector3<S> bias = point_bias_W();
        for (int i = 0; i < 3; ++i) {
            Vector3<P> e;
            e[i] = P(1);
            if (link_.closes) {
                const Vector3<S> f = from_.world(e);
                rows.push_back({f, Vector3<S>(), cross(link_.to.arm_B, to_.body(f)),
                                cast<S>(Vector3<P>(-cross(link_.from.arm_B, e))), dot(f, bias)});
            } else {
                rows.push_back({cast<S>(e), Vector3<S>(), cross(link_.to.arm_B, to_.axes[i]),
                                -cross(link_.from.arm_B, from_.axes[i]), bias[i]});
            }
        }
    }
    // Forces at the centre of mass along world axes, torques about body axes.
    void add_unit_wrenches(std::vector<Row<S>>& rows) const {
        for (int i = 0; i < 6; ++i) {
            Vector3<P> e;
            e[i % 3] = P(1);
            Row<S> row;
            (i < 3 ? row.force_W : row.to_B) = cast<S>(e);
            rows.push_back(row);
        }
    }
    // The accelerations of the coordinates; spherical joint: of the angular velocity, in the axes of `to`. For e fixed
    // in either body, (e . (w2 - w1))' = e . (w2' - w1') + e . (w2 x w1).
    void add_coordinate_accelerations(std::vector<Row<S>>& rows) const {
        if (link_.of == Kind::prismatic) return rows.push_back(slide_row(link_.axis_from, true));
        const Vector3<S> twist = cross(to_.world(to_.angular_velocity_B), from_.world(from_.angular_velocity_B));
        const auto with_bias = [&](Row<S> row) {
            row.bias = dot(row.torque_W, twist);
            return row;
        };
        if (link_.of == Kind::revolute) return rows.push_back(hinge_row(link_.axis_from));
        if (link_.of == Kind::spherical) {
            for (int i = 0; i < 3; ++i) {
                Vector3<S> e;
                e[i] = S(P(1));
                rows.push_back(with_bias(torque_row(e)));
            }
            return;
        }
        const Row<S> e1 = torque_row(to_.body(from_.world(link_.axis_from)), cast<S>(link_.axis_from));
        const Row<S> e2 = torque_row(cast<S>(link_.axes_to[1]), from_.body(to_.world(link_.axes_to[1])));
        const P c = link_.between, scale = P(1) / (P(1) - c * c);
        rows.push_back(with_bias(combined(scale, e1, P(-scale * c), e2)));
        rows.push_back(with_bias(combined(P(-scale * c), e1, scale, e2)));
    }
    // w2 = w1.
    void add_parallel(std::vector<Row<S>>& rows) const {
        for (int i = 0; i < 3; ++i) {
            Vector3<S> e;
            e[i] = S(1);
            rows.push_back({Vector3<S>(), e, to_.axes[i], -from_.axes[i], S(0)});
        }
    }
    // u . (w2 - w1) = 0 for u fixed in `from`; u' = w1 x u.
    Row<S> hinge_row(const Vector3<P>& u) const {
        const Vector3<S> u_W = from_.world(u);
        const Vector3<S> turning = cross(to_.world(to_.angular_velocity_B), from_.world(from_.angular_velocity_B));
        return {Vector3<S>(), u_W, to_.body(u_W), cast<S>(Vector3<P>(-u)), dot(u_W, turning)};
    }
    // (e1 x e2) . (w2 - w1) = 0 for e1 fixed in `from`, e2 in `to`.
    Row<S> cross_row() const {
        const Vector3<S> e1 = from_.world(link_.axis_from), e2 = to_.world(link_.axes_to[1]), n = cross(e1, e2);
        const Vector3<S> w1 = from_.world(from_.angular_velocity_B), w2 = to_.world(to_.angular_velocity_B);
        const Vector3<S> n_rate = cross(cross(w1, e1), e2) + cross(e1, cross(w2, e2));
        return {Vector3<S>(), n, to_.body(n), -from_.body(n), dot(n_rate, w2 - w1)};
    }
    // |d| = l: (d/l) . d'' + d' . d' / l = 0.
    Row<S> distance_row() const {
        const P scale = P(1) / link_.length;
        const Vector3<S> f = scale * apart();
        const Vector3<S> d_rate = to_.velocity_at(link_.to.arm_B) - from_.velocity_at(link_.from.arm_B);
        return {f, Vector3<S>(), cross(link_.to.arm_B, to_.body(f)), -cross(link_.from.arm_B, from_.body(f)),
                dot(f, point_bias_W()) + scale * dot(d_rate, d_rate)};
    }
    // Vector from the centre of mass of `from` to the point of `to`, and its rate, in the axes of `from`.
    Vector3<S> slide_arm_B() const { return from_.body(to_.position_W + to_.world(link_.to.arm_B) - from_.position_W); }
    Vector3<S> sliding_B() const {
        return from_.body(to_.velocity_at(link_.to.arm_B) - from_.velocity_W) -
               cross(from_.angular_velocity_B, slide_arm_B());
    }
    // t . d(sliding)/dt for t fixed in `from`. The force acts at the point of `to`.
    Row<S> slide_row(const Vector3<P>& t, bool with_bias) const {
        const Vector3<S> f = from_.world(t), arm = slide_arm_B();
        Row<S> row{f, Vector3<S>(), cross(link_.to.arm_B, to_.body(f)), -cross(arm, t), S(0)};
        if (!with_bias) return row;
        const Vector3<S> w = from_.angular_velocity_B;
        const Vector3<S> coriolis = cross(w, sliding_B());
        row.bias = dot(f, to_.world(to_.centripetal_B(link_.to.arm_B))) -
                   dot(t, from_.centripetal_B(arm) + (coriolis + coriolis));
        return row;
    }
};

}  // namespace polhode::maximal
