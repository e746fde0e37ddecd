// Bullet's Featherstone bodies: a btMultiBody without links.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

btVector3 bullet(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

class MultibodyWorld {
  public:
    explicit MultibodyWorld(const Body& body)
        : body_(0, body.mass, bullet(body.moments), false, body.setting == "default") {
        if (!body.planes.empty()) throw Unsupported("planes are hit by this driver's btRigidBody only: see bullet");
        world_.setGravity(bullet(body.gravity));
        // the base's rotation is kept from world to body
        body_.setWorldToBaseRot(btQuaternion(body.q.x, body.q.y, body.q.z, body.q.w).inverse());
        body_.setBasePos(bullet(body.p));
        if (body.setting != "default") {
            body_.setLinearDamping(0), body_.setAngularDamping(0);
            body_.setMaxCoordinateVelocity(1e30);
        }
        if (body.setting == "rk4") body_.useRK4Integration(true);
        body_.finalizeMultiDof();
        world_.addMultiBody(&body_);
        set_velocities(body.w, body.v);
        if (body.pivot) {
            // only bodies with a collider are in an island, and only islands are solved; it collides with nothing
            collider_.setCollisionShape(&shape_);
            body_.setBaseCollider(&collider_);
            world_.addCollisionObject(&collider_, 0, 0);
            joint_ =
                std::make_unique<btMultiBodyPoint2Point>(&body_, -1, nullptr, bullet(*body.pivot), btVector3(0, 0, 0));
            joint_->setMaxAppliedImpulse(1e30);
            world_.addMultiBodyConstraint(joint_.get());
        }
    }
    ~MultibodyWorld() {
        if (joint_) {
            world_.removeMultiBodyConstraint(joint_.get());
            world_.removeCollisionObject(&collider_);
        }
        world_.removeMultiBody(&body_);
    }
    MultibodyWorld(const MultibodyWorld&) = delete;
    MultibodyWorld& operator=(const MultibodyWorld&) = delete;

    Motion motion() const {
        const btQuaternion q = body_.getWorldToBaseRot().inverse();
        return {{q.w(), q.x(), q.y(), q.z()},
                vector_of(body_.getBaseOmega()),
                vector_of(body_.getBasePos()),
                vector_of(body_.getBaseVel())};
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        body_.wakeUp();
        body_.setBaseOmega(bullet(w)), body_.setBaseVel(bullet(v));
    }
    void set_gravity(const Vector3<double>& gravity) { world_.setGravity(bullet(gravity)); }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) {
        body_.addBaseForce(bullet(force)), body_.addBaseTorque(bullet(torque));
    }
    void step(double h) { world_.stepSimulation(h, 0); }
    double mass() const { return body_.getBaseMass(); }
    Vector3<double> moments() const { return vector_of(body_.getBaseInertia()); }

  private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    btMultiBody body_;
    btSphereShape shape_{1};
    btMultiBodyLinkCollider collider_{&body_, -1};
    std::unique_ptr<btMultiBodyPoint2Point> joint_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<MultibodyWorld>(
        {"bullet_multibody",
         fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100),
         "binary64",
         {{"default", "damping 0.04 of either velocity, a slow body falls asleep, coordinate velocities up to 100"},
          {"best", "no damping, never asleep, no limit of speed"},
          {"rk4", "as best, by btMultiBody's own RK4"}}});
}
