// Updates of game engines that differ only in their treatment of the gyroscopic term w x I w.
//
// A step of length h, semi-implicit Euler with q (body to world), w, x and v in world axes:
//   1. loads at the old state:  w += h I_W^-1 tau,  v += h F / m,  I_W^-1 = R I^-1 R^T
//   2. gyroscopic term, with w_B = R^T w transformed to body axes and back:
//        none                nothing
//        explicit            w_B -= h I^-1 (w_B x I w_B)
//        implicit            one Newton step from w_B for  I (w - w_B) + h w x I w = 0:
//                            J = I + h (skew(w_B) I - skew(I w_B)),  w_B -= J^-1 (h w_B x I w_B)
//        linearly implicit   (I - h skew(I w0)) w = I w0: the new w rotates the momentum at the start of the step
//        midpoint            the implicit midpoint rule of this term alone, by Newton's iteration:
//                            I (w - w_B) + h m x I m = 0,  m = (w + w_B)/2
//        rescaled momentum   L = I w_B,  L' = L + h L x w_B,  w_B = I^-1 L' |L| / |L'|
//   3. attitude by the new w:   q = exp(h w) q,  or  q += (h/2) (0, w) q  normalised;  x += h v
// With a pivot, w, tau and I are about the pivot, and x, v follow from q, w.
#include <span>

#include "integrators/game/engine_state.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

enum class AttitudeUpdate { exponential, first_order };

/// `substeps`: number of substeps of the gyroscopic term and the attitude, each with an equal part of the change due to
/// loads.
template <GyroscopicTerm term, AttitudeUpdate attitude_update, int substeps, class S>
class GyroscopicUpdate : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::inertia_, Base::steps_;

  public:
    using Base::Base;
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step) / substeps;
        Matrix3<S> R = rotation_matrix(q_);
        const Vector3<S> torque = this->torque_W(t, R), acceleration = this->acceleration_W(R);
        for (int substep = 0; substep < substeps; ++substep) {
            if (substep > 0) R = rotation_matrix(q_);
            const Matrix3<S> back = transposed(R);
            w_ = w_ + h * (R * (inertia_.inverse * (back * torque)));
            if constexpr (term != GyroscopicTerm::none)
                w_ = R * inertia_.template apply_gyroscopic_term<term>(back * w_, h);
            if constexpr (attitude_update == AttitudeUpdate::exponential)
                this->rotate_attitude(h);
            else
                this->rotate_first_order(h);
            this->translate(h, acceleration);
        }
        this->move_to_pivot();
        ++steps_;
    }
    long rhs_evaluations() const { return steps_; }
};

template <GyroscopicTerm term, AttitudeUpdate attitude_update = AttitudeUpdate::exponential, int substeps = 1,
          class S = double>
Trajectory solve_gyroscopic(const Problem& problem, const Settings& settings) {
    return march<GyroscopicUpdate<term, attitude_update, substeps, S>>(problem, settings);
}

// a = -c v - s theta, v+ = v + a, theta+ = theta + the mean of v + a/4, v + 2a/4, v + 3a/4 and v + a.
double substepped_pendulum_growth(double c, double s) {
    constexpr double share = 0.625;
    return spectral_radius(1 - share * s, 1 - share * c, -s, 1 - c);
}

constexpr std::string_view catto_source = "E. Catto 2015, Numerical Methods, Game Developers Conference";

