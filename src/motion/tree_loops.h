// Loop constraints of Tree (motion/tree.h): their rows, the response of the tree to them, and the projection onto
// them.
//
// find_rows() evaluates the constraints g, their rates and bias terms. respond() solves M x = f for wrenches on links
// with the factors of articulate(). respond_to_rows() computes the responses to the independent rows and factorises G
// M^-1 G^T = L D L^T; solve_rows() solves with it. project() applies Newton's method in the mass metric to the
// coordinates, then a linear correction to the rates.
#pragma once

#include "motion/tree.h"

namespace polhode {

template <class P>
template <class S>
void Tree<P>::find_rows(TreeWork<S>& at) const {
    at.rows.resize(all_rows_);
    LoopRow<S>* row = at.rows.data();
    // a point in the world: position, velocity, and the part of its acceleration that does not depend on alpha and a
    struct WorldPoint {
        Vector3<S> arm_W, x, v, bias, w;
    };
    const auto world_point = [&](const LinkPoint<P>& point) {
        WorldPoint there;
        if (point.link < 0) {
            there.x = cast<S>(point.point);
            there.bias = cast<S>(Vector3<P>(-loads_.gravity_W));
            return there;
        }
        const std::size_t i = static_cast<std::size_t>(point.link);
        const LinkFrame<S>& frame = at.frames[i];
        const Vector3<S>& w = at.links[i].w;
        there.arm_W = frame.R * point.point;
        there.x = frame.x + there.arm_W;
        const Vector3<S> around = cross(w, point.point);
        there.v = at.velocity_W[i] + frame.R * around;
        there.bias = frame.R * cross(w, around);
        there.w = frame.R * w;
        return there;
    };
    const auto in_link = [&](int link, const Vector3<S>& v_W) {
        return link < 0 ? v_W : transposed_times(at.frames[static_cast<std::size_t>(link)].R, v_W);
    };
    for (const LinkLoop<P>& loop : loops_) {
        if (loop.couples) {
            const Link<P>& second = links_.links[static_cast<std::size_t>(loop.second.link)];
            const Link<P>& first = links_.links[static_cast<std::size_t>(loop.first.link)];
            row->value = at.y[second.coordinate] - S(loop.offset), row->velocity = at.y[second.rate];
            row->bias = S(P(0));
            row->value = row->value - loop.ratio * at.y[first.coordinate];
            row->velocity = row->velocity - loop.ratio * at.y[first.rate];
            ++row;
            continue;
        }
        const WorldPoint one = world_point(loop.first), two = world_point(loop.second);
        const Vector3<S> d = two.x - one.x, v = two.v - one.v, bias = two.bias - one.bias;
        const auto pull = [&](const Vector3<S>& along_W) {
            const Vector3<S> back = in_link(loop.first.link, Vector3<S>(-along_W));
            const Vector3<S> forth = in_link(loop.second.link, along_W);
            row->first = {cross(loop.first.point, back), back};
            row->second = {cross(loop.second.point, forth), forth};
        };
        if (loop.type == LoopType::distance) {
            // g = (d.d - l^2) / 2
            pull(d);
            row->value = (P(1) / P(2)) * (dot(d, d) - S(loop.length * loop.length));
            row->velocity = dot(d, v);
            row->bias = dot(d, bias) + dot(v, v);
            ++row;
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k, ++row) {
            Vector3<S> along;
            along[k] = S(P(1));
            pull(along);
            row->value = d[k], row->velocity = v[k], row->bias = bias[k];
        }
        if (loop.type != LoopType::revolute) continue;
        const auto in_world = [&](int link, const Vector3<P>& axis) -> Vector3<S> {
            return link < 0 ? cast<S>(axis) : at.frames[static_cast<std::size_t>(link)].R * axis;
        };
        const Vector3<S> a = in_world(loop.second.link, loop.second_axis), turning = two.w - one.w;
        for (const Vector3<P>& across : loop.across) {
            // g = a.e,  g' = (w2 - w1).(a x e)
            const Vector3<S> e = in_world(loop.first.link, across), m = cross(a, e);
            const Vector3<S> m_rate = cross(cross(two.w, a), e) + cross(a, cross(one.w, e));
            row->first = {in_link(loop.first.link, Vector3<S>(-m)), {}};
            row->second = {in_link(loop.second.link, m), {}};
            row->value = dot(a, e), row->velocity = dot(turning, m), row->bias = dot(turning, m_rate);
            ++row;
        }
    }
}

template <class P>
template <class S>
S Tree<P>::applied_to_coupling(const LinkLoop<P>& coupling, const S* rates) const {
    const auto rate = [&](int link) {
        return rates[links_.links[static_cast<std::size_t>(link)].rate - links_.coordinates];
    };
    return S(rate(coupling.second.link) - coupling.ratio * rate(coupling.first.link));
}

template <class P>
template <class S>
S Tree<P>::applied(std::size_t row, const TreeWork<S>& at, const Pair6<S>* accelerations, const S* rates) const {
    const LinkLoop<P>& loop = loops_[static_cast<std::size_t>(loop_of_row_[row])];
    if (loop.couples) return applied_to_coupling(loop, rates);
    S sum(0);
    const auto add = [&](int link, const Pair6<S>& side) {
        if (link < 0) return;
        const Pair6<S>& a = accelerations[link];
        sum = sum + (dot(side.turning, a.turning) + dot(side.linear, a.linear));
    };
    add(loop.first.link, at.rows[row].first);
    add(loop.second.link, at.rows[row].second);
    return sum;
}

/// Adds to at.wrench a force on the link along its coordinate, and the opposite force on its parent.
template <class P>
template <class S>
void Tree<P>::add_generalized_force(int link, const S& size, TreeWork<S>& at) const {
    const std::size_t i = static_cast<std::size_t>(link);
    const bool turns = links_.links[i].kind == LinkJoint::revolute;
    Pair6<S>& own = at.wrench[i];
    S& along = turns ? own.turning[2] : own.linear[2];
    along = along + size;
    if (links_.links[i].parent < 0) return;
    Pair6<S>& parent = at.wrench[static_cast<std::size_t>(links_.links[i].parent)];
    const LinkWork<S>& w = at.links[i];
    const Vector3<S> axis = size * Vector3<S>(w.R[0][2], w.R[1][2], w.R[2][2]);
    if (!turns) parent.linear = parent.linear - axis;
    parent.turning = parent.turning - (turns ? axis : cross(w.r, axis));
}

template <class P>
template <class S>
void Tree<P>::start_coupling_response(const LinkLoop<P>& coupling, TreeWork<S>& at) const {
    add_generalized_force(coupling.second.link, S(P(1)), at);
    add_generalized_force(coupling.first.link, S(-coupling.ratio), at);
}

template <class P>
template <class S>
void Tree<P>::start_response(std::size_t row, TreeWork<S>& at) const {
    const LinkLoop<P>& loop = loops_[static_cast<std::size_t>(loop_of_row_[row])];
    for (std::size_t i = 0; i < links_.links.size(); ++i) at.wrench[i] = {};
    if (loop.couples) return start_coupling_response(loop, at);
    const auto add = [&](int link, const Pair6<S>& side) {
        if (link < 0) return;
        Pair6<S>& there = at.wrench[static_cast<std::size_t>(link)];
        there.turning = there.turning + side.turning, there.linear = there.linear + side.linear;
    };
    add(loop.first.link, at.rows[row].first);
    add(loop.second.link, at.rows[row].second);
}

/// Computes the response to the wrenches at.wrench: accelerations of links and of rates, and, unless `locks` is null,
/// the forces of the locks. Requires articulate().
template <class P>
template <class S>
void Tree<P>::respond(TreeWork<S>& at, Pair6<S>* response, S* rates, S* locks) const {
    if (transmits_along_axes()) return respond_of<true>(at, response, rates, locks);
    respond_of<false>(at, response, rates, locks);
}

/// `along_axes` is transmits_along_axes(), decided once and not per link.
template <class P>
template <bool along_axes, class S>
void Tree<P>::respond_of(TreeWork<S>& at, Pair6<S>* response, S* rates, [[maybe_unused]] S* locks) const {
    const std::size_t n = links_.links.size();
    for (std::size_t i = n; i-- > 0;) {
        const Link<P>& link = links_.links[i];
        const LinkWork<S>& w = at.links[i];
        Pair6<S>& own = at.wrench[i];
        if (link.parent < 0) continue;
        Vector3<S> n_left = own.turning, f_left = own.linear;
        if (link.kind == LinkJoint::spherical) {
            const Vector3<S> step = w.inverse * own.turning;
            n_left = along_axes ? Vector3<S>(n_left - w.inertia.J * step) : Vector3<S>();
            f_left = f_left - transposed_times(w.inertia.B, step);
        } else if (!along_axes || lock_of(i) < 0) {
            const bool turns = link.kind == LinkJoint::revolute;
            const S step = w.inverse.xx * (turns ? own.turning[2] : own.linear[2]);
            n_left = n_left - step * w.U.turning, f_left = f_left - step * w.U.linear;
            if (!along_axes) (turns ? n_left : f_left)[2] = S(0);
        }
        Pair6<S>& parent = at.wrench[static_cast<std::size_t>(link.parent)];
        const Vector3<S> f = w.R * f_left;
        parent.linear = parent.linear + f;
        parent.turning = parent.turning + (w.R * n_left + cross(w.r, f));
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Link<P>& link = links_.links[i];
        const LinkWork<S>& w = at.links[i];
        const Pair6<S>& own = at.wrench[i];
        Vector3<S>&alpha = response[i].turning, &a = response[i].linear;
        S* const out = rates + (link.rate - links_.coordinates);
        if (link.kind == LinkJoint::free) {
            alpha = w.inverse * Vector3<S>(own.turning - w.inertia.B * (w.inverse_mass * own.linear));
            a = w.inverse_mass * Vector3<S>(own.linear - transposed_times(w.inertia.B, alpha));
            const Vector3<S> a_W = w.R * a;
            for (std::size_t k = 0; k < 3; ++k) out[k] = alpha[k], out[k + 3] = a_W[k];
            continue;
        }
        if (link.parent < 0) {
            alpha = {}, a = {};
        } else {
            const Pair6<S>& parent = response[link.parent];
            alpha = transposed_times(w.R, parent.turning);
            a = transposed_times(w.R, Vector3<S>(parent.linear + cross(parent.turning, w.r)));
        }
        if (link.kind == LinkJoint::spherical) {
            const Vector3<S> torque = own.turning - w.inertia.B * a;
            if constexpr (along_axes) {
                const Vector3<S> step = w.inverse * Vector3<S>(torque - w.inertia.J * alpha);
                for (std::size_t k = 0; k < 3; ++k) out[k] = step[k];
                alpha = alpha + step;
                continue;
            }
            const Vector3<S> whole = w.inverse * torque;
            for (std::size_t k = 0; k < 3; ++k) out[k] = whole[k] - alpha[k];
            alpha = whole;
        } else {
            const bool turns = link.kind == LinkJoint::revolute;
            const S force = turns ? own.turning[2] : own.linear[2];
            if (const int lock = along_axes ? lock_of(i) : -1; lock >= 0) {
                out[0] = S(P(0));
                if (locks) locks[lock] = dot(w.U.turning, alpha) + dot(w.U.linear, a) - force;
                continue;
            }
            out[0] = w.inverse.xx * (force - dot(w.U.turning, alpha) - dot(w.U.linear, a));
            S& along = turns ? alpha[2] : a[2];
            along = along + out[0];
        }
    }
}

/// Computes the responses to the chosen rows, and factorises their matrix G M^-1 G^T as L D L^T.
template <class P>
template <class S>
void Tree<P>::respond_to_rows(TreeWork<S>& at) const {
    const std::size_t n = links_.links.size(), rows = chosen_.size(), rates = static_cast<std::size_t>(links_.rates);
    at.response.resize(rows * n), at.rates.resize(rows * rates), at.matrix.resize(rows * rows);
    const std::size_t locks = locks_.size();
    if (locks > 0) at.row_locks.resize(rows * locks);
    for (std::size_t r = 0; r < rows; ++r) {
        start_response(static_cast<std::size_t>(chosen_[r]), at);
        respond(at, at.response.data() + r * n, at.rates.data() + r * rates,
                locks > 0 ? at.row_locks.data() + r * locks : nullptr);
        for (std::size_t c = 0; c <= r; ++c)
            at.matrix[r * rows + c] = applied(static_cast<std::size_t>(chosen_[c]), at, at.response.data() + r * n,
                                              at.rates.data() + r * rates);
    }
    // L D below the diagonal, 1 / D on it
    for (std::size_t c = 0; c < rows; ++c) {
        for (std::size_t k = 0; k < c; ++k) {
            // column k contains L D; row c of L is matrix[c][k] / D_k
            const S factor = at.matrix[c * rows + k] * at.matrix[k * rows + k];
            for (std::size_t r = c; r < rows; ++r)
                at.matrix[r * rows + c] = at.matrix[r * rows + c] - factor * at.matrix[r * rows + k];
        }
        at.matrix[c * rows + c] = S(P(1)) / at.matrix[c * rows + c];
    }
}

template <class P>
template <class S>
void Tree<P>::solve_rows(TreeWork<S>& at, std::vector<S>& x) const {
    const std::size_t rows = chosen_.size();
    // (L D) D^-1 (L D)^T x = b
    for (std::size_t c = 0; c < rows; ++c)
        for (std::size_t r = c + 1; r < rows; ++r)
            x[r] = x[r] - at.matrix[r * rows + c] * (at.matrix[c * rows + c] * x[c]);
    for (std::size_t r = rows; r-- > 0;) {
        for (std::size_t c = r + 1; c < rows; ++c) x[r] = x[r] - at.matrix[c * rows + r] * x[c];
        x[r] = at.matrix[r * rows + r] * x[r];
    }
}

template <class P>
void Tree<P>::lock(const std::vector<int>& links, const std::vector<int>& driven, int first_drive) {
    locks_.clear(), lock_of_link_.clear();
    for (const int link : links) locks_.push_back({link, -1});
    for (std::size_t k = 0; k < driven.size(); ++k) locks_.push_back({driven[k], first_drive + static_cast<int>(k)});
    if (locks_.empty()) return;
    lock_of_link_.assign(links_.links.size(), -1);
    for (std::size_t l = 0; l < locks_.size(); ++l)
        lock_of_link_[static_cast<std::size_t>(locks_[l].link)] = static_cast<int>(l);
}

template <class P>
void Tree<P>::add_motor(int link, const P& force) {
    loads_.motors.resize(links_.links.size(), P(0));
    P& sum = loads_.motors[static_cast<std::size_t>(link)];
    sum = sum + force;
}

template <class P>
std::vector<P> Tree<P>::unit_response(int link, const P* y) const {
    TreeWork<P>& at = work<P>();
    move(y, at);
    if (has_loops()) compute_frames(y, at);
    for (LinkWork<P>& one : at.links) one.force = {};
    articulate(at);
    for (std::size_t i = 0; i < links_.links.size(); ++i) at.wrench[i] = {};
    add_generalized_force(link, P(1), at);
    std::vector<Pair6<P>> accelerations(links_.links.size());
    std::vector<P> jump(static_cast<std::size_t>(links_.rates));
    respond(at, accelerations.data(), jump.data(), static_cast<P*>(nullptr));
    hold_rows(at, accelerations.data(), jump.data());
    return jump;
}

/// Corrects changes of the motions of links and of rates so that they keep to the rows. Requires articulate() and, with
/// rows, frames.
template <class P>
void Tree<P>::hold_rows(TreeWork<P>& at, const Pair6<P>* jumps, P* jump) const {
    if (!has_loops()) return;
    const std::size_t rows = chosen_.size(), rates = static_cast<std::size_t>(links_.rates);
    find_rows(at), respond_to_rows(at);
    at.multipliers.resize(rows);
    for (std::size_t r = 0; r < rows; ++r)
        at.multipliers[r] = -applied(static_cast<std::size_t>(chosen_[r]), at, jumps, jump);
    solve_rows(at, at.multipliers);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t k = 0; k < rates; ++k) jump[k] = jump[k] + at.multipliers[r] * at.rates[r * rates + k];
}

