// The explicit steppers of Boost.Odeint 1.74 on polhode's right-hand side.
//
// Odeint's steppers return normally with NaN or infinity, and do not terminate if the tolerance is out of reach.
// Every attempt is therefore checked, and undone if it is not finite. ControlledExtrapolation wraps Bulirsch-Stoer;
// odeint_pair.h wraps the Runge-Kutta pairs.
#include "integrators/odeint/odeint.h"

#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "integrators/odeint/odeint_pair.h"
#include "integrators/run/amplification.h"

namespace polhode {
namespace {

namespace odeint = boost::numeric::odeint;

template <std::size_t N>
using Euler = odeint::euler<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using CashKarp54 = odeint::runge_kutta_cash_karp54<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using Dopri5 = odeint::runge_kutta_dopri5<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using Fehlberg78 = odeint::runge_kutta_fehlberg78<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;
template <std::size_t N>
using BulirschStoer = odeint::bulirsch_stoer<OdeintArray<N>, double, OdeintArray<N>, double, OdeintAlgebra<N>>;

/// Odeint's Bulirsch-Stoer takes two tolerances: R, and R times the smallest scale of the components.
template <class SystemType>
class ControlledExtrapolation : public ControlledOdeintState<SystemType> {
    using Base = ControlledOdeintState<SystemType>;
    static constexpr std::size_t N = Base::N;

  public:
    // Starts at order 8: columns 2, 4, .., 10 of the midpoint rule.
    ControlledExtrapolation(const Problem& problem, double tolerance)
        : Base(problem, tolerance, 8), extrapolation_(tolerance * this->smallest_scale(), tolerance, 1.0, 0.0) {}

    void restart() {
        Base::restart();
        clear_history();
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        clear_history();
    }
    Attempt attempt(double& t, double& h) {
        const double tried = h;
        const OdeintRightHandSide<SystemType> f{&this->system_, &this->evaluations_};
        if (!has_rate_) f(this->y_, rate_, t), has_rate_ = true;
        OdeintArray<N> next = rate_;
        const bool accepted = extrapolation_.try_step(f, this->y_, rate_, t, next, h) == odeint::success;
        // State and rate are still unmodified here.
        const bool finite = all_finite(next) && std::isfinite(h);
        if (accepted && finite) {
            this->y_ = next, has_rate_ = false;
            this->project();
            return Attempt::accepted;
        }
        if (accepted) t -= tried;
        if (!finite) {
            h = not_finite_shrinkage * tried;
            extrapolation_.reset();
            return Attempt::not_finite;
        }
        if (!(h < tried)) h = tried / 2;  // a second consecutive rejection may leave h unchanged
        return Attempt::rejected;
    }

  private:
    void clear_history() {
        extrapolation_.reset();
        has_rate_ = false;
    }

