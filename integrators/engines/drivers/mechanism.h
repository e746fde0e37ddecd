// Several bodies and joints as a driver receives them.
//
// JointForces sums the motors, springs and dampers of joints at the start of a step, as in a game's code;
// add_joint_forces() applies them to the bodies of engines that have no generalized forces. mechanism_run.h is the loop
// over the steps.
#pragma once

#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "body/mass_properties.h"
#include "integrators/engines/engine_formulas.h"
#include "scene/scene.h"

namespace polhode::engines {

/// Position and velocity of a body; world axes.
struct Motion {
    Quaternion<double> q;
    Vector3<double> w, p, v;
};

/// A body of a mechanism. Its origin is its centre of mass and its axes are its principal axes. It starts at `start`.
struct LinkBody {
    double mass = 0;
    Vector3<double> moments;
    Motion start;
};

/// Laws of a revolute or prismatic joint; see EngineJointLaws.
struct JointLaws {
    JointLimits limits;
    double friction = 0, armature = 0, stiffness = 0, rest = 0, damping = 0;

    bool has_spring() const { return stiffness != 0 || damping != 0; }
};

/// A joint or the closure of a loop; see EngineJoint. All coordinates are zero at the start.
struct LinkJoint {
    std::string type;
    int parent, child;  ///< indices; -1: the world
    Vector3<double> anchor_W, parent_point, child_point;
    std::vector<Vector3<double>> axes_W, parent_axes, child_axes;  ///< unit
    Vector3<double> angular_velocity_W;  ///< angular velocity of the child relative to the parent
    std::vector<double> rates;           ///< rates of the coordinates
    JointLaws laws{};

    /// True if a universal joint has perpendicular axes, as most engines require.
    bool has_perpendicular_axes() const { return std::abs(dot(axes_W.at(0), axes_W.at(1))) < 1e-9; }
};

/// Balls that touch each other and planes, instead of joints.
struct Balls {
    std::vector<double> radii;  ///< radius by body, m
    double restitution, friction;
    std::vector<Plane> planes;  ///< unit normals
};

/// A constant force on a joint; see EngineMotor.
struct JointMotor {
    std::size_t joint = 0;
    double force = 0, from = 0, until = std::numeric_limits<double>::infinity();
};

/// second = ratio * first; see EngineCoupling.
struct JointCoupling {
    std::size_t first, second;
    double ratio;
};

struct Mechanism {
    std::vector<LinkBody> bodies;
    std::vector<LinkJoint> joints;  ///< parents precede children
    std::vector<LinkJoint> loops;
    Vector3<double> gravity;
    std::string setting;
    std::optional<Balls> balls;
    std::vector<JointMotor> motors;
    std::vector<JointCoupling> couplings;
    std::optional<EngineFormulas> formulas;

    const LinkBody& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }
    /// The attitude of a body, or of the world, at the start.
    Quaternion<double> attitude(int index) const { return index < 0 ? Quaternion<double>() : body(index).start.q; }
    /// The joint that carries a body; nullptr for a free body.
    const LinkJoint* parent_joint(int index) const {
        for (const LinkJoint& joint : joints)
            if (joint.child == index) return &joint;
        return nullptr;
    }
    /// The bodies in an order in which parents precede children; free bodies come first.
    std::vector<int> outward_order() const {
        std::vector<int> order;
        for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
            if (!parent_joint(i)) order.push_back(i);
        for (const LinkJoint& joint : joints) order.push_back(joint.child);
        return order;
    }
};

/// World axes with z along `z`, and x along `x` if given (must be perpendicular to z).
inline Quaternion<double> frame_about(const Vector3<double>& z, Vector3<double> x = {}) {
    if (dot(x, x) == 0) {
        int least = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(z[i]) < std::abs(z[least])) least = i;
        x[least] = 1;
        x = x - dot(x, z) * z;
        x = (1 / std::sqrt(dot(x, x))) * x;
    }
    const Vector3<double> y = cross(z, x);
    // columns x, y, z
    const double m00 = x[0], m11 = y[1], m22 = z[2];
    Quaternion<double> q{1 + m00 + m11 + m22, y[2] - z[1], z[0] - x[2], x[1] - y[0]};
    const Quaternion<double> others[] = {{y[2] - z[1], 1 + m00 - m11 - m22, y[0] + x[1], z[0] + x[2]},
                                         {z[0] - x[2], y[0] + x[1], 1 - m00 + m11 - m22, z[1] + y[2]},
                                         {x[1] - y[0], z[0] + x[2], z[1] + y[2], 1 - m00 - m11 + m22}};
    for (const Quaternion<double>& other : others)
        if (squared_norm(other) > squared_norm(q)) q = other;
    return normalized(q);
}

