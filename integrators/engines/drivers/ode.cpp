// Open Dynamics Engine: a dBody with optional ball joint and contacts, or several with joints.
//
// OdeWorld has one body; contacts are created in add_contact_joints() with the requested restitution and friction.
// OdeMechanism has one dBody per body and one dJoint per joint or loop. Limits are the stops of a joint and friction is
// its motor at velocity 0 with a largest force; motors and springs are forces on the bodies. serve.h runs the requests.
#include <fmt/format.h>
#include <ode/ode.h>

#include <array>
#include <numbers>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

// The bodies of a collision as contacts of the next step, with these coefficients.
void add_contact_joints(dWorldID world, dJointGroupID group, dGeomID a, dGeomID b, double friction,
                        double restitution) {
    std::array<dContact, 8> contacts{};
    const int count = dCollide(a, b, int(contacts.size()), &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
        dContact& contact = contacts[std::size_t(i)];
        // without dContactApprox1, mu is the largest friction force instead of a coefficient
        contact.surface.mode = dContactBounce | dContactApprox1;
        contact.surface.mu = dReal(friction);
        contact.surface.bounce = dReal(restitution);
        contact.surface.bounce_vel = 0;
        dJointAttach(dJointCreateContact(world, group, &contact), dGeomGetBody(a), dGeomGetBody(b));
    }
}

void add_plane(dSpaceID space, const Plane& plane) {
    dCreatePlane(space, dReal(plane.normal_W[0]), dReal(plane.normal_W[1]), dReal(plane.normal_W[2]),
                 dReal(plane.offset));
}

class OdeWorld {
  public:
    explicit OdeWorld(const Body& body) : world_(dWorldCreate()), space_(dSimpleSpaceCreate(nullptr)) {
        contacts_ = dJointGroupCreate(0);
        body_ = dBodyCreate(world_);
        set_gravity(body.gravity);
        dMass mass;
        dMassSetParameters(&mass, dReal(body.mass), 0, 0, 0, dReal(body.moments[0]), dReal(body.moments[1]),
                           dReal(body.moments[2]), 0, 0, 0);
        dBodySetMass(body_, &mass);
        const dQuaternion q = {dReal(body.q.w), dReal(body.q.x), dReal(body.q.y), dReal(body.q.z)};
        dBodySetQuaternion(body_, q);
        dBodySetPosition(body_, dReal(body.p[0]), dReal(body.p[1]), dReal(body.p[2]));
        set_velocities(body.w, body.v);
        if (body.setting == "best") dBodySetFiniteRotationMode(body_, 1);
        if (body.setting == "none") dBodySetGyroscopicMode(body_, 0);
        if (body.pivot) {
            const dJointID joint = dJointCreateBall(world_, nullptr);
            dJointAttach(joint, body_, nullptr);
            dJointSetBallAnchor(joint, 0, 0, 0);
        }
        if (body.planes.empty()) return;
        for (const EngineShape& shape : body.shapes) add_shape(shape);
        for (const Plane& plane : body.planes) add_plane(space_, plane);
        contact_plane_ = body.planes.front();
    }
    ~OdeWorld() {
        dJointGroupDestroy(contacts_);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
    }
    OdeWorld(const OdeWorld&) = delete;
    OdeWorld& operator=(const OdeWorld&) = delete;

    Motion motion() const {
        const dReal* q = dBodyGetQuaternion(body_);
        return {{q[0], q[1], q[2], q[3]},
                vector_of(dBodyGetAngularVel(body_)),
                vector_of(dBodyGetPosition(body_)),
                vector_of(dBodyGetLinearVel(body_))};
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        dBodyEnable(body_);
        dBodySetAngularVel(body_, dReal(w[0]), dReal(w[1]), dReal(w[2]));
        dBodySetLinearVel(body_, dReal(v[0]), dReal(v[1]), dReal(v[2]));
    }
    void set_gravity(const Vector3<double>& g) { dWorldSetGravity(world_, dReal(g[0]), dReal(g[1]), dReal(g[2])); }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) {
        dBodyAddForce(body_, dReal(force[0]), dReal(force[1]), dReal(force[2]));
        dBodyAddTorque(body_, dReal(torque[0]), dReal(torque[1]), dReal(torque[2]));
    }
    void step(double h) {
        if (contact_plane_) dSpaceCollide(space_, this, add_contacts);
        dWorldStep(world_, dReal(h));
        dJointGroupEmpty(contacts_);
    }
    double mass() const { return body_mass().mass; }
    Vector3<double> moments() const {
        const dMass mass = body_mass();
        return {mass.I[0], mass.I[5], mass.I[10]};
    }

  private:
    dMass body_mass() const {
        dMass mass;
        dBodyGetMass(body_, &mass);
        return mass;
    }
    dGeomID make_geom(const EngineShape& shape) {
        const dReal radius = dReal(shape.radius);
        if (shape.type == "ball") return dCreateSphere(space_, radius);
        if (shape.type == "capsule") return dCreateCapsule(space_, radius, dReal(2 * shape.half_height));
        if (shape.type == "cylinder") return dCreateCylinder(space_, radius, dReal(2 * shape.half_height));
        if (shape.type == "disc") return dCreateCylinder(space_, radius, dReal(2 * disc_half_height(shape)));
        return dCreateBox(space_, dReal(2 * shape.half[0]), dReal(2 * shape.half[1]), dReal(2 * shape.half[2]));
    }
    void add_shape(const EngineShape& shape) {
        const dGeomID geom = make_geom(shape);
        dGeomSetBody(geom, body_);
        dGeomSetOffsetPosition(geom, dReal(shape.position[0]), dReal(shape.position[1]), dReal(shape.position[2]));
        const dQuaternion q = {dReal(shape.q.w), dReal(shape.q.x), dReal(shape.q.y), dReal(shape.q.z)};
        dGeomSetOffsetQuaternion(geom, q);
    }
    static void add_contacts(void* self, dGeomID a, dGeomID b) {
        const OdeWorld& world = *static_cast<OdeWorld*>(self);
        if (dGeomGetBody(a) != dGeomGetBody(b))
            add_contact_joints(world.world_, world.contacts_, a, b, world.contact_plane_->friction,
                               world.contact_plane_->restitution);
    }

    dWorldID world_;
    dSpaceID space_;
    dJointGroupID contacts_;
    dBodyID body_;
    std::optional<Plane> contact_plane_;
};

