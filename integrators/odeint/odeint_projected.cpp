// Odeint's steppers with a projection after each step.
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "integrators/geometric/projection.h"
#include "integrators/odeint/odeint_pair.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

// Neither keeps a rate between steps, which a projection would invalidate.
template <std::size_t N>
using UnprojectedRk4 = odeint::runge_kutta4<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using UnprojectedFehlberg78 =
    odeint::runge_kutta_fehlberg78<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;

template <class SystemType, template <std::size_t> class Scheme>
class ProjectedFixedStepper : public OdeintFixedStepper<SystemType, Scheme> {
    using Base = OdeintFixedStepper<SystemType, Scheme>;

  public:
    explicit ProjectedFixedStepper(const Problem& problem) : Base(problem), projection_(problem) {}
    void step(double t, double h) {
        Base::step(t, h);
        projection_.project(this->y_.data());
    }

  private:
    Projection<SystemType> projection_;
};

template <class SystemType>
class ProjectedPair : public ControlledPair<SystemType, UnprojectedFehlberg78> {
    using Base = ControlledPair<SystemType, UnprojectedFehlberg78>;

  public:
    ProjectedPair(const Problem& problem, double tolerance) : Base(problem, tolerance), projection_(problem) {}
    Attempt attempt(double& t, double& h) {
        const Attempt outcome = Base::attempt(t, h);
        if (outcome == Attempt::accepted) projection_.project(this->y_.data());
        return outcome;
    }

  private:
    Projection<SystemType> projection_;
};

Trajectory solve_projected_rk4(const Problem& problem, const Settings& settings) {
    return with_one_body(problem, [&]<class SystemType>() {
        return march<ProjectedFixedStepper<SystemType, UnprojectedRk4>>(problem, settings);
    });
}

Trajectory solve_projected_fehlberg78(const Problem& problem, const Settings& settings) {
    if (settings.tolerance && !is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    return with_one_body(problem, [&]<class SystemType>() {
        if (!settings.tolerance)
            return march<ProjectedFixedStepper<SystemType, UnprojectedFehlberg78>>(problem, settings);
        return march_controlled(problem, settings, ProjectedPair<SystemType>(problem, *settings.tolerance));
    });
}

constexpr const char* projected_invariants = "|q| and, if the motion conserves them, E, momenta and spin, to round-off";

constexpr Method odeint_projected_variants[] = {
    {.name = "odeint_rk4_projected",
     .documentation =
         "`odeint_rk4` with the end of each step projected onto the nearest state with |q| = 1 and the initial values "
         "of the motion's invariants: energy, angular and linear momentum (or their conserved components), the spin "
         "about an axis of symmetry. Distances are in units of the components' scales; the projection is computed by "
         "Gauss-Newton steps to round-off. It does not reduce the error along the manifold, which is most of the "
         "attitude error; the errors of the invariants therefore do not indicate the attitude error. Invariants that "
         "an event ends are not projected at all.",
     .source = "Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, IV.4; Kutta 1901",
     .control = Control::fixed_step,
     .order = 4,
     .solve = solve_projected_rk4},
    {.name = "odeint_fehlberg78_projected",
     .documentation = "`odeint_fehlberg78` with a projection after each accepted step, as in `odeint_rk4_projected`.",
     .source = "Hairer, Lubich & Wanner 2006, Geometric Numerical Integration, IV.4; Fehlberg 1968, NASA TR R-287",
     .control = Control::fixed_step_or_tolerance,
     .order = 8,
     .solve = solve_projected_fehlberg78},
};

constexpr auto odeint_projected_family =
    apply_defaults({.conserves = projected_invariants, .family = Family::runge_kutta, .library = odeint_library},
                   odeint_projected_variants);

}  // namespace

extern const std::span<const Method> odeint_projected_methods{odeint_projected_family};

}  // namespace polhode
