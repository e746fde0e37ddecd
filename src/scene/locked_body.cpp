#include "scene/locked_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::array<const char*, 6> freedoms{"x", "y", "z", "rx", "ry", "rz"};

std::array<bool, 6> parse_locks(const JsonNode& node) {
    std::array<bool, 6> is_locked{};
    const char* remedy = "give a list of some of \"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"";
    if (!node.is_array() || node.elements().empty()) node.fail(node.describe(), remedy);
    for (const JsonNode* one : node.elements()) {
        const auto at = std::ranges::find(freedoms, one->string());
        if (at == freedoms.end()) one->fail(one->describe(), remedy);
        bool& lock = is_locked[static_cast<std::size_t>(at - freedoms.begin())];
        if (lock) one->fail("is given twice", "remove it");
        lock = true;
    }
    if (std::ranges::all_of(is_locked, [](bool lock) { return lock; }))
        node.fail("locks all degrees of freedom", "use a fixed joint to the world");
    const auto rotations = std::count(is_locked.begin() + 3, is_locked.end(), true);
    if (rotations == 1)
        node.fail("locks one rotation about a body axis, which is not a joint",
                  "lock two or all of \"rx\", \"ry\", \"rz\", or use a universal joint");
    return is_locked;
}

// The initial angular velocity in body axes.
Vector3<double> body_rates(const JsonNode& node, const Initial& start) {
    const Vector3<double>& w = start.angular_velocity;
    const Quaternion<double>& q = start.orientation;
    const bool is_turned = q.x != 0 || q.y != 0 || q.z != 0;
    if (start.angular_velocity_frame == Frame::world && is_turned && !(w == Vector3<double>()))
        node.fail("is given for a body whose angular velocity is in world axes",
                  "give \"angular_velocity\" in body axes");
    return w;
}

class LockedBody {
  public:
    LockedBody(const std::string& place, const std::string& name) : place_(place), name_(name) {}

    void slide(std::size_t axis, double displacement, double speed) {
        Joint joint = next(JointType::prismatic, freedoms[axis]);
        joint.axes[0][axis] = 1, joint.coordinate[0] = displacement, joint.rate[0] = speed;
        append(std::move(joint));
    }
    Joint next(JointType type, const char* suffix) {
        Joint joint;
        joint.name = fmt::format("{}_{}", name_, suffix), joint.type = type, joint.place = place_;
        joint.parent = last_;
        if (chain_.joints.empty()) joint.parent_point = anchor;
        return joint;
    }
    JointChain finish(Joint joint) {
        joint.child = name_;
        chain_.joints.push_back(std::move(joint));
        return std::move(chain_);
    }

    Vector3<double> anchor;  // the locked components of the position

  private:
    std::string place_, name_, last_ = "world";
    JointChain chain_;

    void append(Joint joint) {
        NamedBody body;
        body.name = fmt::format("{} ({})", name_, joint.name);
        body.body.mass = 0, body.body.inertia_B = {};
        joint.child = last_ = body.name;
        chain_.bodies.push_back(std::move(body));
        chain_.joints.push_back(std::move(joint));
    }
};

}  // namespace

JointChain lock_free_body(const JsonNode& node, const std::string& place, NamedBody& body) {
    const std::array<bool, 6> is_locked = parse_locks(node);
    const Initial start = body.initial;
    const Vector3<double> w = body_rates(node, start);
    for (std::size_t k = 0; k < 3; ++k) {
        if (is_locked[k] && start.velocity_W[k] != 0)
            node.fail(fmt::format("locks \"{}\", but the initial velocity has this component", freedoms[k]),
                      "set it to 0");
        if (is_locked[k + 3] && w[k] != 0)
            node.fail(fmt::format("locks \"{}\", but the initial angular velocity has this component", freedoms[k + 3]),
                      "set it to 0");
    }
    LockedBody chain(place, body.name);
    for (std::size_t k = 0; k < 3; ++k) chain.anchor[k] = is_locked[k] ? start.position_W[k] : 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (!is_locked[k]) chain.slide(k, start.position_W[k], start.velocity_W[k]);
    const auto turns = std::count(is_locked.begin() + 3, is_locked.end(), false);
    Joint joint = chain.next(turns == 3   ? JointType::spherical
                             : turns == 1 ? JointType::revolute
                                          : JointType::fixed,
                             "rotation");
    joint.child_point = body.body.center_of_mass;
    if (turns == 3) {
        joint.orientation = start.orientation, joint.angular_velocity = w;
    } else {
        joint.parent_orientation = start.orientation;
        for (std::size_t k = 0; turns == 1 && k < 3; ++k)
            if (!is_locked[k + 3]) joint.axes[0][k] = 1, joint.rate[0] = w[k];
    }
    body.initial = {};
    return chain.finish(std::move(joint));
}

}  // namespace polhode
