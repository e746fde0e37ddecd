// Joints whose coordinates are coupled, directly or through other joints.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// A joint whose coordinate is ratio * x + offset, where x is the coordinate of another joint.
template <class P>
struct CoupledJoint {
    std::size_t joint = 0;  ///< index in scene.joints
    P ratio{1};
    P offset{0};
};

/// The joints that are coupled with `joint` (an index in scene.joints), which comes first. Their coordinates are
/// functions of its coordinate.
template <class P>
std::vector<CoupledJoint<P>> coupled_joints(const Scene& scene, std::size_t joint) {
    const auto index_of = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(scene.joints, name, &Joint::name) - scene.joints.begin());
    };
    std::vector<CoupledJoint<P>> all{{joint, P(1), P(0)}};
    std::vector<char> is_known(scene.joints.size(), 0);
    is_known[joint] = 1;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const Coupling& coupling : scene.couplings) {
            const std::size_t first = index_of(coupling.first), second = index_of(coupling.second);
            const P ratio(coupling.ratio), offset(coupling.offset);
            const CoupledJoint<P> known = all[i];
            if (known.joint == first && !is_known[second]) {
                all.push_back({second, P(ratio * known.ratio), P(ratio * known.offset + offset)});
                is_known[second] = 1;
            } else if (known.joint == second && !is_known[first]) {
                all.push_back({first, P(known.ratio / ratio), P((known.offset - offset) / ratio)});
                is_known[first] = 1;
            }
        }
    return all;
}

/// A limit of a joint's coordinate.
template <class P>
struct CoordinateLimit {
    bool exists = false;
    P coordinate{0};                ///< rad or m
    P restitution{0};               ///< of impacts on the limit
    CoupledJoint<P> limited_joint;  ///< the joint that the limit belongs to
};

/// The laws of a group of coupled joints, for the coordinate of one of them.
template <class P>
struct CoupledLaws {
    P friction{0};                    ///< N m or N
    CoordinateLimit<P> lower, upper;  ///< the narrowest ones
};

/// Sum of the friction, and the narrowest limits, of joints whose coordinates are functions of that of the first.
template <class P>
CoupledLaws<P> coupled_laws(const Scene& scene, const std::vector<CoupledJoint<P>>& group) {
    CoupledLaws<P> laws;
    for (const CoupledJoint<P>& one : group) {
        const Joint& joint = scene.joints[one.joint];
        const JointLimits &limits = joint.limits, none;
        const bool rises = one.ratio > P(0);
        const P friction = P(joint.friction) * one.ratio;
        laws.friction = laws.friction + (rises ? friction : P(-friction));
        const auto narrow = [&](double limit, bool is_lower) {
            const CoordinateLimit<P> own{true, P((P(limit) - one.offset) / one.ratio), P(limits.restitution), one};
            CoordinateLimit<P>& narrowest = is_lower == rises ? laws.lower : laws.upper;
            const bool is_narrower =
                is_lower == rises ? own.coordinate > narrowest.coordinate : own.coordinate < narrowest.coordinate;
            if (!narrowest.exists || is_narrower) narrowest = own;
        };
        if (limits.lower > none.lower) narrow(limits.lower, true);
        if (limits.upper < none.upper) narrow(limits.upper, false);
    }
    return laws;
}

}  // namespace polhode
