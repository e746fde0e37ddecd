// Converts a mechanism's constants to another scalar by To(number). Binary64 constants are rounded once from 113
// bits.
#pragma once

#include "motion/tree.h"

namespace polhode {

template <class To, class From>
Symmetric3<To> cast(const Symmetric3<From>& m) {
    return {To(m.xx), To(m.yy), To(m.zz), To(m.xy), To(m.xz), To(m.yz)};
}
template <class To, class From>
Pair6<To> cast(const Pair6<From>& pair) {
    return {cast<To>(pair.turning), cast<To>(pair.linear)};
}
template <class To, class From>
LinkPoint<To> cast(const LinkPoint<From>& point) {
    return {point.link, cast<To>(point.point), point.body};
}

template <class To, class From>
Link<To> cast(const Link<From>& l) {
    Link<To> r;
    r.parent = l.parent, r.kind = l.kind, r.joint = l.joint, r.axis = l.axis, r.base = l.base;
    r.coordinate = l.coordinate, r.rate = l.rate, r.dependent = l.dependent;
    r.q_placement = cast<To>(l.q_placement), r.turn = cast<To>(l.turn), r.place = cast<To>(l.place);
    r.mass = To(l.mass), r.moment = cast<To>(l.moment), r.inertia = cast<To>(l.inertia);
    r.stiffness = To(l.stiffness), r.rest = To(l.rest), r.damping = To(l.damping);
    r.rest_orientation = cast<To>(l.rest_orientation);
    r.start = To(l.start), r.start_rate = To(l.start_rate), r.start_q = cast<To>(l.start_q);
    r.start_w = cast<To>(l.start_w), r.start_position = cast<To>(l.start_position);
    r.start_velocity = cast<To>(l.start_velocity);
    r.armature = To(l.armature);
    return r;
}

template <class To, class From>
Links<To> cast(const Links<From>& links) {
    Links<To> r;
    for (const Link<From>& link : links.links) r.links.push_back(cast<To>(link));
    for (const LinkBody<From>& b : links.bodies)
        r.bodies.push_back({b.link, cast<To>(b.q), cast<To>(b.turn), cast<To>(b.origin), cast<To>(b.center), To(b.mass),
                            cast<To>(b.inertia_B)});
    r.order = links.order, r.carrier = links.carrier, r.link_of_joint = links.link_of_joint;
    r.coordinates = links.coordinates, r.rates = links.rates, r.has_armature = links.has_armature;
    return r;
}

template <class To, class From>
LinkLoads<To> cast(const LinkLoads<From>& loads) {
    LinkLoads<To> r;
    r.gravity_W = cast<To>(loads.gravity_W);
    for (const auto& one : loads.constant) r.constant.push_back({one.link, one.body, cast<To>(one.load)});
    for (const auto& one : loads.in_world)
        r.in_world.push_back({one.link, one.body, cast<To>(one.torque_W), cast<To>(one.force_W), cast<To>(one.point)});
    for (const auto& one : loads.at_world_points)
        r.at_world_points.push_back({one.link, one.body, cast<To>(one.force), cast<To>(one.point_W), one.in_link});
    for (const auto& one : loads.drags)
        r.drags.push_back({one.link, one.body, cast<To>(one.rotational), To(one.translational), cast<To>(one.center)});
    for (const auto& one : loads.springs)
        r.springs.push_back({one.link, one.body, To(one.stiffness), cast<To>(one.q), cast<To>(one.rest)});
    for (const auto& one : loads.between)
        r.between.push_back({cast<To>(one.first), cast<To>(one.second), To(one.stiffness), To(one.rest_length)});
    for (const From& motor : loads.motors) r.motors.push_back(To(motor));
    return r;
}

template <class P>
template <class Other>
Tree<P>::Tree(const Tree<Other>& other)
    : links_(cast<P>(other.links_)),
      loads_(cast<P>(other.loads_)),
      loop_of_row_(other.loop_of_row_),
      all_rows_(other.all_rows_),
      chosen_(other.chosen_),
      locks_(other.locks_),
      lock_of_link_(other.lock_of_link_) {
    for (const LinkLoop<Other>& loop : other.loops_)
        loops_.push_back({loop.type,
                          cast<P>(loop.first),
                          cast<P>(loop.second),
                          {cast<P>(loop.across[0]), cast<P>(loop.across[1])},
                          cast<P>(loop.second_axis),
                          P(loop.length),
                          loop.couples,
                          P(loop.ratio),
                          P(loop.offset)});
    for (const Other& y : other.start_) start_.push_back(P(y));
}

template <class P>
template <class Other>
void Tree<P>::convert_loads(const LinkLoads<Other>& loads) {
    loads_ = cast<P>(loads);
}

}  // namespace polhode
