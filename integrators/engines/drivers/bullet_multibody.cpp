// Bullet's Featherstone bodies: a btMultiBody without links for one body, and one btMultiBody per tree of a mechanism.
//
// MultibodyWorld has the body as its base. MultibodyMechanism adds a link per joint (two for a universal joint, with a
// massless link between). Limits and couplings of joints are constraints; friction is a motor at velocity 0 with a
// largest impulse per step; motors and springs are generalized forces. serve.h runs the requests.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyGearConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
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
        if (!body.planes.empty()) throw Unsupported("this driver does not support planes; use bullet");
        world_.setGravity(bullet(body.gravity));
        // Bullet stores the base's rotation from world to body
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
            // only bodies with a collider belong to an island, and only islands are solved; it touches nothing
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

/// One btMultiBody per tree of a mechanism. Its base is the free body, or fixed if the tree is attached to the world.
class MultibodyMechanism {
  public:
    explicit MultibodyMechanism(const Mechanism& mechanism)
        : mechanism_(&mechanism), forces_(mechanism), places_(mechanism.bodies.size()) {
        world_.setGravity(bullet(mechanism.gravity));
        for (int i = 0; i < static_cast<int>(mechanism.bodies.size()); ++i)
            if (!mechanism.parent_joint(i)) add_tree(mechanism, i);
        const auto is_root = [](const LinkJoint& joint) { return joint.parent < 0; };
        if (std::ranges::any_of(mechanism.joints, is_root)) add_tree(mechanism, -1);
        for (const LinkJoint& joint : mechanism.joints) add_laws(joint);
        for (const JointCoupling& coupling : mechanism.couplings) add(coupling);
    }
    ~MultibodyMechanism() {
        for (const auto& constraint : constraints_) world_.removeMultiBodyConstraint(constraint.get());
        for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
        for (const auto& tree : trees_) world_.removeMultiBody(tree.get());
    }
    MultibodyMechanism(const MultibodyMechanism&) = delete;
    MultibodyMechanism& operator=(const MultibodyMechanism&) = delete;