    BulirschStoer<N> extrapolation_;
    OdeintArray<N> rate_{this->system_.size()};
    bool has_rate_ = false;
};

/// R(z) is the result of one step of length 1 on y' = z y from y = 1.
template <template <std::size_t> class Scheme>
double stepper_growth(std::complex<double> z) {
    Scheme<2> scheme;
    OdeintArray<2> y;
    y[0] = 1;
    scheme.do_step(
        [z](const OdeintArray<2>& at, OdeintArray<2>& rate, double) { linear_rate(z, at.data(), rate.data()); }, y, 0.0,
        1.0);
    return magnitude({y[0], y[1]});
}

Trajectory solve_bulirsch_stoer(const Problem& problem, const Settings& settings) {
    if (!is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    return with_system(problem, [&]<class SystemType>() {
        return march_controlled(problem, settings, ControlledExtrapolation<SystemType>(problem, *settings.tolerance));
    });
}

std::string rosenbrock_refusal(const Problem& problem) {
    return problem.needs.user_torque ? "user-defined torques have no Jacobian" : "";
}

constexpr Method odeint_variants[] = {
    {.name = "odeint_euler",
     .documentation = "Euler's explicit method (Boost.Odeint's `euler`), fixed step. One right-hand side per step.",
     .source = "Euler 1768; Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .control = Control::fixed_step,
     .order = 1,
     .solve = march_odeint<Euler>,
     .amplification = stepper_growth<Euler>},
    {.name = "odeint_rk4",
     .documentation =
         "The classical Runge-Kutta method of order 4 (Boost.Odeint's `runge_kutta4`), fixed step. Four right-hand "
         "sides per step.",
     .source = "Kutta 1901; Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .control = Control::fixed_step,
     .order = 4,
     .solve = solve_rk4,
     .amplification = classical_amplification},
    {.name = "odeint_cash_karp54",
     .documentation =
         "Cash & Karp's pair of orders 5 and 4 (Boost.Odeint's `runge_kutta_cash_karp54`), propagating the fifth "
         "order. Six right-hand sides per step. Step control by Odeint: the largest error over the components, each "
         "relative to R (scale + |y|).",
     .source = "Cash & Karp 1990, ACM Trans. Math. Softw. 16, 201; Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .order = 5,
     .solve = solve_pair<CashKarp54>,
     .amplification = stepper_growth<CashKarp54>},
    {.name = "odeint_dopri5",
     .documentation =
         "Dormand & Prince's pair of orders 5 and 4 (Boost.Odeint's `runge_kutta_dopri5`), propagating the fifth "
         "order. Six right-hand sides per step, because the last stage is the first one of the next step. Step control "
         "by Odeint: the largest error over the components, each relative to R (scale + |y|).",
     .source = "Dormand & Prince 1980, J. Comput. Appl. Math. 6, 19; Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .order = 5,
     .solve = solve_pair<Dopri5>,
     .amplification = stepper_growth<Dopri5>},
    {.name = "odeint_fehlberg78",
     .documentation =
         "Fehlberg's pair of orders 8 and 7 (Boost.Odeint's `runge_kutta_fehlberg78`), propagating the eighth order. "
         "Thirteen right-hand sides per step. Step control by Odeint: the largest error over the components, each "
         "relative to R (scale + |y|).",
     .source = "Fehlberg 1968, NASA TR R-287; Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .order = 8,
     .solve = solve_pair<Fehlberg78>,
     .amplification = stepper_growth<Fehlberg78>},
    {.name = "odeint_adams_bashforth_moulton",
     .documentation =
         "Adams-Bashforth formula of six steps as predictor and Adams-Moulton formula of order 6 as corrector, each "
         "followed by an evaluation (Boost.Odeint's `adams_bashforth_moulton<6>`), fixed step. Two right-hand sides "
         "per step. Odeint supports up to eight steps, but with seven or eight the predictor's share of the error "
         "falls below the corrector's only at steps so short that round-off hides both. The first five steps use "
         "Fehlberg's method of order 8; the Runge-Kutta steps of order 4 that Odeint starts with would reduce the "
         "order to 5. An event or a change of the step restarts the history.",
     .source = "Bashforth & Adams 1883; Moulton 1926; Hairer, Norsett & Wanner 1993, III.1; Boost.Odeint 1.74",
     .control = Control::fixed_step,
     .order = 6,
     .solve = solve_adams_bashforth_moulton,
     .amplification = adams_bashforth_moulton_growth,
     .family = Family::multistep},
    {.name = "odeint_bulirsch_stoer",
     .documentation =
         "Extrapolation of the modified midpoint rule with variable order and step (Boost.Odeint's `bulirsch_stoer`, "
         "up to eight columns). Its controller uses one absolute tolerance for all components, R times the smallest of "
         "their scales, and adds the change over the step, h |f|, to |y| in the weights.",
     .source = "Bulirsch & Stoer 1966, Numer. Math. 8, 1; Hairer, Norsett & Wanner 1993, II.9; Boost.Odeint 1.74",
     .control = Control::tolerance,
     .solve = solve_bulirsch_stoer,
     .family = Family::extrapolation},
    {.name = "odeint_rosenbrock4",
     .documentation =
         "A linearly implicit method of order 4 for stiff scenes (Boost.Odeint's `rosenbrock4`: Shampine's and "
         "Kaps-Rentrop's form with the coefficients of RODAS), with the Jacobian by forward differentiation of the "
         "right-hand side and one dense LU factorisation per step. Six right-hand sides and one Jacobian per step; "
         "only right-hand sides are counted. Its controller uses one absolute tolerance for all components, R times "
         "the smallest of their scales. User-defined torques are refused, because they have no Jacobian.",
     .source = "Hairer & Wanner 1996, IV.7 (RODAS); Ahnert & Mulansky 2011, Boost.Odeint 1.74",
     .order = 4,
     .solve = solve_rosenbrock4,
     .amplification = rosenbrock4_growth,
     .refusal = rosenbrock_refusal},
};

constexpr auto odeint_binary64_family = apply_defaults({.conserves = "nothing",
                                                        .control = Control::fixed_step_or_tolerance,
                                                        .general_systems = true,
                                                        .family = Family::runge_kutta,
                                                        .library = odeint_library},
                                                       odeint_variants);

constexpr auto odeint_family = with_binary32<odeint_binary64_family, binary32_system_refusal, solve_euler_float32,
                                             solve_rk4_float32, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr>();

}  // namespace

extern const std::span<const Method> odeint_methods{odeint_family};

}  // namespace polhode
