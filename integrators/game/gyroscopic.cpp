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
#include "integrators/run/binary32.h"
#include "integrators/run/linear_growth.h"

namespace polhode {
namespace {

using Term = GyroscopicTerm;
enum class Turning { exponential, first_order };

/// `parts`: number of substeps of the gyroscopic term and the attitude, each with an equal part of the change due to
/// loads.
template <Term term, Turning turning, int parts, class S>
class GyroscopicUpdate : public EngineState<S> {
    using Base = EngineState<S>;
    using Base::q_, Base::w_, Base::inertia_, Base::steps_;

  public:
    using Base::Base;
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step) / parts;
        Matrix3<S> R = rotation_matrix(q_);
        const Vector3<S> torque = this->torque_W(t, R), acceleration = this->acceleration_W(R);
        for (int part = 0; part < parts; ++part) {
            if (part > 0) R = rotation_matrix(q_);
            const Matrix3<S> back = transposed(R);
            w_ = w_ + h * (R * (inertia_.inverse * (back * torque)));
            if constexpr (term != Term::none) w_ = R * inertia_.template turned<term>(back * w_, h);
            if constexpr (turning == Turning::exponential)
                this->turn(h);
            else
                this->turn_in_first_order(h);
            this->translate(h, acceleration);
        }
        this->place_at_pivot();
        ++steps_;
    }
    long rhs_evaluations() const { return steps_; }
};

template <Term term, Turning turning = Turning::exponential, int parts = 1, class S = double>
Trajectory solve(const Problem& problem, const Settings& settings) {
    return march<GyroscopicUpdate<term, turning, parts, S>>(problem, settings);
}

// a = -c v - s theta, v+ = v + a, theta+ = theta + the mean of v + a/4, v + 2a/4, v + 3a/4 and v + a.
double substepped_pendulum_growth(double c, double s) {
    constexpr double share = 0.625;
    return spectral_radius(1 - share * s, 1 - share * c, -s, 1 - c);
}

constexpr std::string_view catto = "E. Catto 2015, Numerical Methods, Game Developers Conference";

constexpr Method each[] = {
    {.name = "gyroscopic_none",
     .documentation =
         "The semi-implicit step of game engines without a gyroscopic term: w in world axes changes by the loads "
         "alone, then q = exp(h w) q. Of a body that is no ball it converges, with order 1, to I_W dw/dt = tau, which "
         "is another motion: free, it spins for ever about an axis that is fixed in body and world. Godot, cannon-es "
         "and Havok's web build have it so; so do Jolt, PhysX and Unity unless they are told otherwise.",
     .conserves = "|q|; w in world axes, not L, where no torque acts",
     .solve = solve<Term::none>},
    {.name = "gyroscopic_explicit",
     .documentation =
         "The gyroscopic term by an explicit Euler step in the body's axes, w -= h I^-1 (w x I w). Free, every step "
         "adds h^2/2 (dw/dt . I dw/dt) to the energy, so that a tumbling body spins up until it diverges. An option of "
         "Bullet; Chrono, DART and MuJoCo's Euler do the same. Order 1.",
     .source = "the sources of the engines named; D. Baraff & A. Witkin 1997 for the equation",
     .solve = solve<Term::explicit_euler>},
    {.name = "gyroscopic_implicit",
     .documentation =
         "The gyroscopic term by an implicit Euler step in the body's axes, I (w - w0) + h w x I w = 0, of which one "
         "Newton step from w0 is taken. Free, a tumbling body loses energy until it turns about the axis of its "
         "largest moment, with less and less momentum. Bullet's default; Box3D and MuJoCo's implicit integrators do "
         "the same. Order 1.",
     .source = catto,
     .solve = solve<Term::one_newton_step>},
    {.name = "gyroscopic_rescaled_momentum",
     .documentation =
         "The angular momentum in the body's axes by an explicit Euler step, L + h L x w, brought back to the length "
         "that it had. Neither grows nor decays: a free body keeps |L|, though not L, and so a bounded energy, which "
         "in the long run goes to that of a turn about the middle axis, |L|^2 / (2 I_2). Jolt and PhysX where their "
         "gyroscopic forces are switched on. Order 1.",
     .source = "J. Rouwe, Jolt Physics, MotionProperties::ApplyGyroscopicForceInternal; NVIDIA PhysX 5",
     .conserves = "|q|; |L|, not L, where no torque acts",
     .solve = solve<Term::rescaled_momentum>},
    {.name = "gyroscopic_linearly_implicit",
     .documentation =
         "The gyroscopic term with the momentum of the step's begin and the new w, (I - h skew(I w0)) w = I w0, one "
         "linear system: a free body loses the energy (w - w0) . I (w - w0) / 2 a step, at any step. The term of ODE "
         "0.16, which turns the body by the first-order quaternion unless finite rotations are asked for. Order 1.",
     .source = "C. Lacoursière 2006, Stabilizing gyroscopic forces in rigid multibody simulations, UMINF 06.05",
     .solve = solve<Term::linearly_implicit>},
    {.name = "midpoint_gyroscopic",
     .documentation =
         "The gyroscopic term by the implicit midpoint rule in body axes, its equations solved to rounding: the term "
         "then keeps the energy and |L| whatever the step; of the attitude's error it takes away little. MuJoCo's "
         "`implicitfast` from 3.7 to 3.10, Genesis. Order 1.",
     .source = "Google DeepMind, MuJoCo 3.7; Genesis",
     .conserves = "|q|; |L|, not L, and the energy where nothing acts",
     .solve = solve<Term::midpoint>},
    {.name = "gyroscopic_substepped",
     .documentation =
         "`gyroscopic_rescaled_momentum` in four parts a step: torque and force are found once, at the step's begin, "
         "and a quarter of their change, the gyroscopic term and the turn are taken four times. Rapier's four solver "
         "iterations go this way. Order 1.",
     .source = "Dimforge, Rapier",
     .conserves = "|q|; |L|, not L, where no torque acts",
     .solve = solve<Term::rescaled_momentum, Turning::exponential, 4>,
     .pendulum_growth = substepped_pendulum_growth},
    {.name = "first_order_quaternion",
     .documentation =
         "`gyroscopic_explicit` with the attitude by the first-order update instead of the exponential: q += (h/2) (0, "
         "w) q, normalised, which turns by 2 atan(h |w| / 2) in place of h |w|. ODE's default and cannon-es turn so "
         "(cannon-es without a gyroscopic term). Order 1.",
     .solve = solve<Term::explicit_euler, Turning::first_order>},
};

constexpr auto in_binary64 = sharing({.source = "the sources of the engines named",
                                      .conserves = "|q|",
                                      .control = Control::fixed_step,
                                      .order = 1,
                                      .pendulum_growth = semi_implicit_euler_pendulum_growth,
                                      .family = Family::engine_update,
                                      .formulation = Formulation::full},
                                     each);

constexpr auto family =
    with_binary32<in_binary64, refused_by_binary32, solve<Term::none, Turning::exponential, 1, float>,
                  solve<Term::explicit_euler, Turning::exponential, 1, float>,
                  solve<Term::one_newton_step, Turning::exponential, 1, float>,
                  solve<Term::rescaled_momentum, Turning::exponential, 1, float>,
                  solve<Term::linearly_implicit, Turning::exponential, 1, float>,
                  solve<Term::midpoint, Turning::exponential, 1, float>,
                  solve<Term::rescaled_momentum, Turning::exponential, 4, float>,
                  solve<Term::explicit_euler, Turning::first_order, 1, float>>();

}  // namespace

extern const std::span<const Method> gyroscopic_methods{family};

}  // namespace polhode
