#include "scene/robot_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "body/rigid_body.h"
#include "scene/robot_parts.h"
#include "scene/scene_limits.h"
#include "text/message.h"

namespace polhode {
namespace {

// Merges what has no mass.
class RobotMerger {
  public:
    RobotMerger(const Robot& robot, RobotBase base, const std::string& path) : robot_(robot), path_(path) {
        carrier_.assign(robot_.links.size(), none);
        for (std::size_t j = 0; j < robot_.joints.size(); ++j) carrier_[robot_.joints[j].child] = j;
        robot_.places.resize(robot_.links.size());
        hold_roots(base == RobotBase::as_usual ? robot_.roots_are_free : base == RobotBase::free);
        children_.resize(robot_.links.size());
        for (std::size_t j = 0; j < robot_.joints.size(); ++j)
            if (robot_.joints[j].parent != RobotJoint::world) children_[robot_.joints[j].parent].push_back(j);
        gone_.assign(robot_.links.size(), false);
    }

    // from the ends of the trees to their roots
    void merge() {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (joint_of(i).parent == RobotJoint::world) order.push_back(i);
        for (std::size_t k = 0; k < order.size(); ++k)
            for (const std::size_t j : children_[order[k]]) order.push_back(robot_.joints[j].child);
        if (order.size() < robot_.links.size())
            throw InputError(path_, "", "has joints that form a circle",
                             "a robot is a tree: close chains by \"loops\" in the scene");
        for (std::size_t k = order.size(); k-- > 0;)
            if (!robot_.links[order[k]].mass) merge_link(order[k]);
    }

    void build(Scene& scene) const {
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (!gone_[i]) build_link(i, scene);
        if (scene.bodies.empty())
            throw InputError(path_, "", "has no link with a mass", "give a robot whose links have an <inertial>");
        for (const auto& [what, names] : robot_.left_out) scene.left_out.push_back(phrase(what, names));
    }

  private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    RobotJoint& joint_of(std::size_t link) { return robot_.joints[carrier_[link]]; }
    const RobotJoint& joint_of(std::size_t link) const { return robot_.joints[carrier_[link]]; }

    [[noreturn]] void fail(int line, const std::string& fault, const std::string& remedy) const {
        throw InputError(path_, line > 0 ? fmt::format("line {}", line) : "", fault, remedy);
    }

    void hold_roots(bool are_free) {
        std::set<std::string, std::less<>> names;
        for (const RobotJoint& joint : robot_.joints) names.insert(joint.name);
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
            if (carrier_[i] != none) continue;
            RobotJoint joint;
            joint.name = robot_.links[i].name + "_base";
            while (names.contains(joint.name)) joint.name += "_";
            names.insert(joint.name);
            joint.line = robot_.links[i].line, joint.child = i;
            joint.motion = are_free ? RobotMotion::free : RobotMotion::fixed;
            joint.placement = robot_.places[i];
            carrier_[i] = robot_.joints.size();
            robot_.joints.push_back(std::move(joint));
        }
    }

    void note(const char* what, const std::string& name) { robot_.left_out[what].push_back(name); }

    void merge_link(std::size_t i) {
        const RobotLink& link = robot_.links[i];
        RobotJoint& joint = joint_of(i);
        std::vector<std::size_t>& children = children_[i];
        const auto child = std::find_if(children.begin(), children.end(),
                                        [&](std::size_t j) { return robot_.joints[j].motion == RobotMotion::fixed; });
        gone_[i] = true;
        if (children.empty()) {
            if (joint.motion != RobotMotion::fixed)
                fail(link.line,
                     fmt::format("link \"{}\" has no mass, and joint \"{}\" moves it", one_line(link.name, 60),
                                 one_line(joint.name, 60)),
                     "give it an inertial, or make the joint fixed");
            if (joint.parent != RobotJoint::world) std::erase(children_[joint.parent], carrier_[i]);
            if (joint.parent != RobotJoint::world || robot_.links.size() > 1)
                note("links without mass, dropped", link.name);
        } else if (joint.motion == RobotMotion::fixed) {
            merge_up(i, joint);
        } else if (child != children.end()) {
            merge_down(i, joint, *child);
        } else if (joint.motion == RobotMotion::revolute && children.size() == 1 &&
                   robot_.joints[children[0]].motion == RobotMotion::revolute) {
            make_universal(i, joint, children[0]);
        } else {
            fail(link.line,
                 fmt::format("joints \"{}\" and \"{}\" move one after the other without mass between",
                             one_line(joint.name, 60), one_line(robot_.joints[children[0]].name, 60)),
                 "give a link between them with a mass, or a ball joint: only two hinges through one point become one "
                 "joint, a universal one");
        }
    }

