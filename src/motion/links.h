// A mechanism as a tree of links, in the axes and about the points that its recursion uses, exact in the scalar P.
//
// A link is a set of bodies that move as one: a body and everything attached to it by fixed joints. Each link has its
// own axes and origin:
// - revolute, prismatic: z along the joint's axis, the origin at the joint's point;
// - spherical: the axes of the body that the joint carries, the origin at the joint's point;
// - free: the axes of the base body, the origin at the link's centre of mass. A universal joint becomes two revolute
//   joints with a massless link between them.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "motion/mechanism_motion.h"
#include "scene/scene.h"

namespace polhode {

/// How a link moves relative to its parent.
enum class LinkJoint { revolute, prismatic, spherical, free };

/// The parent of a base link, and the link of bodies that do not move.
inline constexpr int world_link = -1;

/// A symmetric 3x3 matrix.
template <class S>
struct Symmetric3 {
    S xx = S(0), yy = S(0), zz = S(0), xy = S(0), xz = S(0), yz = S(0);
};

/// The symmetric matrix with the upper triangle of m.
template <class S>
Symmetric3<S> symmetric_part(const Matrix3<S>& m) {
    return {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
}
template <class A, class B>
Vector3<Product<A, B>> operator*(const Symmetric3<A>& m, const Vector3<B>& v) {
    return {m.xx * v[0] + m.xy * v[1] + m.xz * v[2], m.xy * v[0] + m.yy * v[1] + m.yz * v[2],
            m.xz * v[0] + m.yz * v[1] + m.zz * v[2]};
}

/// One link. All vectors except `place` are in its own axes from its own origin.
template <class P>
struct Link {
    int parent = world_link;
    LinkJoint kind = LinkJoint::revolute;
    int joint = -1;      ///< index in scene.joints; -1 for a free base
    int axis = 0;        ///< index of the axis in a universal joint
    int base = -1;       ///< free base: index in scene.bodies
    int coordinate = 0;  ///< index in y of its coordinates: x; q; or q and the origin's position in W
    int rate = 0;        ///< index in y of its rates: x'; w relative to the parent; or w and the origin's velocity in W
    Quaternion<P> q_placement;  ///< link axes at coordinate zero to the parent link's axes
    Matrix3<P> turn;            ///< `q_placement` as a matrix
    Vector3<P> place;           ///< the joint's point, from the parent's origin, in the parent link's axes
    P mass = P(0);
    Vector3<P> moment;      ///< mass times centre of mass
    Symmetric3<P> inertia;  ///< about the origin
    P stiffness = P(0), rest = P(0), damping = P(0);
    Quaternion<P> rest_orientation;  ///< spherical
    P start = P(0), start_rate = P(0);
    Quaternion<P> start_q;                               ///< spherical, free
    Vector3<P> start_w, start_position, start_velocity;  ///< spherical, free
    bool dependent = false;
    P armature = P(0);  ///< added to the diagonal of the mass matrix for each rate

    int coordinates() const { return kind == LinkJoint::free ? 7 : kind == LinkJoint::spherical ? 4 : 1; }
    int rates() const { return kind == LinkJoint::free ? 6 : kind == LinkJoint::spherical ? 3 : 1; }
};

/// The pose of a body on its link.
template <class P>
struct LinkBody {
    int link = world_link;  ///< world_link: the body does not move, and the following vectors are in world axes
    Quaternion<P> q;        ///< body axes to link axes
    Matrix3<P> turn;        ///< `q` as a matrix
    Vector3<P> origin;      ///< the body's origin
    Vector3<P> center;      ///< its centre of mass
    P mass = P(0);
    Matrix3<P> inertia_B;  ///< about its centre of mass, in the body's axes
};

/// The links and bodies of a mechanism.
template <class P>
struct Links {
    std::vector<Link<P>> links;       ///< parents precede their children
    std::vector<LinkBody<P>> bodies;  ///< in the order of the scene
    std::vector<int> order;           ///< indices of bodies: each follows the body that carries it
    std::vector<int> carrier;         ///< for each body: index in scene.joints; -1 for a free base
    std::vector<int> link_of_joint;   ///< per joint: its (last) link; world_link if it does not move
    int coordinates = 0, rates = 0;   ///< sizes of the state y = (coordinates, rates)
    bool has_armature = false;        ///< whether any link has an armature
};

/// A unit quaternion that rotates z to the direction of `axis`, of any nonzero length. Exact for coordinate axes.
template <class P>
Quaternion<P> from_z(const Vector3<double>& axis) {
    const P half = P(1) / P(2), zero(0), one(1);
    const bool x = axis[0] != 0, y = axis[1] != 0, z = axis[2] != 0;
    if (!x && !y) return axis[2] > 0 ? Quaternion<P>{one, zero, zero, zero} : Quaternion<P>{zero, one, zero, zero};
    // cyclic permutations of the axes, preceded by a half rotation about x for negative axes
    if (!y && !z) {
        const Quaternion<P> q{half, half, half, half};
        return axis[0] > 0 ? q : q * Quaternion<P>{zero, one, zero, zero};
    }
    if (!x && !z) {
        const Quaternion<P> q{half, -half, -half, -half};
        return axis[1] > 0 ? q : q * Quaternion<P>{zero, one, zero, zero};
    }
    const Vector3<P> a = cast<P>(axis);
    const P size = length(a);
    // (|a| + a_z, z x a), or by way of -z, where that would cancel
    if (axis[2] >= 0) return normalized(Quaternion<P>{size + a[2], -a[1], a[0], zero});
    return normalized(Quaternion<P>{size - a[2], a[1], -a[0], zero}) * Quaternion<P>{zero, one, zero, zero};
}

/// The links of a valid scene of several bodies. `properties`: the mass properties of each body.
template <class P>
Links<P> links_of(const Scene& scene, const std::vector<MassProperties<P>>& properties) {
    Links<P> all;
    const std::size_t n = scene.bodies.size();
    all.bodies.resize(n);
    all.link_of_joint.assign(scene.joints.size(), world_link);
    std::vector<int>& carrier = all.carrier;
    carrier.assign(n, -1);
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
        carrier[static_cast<std::size_t>(body_index(scene, scene.joints[j].child))] = static_cast<int>(j);

    LinkBody<P> world;
    world.turn = diagonal(Vector3<P>(P(1), P(1), P(1)));
    const auto set_turn = [](Link<P>& link, const Quaternion<P>& q) {
        link.q_placement = q, link.turn = rotation_matrix(q);
    };
    const auto carry = [&](std::size_t b, int link, const Quaternion<P>& q, const Vector3<P>& origin) {
        LinkBody<P>& body = all.bodies[b];
        body.link = link, body.q = q, body.turn = rotation_matrix(q), body.origin = origin;
        body.mass = properties[b].mass, body.inertia_B = properties[b].inertia;
        body.center = origin + body.turn * properties[b].center;
    };
    std::vector<char> placed(n, 0);
    const auto place = [&](std::size_t b) {
        const int number = static_cast<int>(all.links.size());
        if (carrier[b] < 0) {
            Link<P> link;
            link.kind = LinkJoint::free, link.base = static_cast<int>(b);
            set_turn(link, {});
            all.links.push_back(link);
            carry(b, number, {}, {});
            return;
        }
        const Joint& joint = scene.joints[static_cast<std::size_t>(carrier[b])];
        const int parent_body = body_index(scene, joint.parent);
        const LinkBody<P>& parent = parent_body < 0 ? world : all.bodies[static_cast<std::size_t>(parent_body)];
        const Vector3<P> point = parent.origin + parent.turn * cast<P>(joint.parent_point);
        const Quaternion<P> q0 = parent.q * normalized(cast<P>(joint.parent_orientation));
        const Vector3<P> child_point = cast<P>(joint.child_point);
        if (joint.type == JointType::fixed) {
            carry(b, parent.link, q0, point - rotation_matrix(q0) * child_point);
            return;
        }
        Link<P> link;
        link.parent = parent.link, link.joint = carrier[b], link.place = point, link.dependent = joint.dependent;
        const auto set_axis = [&](int axis) {
            const std::size_t a = static_cast<std::size_t>(axis);
            link.axis = axis;
            link.stiffness = P(joint.stiffness[a]), link.rest = P(joint.rest[a]), link.damping = P(joint.damping[a]);
            link.start = P(joint.coordinate[a]), link.start_rate = P(joint.rate[a]);
            link.armature = P(joint.armature[a]);
            all.has_armature = all.has_armature || joint.armature[a] != 0;
        };
        Quaternion<P> to_body;  // link axes to the child's axes
        set_axis(0);
        if (joint.type == JointType::spherical) {
            link.kind = LinkJoint::spherical;
            set_turn(link, q0);
            link.rest_orientation = normalized(cast<P>(joint.rest_orientation));
            link.start_q = normalized(cast<P>(joint.orientation));
            link.start_w = cast<P>(joint.angular_velocity);
        } else {
            link.kind = joint.type == JointType::prismatic ? LinkJoint::prismatic : LinkJoint::revolute;
            to_body = from_z<P>(joint.axes[0]);
            set_turn(link, q0 * to_body);
        }
        all.links.push_back(link);
        if (joint.type == JointType::universal) {
            const Quaternion<P> second = from_z<P>(joint.axes[1]);
            link.parent = number, link.place = {};
            set_axis(1);
            set_turn(link, conjugate(to_body) * second);
            to_body = second;
            all.links.push_back(link);
        }
        const int last = static_cast<int>(all.links.size()) - 1;
        all.link_of_joint[static_cast<std::size_t>(carrier[b])] = last;
        const Quaternion<P> q = conjugate(to_body);
        carry(b, last, q, -(rotation_matrix(q) * child_point));
    };
    for (std::size_t done = 0, before = n; done < n && done != before;) {
        before = done;
        for (std::size_t b = 0; b < n; ++b) {
            if (placed[b]) continue;
            const int parent =
                carrier[b] < 0 ? -1 : body_index(scene, scene.joints[static_cast<std::size_t>(carrier[b])].parent);
            if (parent >= 0 && !placed[static_cast<std::size_t>(parent)]) continue;
            place(b);
            placed[b] = 1, ++done;
            all.order.push_back(static_cast<int>(b));
        }
    }
    // mass properties of the links; those of a free link are about its own centre of mass
    const auto masses = [&](std::size_t i) {
        std::vector<MassProperties<P>> parts;
        for (const LinkBody<P>& body : all.bodies)
            if (body.link == static_cast<int>(i))
                parts.push_back({body.mass, body.center, rotated(body.inertia_B, body.q)});
        return composite(parts);
    };
    for (std::size_t i = 0; i < all.links.size(); ++i) {
        Link<P>& link = all.links[i];
        const MassProperties<P> whole = masses(i);
        link.mass = whole.mass;
        if (link.kind == LinkJoint::free) {
            for (LinkBody<P>& body : all.bodies)
                if (body.link == static_cast<int>(i))
                    body.origin = body.origin - whole.center, body.center = body.center - whole.center;
            for (Link<P>& child : all.links)
                if (child.parent == static_cast<int>(i)) child.place = child.place - whole.center;
            link.inertia = symmetric_part(whole.inertia);
        } else {
            link.moment = whole.mass * whole.center;
            link.inertia = symmetric_part(about_point(whole, Vector3<P>()));
        }
        if (link.kind == LinkJoint::free) {
            const std::size_t base = static_cast<std::size_t>(link.base);
            const Initial& start = scene.bodies[base].initial;
            link.start_q = normalized(cast<P>(start.orientation));
            const Vector3<P> w = cast<P>(start.angular_velocity);
            link.start_w = start.angular_velocity_frame == Frame::body ? w : rotate_back(link.start_q, w);
            // the scene gives the initial position of the base body's own centre of mass
            const Vector3<P> arm = -all.bodies[base].center;
            link.start_position = cast<P>(start.position_W) + rotate(link.start_q, arm);
            link.start_velocity = cast<P>(start.velocity_W) + rotate(link.start_q, cross(link.start_w, arm));
        }
        link.coordinate = all.coordinates, all.coordinates += link.coordinates();
        all.rates += link.rates();
    }
    int rate = all.coordinates;
    for (Link<P>& link : all.links) link.rate = rate, rate += link.rates();
    return all;
}

}  // namespace polhode
