// DART: a body node on a FreeJoint, or on a BallJoint at its pivot.
#include <fmt/format.h>
// dart/dart.hpp does not compile where its optional parts are missing
#include <dart/config.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

namespace dd = dart::dynamics;

Eigen::Vector3d eigen(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

class DartWorld {
  public:
    explicit DartWorld(const Body& body) {
        if (!body.planes.empty()) throw Unsupported("planes are left to the engines made for games");
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

    Motion motion() const {
        const Eigen::Isometry3d& place = node_->getWorldTransform();
        const Eigen::Quaterniond q(place.linear());
        return {{q.w(), q.x(), q.y(), q.z()},
                vector_of(node_->getAngularVelocity()),
                vector_of(Eigen::Vector3d(place.translation())),
                vector_of(node_->getLinearVelocity())};
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        if (free_) {
            free_->setLinearVelocity(eigen(v));
            free_->setAngularVelocity(eigen(w));
        } else {
            // its velocities are those in body axes
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

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<DartWorld>(
        {"dart",
         DART_VERSION,
         "binary64",
         {{"default", "semi-implicit Euler on joint coordinates, the gyroscopic term explicit; no damping"}}});
}
