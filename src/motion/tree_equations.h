// Definitions of the equations of motion of Tree (motion/tree.h).
//
// accelerate() evaluates the articulated-body recursion (Featherstone 2008, ch. 7; motion/articulated.h): move()
// computes relative poses, velocities and bias accelerations, see() world poses, load() applied forces, articulate()
// runs from the leaves to the root, compute_accelerations() from the root to the leaves (both: solve_accelerations()).
// With loops (tree_loops.h), the multipliers lambda solve (G M^-1 G^T) lambda = -(G a + bias), where a are the
// accelerations without loops, and then correct them. coordinate_rates() computes the rates of the coordinates.
#pragma once

#include "motion/tree.h"

namespace polhode {

template <class P>
template <class S>
TreeWork<S>& Tree<P>::work() const {
    static thread_local TreeWork<S> memory;
    const std::size_t n = links_.links.size();
    if (memory.links.size() < n) {
        memory.links.resize(n), memory.frames.resize(n), memory.velocity_W.resize(n), memory.q.resize(n);
        memory.wrench.resize(n);
    }
    return memory;
}

template <class P>
template <class S>
void Tree<P>::move(const S* y, TreeWork<S>& at) const {
    at.y = y;
    const std::size_t n = links_.links.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Link<P>& link = links_.links[i];
        LinkWork<S>& w = at.links[i];
        const S* const x = y + link.coordinate;
        const S* const rate = y + link.rate;
        const bool on_link = link.parent >= 0;
        w.r = cast<S>(link.place);
        if (link.kind == LinkJoint::revolute) {
            S sine, cosine;
            sine_cosine(x[0], sine, cosine);
            w.R = rotation_about_z(link.turn, cosine, sine);
        } else if (link.kind == LinkJoint::prismatic) {
            w.R = cast<S>(link.turn);
            for (std::size_t k = 0; k < 3; ++k) w.r[k] = w.r[k] + link.turn[k][2] * x[0];
        } else {
            w.R = rotation_matrix(Quaternion<S>{x[0], x[1], x[2], x[3]});
            if (link.kind == LinkJoint::spherical) w.R = link.turn * w.R;
        }
        Vector3<S> carried;
        w.bias = {};
        if (on_link) {
            const LinkWork<S>& parent = at.links[static_cast<std::size_t>(link.parent)];
            carried = transposed_times(w.R, parent.w);
            w.bias.linear = transposed_times(w.R, cross(parent.w, cross(parent.w, w.r)));
        }
        w.w = carried;
        if (link.kind == LinkJoint::revolute) {
            w.w[2] = w.w[2] + rate[0];
            w.bias.turning = {carried[1] * rate[0], -(carried[0] * rate[0]), S(0)};
        } else if (link.kind == LinkJoint::prismatic) {
            const S twice = rate[0] + rate[0];
            w.bias.linear[0] = w.bias.linear[0] + carried[1] * twice;
            w.bias.linear[1] = w.bias.linear[1] - carried[0] * twice;
        } else {
            const Vector3<S> relative(rate[0], rate[1], rate[2]);
            w.w = carried + relative;
            w.bias.turning = cross(carried, relative);
        }
        // the link alone: n = I alpha + h x a + w x I w,  f = alpha x h + m a + w x (w x h)
        ArticulatedInertia<S>& own = w.inertia;
        const Vector3<P>& h = link.moment;
        const Symmetric3<P>& I = link.inertia;
        own.J = {S(I.xx), S(I.yy), S(I.zz), S(I.xy), S(I.xz), S(I.yz)};
        own.B[0] = {S(0), S(-h[2]), S(h[1])};
        own.B[1] = {S(h[2]), S(0), S(-h[0])};
        own.B[2] = {S(-h[1]), S(h[0]), S(0)};
        own.M = {S(link.mass), S(link.mass), S(link.mass), S(0), S(0), S(0)};
        own.n = cross(w.w, I * w.w);
        own.f = cross(w.w, cross(w.w, h));
    }
}

