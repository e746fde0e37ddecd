// The first-order systems dy/dt = f(t, y) that a scene can be posed as:
//
//   PrincipalAxisRotation   3   w, c, s        w along one principal axis e; q = q0 (c, s e)
//   FreeRotation            7   w, q           no torque: w decouples from q
//   LoadedRotation          7   w, q           torque from attitude, rate and time
//   LoadedMotion           13   w, q, p, v     torque or force that ties translation and rotation together
//   FullMotion             13   w, q, p, v     nothing left out: full tensor, body axes (--full, and the truth)
//
// A system owns its state: nobody else knows at which place of y a quantity stands.
#pragma once

#include <concepts>
#include <utility>

#include "motion/body_equations.h"
#include "motion/own_system.h"
#include "motion/problem.h"

namespace polhode {

template <class S>
struct Placement;
struct ImpactOutcome;

/// What a method integrates: made from a problem, at first with the loads of its first segment. The problem must
/// outlive it. `size()` is the number of components; `dimension` is the same where the compiler knows it.
template <class F>
concept System = std::copyable<F> && std::constructible_from<F, const Problem&> &&
    requires(const F c, F f, const Segment& segment, double t, typename F::Scalar* y, double* scales) {
    { F::dimension } -> std::convertible_to<int>;  // run_time where the compiler does not know it
    f.initial(y);                                  // y at t = 0, before any impulse there
    {
        f.enter(segment, y)
        } -> std::same_as<bool>;  // an event: impulses in place, then other loads;
                                  // whether there were impulses
    c.derivative(t, y, y);        // over any scalar: dy/dt from t and y
    c.motion(t, y);               // what y at time t stands for
    c.scales(scales);             // the size that each component's error is measured by
};

/// What the systems of one body share: the problem and the reading of its motion.
class BodySystem {
  public:
    using Scalar = double;  ///< of the state

  protected:
    /// The problem must outlive it.
    explicit BodySystem(const Problem& problem) : problem_(&problem) {}

    /// The sample with this rotation in posed axes.
    Sample rotated(double t, const Vector3<double>& w, const Quaternion<double>& q) const;
    /// The same with the centre of mass where the pivot or the closed form says that it is.
    Sample placed(double t, const Vector3<double>& w, const Quaternion<double>& q) const;
    /// The jumps by one impulse.
    void apply(const PosedImpulse<double>& impulse, Vector3<double>& w, const Quaternion<double>& q,
               const Vector3<double>& p, Vector3<double>& v) const;

    const Problem* problem_;  ///< posed
};

/// Rotation about one principal axis: y = (w, c, s), the rate about the axis and the half-angle's cosine and sine.
class PrincipalAxisRotation : public AxisEquations<double>, public BodySystem {
  public:
    using Equations = AxisEquations<double>;  ///< its right-hand side
    using Equations::dimension;
    static constexpr bool about_axis = true;           ///< it turns about a fixed axis
    static constexpr bool has_translation = false;     ///< p and v are part of the state
    static constexpr bool has_torque = true;           ///< torques may act
    static constexpr bool has_full_inertia = false;    ///< the tensor is as written, not the principal one
    static constexpr int size() { return dimension; }  ///< components of the state
    static constexpr int rates = 1;                    ///< components of w; they come first

    /// With the loads of the first segment. The problem must outlive it.
    explicit PrincipalAxisRotation(const Problem& problem) : PrincipalAxisRotation(problem, problem.segments.front()) {}
    /// With the loads of this segment.
    PrincipalAxisRotation(const Problem& problem, const Segment& segment)
        : Equations(segment.about_axis), BodySystem(problem) {}

    /// y at t = 0, before any impulse there.
    void initial(double* y) const;
    /// Meets an event: the impulses that open the segment act on y in place, then its loads are taken. Returns whether
    /// there were impulses.
    bool enter(const Segment& segment, double* y);
    /// The motion that y at time t (s) stands for.
    Sample motion(double t, const double* y) const;
    /// The size that each component's error is measured by.
    void scales(double* scales) const;
    /// The state that a sample stands for: the way back from motion().
    void state(const Sample& sample, double* y) const;

    /// w in posed axes, rad/s.
    Vector3<double> angular_velocity(const double* y) const { return y[0] * problem_->body.axis; }
    /// q, posed axes to world axes.
    Quaternion<double> attitude(const double* y) const;
    /// |q|^2, which the exact motion keeps at 1.
    template <class S>
    S attitude_square(const S* y) const {
        return y[1] * y[1] + y[2] * y[2];
    }
    /// Kinetic energy and the potentials of the first segment's loads, J, where energy is kept.
    template <class S>
    S energy(const S* y) const {
        // the half angle a with (c, s) = (cos a, sin a): torque cc c^2 + cs c s + ss s^2, over d(2 a). Where energy is
        // kept cc + ss = 0
        const Equations& f = problem_->segments.front().about_axis;
        const S cosine = y[1] * y[1] - y[2] * y[2], half_sine = y[1] * y[2];
        return (0.5 / f.inverse_moment) * (y[0] * y[0]) + ((0.5 * f.cs) * cosine - (f.cc - f.ss) * half_sine);
    }
};

/// The systems whose state is w (posed axes), q (posed axes to world) and, where there is translation, p and v of the
/// centre of mass in world axes. `BodyEquations`: their right-hand side.
template <class BodyEquations>
class QuaternionSystem : public BodyEquations, public BodySystem, public BodyState {
  public:
    using Equations = BodyEquations;                                          ///< its right-hand side
    static constexpr int dimension = Equations::dimension;                    ///< components of the state
    static constexpr bool about_axis = false;                                 ///< it turns freely
    static constexpr bool has_translation = dimension == 13;                  ///< p and v are state
    static constexpr bool has_torque = requires(Equations f) { f.forcing; };  ///< torques may act
    /// The tensor is as written, not the principal one.
    static constexpr bool has_full_inertia = requires(Equations f) { f.inertia.tensor; };
    static constexpr int size() { return dimension; }  ///< components of the state
    static constexpr int rates = 3;                    ///< components of w; they come first

