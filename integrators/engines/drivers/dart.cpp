// DART: a body node with a FreeJoint, or with a BallJoint at its pivot; mechanisms as a skeleton with DART's own
// limits, Coulomb friction, springs and mimic joints.
#include <fmt/format.h>
// not dart/dart.hpp, which does not compile if its optional parts are missing
#include <dart/config.hpp>
#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/UniversalJoint.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

namespace dd = dart::dynamics;

Eigen::Vector3d eigen(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

Motion motion_of(const dd::BodyNode& node) {
    const Eigen::Isometry3d& place = node.getWorldTransform();
    const Eigen::Quaterniond q(place.linear());
    return {{q.w(), q.x(), q.y(), q.z()},
            vector_of(node.getAngularVelocity()),
            vector_of(Eigen::Vector3d(place.translation())),
            vector_of(node.getLinearVelocity())};
}

class DartWorld {
  public:
    explicit DartWorld(const Body& body) {
        if (!body.planes.empty()) throw Unsupported("this driver does not support planes");
        const dd::SkeletonPtr skeleton = dd::Skeleton::create("body");
        const Eigen::Matrix3d turn = Eigen::Quaterniond(body.q.w, body.q.x, body.q.y, body.q.z).toRotationMatrix();
        if (body.pivot) {
            dd::BallJoint::Properties properties;
            properties.mT_ChildBodyToJoint.translation() = eigen(*body.pivot);
            auto [joint, node] = skeleton->createJointAndBodyNodePair<dd::BallJoint>(nullptr, properties);
            joint->setPositions(dd::BallJoint::convertToPositions(turn));
            ball_ = joint, node_ = node;
        } else {
            auto [joint, node] = skeleton->createJointAndBodyNodePair<dd::FreeJoint>();
            Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
            place.linear() = turn, place.translation() = eigen(body.p);
            joint->setTransform(place);
            free_ = joint, node_ = node;
        }
        node_->setInertia(dd::Inertia(body.mass, Eigen::Vector3d::Zero(), eigen(body.moments).asDiagonal()));
        world_->addSkeleton(skeleton);
        set_gravity(body.gravity);
        set_velocities(body.w, body.v);
    }

    Motion motion() const { return motion_of(*node_); }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        if (free_) {
            free_->setLinearVelocity(eigen(v));
            free_->setAngularVelocity(eigen(w));
        } else {
            // the ball joint's velocities are in body axes
            ball_->setVelocities(node_->getWorldTransform().linear().transpose() * eigen(w));
        }
    }
    void set_gravity(const Vector3<double>& gravity) { world_->setGravity(eigen(gravity)); }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) {
        node_->addExtForce(eigen(force), Eigen::Vector3d::Zero(), false, true);
        node_->addExtTorque(eigen(torque), false);
    }
    void step(double h) {
        world_->setTimeStep(h);
        world_->step();
    }
    double mass() const { return node_->getMass(); }
    Vector3<double> moments() const {
        const Eigen::Matrix3d inertia = node_->getInertia().getMoment();
        return {inertia(0, 0), inertia(1, 1), inertia(2, 2)};
    }

  private:
    dart::simulation::WorldPtr world_ = dart::simulation::World::create();
    dd::BodyNode* node_ = nullptr;
    dd::FreeJoint* free_ = nullptr;
    dd::BallJoint* ball_ = nullptr;
};

class DartMechanism {
  public:
    explicit DartMechanism(const Mechanism& mechanism)
        : mechanism_(&mechanism), forces_(mechanism), nodes_(mechanism.bodies.size()) {
        const dd::SkeletonPtr skeleton = dd::Skeleton::create("mechanism");
        for (const int i : mechanism.outward_order()) {
            const LinkBody& body = mechanism.body(i);
            const LinkJoint* joint = mechanism.parent_joint(i);
            dd::BodyNode* node =
                joint ? create_jointed_body(*skeleton, mechanism, *joint) : create_free_body(*skeleton, body);
            node->setInertia(dd::Inertia(body.mass, Eigen::Vector3d::Zero(), eigen(body.moments).asDiagonal()));
            nodes_[std::size_t(i)] = node;
            if (joint) set_laws(*node->getParentJoint(), joint->laws);
        }
        for (const JointCoupling& coupling : mechanism.couplings) {
            // the mimic joint follows the other joint by a servo, which fails an assertion if the joint has friction
            if (mechanism.joints[coupling.second].laws.friction > 0)
                throw Unsupported("DART does not support friction of a joint that mimics another joint");
            dd::Joint& second = joint_of(coupling.second);
            second.setMimicJoint(&joint_of(coupling.first), coupling.ratio, 0);
            second.setActuatorType(dd::Joint::MIMIC);
        }
        world_->addSkeleton(skeleton);
        world_->setGravity(eigen(mechanism.gravity));
        for (const LinkJoint& loop : mechanism.loops) {
            const auto node = [&](int index) { return index < 0 ? nullptr : nodes_[std::size_t(index)]; };
            const bool two = loop.parent >= 0 && loop.child >= 0;
            const Eigen::Vector3d at = eigen(loop.anchor_W);
            world_->getConstraintSolver()->addConstraint(
                two ? std::make_shared<dart::constraint::BallJointConstraint>(node(loop.parent), node(loop.child), at)
                    : std::make_shared<dart::constraint::BallJointConstraint>(node(std::max(loop.parent, loop.child)),
                                                                              at));
        }
    }

