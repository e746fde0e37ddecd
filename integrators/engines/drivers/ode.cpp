// Open Dynamics Engine: a dBody with optional ball joint and contacts, or several with joints.
//
// OdeWorld has one body; contacts are created in add_contacts() with the planes' restitution and friction. OdeMechanism
// has one dBody per body and one dJoint per joint or loop. serve.h runs the requests.
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

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
        add_shape(body);
        for (const Plane& plane : body.planes)
            dCreatePlane(space_, dReal(plane.normal_W[0]), dReal(plane.normal_W[1]), dReal(plane.normal_W[2]),
                         dReal(plane.offset));
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
    // ODE's convex bodies require faces, which the request does not contain; boxes and balls do not.
    void add_shape(const Body& body) {
        dGeomID shape = nullptr;
        if (body.ball) {
            shape = dCreateSphere(space_, dReal(*body.ball));
        } else {
            Vector3<double> half;
            for (const auto& corner : body.hull)
                for (int i = 0; i < 3; ++i) half[i] = std::max(half[i], std::abs(corner[i]));
            const bool is_box = body.hull.size() == 8 && std::ranges::all_of(body.hull, [&](const auto& corner) {
                                    for (int i = 0; i < 3; ++i)
                                        if (std::abs(std::abs(corner[i]) - half[i]) > 1e-9 * half[i]) return false;
                                    return true;
                                });
            if (!is_box) throw Unsupported("on planes this driver supports only boxes and balls");
            shape = dCreateBox(space_, dReal(2 * half[0]), dReal(2 * half[1]), dReal(2 * half[2]));
        }
        dGeomSetBody(shape, body_);
    }
    static void add_contacts(void* self, dGeomID a, dGeomID b) {
        OdeWorld& world = *static_cast<OdeWorld*>(self);
        if (dGeomGetBody(a) == dGeomGetBody(b)) return;
        std::array<dContact, 8> contacts{};
        const int count = dCollide(a, b, int(contacts.size()), &contacts[0].geom, sizeof(dContact));
        for (int i = 0; i < count; ++i) {
            dContact& contact = contacts[std::size_t(i)];
            contact.surface.mode = dContactBounce;
            contact.surface.mu = dReal(world.contact_plane_->friction);
            contact.surface.bounce = dReal(world.contact_plane_->restitution);
            contact.surface.bounce_vel = 0;
            const dJointID joint = dJointCreateContact(world.world_, world.contacts_, &contact);
            dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
        }
    }

    dWorldID world_;
    dSpaceID space_;
    dJointGroupID contacts_;
    dBodyID body_;
    std::optional<Plane> contact_plane_;
};

class OdeMechanism {
  public:
    explicit OdeMechanism(const Mechanism& mechanism) : world_(dWorldCreate()) {
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
    }
    ~OdeMechanism() { dWorldDestroy(world_); }
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
    void step(double h) { dWorldStep(world_, dReal(h)); }

  private:
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
        } else if (link_joint.type == "spherical") {
            const dJointID joint = attach(dJointCreateBall(world_, nullptr));
            dJointSetBallAnchor(joint, dReal(at[0]), dReal(at[1]), dReal(at[2]));
        } else if (link_joint.type == "prismatic") {
            axis(0, dJointSetSliderAxis, attach(dJointCreateSlider(world_, nullptr)));
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

    dWorldID world_;
    std::vector<dBodyID> bodies_;
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
         {"revolute", "spherical"}});
    dCloseODE();
    return exit_code;
}
