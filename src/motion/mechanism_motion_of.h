// Definitions of MechanismMeasure (motion/mechanism_motion.h) for every scalar.
//
// Everything is computed from the poses and velocities of the bodies in maximal coordinates. A joint's relative
// rotation is J = q0* q_parent* q_child. Joint angles are extracted from J by swing-twist decomposition (turn_about)
// and unwrapped by JointCoordinates.
#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "body/elementary.h"
#include "motion/exact_body.h"
#include "motion/mechanism_motion.h"
#include "scene/body_source.h"

namespace polhode {

/// The angle x (rad) of the rotation about a unit axis contained in the unit quaternion r: r = swing exp(axis x),
/// where the swing's axis is perpendicular. Between -pi and pi.
template <class P>
P turn_about(const Quaternion<P>& r, const Vector3<P>& axis) {
    P sine = dot(vector_part(r), axis), cosine = r.w;
    P angle(0);
    // Each pass adds the binary64 angle of the remainder, whose error is cubed (the tangent of a half); three passes
    // suffice for many digits.
    for (int i = 0; i < 3; ++i) {
        const P part(2 * std::atan2(static_cast<double>(sine), static_cast<double>(cosine)));
        P s, c;
        Elementary<P>::sine_cosine(P(part / P(2)), s, c);
        const P rest_sine = sine * c - cosine * s, rest_cosine = cosine * c + sine * s;
        angle = angle + part, sine = rest_sine, cosine = rest_cosine;
    }
    // (w, v) and (-w, -v) are the same rotation
    const P turn = P(2) * Elementary<P>::pi();
    if (angle > Elementary<P>::pi()) return angle - turn;
    if (angle < -Elementary<P>::pi()) return angle + turn;
    return angle;
}

/// The angle of the rotation r (rad), to binary64 precision.
template <class P>
P whole_turn(const Quaternion<P>& r) {
    const double across = static_cast<double>(length(vector_part(r))), along = static_cast<double>(r.w);
    return P(2 * std::atan2(across, std::abs(along)));
}

/// The angle between two vectors (rad), to binary64 precision.
template <class P>
P angle_between(const Vector3<P>& a, const Vector3<P>& b) {
    return P(std::atan2(static_cast<double>(length(cross(a, b))), static_cast<double>(dot(a, b))));
}

template <class P>
std::vector<MassProperties<P>> bodies_mass_properties(const Scene& scene) {
    std::vector<MassProperties<P>> all;
    all.reserve(scene.bodies.size());
    for (const NamedBody& body : scene.bodies) all.push_back(mass_properties<P>(body.body));
    return all;
}

template <class P>
MechanismMeasure<P>::MechanismMeasure(const Scene& scene) : bodies_(bodies_mass_properties<P>(scene)) {
    const auto point = [&](const std::string& body, const Vector3<double>& from_origin) {
        const int b = body_index(scene, body);
        Point p{b, cast<P>(from_origin)};
        if (b >= 0) p.arm = p.arm - bodies_[static_cast<std::size_t>(b)].center;
        return p;
    };
    const auto unit = [](const Vector3<double>& v) {
        const Vector3<P> w = cast<P>(v);
        const P size = length(w);
        return size > P(0) ? Vector3<P>(w[0] / size, w[1] / size, w[2] / size) : w;
    };
    for (const MassProperties<P>& body : bodies_) {
        const P moment = (body.inertia[0][0] + body.inertia[1][1] + body.inertia[2][2]) / P(2);
        slow_angular_ = slow_angular_ + moment / P(scene.duration);
        slow_linear_ = slow_linear_ + square_root(P(body.mass * moment)) / P(scene.duration);
    }
    for (const Joint& joint : scene.joints) {
        Link link;
        link.type = joint.type;
        link.parent = point(joint.parent, joint.parent_point), link.child = point(joint.child, joint.child_point);
        link.q0 = normalized(cast<P>(joint.parent_orientation));
        for (std::size_t i = 0; i < 2; ++i) {
            link.axes[i] = unit(joint.axes[i]);
            link.stiffness[i] = P(joint.stiffness[i]), link.rest[i] = P(joint.rest[i]);
        }
        link.between = dot(link.axes[0], link.axes[1]);
        link.rest_orientation = normalized(cast<P>(joint.rest_orientation));
        link.springy = joint.type != JointType::fixed && (joint.stiffness[0] != 0 || joint.stiffness[1] != 0);
        link.armature = {P(joint.armature[0]), P(joint.armature[1])};
        link.has_armature = joint.armature != std::array<double, 2>{};
        tied_to_world_ = tied_to_world_ || link.parent.body < 0;
        links_.push_back(std::move(link));
    }
    for (const Loop& loop : scene.loops) {
        closures_.push_back({loop.type, point(loop.first, loop.first_point), point(loop.second, loop.second_point),
                             unit(loop.first_axis), unit(loop.second_axis), P(loop.length)});
        tied_to_world_ = tied_to_world_ || closures_.back().first.body < 0 || closures_.back().second.body < 0;
    }
    for (const Load& load : scene.loads) {
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            fields_.push_back({cast<P>(gravity->acceleration_W), gravity->window});
        } else if (const auto* force = std::get_if<Force>(&load)) {
            if (force->frame == Frame::world && force->point_frame == Frame::body)
                pulls_.push_back({point(force->body, force->point), cast<P>(force->vector), force->window});
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            twists_.push_back({body_index(scene, spring->body), P(spring->stiffness),
                               conjugate(normalized(cast<P>(spring->rest_orientation))), spring->window});
        } else if (const auto* strut = std::get_if<PointSpring>(&load)) {
            struts_.push_back({point(strut->first, strut->first_point), point(strut->second, strut->second_point),
                               P(strut->stiffness), P(strut->rest_length), strut->window});
        }
    }
}