    // what hangs on it hangs on its parent
    void merge_up(std::size_t i, const RobotJoint& joint) {
        if (joint.parent != RobotJoint::world) std::erase(children_[joint.parent], carrier_[i]);
        for (const std::size_t j : children_[i]) {
            RobotJoint& below = robot_.joints[j];
            below.placement = joint.placement * below.placement, below.parent = joint.parent;
            if (joint.parent != RobotJoint::world) children_[joint.parent].push_back(j);
        }
        children_[i].clear();
        note("links without mass, merged", robot_.links[i].name);
    }

    // the link that is fixed to it takes its place, with its own frame
    void merge_down(std::size_t i, RobotJoint& joint, std::size_t fixed) {
        const RobotJoint& tie = robot_.joints[fixed];
        const std::size_t c = tie.child;
        const RobotPose back = inverse(tie.placement);
        joint.placement = joint.placement * tie.placement;
        joint.point = back * joint.point;
        for (Vector3<Wide>& axis : joint.axes) axis = rotate(back.turn, axis);
        joint.child = c, carrier_[c] = carrier_[i];
        for (const std::size_t j : children_[i]) {
            if (j == fixed) continue;
            robot_.joints[j].placement = back * robot_.joints[j].placement, robot_.joints[j].parent = c;
            children_[c].push_back(j);
        }
        children_[i].clear();
        note("links without mass, merged", robot_.links[i].name);
    }

    // two hinges whose lines meet; all in the frame of the link between
    void make_universal(std::size_t i, RobotJoint& joint, std::size_t second_joint) {
        const RobotJoint& second = robot_.joints[second_joint];
        const Vector3<Wide> p = joint.point, a = joint.axes[0];
        const Vector3<Wide> r = second.placement * second.point, b = rotate(second.placement.turn, second.axes[0]);
        const Vector3<Wide> n = cross(a, b), d = r - p;
        const Wide across = dot(n, n), scale = dot(d, d);
        const Wide apart = dot(d, n);
        if (!(across > Wide(1e-12) * dot(a, a) * dot(b, b)) || !(apart * apart <= Wide(1e-18) * scale * across))
            fail(robot_.links[i].line,
                 fmt::format("the axes of \"{}\" and \"{}\" do not meet in one point, and no mass is between",
                             one_line(joint.name, 60), one_line(second.name, 60)),
                 "give a link between them with a mass, or axes that meet at an angle: a universal joint");
        const Vector3<Wide> meeting = p + (dot(cross(d, b), n) / across) * a;
        const RobotPose back = inverse(second.placement);
        const std::size_t c = second.child;
        joint.motion = RobotMotion::universal;
        joint.name += "+" + second.name;
        joint.axes = {rotate(back.turn, a), second.axes[0]};
        joint.point = back * meeting;
        joint.placement = joint.placement * second.placement;
        joint.stiffness[1] = second.stiffness[0], joint.rest[1] = second.rest[0], joint.damping[1] = second.damping[0];
        joint.child = c, carrier_[c] = carrier_[i];
        children_[i].clear();
        note("hinges that are one universal joint", joint.name);
    }

    // binary64 without negative zeros
    static double round_to_double(const Wide& x) { return double(x) + 0.0; }
    static Vector3<double> round_to_double(const Vector3<Wide>& v) {
        return {round_to_double(v[0]), round_to_double(v[1]), round_to_double(v[2])};
    }
    static Quaternion<double> round_to_double(const Quaternion<Wide>& q) {
        return {round_to_double(q.w), round_to_double(q.x), round_to_double(q.y), round_to_double(q.z)};
    }