    std::vector<Motion> motions() const {
        std::vector<std::vector<btVector3>> w, v;
        for (const auto& tree : trees_) {
            w.emplace_back(std::size_t(tree->getNumLinks()) + 1), v.emplace_back(w.back().size());
            tree->compTreeLinkVelocities(w.back().data(), v.back().data());
        }
        std::vector<Motion> all;
        for (const LinkPlace& place : places_) {
            const btMultiBody& tree = *trees_[place.tree];
            // the columns of the attitude
            btMatrix3x3 R;
            for (int i = 0; i < 3; ++i) {
                btVector3 unit(0, 0, 0);
                unit[i] = 1;
                const btVector3 column = tree.localDirToWorld(place.link, unit);
                for (int j = 0; j < 3; ++j) R[j][i] = column[j];
            }
            btQuaternion q;
            R.getRotation(q);
            const std::size_t at = std::size_t(place.link + 1);
            all.push_back({{q.w(), q.x(), q.y(), q.z()},
                           vector_of(R * w[place.tree][at]),
                           vector_of(tree.localPosToWorld(place.link, btVector3(0, 0, 0))),
                           vector_of(R * v[place.tree][at])});
        }
        return all;
    }
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        const LinkPlace& place = places_[std::size_t(index)];
        btMultiBody& tree = *trees_[place.tree];
        if (place.link < 0) {
            tree.addBaseForce(bullet(force)), tree.addBaseTorque(bullet(torque));
        } else {
            tree.addLinkForce(place.link, bullet(force)), tree.addLinkTorque(place.link, bullet(torque));
        }
    }
    void step(double h) {
        for (const auto& [motor, friction] : friction_) motor->setMaxAppliedImpulse(friction * h);
        forces_.enter_step(h);
        for (const std::size_t index : forces_.joints()) {
            const auto [tree, link] = place_of(mechanism_->joints[index]);
            tree->addJointTorque(link, forces_.force(index, tree->getJointPos(link), tree->getJointVel(link)));
        }
        world_.stepSimulation(h, 0);
    }

  private:
    struct LinkPlace {
        std::size_t tree = 0;
        int link = -1;  ///< -1: the base
    };

    std::pair<btMultiBody*, int> place_of(const LinkJoint& joint) const {
        const LinkPlace& place = places_[std::size_t(joint.child)];
        return {trees_[place.tree].get(), place.link};
    }
    // only links with a collider belong to an island, and only islands are solved; it touches nothing
    void add_collider(btMultiBody& tree, int link) {
        if (tree.getLink(link).m_collider) return;
        colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(&tree, link));
        colliders_.back()->setCollisionShape(&shape_);
        world_.addCollisionObject(colliders_.back().get(), 0, 0);
        tree.getLink(link).m_collider = colliders_.back().get();
    }
    void add_constraint(std::unique_ptr<btMultiBodyConstraint> constraint) {
        world_.addMultiBodyConstraint(constraint.get());
        constraint->finalizeMultiDof();
        constraints_.push_back(std::move(constraint));
    }
    void add_laws(const LinkJoint& joint) {
        const auto [tree, link] = place_of(joint);
        if (const JointLimits& limits = joint.laws.limits; limits.any()) {
            constexpr double far = 1e6;
            add_collider(*tree, link);
            add_constraint(std::make_unique<btMultiBodyJointLimitConstraint>(tree, link, std::max(limits.lower, -far),
                                                                             std::min(limits.upper, far)));
        }
        if (joint.laws.friction > 0) {
            add_collider(*tree, link);
            auto motor = std::make_unique<btMultiBodyJointMotor>(tree, link, 0, 0);
            friction_.emplace_back(motor.get(), joint.laws.friction);
            add_constraint(std::move(motor));
        }
    }
    // the rate of A plus ratio times the rate of B is zero
    void add(const JointCoupling& coupling) {
        const auto [first, first_link] = place_of(mechanism_->joints[coupling.first]);
        const auto [second, second_link] = place_of(mechanism_->joints[coupling.second]);
        add_collider(*first, first_link), add_collider(*second, second_link);
        const btVector3 none(0, 0, 0);
        const btMatrix3x3 same = btMatrix3x3::getIdentity();
        auto gear =
            std::make_unique<btMultiBodyGearConstraint>(second, second_link, first, first_link, none, none, same, same);
        gear->setGearRatio(-coupling.ratio);
        gear->setMaxAppliedImpulse(1e30);
        add_constraint(std::move(gear));
    }

    void add_tree(const Mechanism& mechanism, int base) {
        std::vector<const LinkJoint*> joints;
        std::vector<bool> in_tree(mechanism.bodies.size(), false);
        int links = 0;
        for (const LinkJoint& joint : mechanism.joints) {
            const bool is_own = joint.parent == base || (joint.parent >= 0 && in_tree[std::size_t(joint.parent)]);
            if (!is_own) continue;
            in_tree[std::size_t(joint.child)] = true;
            joints.push_back(&joint);
            // a universal joint consists of two hinges with a massless link between them
            links += joint.type == "universal" ? 2 : 1;
        }
        const LinkBody world_body{0, {}, {}};
        const LinkBody& base_body = base < 0 ? world_body : mechanism.body(base);
        auto tree = std::make_unique<btMultiBody>(links, base_body.mass, bullet(base_body.moments), base < 0,
                                                  mechanism.setting == "default");
        if (base >= 0) places_[std::size_t(base)] = {trees_.size(), -1};
        int link = 0;
        for (const LinkJoint* joint : joints) {
            set_up_link(mechanism, *joint, *tree, link);
            places_[std::size_t(joint->child)] = {trees_.size(), link - 1};
        }
        const Quaternion<double>& q = base_body.start.q;
        tree->setWorldToBaseRot(btQuaternion(q.x, q.y, q.z, q.w).inverse());
        tree->setBasePos(bullet(base_body.start.p));
        if (mechanism.setting != "default") {
            tree->setLinearDamping(0), tree->setAngularDamping(0);
            tree->setMaxCoordinateVelocity(1e30);
        }
        if (mechanism.setting == "rk4") tree->useRK4Integration(true);
        tree->finalizeMultiDof();
        if (base >= 0) tree->setBaseOmega(bullet(base_body.start.w)), tree->setBaseVel(bullet(base_body.start.v));
        link = 0;
        for (const LinkJoint* joint : joints) {
            if (joint->type == "spherical") {
                const Vector3<double> w = rotate_back(mechanism.attitude(joint->child), joint->angular_velocity_W);
                const double rates[] = {w[0], w[1], w[2]};
                tree->setJointVelMultiDof(link, rates);
            }
            for (std::size_t i = 0; i < joint->rates.size(); ++i) tree->setJointVel(link + int(i), joint->rates[i]);
            link += joint->type == "universal" ? 2 : 1;
        }
        world_.addMultiBody(tree.get());
        trees_.push_back(std::move(tree));
    }
    void set_up_link(const Mechanism& mechanism, const LinkJoint& joint, btMultiBody& tree, int& link) {
        const LinkBody& child = mechanism.body(joint.child);
        const int parent = joint.parent < 0 ? -1 : places_[std::size_t(joint.parent)].link;
        const Quaternion<double> turn = conjugate(child.start.q) * mechanism.attitude(joint.parent);
        const btQuaternion to_child(turn.x, turn.y, turn.z, turn.w);
        const btVector3 out = bullet(joint.parent_point), in = -bullet(joint.child_point), none(0, 0, 0);
        const btVector3 moments = bullet(child.moments);
        const auto axis = [&](std::size_t i) { return bullet(joint.child_axes.at(i)); };
        if (joint.type == "revolute") {
            tree.setupRevolute(link, child.mass, moments, parent, to_child, axis(0), out, in, true);
        } else if (joint.type == "prismatic") {
            tree.setupPrismatic(link, child.mass, moments, parent, to_child, axis(0), out, in, true);
        } else if (joint.type == "spherical") {
            tree.setupSpherical(link, child.mass, moments, parent, to_child, out, in, true);
        } else if (joint.type == "fixed") {
            tree.setupFixed(link, child.mass, moments, parent, to_child, out, in, true);
        } else {
            tree.setupRevolute(link, 0, none, parent, to_child, axis(0), out, none, true);
            ++link;
            tree.setupRevolute(link, child.mass, moments, link - 1, btQuaternion(0, 0, 0, 1), axis(1), none, in, true);
        }
        ++link;
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    const Mechanism* mechanism_;
    JointForces forces_;
    btSphereShape shape_{0.01};
    std::vector<std::unique_ptr<btMultiBody>> trees_;
    std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
    std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;
    std::vector<std::pair<btMultiBodyJointMotor*, double>> friction_;  ///< and the friction of the joint, N m or N
    std::vector<LinkPlace> places_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<MultibodyWorld, MultibodyMechanism>(
        {"bullet_multibody",
         fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100),
         "binary64",
         {{"default", "linear and angular damping 0.04, slow bodies sleep, coordinate velocities limited to 100"},
          {"best", "no damping, no sleeping, no speed limit"},
          {"rk4", "as best, with btMultiBody's RK4"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {},
         {},
         false,
         {"limits", "friction", "springs", "motors", "couplings"}});
}