// The laws of a joint as its parameters. ODE measures the stops of the parent relative to the child, except for a hinge
// on the world.
template <class SetParameter>
void set_joint_laws(dJointID joint, const LinkJoint& link_joint, const SetParameter& set) {
    const JointLaws& laws = link_joint.laws;
    if (laws.limits.any()) {
        const bool is_forward = link_joint.type == "revolute" && link_joint.parent < 0;
        const double low = is_forward ? laws.limits.lower : -laws.limits.upper,
                     high = is_forward ? laws.limits.upper : -laws.limits.lower;
        set(joint, dParamLoStop, dReal(low)), set(joint, dParamHiStop, dReal(high));
        set(joint, dParamBounce, dReal(laws.limits.restitution));
    }
    if (laws.friction > 0) set(joint, dParamVel, 0), set(joint, dParamFMax, dReal(laws.friction));
}

// ODE wraps the angle of a hinge to (-pi, pi].
void require_angle_limits(const JointLimits& limits) {
    const auto is_beyond = [](double limit) { return std::isfinite(limit) && std::abs(limit) > std::numbers::pi; };
    if (is_beyond(limits.lower) || is_beyond(limits.upper))
        throw Unsupported("ODE supports limits of revolute joints only within pi of the start");
}

class OdeMechanism {
  public:
    explicit OdeMechanism(const Mechanism& mechanism)
        : mechanism_(&mechanism), forces_(mechanism), world_(dWorldCreate()) {
        dWorldSetGravity(world_, dReal(mechanism.gravity[0]), dReal(mechanism.gravity[1]), dReal(mechanism.gravity[2]));
        for (const LinkBody& link : mechanism.bodies) {
            const dBodyID body = dBodyCreate(world_);
            dMass mass;
            dMassSetParameters(&mass, dReal(link.mass), 0, 0, 0, dReal(link.moments[0]), dReal(link.moments[1]),
                               dReal(link.moments[2]), 0, 0, 0);
            dBodySetMass(body, &mass);
            const auto& [start, w, p, v] = link.start;
            const dQuaternion q = {dReal(start.w), dReal(start.x), dReal(start.y), dReal(start.z)};
            dBodySetQuaternion(body, q);
            dBodySetPosition(body, dReal(p[0]), dReal(p[1]), dReal(p[2]));
            dBodySetAngularVel(body, dReal(w[0]), dReal(w[1]), dReal(w[2]));
            dBodySetLinearVel(body, dReal(v[0]), dReal(v[1]), dReal(v[2]));
            if (mechanism.setting == "best") dBodySetFiniteRotationMode(body, 1);
            if (mechanism.setting == "none") dBodySetGyroscopicMode(body, 0);
            bodies_.push_back(body);
        }
        for (const LinkJoint& joint : mechanism.joints) add(joint);
        for (const LinkJoint& loop : mechanism.loops) add(loop);
        if (mechanism.balls) add_balls(*mechanism.balls);
    }
    ~OdeMechanism() {
        dJointGroupDestroy(contacts_);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
    }
    OdeMechanism(const OdeMechanism&) = delete;
    OdeMechanism& operator=(const OdeMechanism&) = delete;