template <class P>
std::vector<P> MechanismMeasure<P>::arms() const {
    std::vector<P> all;
    for (const Link& link : links_) all.push_back(length(link.child.arm));
    for (const Closure& closure : closures_) all.push_back(closure.second.body < 0 ? P(0) : length(closure.second.arm));
    return all;
}

template <class P>
Vector3<P> MechanismMeasure<P>::placed(const Point& point, Motions motions) {
    if (point.body < 0) return point.arm;
    const BodyMotion<P>& m = motions[static_cast<std::size_t>(point.body)];
    return m.position_W + rotate(m.q, point.arm);
}

template <class P>
Quaternion<P> MechanismMeasure<P>::attitude(const Point& point, Motions motions) {
    return point.body < 0 ? Quaternion<P>{P(1), P(0), P(0), P(0)} : motions[static_cast<std::size_t>(point.body)].q;
}

// J = q0* q_parent* q_child
template <class P>
Quaternion<P> MechanismMeasure<P>::joint_rotation(const Link& link, Motions motions) {
    return conjugate(link.q0) * (conjugate(attitude(link.parent, motions)) * attitude(link.child, motions));
}

template <class P>
P MechanismMeasure<P>::potential(double t, Motions motions) const {
    P sum(0);
    for (const Field& field : fields_)
        if (acts(field.window, t))
            for (std::size_t i = 0; i < bodies_.size(); ++i)
                sum = sum - bodies_[i].mass * dot(field.acceleration_W, motions[i].position_W);
    for (const Pull& pull : pulls_)
        if (acts(pull.window, t)) sum = sum - dot(pull.force_W, placed(pull.point, motions));
    for (const Twist& twist : twists_)
        if (acts(twist.window, t)) {
            const Vector3<P> r = vector_part(twist.rest * motions[static_cast<std::size_t>(twist.body)].q);
            sum = sum + P(2) * twist.stiffness * dot(r, r);
        }
    for (const Strut& strut : struts_)
        if (acts(strut.window, t)) {
            const P stretch = length(placed(strut.second, motions) - placed(strut.first, motions)) - strut.rest_length;
            sum = sum + strut.stiffness * stretch * stretch / P(2);
        }
    return sum;
}

