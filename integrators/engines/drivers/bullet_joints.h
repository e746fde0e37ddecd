// Bullet's joints between btRigidBody. Compiled with the driver, for both precisions of Bullet.
#pragma once

#include <btBulletDynamicsCommon.h>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {

inline btVector3 bullet(const Vector3<double>& v) { return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])}; }
inline btQuaternion bullet(const Quaternion<double>& q) {
    return {btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)};
}

class BulletMechanism {
  public:
    explicit BulletMechanism(const Mechanism& mechanism) {
        world_.setGravity(bullet(mechanism.gravity));
        for (const LinkBody& link : mechanism.bodies) {
            btCollisionShape* const shape = shape_of(mechanism, bodies_.size());
            btRigidBody::btRigidBodyConstructionInfo info(btScalar(link.mass), nullptr, shape, bullet(link.moments));
            info.m_startWorldTransform = btTransform(bullet(link.start.q), bullet(link.start.p));
            auto body = std::make_unique<btRigidBody>(info);
            if (mechanism.setting != "default") body->setActivationState(DISABLE_DEACTIVATION);
            if (mechanism.setting == "explicit") body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT);
            if (mechanism.setting == "none") body->setFlags(0);
            // bodies collide only as balls
            world_.addRigidBody(body.get(), 1, mechanism.balls ? -1 : 0);
            body->setAngularVelocity(bullet(link.start.w)), body->setLinearVelocity(bullet(link.start.v));
            bodies_.push_back(std::move(body));
        }
        if (mechanism.balls) add_planes(*mechanism.balls);
        for (const LinkJoint& joint : mechanism.joints) add(mechanism, joint);
        for (const LinkJoint& loop : mechanism.loops) add(mechanism, loop);
    }
    ~BulletMechanism() {
        for (const auto& joint : joints_) world_.removeConstraint(joint.get());
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
        for (const auto& plane : planes_) world_.removeRigidBody(plane.get());
        gCalculateCombinedFrictionCallback = btManifoldResult::calculateCombinedFriction;
        gCalculateCombinedRestitutionCallback = btManifoldResult::calculateCombinedRestitution;
    }
    BulletMechanism(const BulletMechanism&) = delete;
    BulletMechanism& operator=(const BulletMechanism&) = delete;

    std::vector<Motion> motions() const {
        std::vector<Motion> all;
        for (const auto& body : bodies_) {
            const btTransform& at = body->getWorldTransform();
            const btQuaternion q = at.getRotation();
            all.push_back({{double(q.w()), double(q.x()), double(q.y()), double(q.z())},
                           vector_of(body->getAngularVelocity()),
                           vector_of(at.getOrigin()),
                           vector_of(body->getLinearVelocity())});
        }
        return all;
    }
    void step(double h) { world_.stepSimulation(btScalar(h), 0); }

  private:
    btCollisionShape* shape_of(const Mechanism& mechanism, std::size_t body) {
        if (!mechanism.balls) return &shape_;
        balls_.push_back(std::make_unique<btSphereShape>(btScalar(mechanism.balls->radii[body])));
        return balls_.back().get();
    }
    // Bullet's rule, which multiplies the coefficients of both bodies, is replaced by the coefficients of the pair
    void add_planes(const Balls& balls) {
        contact_ = balls;
        gCalculateCombinedFrictionCallback = [](const btCollisionObject* a, const btCollisionObject* b) {
            return btScalar(is_plane(a, b) ? contact_->planes.front().friction : contact_->friction);
        };
        gCalculateCombinedRestitutionCallback = [](const btCollisionObject* a, const btCollisionObject* b) {
            return btScalar(is_plane(a, b) ? contact_->planes.front().restitution : contact_->restitution);
        };
        for (const Plane& plane : balls.planes) {
            plane_shapes_.push_back(
                std::make_unique<btStaticPlaneShape>(bullet(plane.normal_W), btScalar(plane.offset)));
            planes_.push_back(std::make_unique<btRigidBody>(0, nullptr, plane_shapes_.back().get()));
            world_.addRigidBody(planes_.back().get());
        }
    }
    static bool is_plane(const btCollisionObject* a, const btCollisionObject* b) {
        return a->isStaticObject() || b->isStaticObject();
    }
    btRigidBody& body(int index) {
        return index < 0 ? btTypedConstraint::getFixedBody() : *bodies_[std::size_t(index)];
    }
    void add(const Mechanism& mechanism, const LinkJoint& joint) {
        btRigidBody &parent = body(joint.parent), &child = body(joint.child);
        // the joint's frame at the start, in each body
        const auto frames = [&](const Quaternion<double>& frame) {
            const auto in = [&](int index, const Vector3<double>& point) {
                return btTransform(bullet(conjugate(mechanism.attitude(index)) * frame), bullet(point));
            };
            return std::pair(in(joint.parent, joint.parent_point), in(joint.child, joint.child_point));
        };
        if (joint.type == "revolute") {
            const auto [a, b] = frames(frame_about(joint.axes_W[0]));
            joints_.push_back(std::make_unique<btHingeConstraint>(parent, child, a, b));
        } else if (joint.type == "spherical") {
            joints_.push_back(std::make_unique<btPoint2PointConstraint>(parent, child, bullet(joint.parent_point),
                                                                        bullet(joint.child_point)));
        } else if (joint.type == "prismatic") {
            // a slider moves along x; z is any axis perpendicular to it
            const Vector3<double>& x = joint.axes_W[0];
            const Vector3<double> across = rotate(frame_about(x), Vector3<double>(1, 0, 0));
            const auto [a, b] = frames(frame_about(across, x));
            auto slider = std::make_unique<btSliderConstraint>(parent, child, a, b, true);
            slider->setLowerLinLimit(1), slider->setUpperLinLimit(-1);
            slider->setLowerAngLimit(0), slider->setUpperAngLimit(0);
            joints_.push_back(std::move(slider));
        } else if (joint.type == "fixed") {
            const auto [a, b] = frames({1, 0, 0, 0});
            joints_.push_back(std::make_unique<btFixedConstraint>(parent, child, a, b));
        } else {
            if (!joint.has_perpendicular_axes())
                throw Unsupported("Bullet supports only universal joints with perpendicular axes");
            // z fixed in the parent, x in the child, no rotation about y
            const auto [a, b] = frames(frame_about(joint.axes_W[0], joint.axes_W[1]));
            auto cross = std::make_unique<btGeneric6DofSpring2Constraint>(parent, child, a, b, RO_XYZ);
            cross->setLinearLowerLimit(btVector3(0, 0, 0)), cross->setLinearUpperLimit(btVector3(0, 0, 0));
            cross->setAngularLowerLimit(btVector3(1, 0, 1)), cross->setAngularUpperLimit(btVector3(-1, 0, -1));
            joints_.push_back(std::move(cross));
        }
        world_.addConstraint(joints_.back().get(), true);
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    btSphereShape shape_{btScalar(0.01)};
    std::vector<std::unique_ptr<btSphereShape>> balls_;
    std::vector<std::unique_ptr<btCollisionShape>> plane_shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_, planes_;
    static inline std::optional<Balls> contact_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace polhode::engines
