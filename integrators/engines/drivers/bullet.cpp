// Bullet's rigid bodies: btRigidBody in a btDiscreteDynamicsWorld. Compiled for both precisions of Bullet.
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include "integrators/engines/drivers/bullet_joints.h"
#include "integrators/engines/drivers/bullet_shapes.h"

namespace polhode::engines {
namespace {

class BulletWorld {
  public:
    explicit BulletWorld(const Body& body) {
        world_.setGravity(bullet(body.gravity));
        btCollisionShape* const shape = shapes_.make(body.shapes);
        btRigidBody::btRigidBodyConstructionInfo info(btScalar(body.mass), nullptr, shape, bullet(body.moments));
        info.m_startWorldTransform =
            btTransform(btQuaternion(btScalar(body.q.x), btScalar(body.q.y), btScalar(body.q.z), btScalar(body.q.w)),
                        bullet(body.p));
        // Bullet multiplies the coefficients of both bodies in contact; those of the planes are 1
        if (!body.planes.empty()) {
            info.m_restitution = btScalar(body.planes.front().restitution);
            info.m_friction = btScalar(body.planes.front().friction);
        }
        body_ = std::make_unique<btRigidBody>(info);
        if (body.setting != "default") body_->setActivationState(DISABLE_DEACTIVATION);
        if (body.setting == "explicit") body_->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT);
        if (body.setting == "none") body_->setFlags(0);
        world_.addRigidBody(body_.get());
        set_velocities(body.w, body.v);
        for (const Plane& plane : body.planes) add(plane);
        if (body.pivot) {
            joint_ = std::make_unique<btPoint2PointConstraint>(*body_, bullet(*body.pivot));
            world_.addConstraint(joint_.get());
        }
    }
    ~BulletWorld() {
        if (joint_) world_.removeConstraint(joint_.get());
        for (const auto& plane : planes_) world_.removeRigidBody(plane.get());
        world_.removeRigidBody(body_.get());
    }
    BulletWorld(const BulletWorld&) = delete;
    BulletWorld& operator=(const BulletWorld&) = delete;

    Motion motion() const {
        const btTransform& at = body_->getWorldTransform();
        const btQuaternion q = at.getRotation();
        return {{double(q.w()), double(q.x()), double(q.y()), double(q.z())},
                vector_of(body_->getAngularVelocity()),
                vector_of(at.getOrigin()),
                vector_of(body_->getLinearVelocity())};
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        body_->activate(true);
        body_->setAngularVelocity(bullet(w)), body_->setLinearVelocity(bullet(v));
    }
    void set_gravity(const Vector3<double>& gravity) { world_.setGravity(bullet(gravity)); }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) {
        body_->applyCentralForce(bullet(force)), body_->applyTorque(bullet(torque));
    }
    void step(double h) { world_.stepSimulation(btScalar(h), 0); }
    double mass() const { return 1 / double(body_->getInvMass()); }
    Vector3<double> moments() const {
        const Vector3<double> inverse = vector_of(body_->getInvInertiaDiagLocal());
        return {1 / inverse[0], 1 / inverse[1], 1 / inverse[2]};
    }

  private:
    void add(const Plane& plane) {
        plane_shapes_.push_back(std::make_unique<btStaticPlaneShape>(bullet(plane.normal_W), btScalar(plane.offset)));
        btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, plane_shapes_.back().get());
        info.m_restitution = info.m_friction = 1;
        planes_.push_back(std::make_unique<btRigidBody>(info));
        world_.addRigidBody(planes_.back().get());
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    BulletShapes shapes_;
    std::unique_ptr<btRigidBody> body_;
    std::vector<std::unique_ptr<btCollisionShape>> plane_shapes_;
    std::vector<std::unique_ptr<btRigidBody>> planes_;
    std::unique_ptr<btPoint2PointConstraint> joint_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    constexpr bool is_double = sizeof(btScalar) == sizeof(double);
    const std::string version = fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100);
    return serve<BulletWorld, BulletMechanism>(
        {is_double ? "bullet" : "bullet_f32",
         version,
         is_double ? "binary64" : "binary32",
         {{"default",
           "gyroscopic term by one Newton step in body axes; slow bodies sleep; no damping; at most pi/4 of "
           "rotation per step"},
          {"best", "as default, without sleeping"},
          {"explicit", "gyroscopic term by an explicit step, no sleeping"},
          {"none", "no gyroscopic term, no sleeping"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"revolute", "spherical"},
         {"ball", "capsule", "cylinder", "disc", "ellipsoid", "box", "polyhedron", "several"},
         true,
         {"limits", "restitution", "friction", "springs", "motors", "couplings"}});
}