template <class P>
P MechanismMeasure<P>::spring_energy(std::size_t joint, double t, Motions motions,
                                     JointCoordinates& coordinates) const {
    const Link& link = links_[joint];
    const Quaternion<P> J = joint_rotation(link, motions);
    if (link.type == JointType::spherical) {
        const Vector3<P> r = vector_part(conjugate(link.rest_orientation) * J);
        return P(2) * link.stiffness[0] * dot(r, r);
    }
    const auto energy = [&](std::size_t axis, const P& x) {
        const P stretch = x - link.rest[axis];
        return link.stiffness[axis] * stretch * stretch / P(2);
    };
    if (link.type == JointType::prismatic) {
        const Vector3<P> along = rotate(attitude(link.parent, motions) * link.q0, link.axes[0]);
        const P x = dot(along, placed(link.child, motions) - placed(link.parent, motions));
        coordinates.keep(joint, 0, t, static_cast<double>(x), 0);
        return energy(0, x);
    }
    // angular velocity of the child relative to the parent, in the child's axes
    const auto rate_W = [&](const Point& point) {
        if (point.body < 0) return Vector3<P>();
        const BodyMotion<P>& m = motions[static_cast<std::size_t>(point.body)];
        return rotate(m.q, m.angular_velocity_B);
    };
    const Vector3<P> w = rotate_back(attitude(link.child, motions), rate_W(link.child) - rate_W(link.parent));
    const auto unwrapped = [&](std::size_t axis, const P& angle, const P& rate) {
        const double turns = coordinates.turns(joint, axis, t, static_cast<double>(angle), static_cast<double>(rate));
        P x = angle + P(turns) * P(2) * Elementary<P>::pi();
        coordinates.keep(joint, axis, t, static_cast<double>(x), static_cast<double>(rate));
        return x;
    };
    const Vector3<P>&a = link.axes[0], &b = link.axes[1];
    if (link.type == JointType::revolute) return energy(0, unwrapped(0, turn_about(J, a), dot(w, a)));
    // J = exp(a x) exp(b y) leaves b fixed in the middle frame: x is the rotation about a from there to J b
    const Vector3<P> u = b - link.between * a, Jb = rotate(J, b);
    const P sine = dot(a, cross(u, Jb)), cosine = dot(u, Jb);
    // the quaternion about a with half of that angle
    const P size = square_root(P(sine * sine + cosine * cosine));
    const Quaternion<P> half =
        cosine >= P(0)
            ? Quaternion<P>{size + cosine, sine * a[0], sine * a[1], sine * a[2]}
            : (sine >= P(0)
                   ? Quaternion<P>{sine, (size - cosine) * a[0], (size - cosine) * a[1], (size - cosine) * a[2]}
                   : Quaternion<P>{-sine, (cosine - size) * a[0], (cosine - size) * a[1], (cosine - size) * a[2]});
    const Quaternion<P> first = normalized(half), second = conjugate(first) * J;
    const Vector3<P> a_child = rotate_back(second, a);
    const P determinant = P(1) - link.between * link.between;
    const P x_rate = (dot(w, a_child) - link.between * dot(w, b)) / determinant;
    const P y_rate = (dot(w, b) - link.between * dot(w, a_child)) / determinant;
    const P x = unwrapped(0, turn_about(first, a), x_rate), y = unwrapped(1, turn_about(second, b), y_rate);
    return energy(0, x) + energy(1, y);
}

// d x'^2 / 2 of the coordinates; spherical joint: d |w|^2 / 2 with the relative angular velocity w.
template <class P>
P MechanismMeasure<P>::armature_energy(const Link& link, Motions motions) const {
    const auto w_of = [&](const Point& point) {
        if (point.body < 0) return Vector3<P>();
        const BodyMotion<P>& m = motions[static_cast<std::size_t>(point.body)];
        return rotate(m.q, m.angular_velocity_B);
    };
    const auto v_of = [&](const Point& point) {
        if (point.body < 0) return Vector3<P>();
        const BodyMotion<P>& m = motions[static_cast<std::size_t>(point.body)];
        return m.velocity_W + rotate(m.q, cross(m.angular_velocity_B, point.arm));
    };
    const Vector3<P> base = w_of(link.parent), w = w_of(link.child) - base;
    const Vector3<P> first = rotate(attitude(link.parent, motions) * link.q0, link.axes[0]);
    const auto energy = [&](std::size_t axis, const P& rate) { return link.armature[axis] * rate * rate / P(2); };
    if (link.type == JointType::spherical) return link.armature[0] * dot(w, w) / P(2);
    if (link.type == JointType::revolute) return energy(0, dot(first, w));
    if (link.type == JointType::prismatic) {
        const Vector3<P> apart = placed(link.child, motions) - placed(link.parent, motions);
        return energy(0, dot(first, v_of(link.child) - v_of(link.parent) - cross(base, apart)));
    }
    // w = e1 x' + e2 y'
    const Vector3<P> second = rotate(attitude(link.child, motions), link.axes[1]);
    const P a = dot(first, w), b = dot(second, w), c = dot(first, second), determinant = P(1) - c * c;
    return energy(0, P((a - c * b) / determinant)) + energy(1, P((b - c * a) / determinant));
}