    /// With the loads of the first segment. The problem must outlive it.
    explicit QuaternionSystem(const Problem& problem)
        : Equations(equations(problem, problem.segments.front())), BodySystem(problem) {}
    /// With the loads of this segment, which must outlive it.
    QuaternionSystem(const Problem& problem, const Segment& segment)
        : Equations(equations(problem, segment)), BodySystem(problem) {}

    /// y at t = 0, before any impulse there.
    void initial(double* y) const;
    /// Meets an event: the impulses that open the segment act on y in place, then its loads are taken. Returns whether
    /// there were impulses.
    bool enter(const Segment& segment, double* y);
    /// The motion that y at time t (s) stands for.
    Sample motion(double t, const double* y) const;
    /// The size that each component's error is measured by.
    void scales(double* scales) const;
    /// The state that a sample stands for: the way back from motion().
    void state(const Sample& sample, double* y) const;

    /// |q|^2, which the exact motion keeps at 1.
    template <class S>
    S attitude_square(const S* y) const {
        return squared_norm(attitude(y));
    }
    /// I w in posed axes, kg m^2/s.
    template <class S>
    Vector3<S> angular_momentum(const S* y) const {
        const Vector3<S> w = angular_velocity(y);
        if constexpr (has_full_inertia) {
            return problem_->body.full_inertia.tensor * w;
        } else {
            const Vector3<double>& I = problem_->body.principal.moments;
            return {I[0] * w[0], I[1] * w[1], I[2] * w[2]};
        }
    }
    /// Kinetic energy and the potentials of the first segment's loads, J: a quadratic polynomial.
    template <class S>
    S energy(const S* y) const {
        const Forcing<double>& f = problem_->segments.front().forcing;
        const Vector3<S> w = angular_velocity(y);
        const Quaternion<S> q = attitude(y);
        S energy = 0.5 * dot(w, angular_momentum(y));
        for (int b = 0; b < 3; ++b)
            if (f.field.present[b]) energy = energy - dot(f.field.moment[b], world_axis(q, b));
        for (const SpringTorque<double>& spring : f.springs) {
            const Vector3<S> r = vector_part(conjugate(spring.rest) * q);
            energy = energy + (2 * spring.stiffness) * dot(r, r);
        }
        if constexpr (has_translation) {
            if (!problem_->body.pivoted) {
                const Vector3<S> p = position(y), v = velocity(y);
                energy = energy + problem_->body.mass * (0.5 * dot(v, v) - dot(f.acceleration_W, p));
            }
        }
        return energy;
    }

  private:
    static Equations equations(const Problem& problem, const Segment& segment) {
        if constexpr (!has_torque)
            return {problem.body.principal_inertia};
        else if constexpr (has_full_inertia)
            return {problem.body.full_inertia, &segment.forcing};
        else
            return {problem.body.principal_inertia, &segment.forcing};
    }
};

/// y = (w, q): no torque acts, and w decouples from q.
using FreeRotation = QuaternionSystem<FreeEquations<double>>;
/// y = (w, q): torques that depend on attitude, rate and time.
using LoadedRotation = QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, false>>;
/// y = (w, q, p, v): loads that tie translation and rotation together.
using LoadedMotion = QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, true>>;
/// y = (w, q, p, v): nothing left out, the tensor in the body's own axes.
using FullMotion = QuaternionSystem<LoadedEquations<double, FullInertia<double>, true>>;

extern template class QuaternionSystem<FreeEquations<double>>;
extern template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, false>>;
extern template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, true>>;
extern template class QuaternionSystem<LoadedEquations<double, FullInertia<double>, true>>;

/// Whether the state is w and q alone: what has kernels of its own.
template <class SystemType>
inline constexpr bool is_rotation = SystemType::dimension == FreeRotation::dimension;

/// Calls visit.template operator() with the one body's system that the problem was posed as for template argument, and
/// returns what that returns. Not for a system of the user's own.
template <class Visitor>
auto with_one_body(const Problem& problem, Visitor&& visit) {
    switch (problem.needs.system) {
        case SystemKind::principal_axis_rotation:
            return visit.template operator()<PrincipalAxisRotation>();
        case SystemKind::free_rotation:
            return visit.template operator()<FreeRotation>();
        case SystemKind::loaded_rotation:
            return visit.template operator()<LoadedRotation>();
        case SystemKind::loaded_motion:
            return visit.template operator()<LoadedMotion>();
        case SystemKind::full_motion:
        case SystemKind::own:
        case SystemKind::mechanism:
            break;
    }
    return visit.template operator()<FullMotion>();
}

/// The same for any problem: with OwnSystem where it is a system of the user's own.
template <class Visitor>
auto with_system(const Problem& problem, Visitor&& visit) {
    if (!std::holds_alternative<OneBody>(problem.system)) return visit.template operator()<OwnSystem>();
    return with_one_body(problem, std::forward<Visitor>(visit));
}

/// Where the body is at a state of a 13-dimensional system, as contacts need it.
Placement<double> placement_of(const double* y);

/// The impact of a state of a 13-dimensional system at the contacts whose gap is at most `tolerance` (m), in place.
ImpactOutcome strike_planes(const Problem& problem, double tolerance, double* y);

}  // namespace polhode