constexpr Method gyroscopic_variants[] = {
    {.name = "gyroscopic_none",
     .documentation =
         "The semi-implicit step of game engines without a gyroscopic term: only loads change w in world axes, then q "
         "= exp(h w) q. For bodies with unequal moments it converges, with order 1, to I_W dw/dt = tau, which is a "
         "different motion: a free body spins indefinitely about an axis fixed in body and world. Godot, cannon-es and "
         "Havok's web build use it; Jolt, PhysX and Unity use it by default.",
     .conserves = "|q|; w in world axes, not L, if no torque acts",
     .solve = solve_gyroscopic<GyroscopicTerm::none>},
    {.name = "gyroscopic_explicit",
     .documentation =
         "The gyroscopic term by an explicit Euler step in body axes, w -= h I^-1 (w x I w). For a free body every "
         "step adds h^2/2 (dw/dt . I dw/dt) to the energy, so that a tumbling body spins up until it diverges. An "
         "option of Bullet; Chrono, DART and MuJoCo's Euler use the same update. Order 1.",
     .source = "the sources of the engines named; D. Baraff & A. Witkin 1997 for the equation",
     .solve = solve_gyroscopic<GyroscopicTerm::explicit_euler>},
    {.name = "gyroscopic_implicit",
     .documentation =
         "The gyroscopic term by an implicit Euler step in body axes, I (w - w0) + h w x I w = 0, solved by one "
         "Newton step from w0. A free tumbling body loses energy until it rotates about the axis of its largest "
         "moment, and its momentum decreases. Bullet's default; Box3D and MuJoCo's implicit integrators use the "
         "same update. Order 1.",
     .source = catto_source,
     .solve = solve_gyroscopic<GyroscopicTerm::one_newton_step>},
    {.name = "gyroscopic_rescaled_momentum",
     .documentation =
         "The angular momentum in body axes by an explicit Euler step, L + h L x w, rescaled to its previous "
         "length. The momentum neither grows nor decays: a free body keeps |L|, but not L. Its energy is bounded "
         "and in the long run approaches that of rotation about the middle axis, |L|^2 / (2 I_2). Jolt and PhysX "
         "use it if their gyroscopic forces are enabled. Order 1.",
     .source = "J. Rouwe, Jolt Physics, MotionProperties::ApplyGyroscopicForceInternal; NVIDIA PhysX 5",
     .conserves = "|q|; |L|, not L, if no torque acts",
     .solve = solve_gyroscopic<GyroscopicTerm::rescaled_momentum>},
    {.name = "gyroscopic_linearly_implicit",
     .documentation =
         "The gyroscopic term with the momentum at the start of the step and the new w, (I - h skew(I w0)) w = I "
         "w0, one linear system. A free body loses the energy (w - w0) . I (w - w0) / 2 per step, for any step "
         "size. The term of ODE 0.16, which rotates the body by the first-order quaternion update unless finite "
         "rotations are enabled. Order 1.",
     .source = "C. Lacoursière 2006, Stabilizing gyroscopic forces in rigid multibody simulations, UMINF 06.05",
     .solve = solve_gyroscopic<GyroscopicTerm::linearly_implicit>},
    {.name = "midpoint_gyroscopic",
     .documentation =
         "The gyroscopic term by the implicit midpoint rule in body axes, its equations solved to rounding. The "
         "term then conserves energy and |L| for any step, but hardly reduces the attitude error. Used by MuJoCo's "
         "`implicitfast` from 3.7 to 3.10 and by Genesis. Order 1.",
     .source = "Google DeepMind, MuJoCo 3.7; Genesis",
     .conserves = "|q|; |L|, not L, and energy if no loads act",
     .solve = solve_gyroscopic<GyroscopicTerm::midpoint>},
    {.name = "gyroscopic_substepped",
     .documentation =
         "`gyroscopic_rescaled_momentum` in four parts per step: torque and force are evaluated once, at the start "
         "of the step; a quarter of their change, the gyroscopic term and the rotation are applied four times. "
         "This is Rapier's scheme with four solver iterations. Order 1.",
     .source = "Dimforge, Rapier",
     .conserves = "|q|; |L|, not L, if no torque acts",
     .solve = solve_gyroscopic<GyroscopicTerm::rescaled_momentum, AttitudeUpdate::exponential, 4>,
     .pendulum_amplification = substepped_pendulum_growth},
    {.name = "first_order_quaternion",
     .documentation =
         "`gyroscopic_explicit` with the attitude by the first-order update instead of the exponential: q += (h/2) "
         "(0, w) q, normalised, which rotates by 2 atan(h |w| / 2) instead of h |w|. ODE's default and cannon-es "
         "use this attitude update (cannon-es without a gyroscopic term). Order 1.",
     .solve = solve_gyroscopic<GyroscopicTerm::explicit_euler, AttitudeUpdate::first_order>},
};

constexpr auto gyroscopic_binary64_family =
    apply_defaults({.source = "the sources of the engines named",
                    .conserves = "|q|",
                    .control = Control::fixed_step,
                    .order = 1,
                    .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                    .family = Family::engine_update,
                    .formulation = Formulation::full},
                   gyroscopic_variants);

constexpr auto gyroscopic_family =
    with_binary32<gyroscopic_binary64_family, binary32_refusal,
                  solve_gyroscopic<GyroscopicTerm::none, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::explicit_euler, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::one_newton_step, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::rescaled_momentum, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::linearly_implicit, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::midpoint, AttitudeUpdate::exponential, 1, float>,
                  solve_gyroscopic<GyroscopicTerm::rescaled_momentum, AttitudeUpdate::exponential, 4, float>,
                  solve_gyroscopic<GyroscopicTerm::explicit_euler, AttitudeUpdate::first_order, 1, float>>();

}  // namespace

extern const std::span<const Method> gyroscopic_methods{gyroscopic_family};

}  // namespace polhode
