#include "integrators/engines/drivers/simbody_world.h"

#include <Simbody.h>

#include <cmath>

namespace polhode::engines {
namespace {

SimTK::Vec3 vector(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

struct SimbodySystem::Parts {
    explicit Parts(const SimbodyStart& start)
        : gravity(forces, matter, vector(start.gravity)), pushes(forces, matter) {}

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter{system};
    SimTK::GeneralForceSubsystem forces{system};
    SimTK::Force::Gravity gravity;
    SimTK::Force::DiscreteForces pushes;
    SimTK::MobilizedBody mobile;
    std::unique_ptr<SimTK::Integrator> integrator;
    bool goes_by_h = false, is_gazebos = false;
    double time = 0, h = 1;

    // An integrator takes its fixed step when it starts: another step is another integrator.
    void start(const SimTK::State& state) {
        if (is_gazebos)
            integrator = std::make_unique<SimTK::SemiExplicitEuler2Integrator>(system);
        else
            integrator = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
        if (goes_by_h) integrator->setFixedStepSize(h);
        integrator->initialize(state);
    }
};

SimbodySystem::SimbodySystem(const SimbodyStart& start) : parts_(std::make_unique<Parts>(start)) {
    Parts& s = *parts_;
    const double* I = start.moments;
    const SimTK::Body::Rigid rigid(SimTK::MassProperties(start.mass, SimTK::Vec3(0), SimTK::Inertia(I[0], I[1], I[2])));
    if (start.pivoted)
        s.mobile = SimTK::MobilizedBody::Ball(s.matter.Ground(), SimTK::Transform(), rigid,
                                              SimTK::Transform(vector(start.pivot)));
    else
        s.mobile = SimTK::MobilizedBody::Free(s.matter.Ground(), rigid);
    SimTK::State state = s.system.realizeTopology();
    const SimTK::Quaternion q(start.q[0], start.q[1], start.q[2], start.q[3]);
    s.mobile.setQToFitTransform(state, SimTK::Transform(SimTK::Rotation(q), vector(start.p)));
    s.mobile.setUToFitVelocity(state, SimTK::SpatialVec(vector(start.w), vector(start.v)));
    s.is_gazebos = start.setting == "gazebo", s.goes_by_h = start.setting == "best";
    s.start(state);
}

SimbodySystem::~SimbodySystem() = default;

void SimbodySystem::motion(double (&numbers)[13]) const {
    const Parts& s = *parts_;
    const SimTK::State& state = s.integrator->getState();
    s.system.realize(state, SimTK::Stage::Velocity);
    const SimTK::Quaternion q = s.mobile.getBodyRotation(state).convertRotationToQuaternion();
    for (int i = 0; i < 4; ++i) numbers[i] = q[i];
    for (int i = 0; i < 3; ++i) {
        numbers[4 + i] = s.mobile.getBodyAngularVelocity(state)[i];
        numbers[7 + i] = s.mobile.getBodyOriginLocation(state)[i];
        numbers[10 + i] = s.mobile.getBodyOriginVelocity(state)[i];
    }
}

void SimbodySystem::set_velocities(const double* w, const double* v) {
    parts_->mobile.setUToFitVelocity(parts_->integrator->updAdvancedState(), SimTK::SpatialVec(vector(w), vector(v)));
    parts_->integrator->reinitialize(SimTK::Stage::Velocity, false);
}

void SimbodySystem::set_gravity(const double* gravity) {
    parts_->gravity.setGravityVector(parts_->integrator->updAdvancedState(), vector(gravity));
}

void SimbodySystem::apply(const double* force, const double* torque) {
    parts_->pushes.setOneBodyForce(parts_->integrator->updAdvancedState(), parts_->mobile,
                                   SimTK::SpatialVec(vector(torque), vector(force)));
}

void SimbodySystem::step(double h) {
    Parts& s = *parts_;
    if (s.goes_by_h && !(std::abs(h / s.h - 1) < 1e-6)) {
        s.h = h;
        const SimTK::State state = s.integrator->getAdvancedState();
        s.start(state);
    }
    s.time += h;
    s.integrator->stepTo(s.time, s.time);
}

double SimbodySystem::mass() const { return parts_->mobile.getBodyMass(parts_->integrator->getState()); }

void SimbodySystem::moments(double* three) const {
    const SimTK::State& state = parts_->integrator->getState();
    const SimTK::Vec3 unit = parts_->mobile.getBodyUnitInertiaAboutBodyOrigin(state).getMoments();
    for (int i = 0; i < 3; ++i) three[i] = mass() * unit[i];
}

std::string SimbodySystem::version() {
    int major = 0, minor = 0, patch = 0;
    SimTK_version_simbody(&major, &minor, &patch);
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace polhode::engines
