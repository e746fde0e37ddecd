// Updates of game engines and of texts on them that do not belong to the gyroscopic updates (gyroscopic.cpp):
// MomentumUpdate, DampedImplicitUpdate, MujocoRungeKutta and the position-based update of position_based.h.
//
// Each is a step of length h from q (body to world), w, x and v; R = R(q), I_W = R I R^T, tau and F at the old state.
#include <span>

#include "body/orientation.h"
#include "integrators/game/engine_state.h"
#include "integrators/game/position_based.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

/// L += h tau,  w = I_W^-1 L at the old attitude,  q = exp(h w) q.  The reported w uses the new attitude.
template <class S>
class MomentumUpdate : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::inertia_, Base::steps_;

  public:
    explicit MomentumUpdate(const Problem& problem) : Base(problem) { update_momentum(); }
    void restart() {
        Base::restart();
        update_momentum();
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        if (!segment.impulses.empty()) update_momentum();
    }
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(q_);
        const Vector3<S> acceleration = this->acceleration_W(R);
        L_ = L_ + h * this->torque_W(t, R);
        w_ = rate(R);
        this->rotate_attitude(h);
        w_ = rate(rotation_matrix(q_));
        this->translate(h, acceleration);
        this->move_to_pivot();
        ++steps_;
    }
    long rhs_evaluations() const { return steps_; }

  private:
    Vector3<S> rate(const Matrix3<S>& R) const { return R * (inertia_.inverse * (transposed(R) * L_)); }
    void update_momentum() {
        const Matrix3<S> R = rotation_matrix(q_);
        L_ = R * (inertia_.tensor * (transposed(R) * w_));
    }

    Vector3<S> L_;  ///< world axes
};

/// Drag and the gyroscopic term in one Newton step in body axes, where D is the drag matrix and tau includes the
/// drag:
///   (I + h D + h (skew(w) I - skew(I w))) (w' - w) = h (tau - w x I w),   v' - v = h a / (1 + h k)
template <class S>
class DampedImplicitUpdate : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::v_, Base::inertia_, Base::loads_, Base::steps_;

  public:
    using Base::Base;
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(q_), back = transposed(R);
        const Vector3<S> w = back * w_, L = inertia_.tensor * w, torque = back * this->torque_W(t, R);
        Vector3<S> acceleration = this->acceleration_W(R);
        const Forcing<S>& forcing = loads_.forcing();
        Matrix3<S> J = skew(w) * inertia_.tensor;
        const Matrix3<S> skew_L = skew(L);
        for (int i = 0; i < 3; ++i) {
            J[i] = J[i] - skew_L[i];
            if (forcing.has_damping) J[i] = J[i] + forcing.damping[i];
            J[i] = h * J[i];
        }
        J = inertia_.inverse * J;
        for (int i = 0; i < 3; ++i) J[i][i] += 1;
        w_ = R * (w + inverse(J) * (h * (inertia_.inverse * (torque + cross(L, w)))));
        this->rotate_attitude(h);
        if (forcing.has_translational_drag) acceleration = (S(1) / (S(1) + h * forcing.specific_drag)) * acceleration;
        this->translate(h, acceleration);
        this->move_to_pivot();
        ++steps_;
    }
    long rhs_evaluations() const { return steps_; }
};

/// The classical Runge-Kutta method for the velocities. The attitudes of the stages and of the step each result from
/// one exponential of body rates, which are added as if they were vectors:
///   q_i = q exp(h a_i w_{i-1}),  w_i = w + h a_i f_{i-1},  q' = q exp(h sum b_i w_i),  w' = w + h sum b_i f_i
template <class S>
class MujocoRungeKutta : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::x_, Base::v_, Base::inertia_, Base::steps_;

  public:
    using Base::Base;
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Quaternion<S> q = q_;
        const Vector3<S> x = x_, v = v_, w = rotate_back(q_, w_);
        constexpr S along[4] = {0, S(0.5), S(0.5), 1}, weight[4] = {S(1) / 6, S(1) / 3, S(1) / 3, S(1) / 6};
        Vector3<S> rate, change, speed, acceleration;  // values of the previous stage
        Vector3<S> mean_rate, mean_change, mean_speed, mean_acceleration;
        for (int i = 0; i < 4; ++i) {
            const S part = h * along[i];
            set_stage_state(q, w, x, v, part, rate, change, speed, acceleration);
            const Matrix3<S> R = rotation_matrix(q_);
            rate = transposed(R) * w_, speed = v_;
            const Vector3<S> torque = transposed(R) * this->torque_W(t + along[i] * step, R);
            change = inertia_.inverse * (torque + cross(inertia_.tensor * rate, rate));
            acceleration = this->acceleration_W(R);
            mean_rate = mean_rate + weight[i] * rate, mean_change = mean_change + weight[i] * change;
            mean_speed = mean_speed + weight[i] * speed;
            mean_acceleration = mean_acceleration + weight[i] * acceleration;
        }
        set_stage_state(q, w, x, v, h, mean_rate, mean_change, mean_speed, mean_acceleration);
        ++steps_;
    }
    long rhs_evaluations() const { return 4 * steps_; }

  private:
    // Sets the state a time `part` after (q, w, x, v), at these rates; w in body axes.
    void set_stage_state(const Quaternion<S>& q, const Vector3<S>& w, const Vector3<S>& x, const Vector3<S>& v, S part,
                         const Vector3<S>& rate, const Vector3<S>& change, const Vector3<S>& speed,
                         const Vector3<S>& acceleration) {
        q_ = normalized(q * quaternion_from_rotation_vector(part * rate));
        w_ = rotate(q_, w + part * change);
        x_ = x + part * speed, v_ = v + part * acceleration;
        this->move_to_pivot();
    }
};

