// Shared wrappers of Boost.Odeint's steppers: the state on one of the systems, and the checks around an attempt.
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

/// After an attempt that is not finite, the step is multiplied by this factor.
inline constexpr double not_finite_shrinkage = 0.1;

/// Placeholder in OdeintState for types that hold their stepper themselves.
struct NoStepper {};

/// The state on one segment, in the system's scalar, with one of Odeint's steppers and the number of right-hand sides
/// since restart(). An event clears the derivative kept from the end of the last step (first same as last) or the
/// history of a multistep method.
template <class SystemType, class Scheme = NoStepper>
class OdeintState {
  public:
    static constexpr std::size_t dimension = static_cast<std::size_t>(SystemType::dimension);
    using Scalar = typename SystemType::Scalar;
    using Method = Scheme;

    explicit OdeintState(const Problem& problem) : problem_(&problem), system_(problem) { restart(); }
    void restart() {
        system_.initial(y_.data());
        evaluations_ = 0;
        clear_history();
    }
    void enter(const Segment& segment) {
        system_.enter(segment, y_.data());
        clear_history();
    }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }

  protected:
    void clear_history() {
        if constexpr (requires { scheme_.reset(); }) scheme_.reset();
    }
    /// After an accepted step: projects the state, if the system has a projection.
    void project() {
        if (project_step(system_, y_.data())) clear_history();
    }

    const Problem* problem_;
    SystemType system_;
    OdeintArray<dimension, Scalar> y_{system_.size()};
    long evaluations_ = 0;
    Scheme scheme_{};
};

/// The right-hand side with the signature that Odeint calls. It counts evaluations.
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
        do_step(this->scheme_, {&this->system_, &this->evaluations_}, this->y_, Scalar(t), Scalar(h));
        this->project();
    }

  private:
    // not inlined: GCC spills the stages if this is part of the loop over steps
    [[gnu::noinline]] static void do_step(typename Base::Method& scheme, OdeintRightHandSide<SystemType> f,
                                          OdeintArray<Base::dimension, Scalar>& y, Scalar t, Scalar h) {
        scheme.do_step(f, y, t, h);
    }
};

/// march() with one of Odeint's steppers, whose state is OdeintArray<N, S>.
template <template <std::size_t> class Scheme, class S = double>
Trajectory march_odeint(const Problem& problem, const Settings& settings) {
    return with_system_in<S>(
        problem, [&]<class SystemType>() { return march<OdeintFixedStepper<SystemType, Scheme>>(problem, settings); });
}

/// OdeintState with a tolerance R: the error of component i is kept below R (scale_i + |y_i|).
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
        // A right-hand side that is not finite is detected and reported at the first attempt.
        return step > 0 && std::isfinite(step) ? step : 1e-6 * this->problem_->scene.duration;
    }

  protected:
    double smallest_scale() const { return *std::min_element(scales_.begin(), scales_.end()); }

    double tolerance_;
    int order_;
    OdeintArray<N> scales_{this->system_.size()};
};

/// y' = z y for a complex number, in real and imaginary parts.
inline void linear_rate(std::complex<double> z, const double* y, double* rate) {
    rate[0] = z.real() * y[0] - z.imag() * y[1];
    rate[1] = z.imag() * y[0] + z.real() * y[1];
}

/// Boost's runge_kutta4 on the problem. It is compiled in its own file, because next to other steppers the compiler's
/// inlining budget does not reach the right-hand side of a heavy top (92 ns per step instead of 81).
Trajectory solve_rk4(const Problem& problem, const Settings& settings);

/// Boost's euler and runge_kutta4 in binary32.
Trajectory solve_euler_float32(const Problem& problem, const Settings& settings);
Trajectory solve_rk4_float32(const Problem& problem, const Settings& settings);

/// Boost's adams_bashforth_moulton on the problem, compiled in its own file for the same reason as solve_rk4().
Trajectory solve_adams_bashforth_moulton(const Problem& problem, const Settings& settings);
/// Method::amplification of adams_bashforth_moulton.
double adams_bashforth_moulton_growth(std::complex<double> z);

/// Boost's rosenbrock4 on the problem, with fixed or controlled steps, in its own file because it compiles only as
/// C++17.
Trajectory solve_rosenbrock4(const Problem& problem, const Settings& settings);
/// Method::amplification of rosenbrock4.
double rosenbrock4_growth(std::complex<double> z);

}  // namespace polhode
