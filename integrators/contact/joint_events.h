// Joints with limits and Coulomb friction: their data, modes and events, over any scalar.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "body/body_motion.h"
#include "motion/trajectory.h"
#include "scene/coupled_joints.h"
#include "scene/scene.h"

namespace polhode::contact {

/// A joint of one coordinate with friction or limits. Joints that are coupled with it move with it: their friction and
/// limits are converted to its coordinate.
template <class P>
struct EventJoint : CoupledLaws<P> {
    std::size_t joint = 0;  ///< index in scene.joints
};

/// The joints of a scene with friction or limits; of coupled joints, only the first.
template <class P>
std::vector<EventJoint<P>> event_joints(const Scene& scene) {
    std::vector<EventJoint<P>> all;
    std::vector<char> is_known(scene.joints.size(), 0);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const Joint& joint = scene.joints[j];
        if (is_known[j] || (joint.friction == 0 && !joint.limits.any())) continue;
        const std::vector<CoupledJoint<P>> group = coupled_joints<P>(scene, j);
        for (const CoupledJoint<P>& one : group) is_known[one.joint] = 1;
        all.push_back({coupled_laws(scene, group), j});
    }
    return all;
}

/// Whether a joint of the scene has friction, limits or a prescribed motion, which only JointDriver follows.
inline bool has_joint_events(const Scene& scene) {
    for (const Joint& joint : scene.joints)
        if (joint.friction != 0 || joint.limits.any() || !joint.motion.empty()) return true;
    return false;
}

/// How a joint with friction or limits moves. Friction F acts with -F, +F, or as a part of the force that holds it.
enum class JointMode { free, forward, backward, held };
/// The limit that a joint is at.
enum class AtLimit { none, lower, upper };

/// A change of mode or an impact.
enum class JointEventKind {
    impact,  ///< an impact on a limit after which the joint moves away
    rests,   ///< an arrival at a limit where the joint then rests
    leaves,  ///< motion away from a limit without impact
    sticks,  ///< friction holds the joint
    slips,   ///< friction does not hold the joint any longer
};
inline constexpr std::array<const char*, 5> joint_event_names{"impact", "rests", "leaves", "sticks", "slips"};

template <class P>
struct JointEvent {
    P t{0};                 ///< s
    std::size_t joint = 0;  ///< index in scene.joints
    JointEventKind kind = JointEventKind::impact;
    P impulse{0};  ///< on the coordinate, N m s or N s
};

/// Result of a run with limits and friction of joints.
template <class P>
struct JointRun {
    std::string fault;                                            ///< why the run stopped early; empty if it did not
    std::vector<std::vector<BodyMotion<P>>> motions;              ///< one per sample
    std::vector<std::vector<Reaction<P>>> reactions;              ///< one per sample
    std::vector<std::vector<std::array<double, 2>>> coordinates;  ///< one per sample; empty if not available
    std::vector<JointEvent<P>> events;
    long steps = 0;
    long evaluations = 0;  ///< number of right-hand sides, or of series if the steps are Taylor series
};

}  // namespace polhode::contact
