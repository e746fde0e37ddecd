// A small engine that has the faults of a hypothesis and steps as game engines do: what known faults predict.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "check/hypothesis.h"
#include "integrators/game/gyroscopic_term.h"
#include "motion/problem.h"
#include "motion/world_loads.h"

namespace polhode {

/// What an update makes of the gyroscopic term and of the loads.
enum class RateUpdate {
    accurate,           ///< as good as can be: many small steps of order 4
    after_loads,        ///< the loads, then an explicit Euler step of the gyroscopic term
    implicit_newton,    ///< the loads, then one Newton step of the implicit one
    rescaled_momentum,  ///< the loads, then L + h L x w brought back to its length
    together,           ///< an explicit Euler step of both together
    midpoint,           ///< the explicit midpoint rule
    momentum,           ///< L in world axes by the loads, w by L and the old attitude
};

/// One step of a known kind of update.
struct UpdateRule {
    std::string_view name;     ///< for people: "semi-implicit Euler, gyroscopic term explicit"
    RateUpdate rate;           ///< of the angular velocity
    bool by_new_rate = true;   ///< the attitude turns by the rate after the step (semi-implicit), else by the old one
    bool first_order = false;  ///< q + (h/2) w q, normalised, in place of the exponential
};

/// The updates that are tried; the first is the accurate one.
std::span<const UpdateRule> update_rules();

/// The state of a modelled engine.
struct ModelState : BodyMotion<double> {
    Vector3<double> row_rate_W;  ///< angular velocity at the start of the row, rad/s; set by advance()
};

/// An engine that was given a cause's scene and has its faults.
class EngineModel {
  public:
    /// Throws InputError where the scene is none.
    explicit EngineModel(const Cause& cause);

    /// The scene's start as the engine was given it; impulses at t = 0 have acted.
    ModelState start() const;
    /// Goes on from t by dt (s) in `steps` steps of the rule; events in between end steps of their own. Positions
    /// follow the new velocities. Returns how much further they are than by the old ones: nothing where the rule is
    /// accurate.
    Vector3<double> advance(ModelState& state, double t, double dt, const UpdateRule& rule, int steps) const;

    /// w at time t brought to the engine's limit.
    void limit(ModelState& s, double t) const;

    /// Whether a rule makes sense for it by this number of steps per row: the momentum's has no gyroscopic term that
    /// could be missing, and with one step per row the first rate of a row is the rate of the step.
    bool takes(const UpdateRule& rule, int steps) const;
    /// Whether the attitude is rotated by the rate at the start of the row.
    bool uses_row_rate() const {
        return fault_.turned_by == TurnedBy::first_rate_of_row_w_in_world ||
               fault_.turned_by == TurnedBy::first_rate_of_row_w_in_body;
    }
    /// Whether an event of the scene falls in t < event <= t + dt.
    bool has_event(double t, double dt) const;
    const Problem& problem() const { return problem_; }
    const ExactBody<double>& body() const { return problem_.body; }

  private:
    EngineFault fault_;
    Problem problem_;
    BodyInertia<double> inertia_;
    Vector3<double> center_;      // of mass, from the body's origin, body axes, m
    std::vector<Window> pushes_;  // when torques and forces act

    // what acts on a state: torque in body axes, acceleration of the centre of mass in world axes
    struct Action {
        Vector3<double> torque_B, acceleration_W;
    };
    // what the engine takes for the tensor in body axes at an attitude
    BodyInertia<double> inertia(const Quaternion<double>& q) const;
    bool is_coasting(double t) const;
    Vector3<double> misdirected(const WorldLoads<double>& loads, double t, const ModelState& s,
                                const Matrix3<double>& A) const;
    Vector3<double> damped(const Vector3<double>& w, double t, double h) const;
    Action action(const WorldLoads<double>& loads, double t, const ModelState& s) const;
    Vector3<double> step(ModelState& s, const WorldLoads<double>& loads, double t, double h,
                         const UpdateRule& rule) const;
    Vector3<double> midpoint_step(ModelState& s, const WorldLoads<double>& loads, double t, double h) const;
    void small_step(ModelState& s, const WorldLoads<double>& loads, double t, double h) const;
    void go_on(ModelState& s, const WorldLoads<double>& loads, double t, double dt, const UpdateRule& rule, int steps,
               Vector3<double>& further) const;
    Vector3<double> turned(const BodyInertia<double>& inertia, const Vector3<double>& w, double h,
                           const UpdateRule& rule) const;
    void turn(ModelState& s, const Vector3<double>& rate_B, double h, bool first_order) const;
    Vector3<double> origin_error(const ModelState& s, const Vector3<double>& w_B, const Vector3<double>& dw_B) const;
    Vector3<double> translate(ModelState& s, const ModelState& old, const Vector3<double>& acceleration_W,
                              double h) const;
    void strike(ModelState& s, const Segment& segment) const;
    void place_at_pivot(ModelState& s) const;
};

}  // namespace polhode