template <class P>
template <class S>
void Tree<P>::compute_frames(const S* y, TreeWork<S>& at) const {
    for (std::size_t i = 0; i < links_.links.size(); ++i) {
        const Link<P>& link = links_.links[i];
        const LinkWork<S>& w = at.links[i];
        LinkFrame<S>& frame = at.frames[i];
        Vector3<S>& v = at.velocity_W[i];
        if (link.kind == LinkJoint::free) {
            const S *const x = y + link.coordinate, *const rate = y + link.rate;
            frame.R = w.R;
            frame.x = {x[4], x[5], x[6]};
            v = {rate[3], rate[4], rate[5]};
            continue;
        }
        if (link.parent < 0) {
            frame.R = w.R, frame.x = w.r, v = {};
        } else {
            const std::size_t p = static_cast<std::size_t>(link.parent);
            const LinkFrame<S>& parent = at.frames[p];
            frame.R = parent.R * w.R;
            frame.x = parent.x + parent.R * w.r;
            v = at.velocity_W[p] + parent.R * cross(at.links[p].w, w.r);
        }
        if (link.kind == LinkJoint::prismatic)
            for (std::size_t k = 0; k < 3; ++k) v[k] = v[k] + frame.R[k][2] * y[link.rate];
    }
}

template <class P>
template <class S>
void Tree<P>::force_at(const LinkPoint<P>& where, const Vector3<S>& force_W, TreeWork<S>& at) const {
    if (where.link < 0) return;
    const std::size_t i = static_cast<std::size_t>(where.link);
    ArticulatedInertia<S>& own = at.links[i].inertia;
    const Vector3<S> force = transposed_times(at.frames[i].R, force_W);
    own.f = own.f - force;
    own.n = own.n - cross(where.point, force);
}

template <class P>
template <class S>
void Tree<P>::load(const S* y, TreeWork<S>& at) const {
    for (std::size_t i = 0; i < links_.links.size(); ++i) {
        const Link<P>& link = links_.links[i];
        Vector3<S>& force = at.links[i].force;
        const S *const x = y + link.coordinate, *const rate = y + link.rate;
        force = {};
        if (link.kind == LinkJoint::free) continue;
        if (link.kind == LinkJoint::spherical) {
            if (!(link.stiffness == P(0))) {
                const Quaternion<S> r = conjugate(link.rest_orientation) * Quaternion<S>{x[0], x[1], x[2], x[3]};
                force = (P(-2) * link.stiffness) * (r.w * vector_part(r));
            }
            if (!(link.damping == P(0))) force = force - link.damping * Vector3<S>(rate[0], rate[1], rate[2]);
            continue;
        }
        if (!loads_.motors.empty() && !(loads_.motors[i] == P(0))) force[0] = S(loads_.motors[i]);
        if (!(link.stiffness == P(0))) force[0] = force[0] - link.stiffness * (x[0] - S(link.rest));
        if (!(link.damping == P(0))) force[0] = force[0] - link.damping * rate[0];
    }
    for (const auto& one : loads_.constant) {
        if (one.link < 0) continue;
        ArticulatedInertia<S>& own = at.links[static_cast<std::size_t>(one.link)].inertia;
        own.n = own.n - cast<S>(one.load.turning);
        own.f = own.f - cast<S>(one.load.linear);
    }
    for (const auto& one : loads_.in_world) {
        if (one.link < 0) continue;
        force_at(LinkPoint<P>{one.link, one.point}, cast<S>(one.force_W), at);
        const std::size_t i = static_cast<std::size_t>(one.link);
        ArticulatedInertia<S>& own = at.links[i].inertia;
        own.n = own.n - transposed_times(at.frames[i].R, one.torque_W);
    }
    for (const auto& one : loads_.at_world_points) {
        if (one.link < 0) continue;
        const std::size_t i = static_cast<std::size_t>(one.link);
        ArticulatedInertia<S>& own = at.links[i].inertia;
        const Vector3<S> arm = transposed_times(at.frames[i].R, one.point_W - at.frames[i].x);
        const Vector3<S> force = one.in_link ? cast<S>(one.force) : transposed_times(at.frames[i].R, one.force);
        own.f = own.f - force;
        own.n = own.n - cross(arm, force);
    }
    for (const auto& one : loads_.drags) {
        if (one.link < 0) continue;
        const std::size_t i = static_cast<std::size_t>(one.link);
        const Vector3<S>& w = at.links[i].w;
        ArticulatedInertia<S>& own = at.links[i].inertia;
        own.n = own.n + one.rotational * w;
        if (one.translational == P(0)) continue;
        const Vector3<S> v = transposed_times(at.frames[i].R, at.velocity_W[i]) + cross(w, one.center);
        own.f = own.f + one.translational * v;
        own.n = own.n + one.translational * cross(one.center, v);
    }
    for (const auto& one : loads_.between) {
        const auto place = [&](const LinkPoint<P>& point) -> Vector3<S> {
            if (point.link < 0) return cast<S>(point.point);
            const LinkFrame<S>& frame = at.frames[static_cast<std::size_t>(point.link)];
            return frame.x + frame.R * point.point;
        };
        const Vector3<S> d = place(one.second) - place(one.first);
        // k (|d| - d0) d / |d|
        Vector3<S> pull = one.stiffness * d;
        if (!(one.rest_length == P(0))) {
            const S distance = square_root(S(dot(d, d)));
            pull = pull - ((one.stiffness * one.rest_length) * (S(P(1)) / distance)) * d;
        }
        force_at(one.first, pull, at);
        force_at(one.second, Vector3<S>(-pull), at);
    }
    if (loads_.springs.empty()) return;
    // attitudes of the links as quaternions, from half-angles
    for (std::size_t i = 0; i < links_.links.size(); ++i) at.q[i] = attitude_of(i, y, at);
    for (const auto& one : loads_.springs) {
        if (one.link < 0) continue;
        const std::size_t i = static_cast<std::size_t>(one.link);
        const Quaternion<S> r = conjugate(one.rest) * (at.q[i] * one.q);
        const Vector3<S> torque = rotate(one.q, Vector3<S>((P(-2) * one.stiffness) * (r.w * vector_part(r))));
        at.links[i].inertia.n = at.links[i].inertia.n - torque;
    }
}

