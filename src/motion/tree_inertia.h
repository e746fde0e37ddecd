// Checks that a mechanism of motion/tree.h has a regular mass matrix at its start. With the articulated inertias D_i
// of the joints, det M = prod D_i (Featherstone 2008, ch. 7), and D_i depends only on what is attached below joint i.
// Going from the leaves to the root, the first D_i that vanishes identifies a joint whose motion has no inertia.
// Massless bodies, point masses and rods are allowed if no D_i vanishes.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "motion/tree.h"
#include "text/message.h"

namespace polhode {

/// A joint has no inertia if its articulated inertia is below this fraction of the rigid inertia of everything it
/// carries: mass, or trace of the tensor about the joint's point. Such a quotient has no correct digit in binary64.
inline constexpr double least_joint_inertia = 1e-14;

/// A value between a third of the smallest eigenvalue of a symmetric matrix and the smallest eigenvalue, divided by
/// `size` > 0.
template <class P>
double least_eigenvalue_share(const Symmetric3<P>& m, const P& size) {
    const P xx = m.xx / size, yy = m.yy / size, zz = m.zz / size, xy = m.xy / size, xz = m.xz / size, yz = m.yz / size;
    const P x = yy * zz - yz * yz, y = xx * zz - xz * xz, z = xx * yy - xy * xy;
    const P determinant = xx * x - xy * (xy * zz - xz * yz) + xz * (xy * yz - xz * yy), minors = x + y + z;
    return minors > P(0) ? static_cast<double>(P(determinant / minors)) : 0;
}

/// Whether all principal moments of a tensor exceed 1e-12 of their sum, so that its inverse is accurate.
template <class P>
bool has_three_moments(const Matrix3<P>& inertia) {
    const P sum = inertia[0][0] + inertia[1][1] + inertia[2][2];
    return sum > P(0) && least_eigenvalue_share(symmetric_part(inertia), sum) > 1e-12;
}

/// Sums over a link and everything attached below it, as one rigid body.
template <class P>
struct RigidSums {
    P mass = P(0);
    Vector3<P> moment;  ///< sum of mass times position, from the link's origin, in its axes
    P trace = P(0);     ///< trace of the inertia tensor about that origin
};

template <class P>
void Tree<P>::require_inertia(const Scene& scene) const {
    TreeWork<P>& at = work<P>();
    move(start_.data(), at);
    for (LinkWork<P>& link : at.links) link.force = {};
    articulate(at);
    std::vector<RigidSums<P>> carried(links_.links.size());
    for (std::size_t i = links_.links.size(); i-- > 0;) {
        const Link<P>& link = links_.links[i];
        const LinkWork<P>& w = at.links[i];
        RigidSums<P>& sums = carried[i];
        sums.mass = sums.mass + link.mass, sums.moment = sums.moment + link.moment;
        sums.trace = sums.trace + (link.inertia.xx + link.inertia.yy + link.inertia.zz);
        require_inertia(scene, i, w.inertia, sums.mass, sums.trace);
        if (link.parent < 0) continue;
        // the trace about the parent's origin is twice the sum of m |x + r|^2
        RigidSums<P>& parent = carried[static_cast<std::size_t>(link.parent)];
        const Vector3<P> moment = w.R * sums.moment;
        parent.mass = parent.mass + sums.mass;
        parent.moment = parent.moment + (moment + sums.mass * w.r);
        parent.trace = parent.trace + (sums.trace + P(4) * dot(w.r, moment) + P(2) * sums.mass * dot(w.r, w.r));
    }
}

template <class P>
void Tree<P>::require_inertia(const Scene& scene, std::size_t i, const ArticulatedInertia<P>& articulated,
                              const P& mass, const P& trace) const {
    const Link<P>& link = links_.links[i];
    const auto is_enough = [](const P& inertia, const P& of) { return inertia > P(least_joint_inertia) * of; };
    const auto fail = [&](const std::string& body, const std::string& fault, const std::string& remedy) {
        const auto index = static_cast<std::size_t>(body_index(scene, body));
        // an imported robot has places in its own file
        std::string place =
            link.kind == LinkJoint::free ? "" : scene.joints[static_cast<std::size_t>(link.joint)].place;
        if (place.empty()) place = scene.bodies[index].place;
        if (!place.starts_with('/')) place = place.empty() ? fmt::format("/bodies/{}", index) : "/import: " + place;
        throw InputError(scene.name, place, fmt::format("\"{}\" has no {}", one_line(body, 60), fault), remedy);
    };
    if (link.kind == LinkJoint::free) {
        const std::string& body = scene.bodies[static_cast<std::size_t>(link.base)].name;
        const char* remedy =
            "a body that is not the child of a joint needs a mass and three moments of inertia, its own or those of "
            "bodies fixed to it";
        if (!(link.mass > P(0))) fail(body, "mass and is not the child of a joint", remedy);
        const P own = link.inertia.xx + link.inertia.yy + link.inertia.zz;
        if (!(own > P(0)) || !(least_eigenvalue_share(link.inertia, own) > least_joint_inertia))
            fail(body, "moment of inertia about some axis and is not the child of a joint", remedy);
        return;
    }
    const Joint& joint = scene.joints[static_cast<std::size_t>(link.joint)];
    const std::string name = fmt::format("joint \"{}\"", one_line(joint.name, 60));
    switch (link.kind) {
        case LinkJoint::prismatic:
            if (!is_enough(P(articulated.M.zz + link.armature), mass))
                fail(joint.child, "mass along " + name, "give it mass, or use a fixed joint");
            break;
        case LinkJoint::revolute:
            if (is_enough(P(articulated.J.zz + link.armature), trace)) break;
            fail(joint.child,
                 joint.type == JointType::universal ? fmt::format("inertia about axis {} of {}", link.axis, name)
                                                    : "inertia about " + name,
                 mass > P(0) ? "give it mass away from the axis, or use a fixed joint"
                             : "give it mass, or use a fixed joint");
            break;
        case LinkJoint::spherical: {
            const P& d = link.armature;
            Symmetric3<P> J = articulated.J;
            J.xx = J.xx + d, J.yy = J.yy + d, J.zz = J.zz + d;
            const P size = trace + P(3) * d;
            if (!(size > P(0)) || !(least_eigenvalue_share(J, size) > least_joint_inertia))
                fail(joint.child, "inertia about some axis through " + name,
                     mass > P(0) ? "give it a moment of inertia about each axis, or use a universal joint"
                                 : "give it mass, or use a fixed joint");
            break;
        }
        case LinkJoint::free:
            break;
    }
}

}  // namespace polhode
