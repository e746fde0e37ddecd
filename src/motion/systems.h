// The first-order systems dy/dt = f(t, y) as which a scene can be posed:
//
//   PrincipalAxisRotation   3   w, c, s        w along one principal axis e; q = q0 (c, s e)
//   FreeRotation            7   w, q           no torque: w decouples from q
//   LoadedRotation          7   w, q           torque from attitude, rate and time
//   LoadedMotion           13   w, q, p, v     torque or force that couples translation and rotation
//   FullMotion             13   w, q, p, v     nothing omitted: full tensor, body axes (--full, and the reference)
//
// A system encapsulates its state: only the system knows the index of each quantity in y.
#pragma once

#include <concepts>
#include <utility>

#include "motion/body_equations.h"
#include "motion/problem.h"
#include "motion/user_system.h"

namespace polhode {

template <class S>
struct Placement;
struct ImpactOutcome;

/// What a method integrates. It is constructed from a problem, initially with the loads of its first segment. The
/// problem must outlive it. `size()` is the number of components; `dimension` is the same number, or run_time.
template <class F>
concept System = std::copyable<F> && std::constructible_from<F, const Problem&> &&
    requires(const F c, F f, const Segment& segment, double t, typename F::Scalar* y, double* scales) {
    { F::dimension } -> std::convertible_to<int>;  // run_time if known only at run time
    f.initial(y);                                  // y at t = 0, before any impulse there
    {
        f.enter(segment, y)
        } -> std::same_as<bool>;  // an event: applies impulses to y, takes the new
                                  // loads; returns whether there were impulses
    c.derivative(t, y, y);        // over any scalar: dy/dt from t and y
    c.motion(t, y);               // the motion at time t
    c.scales(scales);             // the scale of each component's error
};

/// Common base of the systems of one body: the problem and the conversion of states to samples.
class BodySystem {
  public:
    using Scalar = double;  ///< scalar of the state

  protected:
    /// The problem must outlive it.
    explicit BodySystem(const Problem& problem) : problem_(&problem) {}

    /// The sample with this rotation in posed axes.
    Sample rotated(double t, const Vector3<double>& w, const Quaternion<double>& q) const;
    /// The sample with this rotation, and with the centre of mass from the pivot or the closed form.
    Sample placed(double t, const Vector3<double>& w, const Quaternion<double>& q) const;
    /// Applies one impulse to w and v.
    void apply(const PosedImpulse<double>& impulse, Vector3<double>& w, const Quaternion<double>& q,
               const Vector3<double>& p, Vector3<double>& v) const;

    const Problem* problem_;  ///< posed
};

/// Rotation about one principal axis: y = (w, c, s), the rate about the axis and the cosine and sine of the
/// half-angle.
class PrincipalAxisRotation : public AxisEquations<double>, public BodySystem {
  public:
    using Equations = AxisEquations<double>;  ///< the right-hand side
    using Equations::dimension;
    static constexpr bool about_axis = true;           ///< rotates about a fixed axis
    static constexpr bool has_translation = false;     ///< whether p and v are part of the state
    static constexpr bool has_torque = true;           ///< whether torques may act
    static constexpr bool has_full_inertia = false;    ///< whether the tensor is used as given, not the principal one
    static constexpr int size() { return dimension; }  ///< number of components
    static constexpr int rates = 1;                    ///< components of w, which come first

    /// With the loads of the first segment. The problem must outlive it.
    explicit PrincipalAxisRotation(const Problem& problem) : PrincipalAxisRotation(problem, problem.segments.front()) {}
    /// With the loads of this segment.
    PrincipalAxisRotation(const Problem& problem, const Segment& segment)
        : Equations(segment.about_axis), BodySystem(problem) {}

    /// y at t = 0, before any impulse there.
    void initial(double* y) const;
    /// Processes an event: applies the impulses at the start of the segment to y, then takes its loads. Returns
    /// whether there were impulses.
    bool enter(const Segment& segment, double* y);
    /// The motion at state y and time t (s).
    Sample motion(double t, const double* y) const;
    /// The scale of each component's error.
    void scales(double* scales) const;
    /// The state of a sample: the inverse of motion().
    void state(const Sample& sample, double* y) const;

