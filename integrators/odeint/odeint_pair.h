// Boost.Odeint's Runge-Kutta pairs with its own step control, as a ControlledStepper.
#pragma once

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <cmath>
#include <limits>

#include "integrators/odeint/odeint.h"

namespace polhode {

/// The largest error in units of R (scale_i + |y_i|); infinity if an error is NaN.
template <std::size_t N>
class ComponentError {
  public:
    ComponentError() = default;
    ComponentError(double tolerance, const OdeintArray<N>& scales) : tolerance_(tolerance), scales_(scales) {}

    template <class Algebra>
    double error(Algebra&, const OdeintArray<N>& y, const OdeintArray<N>&, const OdeintArray<N>& difference,
                 double) const {
        OdeintArray<N> ratio = y;
        for (std::size_t i = 0; i < y.size(); ++i)
            ratio[i] = difference[i] / (tolerance_ * (scales_[i] + std::abs(y[i])));
        return OdeintAlgebra<N>::norm_inf(ratio);
    }

  private:
    double tolerance_ = 1;
    OdeintArray<N> scales_;
};

/// Odeint's step size rule. An infinite error gives NaN, which attempt() checks for.
struct StepRule : boost::numeric::odeint::default_step_adjuster<double, double> {
    double decrease_step(double h, double error, int error_order) const {
        if (!std::isfinite(error)) return std::numeric_limits<double>::quiet_NaN();
        return default_step_adjuster::decrease_step(h, error, error_order);
    }
};

/// A Runge-Kutta pair with N components and Odeint's step control.
template <std::size_t N, template <std::size_t> class Scheme>
using Controlled = boost::numeric::odeint::controlled_runge_kutta<Scheme<N>, ComponentError<N>, StepRule>;

/// A Runge-Kutta pair on a system, with Odeint's step control.
template <class SystemType, template <std::size_t> class Scheme>
class ControlledPair
    : public ControlledOdeintState<SystemType, Controlled<OdeintState<SystemType>::dimension, Scheme>> {
    static constexpr std::size_t N = OdeintState<SystemType>::dimension;
    using Base = ControlledOdeintState<SystemType, Controlled<N, Scheme>>;

  public:
    static constexpr int order = Scheme<N>::stepper_order_value;

    ControlledPair(const Problem& problem, double tolerance) : Base(problem, tolerance, order) {
        this->scheme_ = Controlled<N, Scheme>(ComponentError<N>(tolerance, this->scales_));
    }

    Attempt attempt(double& t, double& h) {
        const OdeintArray<N> before = this->y_;
        const double begin = t, tried = h;
        const OdeintRightHandSide<SystemType> f{&this->system_, &this->evaluations_};
        const bool accepted = this->scheme_.try_step(f, this->y_, t, h) == boost::numeric::odeint::success;
        if (accepted && this->finite()) {
            this->project();
            return Attempt::accepted;
        }
        if (!accepted && h < tried) return Attempt::rejected;
        this->y_ = before, t = begin, h = not_finite_shrinkage * tried;
        this->clear_history();
        return Attempt::not_finite;
    }
};

/// Solves the problem with the pair, with fixed steps or by tolerance.
template <template <std::size_t> class Scheme>
Trajectory solve_pair(const Problem& problem, const Settings& settings) {
    if (!settings.tolerance) return march_odeint<Scheme>(problem, settings);
    if (!is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    return with_system(problem, [&]<class SystemType>() {
        return march_controlled(problem, settings, ControlledPair<SystemType, Scheme>(problem, *settings.tolerance));
    });
}

}  // namespace polhode
