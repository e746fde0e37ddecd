// Extended position-based dynamics of a rigid body: M. Mueller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim 2020,
// Detailed Rigid Body Simulation with Extended Position Based Dynamics, Computer Graphics Forum 39(8).
#pragma once

#include <optional>

#include "body/orientation.h"
#include "integrators/game/engine_state.h"
#include "motion/problem.h"

namespace polhode {

/// A substep of the paper's algorithm 2: unconstrained update, then the constraint (equations 2 to 9, without
/// compliance), then velocities from the change of position.
///   v += h a,  x += h v,  w += h I_W^-1 (tau - w x I_W w),  q += (h/2) (0, w) q
///   pivot:  c = x + r,  r = R arm,  n = c/|c|,  lambda = -|c| / (1/m + (r x n) . I_W^-1 (r x n)),
///           x += lambda n / m,  q += (1/2) (0, I_W^-1 (r x lambda n)) q
///   v = (x - x_old) / h,  w = +-2 vec(q q_old*) / h
/// Rounding and previous pivot errors are divided by h too. The paper's steps have equal lengths. Here an event can
/// leave a remainder of only a rounding error, over which a body that has not moved would lose all its velocity.
template <class S>
class PositionBasedUpdate : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::x_, Base::v_, Base::inertia_, Base::problem_, Base::steps_;

  public:
    /// `arm`: pivot relative to the centre of mass, body axes, m. `step`: length of a step without events, s.
    PositionBasedUpdate(const Problem& problem, const std::optional<Vector3<double>>& arm, double step)
        : Base(problem), min_step_(step / 64) {
        if (arm) arm_ = cast<S>(*arm);
    }
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Quaternion<S> q = q_;
        const Vector3<S> x = x_;
        const Matrix3<S> R = rotation_matrix(q_);
        const Vector3<S> w = transposed(R) * w_, torque = transposed(R) * this->torque_W(t, R);
        this->translate(h, this->acceleration_W(R));
        w_ = w_ + h * (R * (inertia_.inverse * (torque + cross(inertia_.tensor * w, w))));
        this->rotate_first_order(h);
        ++steps_;
        if (step < min_step_) return;
        if (arm_) solve_pivot();
        v_ = (S(1) / h) * (x_ - x);
        const Quaternion<S> change = q_ * conjugate(q);
        w_ = ((change.w < 0 ? S(-2) : S(2)) / h) * vector_part(change);
    }
    long rhs_evaluations() const { return steps_; }

  private:
    void solve_pivot() {
        const Matrix3<S> R = rotation_matrix(q_);
        const Vector3<S> r = R * *arm_, c = x_ + r;
        const S distance = hypotenuse(c);
        if (!(distance > 0)) return;
        const Vector3<S> n = (S(1) / distance) * c, lever = cross(r, n);
        const Vector3<S> angular_response = R * (inertia_.inverse * (transposed(R) * lever));
        const S inverse_mass = S(1 / problem_->body.mass),
                lambda = -distance / (inverse_mass + dot(lever, angular_response));
        x_ = x_ + (lambda * inverse_mass) * n;
        w_ = lambda * angular_response;  // as a rotation in unit time
        this->rotate_first_order(1);
    }

    std::optional<Vector3<S>> arm_;
    double min_step_;  ///< s; shorter steps keep their velocities and leave the pivot to the next step
};

/// The body keeps all its coordinates, and the pivot is a constraint.
template <class S>
Trajectory solve_position_based(const Problem& problem, const Settings& settings) {
    using Arm = std::optional<Vector3<double>>;
    const double step = longest_step(problem, settings);
    if (!problem.body.pivoted) return march<PositionBasedUpdate<S>>(problem, settings, Arm(), step);
    Scene free = problem.scene;
    free.pivot.reset();
    free.initial.position_W = problem.body.position_W, free.initial.velocity_W = problem.body.velocity_W;
    const Arm arm = *problem.scene.pivot - free.body.center_of_mass;
    return march<PositionBasedUpdate<S>>(pose(free, Formulation::full), settings, arm, step);
}

}  // namespace polhode