    /// w in posed axes, rad/s.
    Vector3<double> angular_velocity(const double* y) const { return y[0] * problem_->body.axis; }
    /// q, posed axes to world axes.
    Quaternion<double> attitude(const double* y) const;
    /// |q|^2, which is 1 for the exact motion.
    template <class S>
    S attitude_square(const S* y) const {
        return y[1] * y[1] + y[2] * y[2];
    }
    /// Kinetic energy and the potentials of the first segment's loads, J, if energy is conserved.
    template <class S>
    S energy(const S* y) const {
        // With the half-angle a, (c, s) = (cos a, sin a): integrates the torque cc c^2 + cs c s + ss s^2 over d(2 a).
        // If energy is conserved, cc + ss = 0.
        const Equations& f = problem_->segments.front().about_axis;
        const S cosine = y[1] * y[1] - y[2] * y[2], half_sine = y[1] * y[2];
        return (0.5 / f.inverse_moment) * (y[0] * y[0]) + ((0.5 * f.cs) * cosine - (f.cc - f.ss) * half_sine);
    }
};

/// Systems whose state is w (posed axes), q (posed axes to world axes) and, with translation, p and v of the centre
/// of mass in world axes. `BodyEquations`: the right-hand side.
template <class BodyEquations>
class QuaternionSystem : public BodyEquations, public BodySystem, public BodyState {
  public:
    using Equations = BodyEquations;                                          ///< the right-hand side
    static constexpr int dimension = Equations::dimension;                    ///< number of components
    static constexpr bool about_axis = false;                                 ///< rotates freely
    static constexpr bool has_translation = dimension == 13;                  ///< p and v are state
    static constexpr bool has_torque = requires(Equations f) { f.forcing; };  ///< whether torques may act
    /// Whether the tensor is used as given, not the principal one.
    static constexpr bool has_full_inertia = requires(Equations f) { f.inertia.tensor; };
    static constexpr int size() { return dimension; }  ///< number of components
    static constexpr int rates = 3;                    ///< components of w, which come first

    /// With the loads of the first segment. The problem must outlive it.
    explicit QuaternionSystem(const Problem& problem)
        : Equations(equations(problem, problem.segments.front())), BodySystem(problem) {}
    /// With the loads of this segment, which must outlive it.
    QuaternionSystem(const Problem& problem, const Segment& segment)
        : Equations(equations(problem, segment)), BodySystem(problem) {}

    /// y at t = 0, before any impulse there.
    void initial(double* y) const;
    /// Processes an event: applies the impulses at the start of the segment to y, then takes its loads. Returns
    /// whether there were impulses.
    bool enter(const Segment& segment, double* y);
    /// The motion at state y and time t (s).
    Sample motion(double t, const double* y) const;
    /// The scale of each component's error.
    void scales(double* scales) const;
    /// The state of a sample: the inverse of motion().
    void state(const Sample& sample, double* y) const;

    /// |q|^2, which is 1 for the exact motion.
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
/// y = (w, q, p, v): loads that couple translation and rotation.
using LoadedMotion = QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, true>>;
/// y = (w, q, p, v): nothing is omitted; the tensor is in the body's own axes.
using FullMotion = QuaternionSystem<LoadedEquations<double, FullInertia<double>, true>>;

extern template class QuaternionSystem<FreeEquations<double>>;
extern template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, false>>;
extern template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, true>>;
extern template class QuaternionSystem<LoadedEquations<double, FullInertia<double>, true>>;

/// Whether the state is exactly (w, q), for which specialised kernels exist.
template <class SystemType>
inline constexpr bool is_rotation = SystemType::dimension == FreeRotation::dimension;

/// Calls the template operator() of `visit` with the type of the system of one body as which the problem was posed, and
/// returns its result. Not for user-defined systems.
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
        case SystemKind::user_defined:
        case SystemKind::mechanism:
        case SystemKind::body_with_formulas:
        case SystemKind::mechanism_with_formulas:
            break;
    }
    return visit.template operator()<FullMotion>();
}

/// Like with_one_body(), for any problem: uses ErasedSystem for user-defined systems and several bodies.
template <class Visitor>
auto with_system(const Problem& problem, Visitor&& visit) {
    if (!std::holds_alternative<OneBody>(problem.system)) return visit.template operator()<ErasedSystem>();
    return with_one_body(problem, std::forward<Visitor>(visit));
}

/// Position and velocity of the body at a state of a 13-dimensional system, in the form that contacts use.
Placement<double> placement_of(const double* y);

/// Applies the impact at the contacts whose gap is at most `tolerance` (m) to the state y of a 13-dimensional system.
ImpactOutcome resolve_plane_impacts(const Problem& problem, double tolerance, double* y);

}  // namespace polhode
