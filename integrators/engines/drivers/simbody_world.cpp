// Simbody behind the interface of simbody_world.h, compiled as C++17.
//
// SettingIntegrator holds the integrator of a setting. SimbodySystem has one body; SimbodyMechanismSystem has one
// mobilizer per body and constraints for loops.
#include "integrators/engines/drivers/simbody_world.h"

#include <Simbody.h>

#include <cmath>

namespace polhode::engines {
namespace {

SimTK::Vec3 vector(const double* v) { return {v[0], v[1], v[2]}; }

SimTK::Rotation rotation(const double* q) { return SimTK::Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3])); }

SimTK::Body::Rigid rigid_body(double mass, const double* I) {
    return SimTK::Body::Rigid(SimTK::MassProperties(mass, SimTK::Vec3(0), SimTK::Inertia(I[0], I[1], I[2])));
}

// writes q, w, p and v
void write_motion(const SimTK::MobilizedBody& body, const SimTK::State& state, double* numbers) {
    const SimTK::Quaternion q = body.getBodyRotation(state).convertRotationToQuaternion();
    for (int i = 0; i < 4; ++i) numbers[i] = q[i];
    for (int i = 0; i < 3; ++i) {
        numbers[4 + i] = body.getBodyAngularVelocity(state)[i];
        numbers[7 + i] = body.getBodyOriginLocation(state)[i];
        numbers[10 + i] = body.getBodyOriginVelocity(state)[i];
    }
}

/// The integrator of the driver's setting. Its fixed step is set at the start, so that another step requires a new one.
struct SettingIntegrator {
    std::unique_ptr<SimTK::Integrator> integrator;
    bool has_fixed_step = false, is_gazebo = false;
    double time = 0, h = 1;

    void start(const SimTK::System& system, const SimTK::State& state) {
        if (is_gazebo)
            integrator = std::make_unique<SimTK::SemiExplicitEuler2Integrator>(system);
        else
            integrator = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
        if (has_fixed_step) integrator->setFixedStepSize(h);
        integrator->initialize(state);
    }
    void set(const std::string& setting) { is_gazebo = setting == "gazebo", has_fixed_step = setting == "best"; }
    void step(const SimTK::System& system, double step) {
        if (has_fixed_step && !(std::abs(step / h - 1) < 1e-6)) {
            h = step;
            const SimTK::State state = integrator->getAdvancedState();
            start(system, state);
        }
        time += step;
        // the first call after the start only reports the start of an interval
        while (integrator->stepTo(time, time) == SimTK::Integrator::StartOfContinuousInterval) {
        }
    }
};

}  // namespace

struct SimbodySystem::Parts {
    explicit Parts(const SimbodyStart& start)
        : gravity(forces, matter, vector(start.gravity)), external_forces(forces, matter) {}

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter{system};
    SimTK::GeneralForceSubsystem forces{system};
    SimTK::Force::Gravity gravity;
    SimTK::Force::DiscreteForces external_forces;
    SimTK::MobilizedBody body;
    SettingIntegrator stepper;
};

SimbodySystem::SimbodySystem(const SimbodyStart& start) : parts_(std::make_unique<Parts>(start)) {
    Parts& s = *parts_;
    const SimTK::Body::Rigid rigid = rigid_body(start.mass, start.moments);
    if (start.pivoted)
        s.body = SimTK::MobilizedBody::Ball(s.matter.Ground(), SimTK::Transform(), rigid,
                                            SimTK::Transform(vector(start.pivot)));
    else
        s.body = SimTK::MobilizedBody::Free(s.matter.Ground(), rigid);
    SimTK::State state = s.system.realizeTopology();
    const SimTK::Quaternion q(start.q[0], start.q[1], start.q[2], start.q[3]);
    s.body.setQToFitTransform(state, SimTK::Transform(SimTK::Rotation(q), vector(start.p)));
    s.body.setUToFitVelocity(state, SimTK::SpatialVec(vector(start.w), vector(start.v)));
    s.stepper.set(start.setting);
    s.stepper.start(s.system, state);
}

SimbodySystem::~SimbodySystem() = default;

void SimbodySystem::motion(double (&numbers)[13]) const {
    const Parts& s = *parts_;
    const SimTK::State& state = s.stepper.integrator->getState();
    s.system.realize(state, SimTK::Stage::Velocity);
    write_motion(s.body, state, numbers);
}

void SimbodySystem::set_velocities(const double* w, const double* v) {
    parts_->body.setUToFitVelocity(parts_->stepper.integrator->updAdvancedState(),
                                   SimTK::SpatialVec(vector(w), vector(v)));
    parts_->stepper.integrator->reinitialize(SimTK::Stage::Velocity, false);
}

void SimbodySystem::set_gravity(const double* gravity) {
    parts_->gravity.setGravityVector(parts_->stepper.integrator->updAdvancedState(), vector(gravity));
}

void SimbodySystem::apply(const double* force, const double* torque) {
    parts_->external_forces.setOneBodyForce(parts_->stepper.integrator->updAdvancedState(), parts_->body,
                                            SimTK::SpatialVec(vector(torque), vector(force)));
}

void SimbodySystem::step(double h) { parts_->stepper.step(parts_->system, h); }

double SimbodySystem::mass() const { return parts_->body.getBodyMass(parts_->stepper.integrator->getState()); }

void SimbodySystem::moments(double* three) const {
    const SimTK::State& state = parts_->stepper.integrator->getState();
    const SimTK::Vec3 unit = parts_->body.getBodyUnitInertiaAboutBodyOrigin(state).getMoments();
    for (int i = 0; i < 3; ++i) three[i] = mass() * unit[i];
}

