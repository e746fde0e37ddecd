// Bullet's joints between btRigidBody. Compiled with the driver, for both precisions of Bullet.
//
// Limits are those of hinges and sliders. Friction is a motor at velocity 0 with a largest force; a hinge takes its
// impulse per step. A coupling of two rotations relative to the world is a gear constraint. Motors and springs are
// forces on the bodies.
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
    explicit BulletMechanism(const Mechanism& mechanism) : mechanism_(&mechanism), forces_(mechanism) {
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
        for (const JointCoupling& coupling : mechanism.couplings) add(coupling);
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
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        btRigidBody& loaded = body(index);
        loaded.activate(true);
        loaded.applyCentralForce(bullet(force)), loaded.applyTorque(bullet(torque));
    }
    void step(double h) {
        for (const auto& [hinge, friction] : hinges_with_friction_) hinge->setMaxMotorImpulse(btScalar(friction * h));
        forces_.enter_step(h);
        if (!forces_.joints().empty())
            add_joint_forces(forces_, *mechanism_, motions(), [&](auto... load) { apply(load...); });
        world_.stepSimulation(btScalar(h), 0);
    }

  private:
    // Bullet's gear constraint holds the angular velocities of two bodies in a fixed ratio.
    void add(const JointCoupling& coupling) {
        const LinkJoint &first = mechanism_->joints[coupling.first], &second = mechanism_->joints[coupling.second];
        const auto rotates_about_world = [](const LinkJoint& joint) {
            return joint.type == "revolute" && joint.parent < 0;
        };
        if (!rotates_about_world(first) || !rotates_about_world(second))
            throw Unsupported("Bullet supports couplings only of two revolute joints on the world");
        // axis of A times w_A plus ratio times axis of B times w_B is zero
        joints_.push_back(std::make_unique<btGearConstraint>(body(second.child), body(first.child),
                                                             bullet(second.child_axes[0]), bullet(first.child_axes[0]),
                                                             btScalar(-coupling.ratio)));
        world_.addConstraint(joints_.back().get(), true);
    }
    // A hinge multiplies its restitution by the bias factor, which is 0.3 by default.
    void add_hinge(btRigidBody& parent, btRigidBody& child, const btTransform& a, const btTransform& b,
                   const JointLaws& laws) {
        auto hinge = std::make_unique<btHingeConstraint>(parent, child, a, b);
        if (const JointLimits& limits = laws.limits; limits.any()) {
            if (!(limits.lower >= -SIMD_PI && limits.upper <= SIMD_PI))
                throw Unsupported(
                    "Bullet supports limits of revolute joints only on both sides within pi of the start");
            // Bullet measures the angle of the parent relative to the child. The softness is the
            // default; the relaxation factor is the restitution, 1 by default
            hinge->setLimit(btScalar(-limits.upper), btScalar(-limits.lower), btScalar(0.9),
                            btScalar(mechanism_->setting == "default" ? 0.3 : 1), btScalar(limits.restitution));
        }
        if (laws.friction > 0) {
            hinge->enableAngularMotor(true, 0, 0);
            hinges_with_friction_.emplace_back(hinge.get(), laws.friction);
        }
        joints_.push_back(std::move(hinge));
    }
    static void set_laws(btSliderConstraint& slider, const JointLaws& laws) {
        if (const JointLimits& limits = laws.limits; limits.any()) {
            // the slider stops at its limits, whatever the damping that is documented as its restitution
            if (limits.restitution > 0)
                throw Unsupported("Bullet supports restitution only at the limits of revolute joints");
            constexpr double far = 1e6;
            slider.setLowerLinLimit(btScalar(std::max(limits.lower, -far)));
            slider.setUpperLinLimit(btScalar(std::min(limits.upper, far)));
        }
        if (laws.friction > 0) {
            slider.setPoweredLinMotor(true), slider.setTargetLinMotorVelocity(0);
            slider.setMaxLinMotorForce(btScalar(laws.friction));
        }
    }
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
            add_hinge(parent, child, a, b, joint.laws);
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
            set_laws(*slider, joint.laws);
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

    const Mechanism* mechanism_;
    JointForces forces_;
    std::vector<std::pair<btHingeConstraint*, double>> hinges_with_friction_;  ///< and their friction, N m
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