    std::vector<Motion> motions() const {
        std::vector<Motion> all;
        for (const dBodyID body : bodies_) {
            const dReal* q = dBodyGetQuaternion(body);
            all.push_back({{q[0], q[1], q[2], q[3]},
                           vector_of(dBodyGetAngularVel(body)),
                           vector_of(dBodyGetPosition(body)),
                           vector_of(dBodyGetLinearVel(body))});
        }
        return all;
    }
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        const dBodyID body = bodies_[std::size_t(index)];
        dBodyAddForce(body, dReal(force[0]), dReal(force[1]), dReal(force[2]));
        dBodyAddTorque(body, dReal(torque[0]), dReal(torque[1]), dReal(torque[2]));
    }
    void step(double h) {
        if (balls_) dSpaceCollide(space_, this, add_contacts);
        forces_.enter_step(h);
        if (!forces_.joints().empty())
            add_joint_forces(forces_, *mechanism_, motions(), [&](auto... load) { apply(load...); });
        dWorldStep(world_, dReal(h));
        dJointGroupEmpty(contacts_);
    }

  private:
    void add_balls(const Balls& balls) {
        balls_ = balls;
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            dGeomSetBody(dCreateSphere(space_, dReal(balls.radii[i])), bodies_[i]);
        for (const Plane& plane : balls.planes) add_plane(space_, plane);
    }
    static void add_contacts(void* self, dGeomID a, dGeomID b) {
        const OdeMechanism& world = *static_cast<OdeMechanism*>(self);
        const bool is_plane = !dGeomGetBody(a) || !dGeomGetBody(b);
        if (is_plane && dGeomGetBody(a) == dGeomGetBody(b)) return;
        const Balls& balls = *world.balls_;
        add_contact_joints(world.world_, world.contacts_, a, b,
                           is_plane ? balls.planes.front().friction : balls.friction,
                           is_plane ? balls.planes.front().restitution : balls.restitution);
    }
    void add(const LinkJoint& link_joint) {
        const Vector3<double>& at = link_joint.anchor_W;
        const auto attach = [&](dJointID joint) {
            const auto body = [&](int index) { return index < 0 ? nullptr : bodies_[std::size_t(index)]; };
            dJointAttach(joint, body(link_joint.parent), body(link_joint.child));
            return joint;
        };
        const auto axis = [&](std::size_t i, auto set, dJointID joint) {
            const Vector3<double>& a = link_joint.axes_W.at(i);
            set(joint, dReal(a[0]), dReal(a[1]), dReal(a[2]));
        };
        if (link_joint.type == "revolute") {
            const dJointID joint = attach(dJointCreateHinge(world_, nullptr));
            dJointSetHingeAnchor(joint, dReal(at[0]), dReal(at[1]), dReal(at[2]));
            axis(0, dJointSetHingeAxis, joint);
            require_angle_limits(link_joint.laws.limits);
            set_joint_laws(joint, link_joint, dJointSetHingeParam);
        } else if (link_joint.type == "spherical") {
            const dJointID joint = attach(dJointCreateBall(world_, nullptr));
            dJointSetBallAnchor(joint, dReal(at[0]), dReal(at[1]), dReal(at[2]));
        } else if (link_joint.type == "prismatic") {
            const dJointID joint = attach(dJointCreateSlider(world_, nullptr));
            axis(0, dJointSetSliderAxis, joint);
            set_joint_laws(joint, link_joint, dJointSetSliderParam);
        } else if (link_joint.type == "fixed") {
            dJointSetFixed(attach(dJointCreateFixed(world_, nullptr)));
        } else {
            if (!link_joint.has_perpendicular_axes())
                throw Unsupported("ODE supports only universal joints with perpendicular axes");
            const dJointID joint = attach(dJointCreateUniversal(world_, nullptr));
            dJointSetUniversalAnchor(joint, dReal(at[0]), dReal(at[1]), dReal(at[2]));
            axis(0, dJointSetUniversalAxis1, joint), axis(1, dJointSetUniversalAxis2, joint);
        }
    }

    const Mechanism* mechanism_;
    JointForces forces_;
    dWorldID world_;
    dSpaceID space_ = dSimpleSpaceCreate(nullptr);
    dJointGroupID contacts_ = dJointGroupCreate(0);
    std::vector<dBodyID> bodies_;
    std::optional<Balls> balls_;
};

std::string version() {
    // from the headers: the library reports only "ODE ODE_OPT_.. ODE_double_precision" and no version number
    return POLHODE_ODE_VERSION;
}

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    dInitODE2(0);
    const bool is_double = dCheckConfiguration("ODE_double_precision") != 0;
    if (is_double != (sizeof(dReal) == sizeof(double))) {
        fmt::print(stderr, "ode: the library and its headers differ in precision\n");
        return 1;
    }
    const int exit_code = serve<OdeWorld, OdeMechanism>(
        {"ode",
         version(),
         is_double ? "binary64" : "binary32",
         {{"default",
           "dWorldStep; gyroscopic term linearly implicit; attitude by the first-order quaternion update; no "
           "damping, no sleeping"},
          {"best", "as default, with finite rotations: attitude by an exponential"},
          {"none", "as default, gyroscopic term off"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"revolute", "spherical"},
         {"ball", "capsule", "cylinder", "disc", "box", "several"},
         true,
         {"limits", "restitution", "friction", "springs", "motors"}});
    dCloseODE();
    return exit_code;
}