std::string SimbodySystem::version() {
    int major = 0, minor = 0, patch = 0;
    SimTK_version_simbody(&major, &minor, &patch);
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

struct SimbodyMechanismSystem::Parts {
    explicit Parts(const double* acceleration)
        : gravity(forces, matter, vector(acceleration)), external_forces(forces, matter) {}

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter{system};
    SimTK::GeneralForceSubsystem forces{system};
    SimTK::Force::Gravity gravity;
    SimTK::Force::DiscreteForces external_forces;
    std::vector<SimTK::MobilizedBody> bodies;
    SettingIntegrator stepper;

    SimTK::MobilizedBody& at(int index) {
        return index < 0 ? matter.updGround() : bodies[static_cast<std::size_t>(index)];
    }
    SimTK::MobilizedBody make_mobilizer(const SimbodyJoint& joint, const SimTK::Body& body) {
        SimTK::MobilizedBody& parent = at(joint.parent);
        const SimTK::Transform out(rotation(joint.parent_frame), vector(joint.parent_point));
        const SimTK::Transform in(rotation(joint.child_frame), vector(joint.child_point));
        if (joint.type == "revolute") return SimTK::MobilizedBody::Pin(parent, out, body, in);
        if (joint.type == "prismatic") return SimTK::MobilizedBody::Slider(parent, out, body, in);
        if (joint.type == "spherical") return SimTK::MobilizedBody::Ball(parent, out, body, in);
        if (joint.type == "universal") return SimTK::MobilizedBody::Universal(parent, out, body, in);
        if (joint.type == "fixed") return SimTK::MobilizedBody::Weld(parent, out, body, in);
        return SimTK::MobilizedBody::Free(parent, body);
    }
    void add_loop(const SimbodyJoint& loop) {
        SimTK::MobilizedBody &first = at(loop.parent), &second = at(loop.child);
        SimTK::Constraint::Ball(first, vector(loop.parent_point), second, vector(loop.child_point));
        if (loop.type != "revolute") return;
        const SimTK::Rotation in_first = rotation(loop.parent_frame), in_second = rotation(loop.child_frame);
        for (const int across : {0, 1})
            SimTK::Constraint::ConstantAngle(first, SimTK::UnitVec3(in_first.col(across)), second,
                                             SimTK::UnitVec3(in_second.col(2)));
    }
};

SimbodyMechanismSystem::SimbodyMechanismSystem(const SimbodyMechanismStart& start)
    : parts_(std::make_unique<Parts>(start.gravity)) {
    Parts& s = *parts_;
    s.bodies.resize(start.links.size());
    for (const SimbodyJoint& joint : start.joints) {
        const SimbodyLink& link = start.links[static_cast<std::size_t>(joint.child)];
        s.bodies[static_cast<std::size_t>(joint.child)] = s.make_mobilizer(joint, rigid_body(link.mass, link.moments));
    }
    for (const SimbodyJoint& loop : start.loops) s.add_loop(loop);
    SimTK::State state = s.system.realizeTopology();
    s.system.realizeModel(state);
    // the children's positions and velocities depend on those of their parents
    for (const SimbodyJoint& joint : start.joints) {
        const double* n = start.links[static_cast<std::size_t>(joint.child)].motion;
        if (joint.type == "free")
            s.at(joint.child).setQToFitTransform(state, SimTK::Transform(rotation(n), vector(n + 7)));
        s.system.realize(state, SimTK::Stage::Position);
    }
    for (const SimbodyJoint& joint : start.joints) {
        s.system.realize(state, SimTK::Stage::Velocity);
        const double* n = start.links[static_cast<std::size_t>(joint.child)].motion;
        const SimTK::MobilizedBody& body = s.at(joint.child);
        const SimTK::MobilizedBody& parent = s.at(joint.parent);
        // velocity of the child's joint frame relative to the parent's, in the parent's joint frame
        const SimTK::Transform F = parent.getBodyTransform(state) * body.getInboardFrame(state);
        const SimTK::Vec3 arm = rotation(n) * vector(joint.child_point), w = vector(n + 4);
        const SimTK::Vec3 there = vector(n + 7) + arm, v = vector(n + 10) + w % arm;
        const SimTK::Vec3 w_parent = parent.getBodyAngularVelocity(state);
        const SimTK::Vec3 v_parent =
            parent.getBodyOriginVelocity(state) + w_parent % (there - parent.getBodyOriginLocation(state));
        body.setUToFitVelocity(state, SimTK::SpatialVec(~F.R() * (w - w_parent), ~F.R() * (v - v_parent)));
    }
    s.stepper.set(start.setting);
    s.stepper.start(s.system, state);
}

SimbodyMechanismSystem::~SimbodyMechanismSystem() = default;

void SimbodyMechanismSystem::motions(double* numbers) const {
    const Parts& s = *parts_;
    const SimTK::State& state = s.stepper.integrator->getState();
    s.system.realize(state, SimTK::Stage::Velocity);
    for (const SimTK::MobilizedBody& body : s.bodies) write_motion(body, state, numbers), numbers += 13;
}

void SimbodyMechanismSystem::apply(int body, const double* force, const double* torque) {
    parts_->external_forces.setOneBodyForce(parts_->stepper.integrator->updAdvancedState(), parts_->at(body),
                                            SimTK::SpatialVec(vector(torque), vector(force)));
}

void SimbodyMechanismSystem::step(double h) { parts_->stepper.step(parts_->system, h); }

}  // namespace polhode::engines