template <class P>
template <class S>
Quaternion<S> Tree<P>::attitude_of(std::size_t i, const S* y, const TreeWork<S>& at) const {
    const Link<P>& link = links_.links[i];
    const S* const x = y + link.coordinate;
    Quaternion<S> q;
    if (link.kind == LinkJoint::revolute) {
        S sine, cosine;
        sine_cosine(S((P(1) / P(2)) * x[0]), sine, cosine);
        q = link.q_placement * Quaternion<S>{cosine, S(0), S(0), sine};
    } else if (link.kind == LinkJoint::prismatic) {
        q = cast<S>(link.q_placement);
    } else {
        q = link.q_placement * Quaternion<S>{x[0], x[1], x[2], x[3]};
    }
    return link.parent < 0 ? q : at.q[static_cast<std::size_t>(link.parent)] * q;
}

template <class P>
template <class S>
void Tree<P>::articulate(TreeWork<S>& at) const {
    if (transmits_along_axes()) return articulate_with_armature(at);
    for (std::size_t i = links_.links.size(); i-- > 0;) {
        const Link<P>& link = links_.links[i];
        LinkWork<S>& w = at.links[i];
        const ArticulatedInertia<S>& I = w.inertia;
        if (link.kind == LinkJoint::free) {
            // f = B^T alpha + M a = -f0,  (J - B M^-1 B^T) alpha = -n0 + B M^-1 f0
            w.inverse_mass = inverse(I.M);
            w.inverse = inverse(I.J - congruence(I.B, w.inverse_mass));
            continue;
        }
        const bool hangs = link.parent >= 0;
        const Vector3<S>&c_w = w.bias.turning, &c_v = w.bias.linear;
        Symmetric3<S> J, M;
        Matrix3<S> B;
        Vector3<S> n, f;
        if (link.kind == LinkJoint::spherical) {
            // the joint transmits only its own torque: J and B vanish, M - B^T J^-1 B remains
            w.inverse = inverse(I.J);
            const Vector3<S> torque = w.force;
            w.force = torque - I.n;
            if (!hangs) continue;
            M = I.M - congruence(transposed(I.B), w.inverse);
            n = torque;
            f = I.f + M * c_v + transposed_times(I.B, w.inverse * w.force);
        } else {
            const bool turns = link.kind == LinkJoint::revolute;
            Vector3<S>&U_n = w.U.turning, &U_f = w.U.linear;
            if (turns)
                U_n = {I.J.xz, I.J.yz, I.J.zz}, U_f = I.B[2];
            else
                U_n = {I.B[0][2], I.B[1][2], I.B[2][2]}, U_f = {I.M.xz, I.M.yz, I.M.zz};
            const S per = S(P(1)) / (turns ? I.J.zz : I.M.zz), force = w.force[0];
            w.inverse.xx = per;
            const S u = force - (turns ? I.n[2] : I.f[2]);
            w.force[0] = u;
            if (!hangs) continue;
            const Vector3<S> N = per * U_n, F = per * U_f;
            const S step = per * u;
            // subtract what the joint yields to; along its axis nothing remains
            if (turns) {
                J.xx = I.J.xx - N[0] * U_n[0], J.yy = I.J.yy - N[1] * U_n[1], J.xy = I.J.xy - N[0] * U_n[1];
                for (std::size_t r = 0; r < 2; ++r)
                    for (std::size_t c = 0; c < 3; ++c) B[r][c] = I.B[r][c] - N[r] * U_f[c];
                M = I.M - outer(F, U_f);
                n = {I.n[0] + J.xx * c_w[0] + J.xy * c_w[1] + dot(B[0], c_v) + U_n[0] * step,
                     I.n[1] + J.xy * c_w[0] + J.yy * c_w[1] + dot(B[1], c_v) + U_n[1] * step, force};
                f = I.f + transposed_times(B, c_w) + M * c_v + step * U_f;
            } else {
                J = I.J - outer(N, U_n);
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 2; ++c) B[r][c] = I.B[r][c] - N[r] * U_f[c];
                M.xx = I.M.xx - F[0] * U_f[0], M.yy = I.M.yy - F[1] * U_f[1], M.xy = I.M.xy - F[0] * U_f[1];
                n = I.n + J * c_w + B * c_v + step * U_n;
                f = I.f + transposed_times(B, c_w) + M * c_v + step * U_f;
                f[2] = force;
            }
        }
        add_child_inertia(w, J, B, M, n, f, at.links[static_cast<std::size_t>(link.parent)].inertia);
    }
}

