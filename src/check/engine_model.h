// A small engine with the faults of a hypothesis. It steps as game engines do and predicts the rows of a file.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "check/hypothesis.h"
#include "integrators/game/gyroscopic_term.h"
#include "motion/problem.h"
#include "motion/world_loads.h"

namespace polhode {

template <class P>
class FormulaTerms;

/// How an update integrates the gyroscopic term and the loads.
enum class RateUpdate {
    accurate,           ///< many small Runge-Kutta steps of order 4
    after_loads,        ///< the loads, then an explicit Euler step of the gyroscopic term
    implicit_newton,    ///< the loads, then one Newton step of the implicit gyroscopic term
    rescaled_momentum,  ///< the loads, then L + h L x w rescaled to the length of L
    together,           ///< one explicit Euler step of loads and gyroscopic term
    midpoint,           ///< the explicit midpoint rule
    momentum,           ///< L in world axes from the loads, w from L and the old attitude
};

/// A known kind of update.
struct UpdateRule {
    std::string_view name;     ///< for users: "semi-implicit Euler with an explicit gyroscopic term"
    RateUpdate rate;           ///< update of the angular velocity
    bool by_new_rate = true;   ///< rotate by the new rate (semi-implicit), else by the old one
    bool first_order = false;  ///< use q + (h/2) w q, normalised, instead of the exponential
};

/// The updates that are tested. The first is RateUpdate::accurate.
std::span<const UpdateRule> update_rules();

/// The state of a modelled engine.
struct ModelState : BodyMotion<double> {
    Vector3<double> row_rate_W;  ///< angular velocity at the start of the row, rad/s; set by advance()
};

/// The loads that act on the engine's body at a time.
struct EngineLoads : WorldLoads<double> {
    using WorldLoads<double>::WorldLoads;

    const FormulaTerms<double>* formulas = nullptr;  ///< nullptr: no load is a formula
    double row_start = 0;                            ///< time at the start of the row, s
    ModelState at_row_start = {};                    ///< the state at the start of the row
};

/// An engine that runs the scene of a cause with the faults of the cause.
class EngineModel {
  public:
    /// Throws InputError if the scene is invalid.
    explicit EngineModel(const Cause& cause);

    /// Returns the engine's initial state, after impulses at t = 0.
    ModelState start() const;
    /// Advances from t by dt (s) in `steps` steps of the rule. An event splits this interval; each part takes `steps`
    /// steps. Positions use the new velocities. Returns the difference to positions by the old velocities, m; zero
    /// for the accurate rule.
    Vector3<double> advance(ModelState& state, double t, double dt, const UpdateRule& rule, int steps) const;

    /// Applies the engine's speed limit to w at time t.
    void limit(ModelState& s, double t) const;

    /// Whether the engine can use a rule with this number of steps per row. For example, RateUpdate::momentum has no
    /// gyroscopic term that could be missing, and with one step per row the row's first rate is the rate of the step.
    bool supports(const UpdateRule& rule, int steps) const;
    /// Whether the attitude is rotated by the rate at the start of the row.
    bool uses_row_rate() const {
        return fault_.rotation_rate == AttitudeRate::first_rate_of_row_w_in_world ||
               fault_.rotation_rate == AttitudeRate::first_rate_of_row_w_in_body;
    }
    /// Whether an event of the scene falls in t < event <= t + dt.
    bool has_event(double t, double dt) const;
    const Problem& problem() const { return problem_; }
    const ExactBody<double>& body() const { return problem_.body; }

  private:
    EngineFault fault_;
    Problem problem_;
    BodyInertia<double> inertia_;
    Vector3<double> center_;      // centre of mass from the body's origin, body axes, m
    std::vector<Window> pushes_;  // windows of torques and forces
    // the formulas that act in each segment; nullptr: no load is a formula
    std::shared_ptr<const std::vector<FormulaTerms<double>>> formulas_;

    // torque in body axes and acceleration of the centre of mass in world axes
    struct Action {
        Vector3<double> torque_B, acceleration_W;
    };
    // the tensor that the engine uses at an attitude, converted to body axes
    BodyInertia<double> inertia(const Quaternion<double>& q) const;
    bool is_coasting(double t) const;
    Vector3<double> torque_error(const EngineLoads& loads, double t, const ModelState& s,
                                 const Matrix3<double>& A) const;
    Vector3<double> apply_damping(const Vector3<double>& w, double t, double h) const;
    void enter(std::size_t segment, EngineLoads& loads) const;
    void add_formulas(const EngineLoads& loads, double t, const ModelState& s, Action& action) const;
    Action action(const EngineLoads& loads, double t, const ModelState& s) const;
    Vector3<double> step(ModelState& s, const EngineLoads& loads, double t, double h, const UpdateRule& rule) const;
    Vector3<double> midpoint_step(ModelState& s, const EngineLoads& loads, double t, double h) const;
    void small_step(ModelState& s, const EngineLoads& loads, double t, double h) const;
    void advance_segment(ModelState& s, const EngineLoads& loads, double t, double dt, const UpdateRule& rule,
                         int steps, Vector3<double>& position_difference) const;
    Vector3<double> apply_gyroscopic_term(const BodyInertia<double>& inertia, const Vector3<double>& w, double h,
                                          const UpdateRule& rule) const;
    void rotate_attitude(ModelState& s, const Vector3<double>& rate_B, double h, bool first_order) const;
    Vector3<double> origin_error(const ModelState& s, const Vector3<double>& w_B, const Vector3<double>& dw_B) const;
    Vector3<double> translate(ModelState& s, const ModelState& old, const Vector3<double>& acceleration_W,
                              double h) const;
    void apply_impulses(ModelState& s, const Segment& segment) const;
    void place_at_pivot(ModelState& s) const;
};

}  // namespace polhode