    std::vector<Motion> motions() const {
        std::vector<Motion> all;
        for (const dd::BodyNode* node : nodes_) all.push_back(motion_of(*node));
        return all;
    }
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        dd::BodyNode& node = *nodes_[std::size_t(index)];
        node.addExtForce(eigen(force), Eigen::Vector3d::Zero(), false, true);
        node.addExtTorque(eigen(torque), false);
    }
    void step(double h) {
        forces_.enter_step(h);
        // DART resets the forces after each step
        for (const JointMotor& motor : mechanism_->motors)
            joint_of(motor.joint).setForce(0, forces_.motor_force(motor.joint));
        world_->setTimeStep(h);
        world_->step();
    }

  private:
    dd::Joint& joint_of(std::size_t index) const {
        return *nodes_[std::size_t(mechanism_->joints[index].child)]->getParentJoint();
    }
    static void set_laws(dd::Joint& joint, const JointLaws& laws) {
        if (laws.limits.any()) {
            joint.setLimitEnforcement(true);
            joint.setPositionLowerLimit(0, laws.limits.lower), joint.setPositionUpperLimit(0, laws.limits.upper);
        }
        if (laws.friction > 0) joint.setCoulombFriction(0, laws.friction);
        if (!laws.has_spring()) return;
        joint.setSpringStiffness(0, laws.stiffness), joint.setRestPosition(0, laws.rest);
        joint.setDampingCoefficient(0, laws.damping);
    }
    static dd::BodyNode* create_free_body(dd::Skeleton& skeleton, const LinkBody& body) {
        auto [joint, node] = skeleton.createJointAndBodyNodePair<dd::FreeJoint>();
        const Quaternion<double>& q = body.start.q;
        Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
        place.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
        place.translation() = eigen(body.start.p);
        joint->setTransform(place);
        joint->setLinearVelocity(eigen(body.start.v)), joint->setAngularVelocity(eigen(body.start.w));
        return node;
    }
    // The joint's frame is the child's frame at the start.
    dd::BodyNode* create_jointed_body(dd::Skeleton& skeleton, const Mechanism& mechanism, const LinkJoint& joint) {
        dd::BodyNode* parent = joint.parent < 0 ? nullptr : nodes_[std::size_t(joint.parent)];
        const Quaternion<double> turn = conjugate(mechanism.attitude(joint.parent)) * mechanism.attitude(joint.child);
        const auto set_frames = [&](auto properties) {
            properties.mT_ParentBodyToJoint.linear() =
                Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).toRotationMatrix();
            properties.mT_ParentBodyToJoint.translation() = eigen(joint.parent_point);
            properties.mT_ChildBodyToJoint.translation() = eigen(joint.child_point);
            // DART prints a message for each duplicate name
            properties.mName = fmt::format("joint_{}", joint.child);
            return properties;
        };
        const dd::BodyNode::AspectProperties named(fmt::format("body_{}", joint.child));
        const auto set_axis = [&](auto properties) {
            properties.mAxis = eigen(joint.child_axes[0]);
            return properties;
        };
        if (joint.type == "revolute") {
            auto [dart_joint, node] = skeleton.createJointAndBodyNodePair<dd::RevoluteJoint>(
                parent, set_axis(set_frames(dd::RevoluteJoint::Properties())), named);
            dart_joint->setVelocity(0, joint.rates[0]);
            return node;
        }
        if (joint.type == "prismatic") {
            auto [dart_joint, node] = skeleton.createJointAndBodyNodePair<dd::PrismaticJoint>(
                parent, set_axis(set_frames(dd::PrismaticJoint::Properties())), named);
            dart_joint->setVelocity(0, joint.rates[0]);
            return node;
        }
        if (joint.type == "universal") {
            auto properties = set_frames(dd::UniversalJoint::Properties());
            properties.mAxis = {eigen(joint.child_axes[0]), eigen(joint.child_axes[1])};
            auto [dart_joint, node] =
                skeleton.createJointAndBodyNodePair<dd::UniversalJoint>(parent, properties, named);
            for (std::size_t i = 0; i < 2; ++i) dart_joint->setVelocity(i, joint.rates[i]);
            return node;
        }
        if (joint.type == "spherical") {
            auto [dart_joint, node] = skeleton.createJointAndBodyNodePair<dd::BallJoint>(
                parent, set_frames(dd::BallJoint::Properties()), named);
            dart_joint->setVelocities(eigen(rotate_back(mechanism.attitude(joint.child), joint.angular_velocity_W)));
            return node;
        }
        return skeleton
            .createJointAndBodyNodePair<dd::WeldJoint>(parent, set_frames(dd::WeldJoint::Properties()), named)
            .second;
    }

    const Mechanism* mechanism_;
    JointForces forces_;
    dart::simulation::WorldPtr world_ = dart::simulation::World::create();
    std::vector<dd::BodyNode*> nodes_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<DartWorld, DartMechanism>(
        {"dart",
         DART_VERSION,
         "binary64",
         {{"default", "semi-implicit Euler in joint coordinates, gyroscopic term explicit; no damping"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"spherical"},
         {},
         false,
         {"limits", "friction", "springs", "motors", "couplings"}});
}