template <class P>
void Tree<P>::displace(const P* by, P* y) const {
    for (const Link<P>& link : links_.links) {
        P* const x = y + link.coordinate;
        const P* const d = by + (link.rate - links_.coordinates);
        if (link.coordinates() == 1) {
            x[0] = x[0] + d[0];
            continue;
        }
        const P half = P(1) / P(2);
        const Quaternion<P> q{x[0], x[1], x[2], x[3]};
        const Quaternion<P> turned = normalized(q * Quaternion<P>{P(1), half * d[0], half * d[1], half * d[2]});
        x[0] = turned.w, x[1] = turned.x, x[2] = turned.y, x[3] = turned.z;
        if (link.kind == LinkJoint::free)
            for (std::size_t k = 0; k < 3; ++k) x[4 + k] = x[4 + k] + d[3 + k];
    }
}

template <class P>
P Tree<P>::loop_gap(const P* y) const {
    TreeWork<P>& at = work<P>();
    move(y, at), compute_frames(y, at), find_rows(at);
    P worst(0);
    for (const LoopRow<P>& row : at.rows)
        for (const P& size : {Elementary<P>::magnitude(row.value), Elementary<P>::magnitude(row.velocity)})
            if (size > worst) worst = size;
    return worst;
}

template <class P>
void Tree<P>::project(P* y) const {
    if (!has_loops()) return;
    constexpr int most_steps = 20;
    TreeWork<P>& at = work<P>();
    const std::size_t rows = chosen_.size(), rates = static_cast<std::size_t>(links_.rates);
    std::vector<P> change(rates);
    const auto solve_multipliers = [&](P LoopRow<P>::*what) {
        at.multipliers.resize(rows);
        for (std::size_t r = 0; r < rows; ++r)
            at.multipliers[r] = -(at.rows[static_cast<std::size_t>(chosen_[r])].*what);
        solve_rows(at, at.multipliers);
        for (std::size_t k = 0; k < rates; ++k) {
            change[k] = P(0);
            for (std::size_t r = 0; r < rows; ++r) change[k] = change[k] + at.multipliers[r] * at.rates[r * rates + k];
        }
    };
    const auto linearize = [&] {
        move(y, at), compute_frames(y, at);
        for (LinkWork<P>& link : at.links) link.force = {};
        articulate(at), find_rows(at), respond_to_rows(at);
    };
    // Newton's method, until round-off limits it
    P before(-1);
    linearize();
    for (int step = 0; step < most_steps; ++step) {
        P worst(0);
        for (const int row : chosen_) {
            const P size = Elementary<P>::magnitude(at.rows[static_cast<std::size_t>(row)].value);
            if (size > worst) worst = size;
        }
        if (!(worst > P(0)) || (step > 0 && !(worst + worst < before))) break;
        before = worst;
        solve_multipliers(&LoopRow<P>::value);
        displace(change.data(), y);
        linearize();
    }
    solve_multipliers(&LoopRow<P>::velocity);
    for (std::size_t k = 0; k < rates; ++k) {
        P& rate = y[static_cast<std::size_t>(links_.coordinates) + k];
        rate = rate + change[k];
    }
}

