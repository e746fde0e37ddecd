// Common part of the engine drivers: the protocol, and the loop over a request's steps.
//
// A driver provides an EngineWorld: the engine with one body, created for each run.
#pragma once

#include <chrono>
#include <cmath>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "integrators/engines/drivers/mechanism_run.h"
#include "integrators/engines/engine_request.h"
#include "integrators/run/march.h"
#include "motion/world_loads.h"

namespace polhode::engines {

/// A body to be created in an engine. Its origin is its centre of mass and its axes are its principal axes.
struct Body {
    double mass;                               ///< kg
    Vector3<double> moments;                   ///< kg m^2
    Quaternion<double> q;                      ///< body to world
    Vector3<double> w, p, v;                   ///< world axes, rad/s, m, m/s
    Vector3<double> gravity;                   ///< world axes, at t = 0, m/s^2
    std::optional<Vector3<double>> pivot;      ///< point fixed at the world's origin by a ball joint, body axes, m
    std::vector<Plane> planes;                 ///< unit normals
    std::vector<EngineShape> shapes;           ///< shapes that touch the planes, body axes
    std::string setting;                       ///< one of Driver::settings
    std::optional<EngineFormulas> formulas{};  ///< loads given by formulas
};

/// Half the thickness of the cylinder that represents a disc, m.
inline double disc_half_height(const EngineShape& disc) { return 1e-3 * disc.radius; }

/// Thrown by a World for scenes that its engine cannot represent.
struct Unsupported : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// An engine with one body.
template <class World>
concept EngineWorld = std::constructible_from<World, const Body&> &&
    requires(World world, const World view, const Vector3<double>& vector, double h) {
    { view.motion() } -> std::same_as<Motion>;
    world.set_velocities(vector, vector);  // sets w and v after an impulse
    world.set_gravity(vector);
    world.apply(vector, vector);  // force at the centre of mass and torque, for one step
    world.step(h);
    { view.mass() } -> std::convertible_to<double>;
    { view.moments() } -> std::convertible_to<Vector3<double>>;
};

/// Information about a driver's engine.
struct Driver {
    std::string engine, version, precision;
    std::vector<std::pair<std::string, std::string>> settings;
    std::vector<std::string> joints{}, loops{};  ///< types of joints that it supports
    std::vector<std::string> shapes{};           ///< types of shapes that it supports on planes
    bool contacts = false;                       ///< supports balls that touch each other and planes
    std::vector<std::string> laws{};             ///< laws of joints that it supports; see README.md
};

/// A request as read by a driver.
struct Request {
    Problem problem;  ///< problem of the free body
    Settings settings;
    Body body;
};

/// The result of a request.
struct Run {
    Trajectory trajectory;
    EngineReadback readback;
};

/// Reads requests from standard input and writes answers to descriptor 3 until the input ends. Returns the exit code.
int serve(const Driver& driver, const std::function<Run(const Request&)>& run,
          const std::function<MechanismRun(const MechanismRequest&)>& run_mechanism = {});

/// Runs a World as a Stepper (run/march.h).
template <EngineWorld World>
class WorldStepper {
  public:
    WorldStepper(const Problem& problem, const Body& body, EngineReadback* readback)
        : problem_(&problem), body_(&body), readback_(readback), loads_(problem) {}

    void restart() {
        const Stopwatch stopwatch;
        enter_loads(problem_->segments.front());
        Body body = *body_;
        body.gravity = gravity_;
        world_ = std::make_unique<World>(body);
        if (body_->formulas) formulas_.emplace(*body_->formulas, no_joints_);
        const Motion initial = world_->motion();
        *readback_ = {world_->mass(), world_->moments(), initial.q, initial.w, initial.p, initial.v};
        steps_ = 0, ++worlds_, setup_seconds_ += stopwatch.seconds();
    }
    void enter(const Segment& segment) {
        enter_loads(segment);
        world_->set_gravity(gravity_);
        if (segment.impulses.empty()) return;
        const Motion at = world_->motion();
        const Matrix3<double> R = rotation_matrix(normalized(at.q));
        Vector3<double> angular_impulse, v = at.v;
        WorldLoads<double>::apply_impulses(*problem_, segment, R, at.p, angular_impulse, v);
        const Vector3<double> change = transposed(R) * angular_impulse;
        Vector3<double> change_of_w;
        for (int i = 0; i < 3; ++i) change_of_w[i] = change[i] / body_->moments[i];
        world_->set_velocities(at.w + R * change_of_w, v);
    }
    void step(double t, double h) {
        if (has_loads_ || formulas_) {
            const Motion at = world_->motion();
            BodyLoad sum;
            if (has_loads_) {
                const Quaternion<double> q = normalized(at.q);
                const Matrix3<double> R = rotation_matrix(q);
                sum.force = body_->mass * (loads_.acceleration_W(R, at.v) - gravity_);
                sum.torque = loads_.torque_W(
                    t, R, [&] { return q; }, at.w, at.p, at.v);
            }
            if (formulas_) {
                const BodyLoad& load = formulas_->evaluate(t, h, {at}).front();
                sum.force = sum.force + load.force, sum.torque = sum.torque + load.torque;
            }
            world_->apply(sum.force, sum.torque);
        }
        world_->step(h);
        ++steps_;
    }
    Sample sample(double t) const {
        const Motion at = world_->motion();
        return {t, at.q, rotate_back(normalized(at.q), at.w), at.p, at.v};
    }
    bool finite() const {
        const Motion at = world_->motion();
        return all_finite(at.w, at.p, at.v) && all_finite(at.q);
    }
    long rhs_evaluations() const { return steps_; }
    /// Subtracts the time for creating worlds, which is not integration time.
    void report(Trajectory& trajectory) const { trajectory.seconds -= setup_seconds_ / static_cast<double>(worlds_); }

  private:
    // gravity is set in the engine; all other loads are applied as external forces
    void enter_loads(const Segment& segment) {
        loads_.enter(segment);
        gravity_ = {};
        has_loads_ = false;
        for (const Load& load : problem_->scene.loads) {
            if (std::holds_alternative<Impulse>(load) || !acts(window_of(load), segment.begin)) continue;
            if (const Gravity* gravity = std::get_if<Gravity>(&load))
                gravity_ = gravity_ + gravity->acceleration_W;
            else
                has_loads_ = true;
        }
    }

    const Problem* problem_;
    const Body* body_;
    EngineReadback* readback_;
    WorldLoads<double> loads_;
    std::unique_ptr<World> world_;
    Mechanism no_joints_{};
    std::optional<FormulaLoads> formulas_;
    Vector3<double> gravity_;
    bool has_loads_ = false;
    long steps_ = 0, worlds_ = 0;
    double setup_seconds_ = 0;
};

/// Runs a request for one body.
template <EngineWorld World>
Run march_world(const Request& request) {
    Run run;
    run.trajectory = march<WorldStepper<World>>(request.problem, request.settings, request.body, &run.readback);
    return run;
}
/// Serves requests for one body and for several, each with a new world.
template <EngineWorld World, MechanismWorld Several>
int serve(const Driver& driver) {
    return serve(driver, march_world<World>, march_mechanism<Several>);
}

/// Converts an engine's vector of double or float.
template <class V>
Vector3<double> vector_of(const V& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace polhode::engines
