#include "scene/robot_chains.h"

#include <fmt/format.h>

#include <utility>

namespace polhode {
namespace {

// One axis of a joint as a joint of its own; parent, child and placement are set by JointExpander.
RobotJoint single_axis(const RobotJoint& whole, std::size_t axis, RobotMotion motion, const std::string& name) {
    RobotJoint one;
    one.name = name, one.place = whole.place, one.motion = motion, one.point = whole.point;
    one.axes[0] = whole.axes[axis];
    one.stiffness[0] = whole.stiffness[axis], one.rest[0] = whole.rest[axis], one.damping[0] = whole.damping[axis];
    one.armature[0] = whole.armature[axis], one.friction[0] = whole.friction[axis];
    one.limits[0] = whole.limits[axis], one.start[0] = whole.start[axis];
    return one;
}

// A joint that moves freely along or about an axis.
RobotJoint free_axis(const RobotJoint& whole, const Vector3<Wide>& axis, RobotMotion motion, const char* suffix) {
    RobotJoint one;
    one.name = whole.name + suffix, one.place = whole.place, one.motion = motion, one.point = whole.point;
    one.axes[0] = axis;
    return one;
}

// Two directions perpendicular to n; coordinate axes if n is one.
std::pair<Vector3<Wide>, Vector3<Wide>> directions_perpendicular_to(const Vector3<Wide>& n) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (n[i] * n[i] > n[largest] * n[largest]) largest = i;
    Vector3<Wide> next;
    next[(largest + 1) % 3] = Wide(1);
    const Vector3<Wide> first = next - (dot(next, n) / dot(n, n)) * n;
    return {first, cross(n, first)};
}

class JointExpander {
  public:
    JointExpander(Robot& robot, bool with_laws) : robot_(robot), with_laws_(with_laws) {}

    void expand() {
        before_.resize(robot_.links.size());
        robot_.places.resize(robot_.links.size());
        for (RobotJoint& joint : std::exchange(robot_.joints, {})) expand(std::move(joint));
        sort_links();
    }

  private:
    Robot& robot_;
    const bool with_laws_;
    std::vector<std::vector<std::size_t>> before_;  // per link of the file: the massless links of its chain

    // Moves the links of each chain before the chain's child.
    void sort_links() {
        std::vector<std::size_t> order, place(robot_.links.size());
        for (std::size_t i = 0; i < before_.size(); ++i) {
            order.insert(order.end(), before_[i].begin(), before_[i].end());
            order.push_back(i);
        }
        std::vector<RobotLink> links;
        std::vector<RobotPose> places;
        for (const std::size_t i : order) {
            place[i] = links.size();
            links.push_back(std::move(robot_.links[i]));
            places.push_back(i < before_.size() ? robot_.places[i] : RobotPose{});
        }
        robot_.links = std::move(links), robot_.places = std::move(places);
        const auto move = [&](std::size_t& link) {
            if (link != RobotJoint::world) link = place[link];
        };
        for (RobotJoint& joint : robot_.joints) move(joint.parent), move(joint.child);
        for (Robot::FreeDamping& damping : robot_.free_damping) move(damping.link);
        for (Robot::Loop& loop : robot_.loops) move(loop.first), move(loop.second);
    }

    void expand(RobotJoint joint) {
        if (with_laws_) fix(joint);
        if (joint.motion == RobotMotion::screw) return expand_screw(joint);
        if (joint.motion == RobotMotion::planar) return expand_planar(joint);
        const Vector3<Wide> across = cross(joint.axes[0], joint.axes[1]);
        if (joint.motion == RobotMotion::universal && ((with_laws_ && joint.has_law()) || across == Vector3<Wide>()))
            return chain(joint, {single_axis(joint, 0, RobotMotion::revolute, joint.name + "_1"),
                                 single_axis(joint, 1, RobotMotion::revolute, joint.name + "_2")});
        robot_.joints.push_back(std::move(joint));
    }

    void expand_screw(const RobotJoint& joint) {
        const RobotJoint turn = single_axis(joint, 0, RobotMotion::revolute, joint.name);
        if (joint.pitch == Wide(0)) return chain(joint, {turn});
        const RobotJoint shift = free_axis(joint, joint.axes[0], RobotMotion::prismatic, "_translation");
        chain(joint, {shift, turn});
        robot_.couplings.push_back({turn.name, shift.name, double(joint.pitch), 0});
    }
    void expand_planar(const RobotJoint& joint) {
        const auto [first, second] = directions_perpendicular_to(joint.axes[0]);
        chain(joint, {free_axis(joint, first, RobotMotion::prismatic, "_first"),
                      free_axis(joint, second, RobotMotion::prismatic, "_second"),
                      free_axis(joint, joint.axes[0], RobotMotion::revolute, "_rotation")});
    }

    // Connects joints in a row from the parent to the child of `whole`. The links between have the child's frame.
    void chain(const RobotJoint& whole, std::vector<RobotJoint> parts) {
        for (std::size_t k = 0; k < parts.size(); ++k) {
            RobotJoint& one = parts[k];
            one.parent = whole.parent, one.child = whole.child;
            if (k == 0) one.placement = whole.placement;
            if (k > 0) one.parent = robot_.links.size() - 1;
            if (k + 1 < parts.size()) {
                one.child = robot_.links.size();
                before_[whole.child].push_back(one.child);
                robot_.links.push_back({fmt::format("{} ({})", whole.name, one.name), whole.place, {}});
            }
            robot_.joints.push_back(std::move(one));
        }
    }

    // A joint with equal limits does not move.
    void fix(RobotJoint& joint) {
        const JointLimits& limits = joint.limits[0];
        const bool moves = joint.motion == RobotMotion::revolute || joint.motion == RobotMotion::prismatic;
        if (!moves || limits.lower != limits.upper) return;
        joint.lock(Wide(limits.lower));
        robot_.assumed["joints with equal limits, fixed"].push_back(joint.name);
    }
};

}  // namespace

void expand_robot_joints(Robot& robot, bool with_laws) { JointExpander(robot, with_laws).expand(); }

}  // namespace polhode
