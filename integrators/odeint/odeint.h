// What the wraps of Boost.Odeint's steppers share: the state on one of the systems, and the guards around an attempt.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

#include "integrators/odeint/odeint_algebra.h"
#include "integrators/run/binary32.h"
#include "integrators/run/march.h"
#include "integrators/run/march_controlled.h"
#include "integrators/run/tolerance.h"

namespace polhode {

/// An attempt that is not finite is tried again with this fraction of the step.
inline constexpr double not_finite_shrinkage = 0.1;

/// No stepper: what stands in OdeintState for one that needs more than it gives.
struct NoStepper {};

/// The state on one segment in the scalar of the system, the count of right-hand sides since restart(), and one of
/// Odeint's steppers. An event makes it forget the derivative kept from the last step's end (first same as last), or
/// those of a multistep method.
template <class SystemType, class Scheme = NoStepper>
class OdeintState {
  public:
    static constexpr std::size_t dimension = static_cast<std::size_t>(SystemType::dimension);
    using Scalar = typename SystemType::Scalar;

    explicit OdeintState(const Problem& problem) : problem_(&problem), system_(problem) { restart(); }
    void restart() {
        system_.initial(y_.data());
        evaluations_ = 0;
        forget();
    }
    void enter(const Segment& segment) {
        system_.enter(segment, y_.data());
        forget();
    }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }

  protected:
    void forget() {
        if constexpr (requires { scheme_.reset(); }) scheme_.reset();
    }
    /// After an accepted step: back onto what the system keeps, where it keeps anything.
    void project() {
        if (project_step(system_, y_.data())) forget();
    }

    const Problem* problem_;
    SystemType system_;
    OdeintArray<dimension, Scalar> y_{system_.size()};
    long evaluations_ = 0;
    Scheme scheme_{};
};

/// The signature that Odeint calls; counts.
template <class SystemType>
struct OdeintRightHandSide {
    const SystemType* system;
    long* evaluations;

    template <class State>
    void operator()(const State& y, State& dydt, double t) const {
        ++*evaluations;
        system->derivative(t, y.data(), dydt.data());
    }
};

/// Any stepper of Odeint with do_step(), as a Stepper.
template <class SystemType, template <std::size_t> class Scheme>
class OdeintFixedStepper : public OdeintState<SystemType, Scheme<static_cast<std::size_t>(SystemType::dimension)>> {
    using Base = OdeintState<SystemType, Scheme<static_cast<std::size_t>(SystemType::dimension)>>;
    using Scalar = typename Base::Scalar;

  public:
    using Base::Base;
    void step(double t, double h) {
        this->scheme_.do_step(OdeintRightHandSide<SystemType>{&this->system_, &this->evaluations_}, this->y_, Scalar(t),
                              Scalar(h));
        this->project();
    }
};

/// march() of one of Odeint's steppers, whose state is OdeintArray<N, S>.
template <template <std::size_t> class Scheme, class S = double>
Trajectory march_odeint(const Problem& problem, const Settings& settings) {
    return with_system_in<S>(
        problem, [&]<class SystemType>() { return march<OdeintFixedStepper<SystemType, Scheme>>(problem, settings); });
}

/// The same state with a tolerance R: component i is held to R (scale_i + |y_i|).
template <class SystemType, class Scheme = NoStepper>
class ControlledOdeintState : public OdeintState<SystemType, Scheme> {
  public:
    static constexpr std::size_t N = OdeintState<SystemType>::dimension;

    ControlledOdeintState(const Problem& problem, double tolerance, int order)
        : OdeintState<SystemType, Scheme>(problem), tolerance_(tolerance), order_(order) {
        this->system_.scales(scales_.data());
    }

    double first_step(double t) {
        OdeintArray<N> tolerated = scales_;
        for (std::size_t i = 0; i < scales_.size(); ++i)
            tolerated[i] = tolerance_ * (scales_[i] + std::abs(this->y_[i]));
        const auto rate = [&](double later, const OdeintArray<N>& y, OdeintArray<N>& dydt) {
            this->system_.derivative(t + later, y.data(), dydt.data());
            ++this->evaluations_;
        };
        const double step = polhode::first_step(rate, this->y_, tolerated, order_);
        // a right-hand side that is not finite is met, and named, at the first attempt
        return step > 0 && std::isfinite(step) ? step : 1e-6 * this->problem_->scene.duration;
    }

  protected:
    double smallest_scale() const { return *std::min_element(scales_.begin(), scales_.end()); }

    double tolerance_;
    int order_;
    OdeintArray<N> scales_{this->system_.size()};
};

/// y' = z y of a complex number, by its real and imaginary part.
inline void linear_rate(std::complex<double> z, const double* y, double* rate) {
    rate[0] = z.real() * y[0] - z.imag() * y[1];
    rate[1] = z.imag() * y[0] + z.real() * y[1];
}

/// Boost's runge_kutta4 on the problem. Compiled alone: among the other steppers the compiler's budget for inlining
/// runs out before the right-hand side of a heavy top (92 ns a step instead of 81).
Trajectory solve_rk4(const Problem& problem, const Settings& settings);

/// Boost's euler and runge_kutta4 in binary32.
Trajectory solve_euler_float32(const Problem& problem, const Settings& settings);
Trajectory solve_rk4_float32(const Problem& problem, const Settings& settings);

/// Boost's adams_bashforth_moulton on the problem. Compiled alone, likewise.
Trajectory solve_adams_bashforth_moulton(const Problem& problem, const Settings& settings);
/// Method::growth of it.
double adams_bashforth_moulton_growth(std::complex<double> z);

/// Boost's rosenbrock4 on the problem, fixed or controlled; in a file of its own, for it compiles only as C++17.
Trajectory solve_rosenbrock4(const Problem& problem, const Settings& settings);
/// Method::growth of it.
double rosenbrock4_growth(std::complex<double> z);

}  // namespace polhode
