// Open Dynamics Engine.
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
        touching_ = body.planes.front();
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
        if (touching_) dSpaceCollide(space_, this, touch);
        dWorldStep(world_, dReal(h));
        dJointGroupEmpty(contacts_);
    }
    double mass() const { return of_body().mass; }
    Vector3<double> moments() const {
        const dMass mass = of_body();
        return {mass.I[0], mass.I[5], mass.I[10]};
    }

  private:
    dMass of_body() const {
        dMass mass;
        dBodyGetMass(body_, &mass);
        return mass;
    }
    // ODE's convex bodies want faces; a box is all that there is without.
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
            if (!is_box) throw Unsupported("of bodies that hit planes this driver makes boxes and balls");
            shape = dCreateBox(space_, dReal(2 * half[0]), dReal(2 * half[1]), dReal(2 * half[2]));
        }
        dGeomSetBody(shape, body_);
    }
    static void touch(void* self, dGeomID a, dGeomID b) {
        OdeWorld& world = *static_cast<OdeWorld*>(self);
        if (dGeomGetBody(a) == dGeomGetBody(b)) return;
        std::array<dContact, 8> contacts{};
        const int count = dCollide(a, b, int(contacts.size()), &contacts[0].geom, sizeof(dContact));
        for (int i = 0; i < count; ++i) {
            dContact& contact = contacts[std::size_t(i)];
            contact.surface.mode = dContactBounce;
            contact.surface.mu = dReal(world.touching_->friction);
            contact.surface.bounce = dReal(world.touching_->restitution);
            contact.surface.bounce_vel = 0;
            const dJointID joint = dJointCreateContact(world.world_, world.contacts_, &contact);
            dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
        }
    }

    dWorldID world_;
    dSpaceID space_;
    dJointGroupID contacts_;
    dBodyID body_;
    std::optional<Plane> touching_;
};

std::string version() {
    // "ODE ODE_OPT_.. ODE_double_precision": the library tells no number of its version; this is the headers'
    return POLHODE_ODE_VERSION;
}

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    dInitODE2(0);
    const bool is_double = dCheckConfiguration("ODE_double_precision") != 0;
    if (is_double != (sizeof(dReal) == sizeof(double))) {
        fmt::print(stderr, "ode: the library was compiled for another precision than its headers say\n");
        return 1;
    }
    const int exit_code = serve<OdeWorld>(
        {"ode",
         version(),
         is_double ? "binary64" : "binary32",
         {{"default",
           "dWorldStep; the gyroscopic term linearly implicit; attitude by the first-order quaternion; no damping, "
           "never asleep"},
          {"best", "as default, with finite rotations: the attitude by an exponential"},
          {"none", "as default, the gyroscopic term switched off"}}});
    dCloseODE();
    return exit_code;
}