    void build_link(std::size_t i, Scene& scene) const {
        const RobotLink& link = robot_.links[i];
        const RobotJoint& joint = joint_of(i);
        NamedBody one;
        one.name = link.name;
        one.body.mass = double(link.mass->mass);
        one.body.center_of_mass = round_to_double(link.mass->center);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c <= r; ++c)
                one.body.inertia_B[r][c] = one.body.inertia_B[c][r] = round_to_double(link.mass->inertia[r][c]);
        const Vector3<double> moments = principal_frame(cast<Wide>(one.body.inertia_B)).moments;
        const double largest = std::max({moments[0], moments[1], moments[2]});
        for (int k = 0; k < 3; ++k)
            if (!(moments[k] > 1e-30 * largest))
                fail(link.line,
                     fmt::format("link \"{}\" has a principal moment that is not > 0", one_line(link.name, 60)),
                     "a whole body has three moments of inertia > 0");
        if (joint.motion == RobotMotion::free) {
            if (joint.parent != RobotJoint::world)
                fail(joint.line, fmt::format("joint \"{}\" frees a link from another", one_line(joint.name, 60)),
                     "only what hangs on the world floats: make its parent the root, without a mass");
            one.initial.orientation = round_to_double(joint.placement.turn);
            one.initial.position_W = round_to_double(joint.placement * link.mass->center);
        } else {
            scene.joints.push_back(built(joint));
        }
        scene.bodies.push_back(std::move(one));
    }

    Joint built(const RobotJoint& from) const {
        Joint joint;
        joint.name = from.name;
        joint.type = from.motion == RobotMotion::revolute    ? JointType::revolute
                     : from.motion == RobotMotion::prismatic ? JointType::prismatic
                     : from.motion == RobotMotion::spherical ? JointType::spherical
                     : from.motion == RobotMotion::universal ? JointType::universal
                                                             : JointType::fixed;
        if (from.parent != RobotJoint::world) joint.parent = robot_.links[from.parent].name;
        joint.child = robot_.links[from.child].name;
        joint.parent_point = round_to_double(from.placement * from.point);
        joint.child_point = round_to_double(from.point);
        joint.parent_orientation = round_to_double(from.placement.turn);
        const std::size_t axes = joint.type == JointType::universal                                        ? 2
                                 : joint.type == JointType::revolute || joint.type == JointType::prismatic ? 1
                                                                                                           : 0;
        for (std::size_t k = 0; k < axes; ++k) {
            joint.axes[k] = round_to_double(from.axes[k]);
            joint.stiffness[k] = round_to_double(from.stiffness[k]), joint.rest[k] = round_to_double(from.rest[k]);
        }
        if (joint.type != JointType::fixed)
            for (std::size_t k = 0; k < std::max<std::size_t>(axes, 1); ++k)
                joint.damping[k] = round_to_double(from.damping[k]);
        return joint;
    }

    // "limits of joints: a, b, c"; the names of many are counted
    static std::string phrase(const std::string& what, const std::vector<std::string>& names) {
        constexpr std::size_t most = 8;
        std::vector<std::string> told;
        for (const std::string& name : names)
            if (!name.empty() && told.size() < most && std::find(told.begin(), told.end(), name) == told.end())
                told.push_back(one_line(name, 60));
        if (names.size() > most) told.push_back(fmt::format("{} in all", names.size()));
        return told.empty() ? what : what + ": " + listed(told);
    }

    Robot robot_;
    const std::string& path_;
    std::vector<std::size_t> carrier_;                // the joint of each link
    std::vector<std::vector<std::size_t>> children_;  // the joints that hang on each
    std::vector<bool> gone_;
};

}  // namespace

void add_robot(const Robot& robot, RobotBase base, const std::string& path, Scene& scene) {
    if (robot.links.size() > most_bodies)
        throw InputError(path, "", fmt::format("has {} links", robot.links.size()),
                         fmt::format("give {} at the most", most_bodies));
    RobotMerger merger(robot, base, path);
    merger.merge();
    merger.build(scene);
}

}  // namespace polhode