template <class P>
SystemInvariants<P> MechanismMeasure<P>::invariants(double t, Motions motions, JointCoordinates& coordinates) const {
    if (motions.size() != bodies_.size())
        throw std::invalid_argument("the number of motions must equal the number of bodies");
    SystemInvariants<P> result;
    result.angular_size = slow_angular_, result.linear_size = slow_linear_;
    P mass(0);
    Vector3<P> center_W;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const P& m = bodies_[i].mass;
        mass = mass + m;
        center_W = center_W + m * motions[i].position_W;
        result.linear_momentum_W = result.linear_momentum_W + m * motions[i].velocity_W;
        result.linear_size = result.linear_size + m * length(motions[i].velocity_W);
    }
    Vector3<P> about_W, drift_W;
    if (!tied_to_world_) about_W = (P(1) / mass) * center_W, drift_W = (P(1) / mass) * result.linear_momentum_W;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const BodyMotion<P>& motion = motions[i];
        const P& m = bodies_[i].mass;
        const Vector3<P> spin_B = bodies_[i].inertia * motion.angular_velocity_B;
        const Vector3<P> orbit_W = m * cross(motion.position_W - about_W, motion.velocity_W - drift_W);
        result.angular_momentum_W = result.angular_momentum_W + (rotate(motion.q, spin_B) + orbit_W);
        result.angular_size = result.angular_size + (length(spin_B) + length(orbit_W));
        result.kinetic =
            result.kinetic +
            (dot(motion.angular_velocity_B, spin_B) + m * dot(motion.velocity_W, motion.velocity_W)) / P(2);
    }
    for (const Link& link : links_)
        if (link.has_armature) result.kinetic = result.kinetic + armature_energy(link, motions);
    result.energy = result.kinetic + potential(t, motions);
    for (std::size_t j = 0; j < links_.size(); ++j)
        if (links_[j].springy) result.energy = result.energy + spring_energy(j, t, motions, coordinates);
    return result;
}

template <class P>
JointViolations<P> MechanismMeasure<P>::violations(Motions motions) const {
    if (motions.size() != bodies_.size())
        throw std::invalid_argument("the number of motions must equal the number of bodies");
    JointViolations<P> worst;
    // NaN is larger than everything
    const auto larger = [](const P& a, const P& b) { return !(a <= b) && !std::isnan(static_cast<double>(b)); };
    const auto note = [&](std::size_t joint, const P& gap, const P& turn) {
        if (larger(gap, worst.gap)) worst.gap = gap, worst.gap_joint = joint;
        if (larger(turn, worst.turn)) worst.turn = turn, worst.turn_joint = joint;
    };
    for (std::size_t j = 0; j < links_.size(); ++j) {
        const Link& link = links_[j];
        const Quaternion<P> J = joint_rotation(link, motions);
        Vector3<P> apart = placed(link.child, motions) - placed(link.parent, motions);
        P turn(0);
        switch (link.type) {
            case JointType::revolute:
                turn = angle_between(link.axes[0], rotate(J, link.axes[0]));
                break;
            case JointType::prismatic: {
                const Vector3<P> along = rotate(attitude(link.parent, motions) * link.q0, link.axes[0]);
                apart = apart - dot(along, apart) * along;
                turn = whole_turn(J);
                break;
            }
            case JointType::spherical:
                break;
            case JointType::universal: {
                const double should = static_cast<double>(angle_between(link.axes[0], link.axes[1]));
                const double is = static_cast<double>(angle_between(link.axes[0], rotate(J, link.axes[1])));
                turn = P(std::abs(is - should));
                break;
            }
            case JointType::fixed:
                turn = whole_turn(J);
                break;
        }
        note(j, length(apart), turn);
    }
    for (std::size_t i = 0; i < closures_.size(); ++i) {
        const Closure& loop = closures_[i];
        const P distance = length(placed(loop.second, motions) - placed(loop.first, motions));
        const P gap = loop.type == LoopType::distance ? Elementary<P>::magnitude(P(distance - loop.length)) : distance;
        P turn(0);
        if (loop.type == LoopType::revolute)
            turn = angle_between(rotate(attitude(loop.first, motions), loop.first_axis),
                                 rotate(attitude(loop.second, motions), loop.second_axis));
        note(links_.size() + i, gap, turn);
    }
    return worst;
}

}  // namespace polhode
