// Reactions of a mechanism of motion/tree.h: the force and torque that each joint exerts on its child, by the
// Newton-Euler equations of every body, from the leaves of the tree to its root.
#pragma once

#include "motion/tree.h"

namespace polhode {

template <class P>
template <class S>
std::vector<Reaction<S>> Tree<P>::reactions(const Scene& scene, const S* y) const {
    TreeWork<S>& at = work<S>();
    std::vector<S> dy(static_cast<std::size_t>(dimension()));
    accelerate(y, at, dy.data());
    if (!uses_frames()) compute_frames(y, at);
    return find_reactions(scene, y, at, {});
}

template <class P>
template <class S, class AddLoads>
std::vector<Reaction<S>> Tree<P>::reactions_with(const Scene& scene, const S* y, const AddLoads& add_loads) const {
    TreeWork<S>& at = work<S>();
    std::vector<S> dy(static_cast<std::size_t>(dimension()));
    move(y, at), compute_frames(y, at);
    load(y, at);
    const std::vector<BodyLoad<S>> applied = add_loads(at);
    solve_accelerations(at, dy.data());
    return find_reactions(scene, y, at, applied);
}

/// Requires the accelerations and the frames of the links under all loads, those of `applied` included.
template <class P>
template <class S>
std::vector<Reaction<S>> Tree<P>::find_reactions(const Scene& scene, const S* y, TreeWork<S>& at,
                                                 const std::vector<BodyLoad<S>>& applied) const {
    // For each body: position of its centre of mass, and the force and torque about it, in world axes, that remain to
    // be exerted by its joint and by the bodies attached to it.
    struct Balance {
        Matrix3<S> R;
        Vector3<S> x, arm, force, torque;
    };
    const std::size_t n = links_.bodies.size();
    std::vector<Balance> bodies(n);
    for (std::size_t b = 0; b < n; ++b) {
        const LinkBody<P>& body = links_.bodies[b];
        Balance& own = bodies[b];
        if (body.link < 0) {
            own.R = diagonal(Vector3<S>(S(P(1)), S(P(1)), S(P(1))));
            own.x = cast<S>(body.center);
            own.force = cast<S>(Vector3<P>(-body.mass * loads_.gravity_W));
            continue;
        }
        const std::size_t i = static_cast<std::size_t>(body.link);
        const LinkWork<S>& link = at.links[i];
        own.R = at.frames[i].R;
        own.arm = own.R * body.center;
        own.x = at.frames[i].x + own.arm;
        // the accelerations do not include gravity
        const Vector3<S> a = link.acceleration.linear + cross(link.acceleration.turning, body.center) +
                             cross(link.w, cross(link.w, body.center));
        own.force = body.mass * (own.R * a);
        const Vector3<S> w = transposed_times(body.turn, link.w);
        const Vector3<S> alpha = transposed_times(body.turn, link.acceleration.turning);
        const Vector3<S> torque_B = body.inertia_B * alpha + cross(w, body.inertia_B * w);
        own.torque = own.R * (body.turn * torque_B);
    }
    const auto take = [&](int body, const Vector3<S>& point_W, const Vector3<S>& force_W, const Vector3<S>& torque_W) {
        if (body < 0) return;
        Balance& own = bodies[static_cast<std::size_t>(body)];
        own.force = own.force - force_W;
        own.torque = own.torque - (torque_W + cross(point_W - own.x, force_W));
    };
    const auto origin = [&](int link) { return link < 0 ? Vector3<S>() : at.frames[static_cast<std::size_t>(link)].x; };
    const auto place = [&](const LinkPoint<P>& point) -> Vector3<S> {
        if (point.link < 0) return cast<S>(point.point);
        const LinkFrame<S>& frame = at.frames[static_cast<std::size_t>(point.link)];
        return frame.x + frame.R * point.point;
    };
    for (const BodyLoad<S>& one : applied) {
        const Matrix3<S>& R = bodies[static_cast<std::size_t>(one.body)].R;
        take(one.body, origin(one.link), R * one.load.linear, R * one.load.turning);
    }
    for (const auto& one : loads_.constant) {
        const Matrix3<S>& R = bodies[static_cast<std::size_t>(one.body)].R;
        take(one.body, origin(one.link), R * one.load.linear, R * one.load.turning);
    }
    for (const auto& one : loads_.in_world)
        take(one.body, place({one.link, one.point, one.body}), cast<S>(one.force_W), cast<S>(one.torque_W));
    for (const auto& one : loads_.at_world_points) {
        const Matrix3<S>& R = bodies[static_cast<std::size_t>(one.body)].R;
        take(one.body, cast<S>(one.point_W), one.in_link ? Vector3<S>(R * one.force) : cast<S>(one.force), {});
    }
    for (const auto& one : loads_.drags) {
        if (one.link < 0) continue;
        const std::size_t i = static_cast<std::size_t>(one.link);
        const Matrix3<S>& R = at.frames[i].R;
        const Vector3<S> v = at.velocity_W[i] + R * cross(at.links[i].w, one.center);
        take(one.body, place({one.link, one.center, one.body}), (-one.translational) * v,
             -(R * (one.rotational * at.links[i].w)));
    }
    for (std::size_t i = 0; i < links_.links.size(); ++i) at.q[i] = attitude_of(i, y, at);
    for (const auto& one : loads_.springs) {
        const Quaternion<S> link =
            one.link < 0 ? Quaternion<S>{S(P(1)), S(P(0)), S(P(0)), S(P(0))} : at.q[static_cast<std::size_t>(one.link)];
        const Quaternion<S> q = link * one.q, r = conjugate(one.rest) * q;
        const Vector3<S> torque_B = (P(-2) * one.stiffness) * (r.w * vector_part(r));
        take(one.body, bodies[static_cast<std::size_t>(one.body)].x, {}, rotate(q, torque_B));
    }
    for (const auto& one : loads_.between) {
        const Vector3<S> first = place(one.first), second = place(one.second), d = second - first;
        Vector3<S> pull = one.stiffness * d;
        if (!(one.rest_length == P(0)))
            pull = pull - ((one.stiffness * one.rest_length) * (S(P(1)) / square_root(S(dot(d, d))))) * d;
        take(one.first.body, first, pull, {});
        take(one.second.body, second, Vector3<S>(-pull), {});
    }
    std::vector<Reaction<S>> all(scene.joints.size());
    for (std::size_t l = 0, row = 0; l < loops_.size(); ++l) {
        const LinkLoop<P>& loop = loops_[l];
        // its forces are part of the reactions of its joints
        if (loop.couples) {
            ++row;
            continue;
        }
        Pair6<S> on_second;  // about the second link's origin, in its axes
        for (int k = 0; k < loop.rows(); ++k, ++row)
            for (std::size_t c = 0; c < chosen_.size(); ++c) {
                if (static_cast<std::size_t>(chosen_[c]) != row) continue;
                const Pair6<S>& unit = at.rows[row].second;
                on_second.turning = on_second.turning + at.multipliers[c] * unit.turning;
                on_second.linear = on_second.linear + at.multipliers[c] * unit.linear;
            }
        Reaction<S> reaction{on_second.linear, on_second.turning - cross(loop.second.point, on_second.linear)};
        if (loop.second.link >= 0) {
            const Matrix3<S>& R = at.frames[static_cast<std::size_t>(loop.second.link)].R;
            reaction = {R * reaction.force_W, R * reaction.torque_W};
        }
        take(loop.second.body, place(loop.second), reaction.force_W, reaction.torque_W);
        // a distance loop acts along the line between its points, any other loop at the common point
        take(loop.first.body, place(loop.first), -reaction.force_W, -reaction.torque_W);
        all.push_back(reaction);
    }
    for (std::size_t k = n; k-- > 0;) {
        const std::size_t b = static_cast<std::size_t>(links_.order[k]);
        const int carrier = links_.carrier[b];
        if (carrier < 0) continue;
        const Joint& joint = scene.joints[static_cast<std::size_t>(carrier)];
        const LinkBody<P>& body = links_.bodies[b];
        const Vector3<P> in_link = body.origin + body.turn * cast<P>(joint.child_point);
        const Vector3<S> point = place({body.link, in_link, static_cast<int>(b)});
        const Balance& own = bodies[b];
        Reaction<S>& reaction = all[static_cast<std::size_t>(carrier)];
        reaction = {own.force, own.torque + cross(Vector3<S>(own.x - point), own.force)};
        // the opposite acts on the parent at the child's point; this also holds for a prismatic joint, which
        // transmits the whole force
        take(body_index(scene, joint.parent), point, -reaction.force_W, -reaction.torque_W);
    }
    return all;
}

}  // namespace polhode