/// Motors, springs and dampers of joints as generalized forces that are constant during a step.
class JointForces {
  public:
    explicit JointForces(const Mechanism& mechanism) : mechanism_(&mechanism) {
        std::vector<bool> is_loaded(mechanism.joints.size(), false);
        for (const JointMotor& motor : mechanism.motors) is_loaded[motor.joint] = true;
        for (std::size_t i = 0; i < is_loaded.size(); ++i)
            if (is_loaded[i] || mechanism.joints[i].laws.has_spring()) joints_.push_back(i);
    }
    /// Indices of the joints with a motor, spring or damper.
    const std::vector<std::size_t>& joints() const { return joints_; }
    /// Moves on to a step of length h. A motor acts in the steps whose middle is in its window.
    void enter_step(double h) { middle_ = time_ + 0.5 * h, time_ += h; }
    double motor_force(std::size_t joint) const {
        double force = 0;
        for (const JointMotor& motor : mechanism_->motors)
            if (motor.joint == joint && motor.from <= middle_ && middle_ < motor.until) force += motor.force;
        return force;
    }
    /// Motors, spring and damper of a joint with coordinate x and this rate at the start of the step.
    double force(std::size_t joint, double x, double rate) const {
        const JointLaws& laws = mechanism_->joints[joint].laws;
        return motor_force(joint) - laws.stiffness * (x - laws.rest) - laws.damping * rate;
    }

  private:
    const Mechanism* mechanism_;
    std::vector<std::size_t> joints_;
    double time_ = 0, middle_ = 0;
};

/// The coordinate of a revolute (between -pi and pi) or prismatic joint and its rate, from the motions of its bodies.
inline std::pair<double, double> joint_coordinate(const LinkJoint& joint, const Mechanism& mechanism,
                                                  const std::vector<Motion>& motions) {
    const Motion world{};
    const Motion& parent = joint.parent < 0 ? world : motions[static_cast<std::size_t>(joint.parent)];
    const Motion& child = motions[static_cast<std::size_t>(joint.child)];
    const Vector3<double> axis_W = rotate(normalized(parent.q), joint.parent_axes[0]);
    if (joint.type == "revolute") {
        // child relative to parent, from their relation at the start
        const Quaternion<double> start = conjugate(mechanism.attitude(joint.parent)) * mechanism.attitude(joint.child),
                                 turn = conjugate(normalized(parent.q)) * normalized(child.q) * conjugate(start);
        const double sine = dot(joint.parent_axes[0], Vector3<double>(turn.x, turn.y, turn.z));
        return {2 * std::atan2(turn.w < 0 ? -sine : sine, std::abs(turn.w)), dot(axis_W, child.w - parent.w)};
    }
    const Vector3<double> at_parent = parent.p + rotate(normalized(parent.q), joint.parent_point),
                          arm = rotate(normalized(child.q), joint.child_point), at_child = child.p + arm,
                          v_parent = parent.v + cross(parent.w, at_child - parent.p);
    return {dot(axis_W, at_child - at_parent), dot(axis_W, child.v + cross(child.w, arm) - v_parent)};
}

/// Passes a generalized force on a joint to `apply(body, force, torque)` as opposite loads on its bodies: at the centre
/// of mass, in world axes.
template <class Apply>
void add_joint_force(const LinkJoint& joint, double force, const std::vector<Motion>& motions, const Apply& apply) {
    const Motion& child = motions[static_cast<std::size_t>(joint.child)];
    const Vector3<double> along = force * rotate(normalized(child.q), joint.child_axes[0]);
    if (joint.type == "revolute") {
        apply(joint.child, Vector3<double>(), along);
        if (joint.parent >= 0) apply(joint.parent, Vector3<double>(), -along);
    } else {
        apply(joint.child, along, Vector3<double>());
        if (joint.parent < 0) return;
        const Vector3<double> arm = child.p - motions[static_cast<std::size_t>(joint.parent)].p;
        apply(joint.parent, -along, cross(arm, -along));
    }
}

/// Passes the forces on the joints to `apply(body, force, torque)`: at the centre of mass, in world axes.
template <class Apply>
void add_joint_forces(const JointForces& forces, const Mechanism& mechanism, const std::vector<Motion>& motions,
                      const Apply& apply) {
    for (const std::size_t index : forces.joints()) {
        const LinkJoint& joint = mechanism.joints[index];
        const auto [x, rate] = joint_coordinate(joint, mechanism, motions);
        add_joint_force(joint, forces.force(index, x, rate), motions, apply);
    }
}

}  // namespace polhode::engines