template <class Update>
Trajectory solve_engine_update(const Problem& problem, const Settings& settings) {
    return march<Update>(problem, settings);
}

// v+ = v - c v+ - s theta, theta+ = theta + v+.
double damped_pendulum_growth(double c, double s) {
    const double factor = 1 / (1 + c);
    return spectral_radius(1 - s * factor, factor, -s * factor, factor);
}

constexpr Method engine_update_variants[] = {
    {.name = "momentum_exponential_map",
     .documentation =
         "A first-order step whose state is the angular momentum in world axes, L += h tau. w = I_W^-1 L at the "
         "old attitude rotates the body by exp(h w). A free body keeps L exactly. No gyroscopic term is needed, "
         "unlike in updates whose state is w in world axes. Order 1.",
     .source = "D. Baraff 1997, Physically Based Modeling, SIGGRAPH course notes (L as the state)",
     .conserves = "|q|; L if no torque acts",
     .solve = solve_engine_update<MomentumUpdate<double>>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification},
    {.name = "damped_implicit",
     .documentation =
         "`gyroscopic_implicit` with drag in the same Newton step, (I + h D + h (skew(w) I - skew(I w))) dw = h "
         "(tau - w x I w). Without drag the two methods are identical. Stiff drag does not blow up. This is the "
         "step of MuJoCo's `implicit` and, from 3.11 on, `implicitfast`, for a free body whose frame origin is its "
         "centre of mass. For other origins MuJoCo solves for the velocity of the origin, which adds the "
         "derivative of the centripetal force. Order 1.",
     .source = "Google DeepMind, MuJoCo, integrators implicit and implicitfast (mj_implicitSkip, mjd_freeMhat)",
     .conserves = "|q|",
     .solve = solve_engine_update<DampedImplicitUpdate<double>>,
     .pendulum_amplification = damped_pendulum_growth},
    {.name = "mujoco_rk4",
     .documentation =
         "The classical Runge-Kutta method for the velocities in body axes, with the attitude by one exponential "
         "of the weighted mean of the stages' rates. The rates are added as vectors, although each belongs to a "
         "different attitude. Quantities that do not depend on the attitude, such as w and the energy of a free "
         "body, have order 4. The attitude has order 2.",
     .source = "Google DeepMind, MuJoCo, integrator RK4 (mj_RungeKutta)",
     .conserves = "|q|",
     .order = 2,
     .solve = solve_engine_update<MujocoRungeKutta<double>>,
     .amplification = classical_amplification},
    {.name = "xpbd_rigid",
     .documentation =
         "A substep of extended position-based dynamics. The body moves with its velocities, a pivot corrects position "
         "and attitude, and the new velocities are the displacements divided by h. For a free body each step reduces w "
         "by the relative amount (h |w|)^2 / 8. Rounding adds 2^-53 |x| / h to v (2^-24 |x| / h in binary32), so very "
         "short steps increase the error. If an event leaves less than 1/64 of a step, this remainder keeps the "
         "velocities and does not correct the pivot. Order 1.",
     .source = "M. Mueller, M. Macklin, N. Chentanez, S. Jeschke, T.-Y. Kim 2020, Detailed Rigid Body Simulation with "
               "Extended Position Based Dynamics, Computer Graphics Forum 39(8), algorithm 2",
     .conserves = "|q|",
     .solve = solve_position_based<double>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification},
};

constexpr auto engine_update_binary64_family = apply_defaults(
    {.control = Control::fixed_step, .order = 1, .family = Family::engine_update, .formulation = Formulation::full},
    engine_update_variants);

constexpr auto engine_update_family =
    with_binary32<engine_update_binary64_family, binary32_refusal, solve_engine_update<MomentumUpdate<float>>,
                  solve_engine_update<DampedImplicitUpdate<float>>, solve_engine_update<MujocoRungeKutta<float>>,
                  solve_position_based<float>>();

}  // namespace

extern const std::span<const Method> engine_updates_methods{engine_update_family};

}  // namespace polhode