template <class P>
std::vector<std::array<P, 2>> Tree<P>::joint_coordinates(const P* y) const {
    std::vector<std::array<P, 2>> all(links_.link_of_joint.size(), std::array<P, 2>{P(0), P(0)});
    for (const Link<P>& link : links_.links)
        if (link.joint >= 0 && link.coordinates() == 1)
            all[static_cast<std::size_t>(link.joint)][static_cast<std::size_t>(link.axis)] = y[link.coordinate];
    return all;
}

template <class P>
template <class S>
std::vector<BodyMotion<S>> Tree<P>::motions(const S* y) const {
    TreeWork<S>& at = work<S>();
    move(y, at), compute_frames(y, at);
    for (std::size_t i = 0; i < links_.links.size(); ++i) at.q[i] = attitude_of(i, y, at);
    std::vector<BodyMotion<S>> all(links_.bodies.size());
    for (std::size_t b = 0; b < all.size(); ++b) {
        const LinkBody<P>& body = links_.bodies[b];
        BodyMotion<S>& m = all[b];
        if (body.link < 0) {
            m.q = cast<S>(body.q), m.position_W = cast<S>(body.center);
            continue;
        }
        const std::size_t i = static_cast<std::size_t>(body.link);
        const LinkFrame<S>& frame = at.frames[i];
        m.q = at.q[i] * body.q;
        m.angular_velocity_B = transposed_times(body.turn, at.links[i].w);
        m.position_W = frame.x + frame.R * body.center;
        m.velocity_W = at.velocity_W[i] + frame.R * cross(at.links[i].w, body.center);
    }
    return all;
}

}  // namespace polhode