template <class P>
template <class S>
void Tree<P>::compute_accelerations(TreeWork<S>& at, S* rates) const {
    if (!transmits_along_axes()) return compute_accelerations_of<false>(at, rates);
    at.locks.resize(locks_.size());
    compute_accelerations_of<true>(at, rates);
}

/// `along_axes` is transmits_along_axes(), decided once and not per link.
template <class P>
template <bool along_axes, class S>
void Tree<P>::compute_accelerations_of(TreeWork<S>& at, S* rates) const {
    for (std::size_t i = 0; i < links_.links.size(); ++i) {
        const Link<P>& link = links_.links[i];
        LinkWork<S>& w = at.links[i];
        const ArticulatedInertia<S>& I = w.inertia;
        Vector3<S>&alpha = w.acceleration.turning, &a = w.acceleration.linear;
        S* const out = rates + (link.rate - links_.coordinates);
        if (link.kind == LinkJoint::free) {
            alpha = w.inverse * Vector3<S>(I.B * (w.inverse_mass * I.f) - I.n);
            a = w.inverse_mass * Vector3<S>(-(I.f + transposed_times(I.B, alpha)));
            const Vector3<S> a_W = w.R * a + cast<S>(loads_.gravity_W);
            for (std::size_t k = 0; k < 3; ++k) out[k] = alpha[k], out[k + 3] = a_W[k];
            continue;
        }
        if (link.parent < 0) {
            // gravity as an acceleration of the world
            alpha = {};
            a = transposed_times(w.R, Vector3<P>(-loads_.gravity_W));
        } else {
            const Pair6<S>& parent = at.links[static_cast<std::size_t>(link.parent)].acceleration;
            alpha = transposed_times(w.R, parent.turning);
            a = transposed_times(w.R, Vector3<S>(parent.linear + cross(parent.turning, w.r)));
        }
        alpha = alpha + w.bias.turning;
        a = a + w.bias.linear;
        if (link.kind == LinkJoint::spherical) {
            if constexpr (along_axes) {
                const Vector3<S> own = w.inverse * Vector3<S>(w.force - I.J * alpha - I.B * a);
                for (std::size_t k = 0; k < 3; ++k) out[k] = own[k];
                alpha = alpha + own;
                continue;
            }
            const Vector3<S> whole = w.inverse * Vector3<S>(w.force - I.B * a);
            for (std::size_t k = 0; k < 3; ++k) out[k] = whole[k] - alpha[k];
            alpha = whole;
        } else if (const int lock = along_axes ? lock_of(i) : -1; lock >= 0) {
            const int drive = locks_[static_cast<std::size_t>(lock)].drive;
            S& force = at.locks[static_cast<std::size_t>(lock)];
            // alpha and a contain a given acceleration
            force = dot(w.U.turning, alpha) + dot(w.U.linear, a) - w.force[0];
            out[0] = drive < 0 ? S(P(0)) : at.y[drive];
            if (drive >= 0) force = force + S(link.armature) * out[0];
        } else {
            out[0] = w.inverse.xx * (w.force[0] - dot(w.U.turning, alpha) - dot(w.U.linear, a));
            S& along = link.kind == LinkJoint::revolute ? alpha[2] : a[2];
            along = along + out[0];
        }
    }
}

template <class P>
template <class S>
void Tree<P>::accelerate(const S* y, TreeWork<S>& at, S* dy) const {
    move(y, at);
    if (uses_frames()) compute_frames(y, at);
    load(y, at);
    solve_accelerations(at, dy);
}

template <class P>
template <class S, class AddLoads>
void Tree<P>::derivative_with(const S* y, S* dy, const AddLoads& add_loads) const {
    TreeWork<S>& at = work<S>();
    move(y, at);
    compute_frames(y, at);
    load(y, at);
    add_loads(at);
    solve_accelerations(at, dy);
    coordinate_rates(y, at, dy);
}

template <class P>
template <class S>
void Tree<P>::add_load(TreeWork<S>& at, int link, const Pair6<S>& load) {
    if (link < 0) return;
    ArticulatedInertia<S>& own = at.links[static_cast<std::size_t>(link)].inertia;
    own.n = own.n - load.turning;
    own.f = own.f - load.linear;
}

template <class P>
template <class S>
void Tree<P>::solve_accelerations(TreeWork<S>& at, S* dy) const {
    articulate(at);
    compute_accelerations(at, dy + links_.coordinates);
    if (!has_loops()) return;
    find_rows(at);
    respond_to_rows(at);
    const std::size_t n = links_.links.size(), rows = chosen_.size(), rates = static_cast<std::size_t>(links_.rates);
    const std::size_t locks = locks_.size();
    std::vector<Pair6<S>>& now = at.wrench;
    for (std::size_t i = 0; i < n; ++i) now[i] = at.links[i].acceleration;
    at.multipliers.resize(rows);
    for (std::size_t r = 0; r < rows; ++r) {
        const std::size_t row = static_cast<std::size_t>(chosen_[r]);
        at.multipliers[r] = -(applied(row, at, now.data(), dy + links_.coordinates) + at.rows[row].bias);
    }
    solve_rows(at, at.multipliers);
    for (std::size_t r = 0; r < rows; ++r) {
        const S& multiplier = at.multipliers[r];
        for (std::size_t k = 0; k < rates; ++k) {
            S& out = dy[static_cast<std::size_t>(links_.coordinates) + k];
            out = out + multiplier * at.rates[r * rates + k];
        }
        for (std::size_t i = 0; i < n; ++i) {
            Pair6<S>& a = at.links[i].acceleration;
            a.turning = a.turning + multiplier * at.response[r * n + i].turning;
            a.linear = a.linear + multiplier * at.response[r * n + i].linear;
        }
        for (std::size_t l = 0; l < locks; ++l) at.locks[l] = at.locks[l] + multiplier * at.row_locks[r * locks + l];
    }
}

template <class P>
template <class S>
void Tree<P>::coordinate_rates(const S* y, TreeWork<S>&, S* dy) const {
    for (const Link<P>& link : links_.links) {
        const S *const x = y + link.coordinate, *const rate = y + link.rate;
        S* const out = dy + link.coordinate;
        if (link.coordinates() == 1) {
            out[0] = rate[0];
            continue;
        }
        // dq/dt = 1/2 q (0, w)
        const P half = P(1) / P(2);
        const Quaternion<S> q{x[0], x[1], x[2], x[3]};
        out[0] = -(half * (q.x * rate[0] + q.y * rate[1] + q.z * rate[2]));
        out[1] = half * (q.w * rate[0] + q.y * rate[2] - q.z * rate[1]);
        out[2] = half * (q.w * rate[1] + q.z * rate[0] - q.x * rate[2]);
        out[3] = half * (q.w * rate[2] + q.x * rate[1] - q.y * rate[0]);
        if (link.kind == LinkJoint::free)
            for (int k = 0; k < 3; ++k) out[4 + k] = rate[3 + k];
    }
}

}  // namespace polhode
