// Radau IIA with 3, 5 and 7 stages, with all stages side by side in vector registers.
//
// Radau holds the state and solves the collocation equations by simplified Newton iterations (Equations, Kernel),
// each of which solves four linear systems side by side (FourSystems, DenseSystems). FixedRadau takes fixed steps.
// ControlledRadau controls the step size (Hairer & Wanner 1996, IV.8, and 1999).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "integrators/contact/solve_contacts.h"
#include "integrators/own/dense_systems.h"
#include "integrators/own/radau_coefficients.h"
#include "integrators/own/stages.h"
#include "integrators/run/amplification.h"
#include "integrators/run/controlled_steps.h"
#include "integrators/run/march.h"
#include "integrators/run/march_controlled.h"
#include "integrators/run/refusals.h"
#include "integrators/run/tolerance.h"
#include "motion/formula_model.h"
#include "motion/jacobian.h"
#include "motion/numbers.h"

namespace polhode {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

template <class SystemType>
struct LinearSystems {
    using Type = FourSystems<SystemType::dimension, SystemType::rates>;
};
template <class SystemType>
requires(SystemType::dimension == run_time) struct LinearSystems<SystemType> {
    using Type = DenseSystems;
};

/// The equations of one step, Z = h (A x I) f(y + Z).
template <class SystemType>
struct Equations {
    static constexpr int N = SystemType::dimension;
    using Systems = typename LinearSystems<SystemType>::Type;
    static constexpr int squared = N == run_time ? run_time : N * N;

    explicit Equations(int n) : y(n), weight(n), J(n * n), matrix(matrix_of(n)), Z(n) {}

    Numbers<N> y;          ///< at the start of the step
    Numbers<N> weight;     ///< weight of each component in norms
    Numbers<squared> J;    ///< df/dy, row by row
    Systems matrix;        ///< eigenvalue / h - J
    Numbers<N, Stages> Z;  ///< y at the stages minus y at the start

  private:
    static Systems matrix_of([[maybe_unused]] int n) {
        if constexpr (N == run_time)
            return Systems(n);
        else
            return {};
    }
};

/// Evaluates the right-hand side at the stages.
template <class SystemType>
[[gnu::always_inline]] inline void compute_stage_rates(const SystemType& system, double t, const Stages* y, Stages* dy,
                                                       int) {
    system.derivative(t, y, dy);
}
template <class SystemType>
requires(SystemType::dimension == run_time)
    [[gnu::noinline]] void compute_stage_rates(const SystemType& system, double t, const Stages* y, Stages* dy,
                                               int stages) {
    Numbers<run_time> at(system.size()), rate(system.size());
    for (int j = 0; j < stages; ++j) {
        for (int n = 0; n < system.size(); ++n) at[n] = y[n].lane[j];
        system.derivative(t, at.data(), rate.data());
        for (int n = 0; n < system.size(); ++n) dy[n].lane[j] = rate[n];
    }
}

template <class SystemType>
[[gnu::always_inline]] inline void factor(Equations<SystemType>& e, const RadauCoefficients& radau, double h) {
    const double per_h = 1 / h;
    e.matrix.factor({radau.eigenvalue.re * per_h, radau.eigenvalue.im * per_h}, e.J.data());
}

/// One simplified Newton iteration: (I - h A x J) dZ = h (A x I) f(y + Z) - Z, then Z += dZ. Returns the weighted
/// root mean square of dZ over all stages. The residual uses A itself, so rounding errors of the eigenvectors do not
/// affect it.
template <class SystemType>
[[gnu::always_inline]] inline double newton_iteration(Equations<SystemType>& e, const SystemType& system,
                                                      const RadauCoefficients& radau, double t, double h) {
    const int N = system.size();
    const int s = radau.stages;
    const double per_h = 1 / h;
    Numbers<SystemType::dimension, Stages> Y(N), F(N);
    for (int n = 0; n < N; ++n) Y[n] = e.y[n] + e.Z[n];
    compute_stage_rates(system, t, Y.data(), F.data(), s);
    Numbers<SystemType::dimension, Complex4> W(N);
    for (int n = 0; n < N; ++n) {
        // Lambda T^-1 (A F - Z / h); multiplication by (eigenvalue / h - J)^-1 gives T^-1 dZ
        Lanes8 residual = -per_h * e.Z[n].lane, transformed{};
        for (int j = 0; j < s; ++j) residual += F[n].lane[j] * radau.a[j];
        for (int j = 0; j < s; ++j) transformed += residual[j] * radau.to_eigenbasis[j];
        W[n].re = __builtin_shufflevector(transformed, transformed, 0, 1, 2, 3);
        W[n].im = __builtin_shufflevector(transformed, transformed, 4, 5, 6, 7);
    }
    e.matrix.solve(W.data());
    Lanes8 squares{};
    for (int n = 0; n < N; ++n) {
        Lanes8 change{};
        for (int k = 0; k < 4; ++k) change += W[n].re[k] * radau.from_eigenbasis[k];
        for (int k = 0; k < 3; ++k) change += W[n].im[k] * radau.from_eigenbasis[4 + k];
        e.Z[n].lane += change;
        const Lanes8 weighted = e.weight[n] * change;
        squares += weighted * weighted;
    }
    double sum = 0;
    for (int j = 0; j < 8; ++j) sum += squares[j];
    return std::sqrt(sum / (N * s));
}

/// x := (gamma / h - J)^-1 x with the real eigenvalue gamma.
template <class SystemType>
[[gnu::always_inline]] inline void solve_real(const Equations<SystemType>& e, double* x) {
    const int N = static_cast<int>(e.y.size());
    Numbers<SystemType::dimension, Complex4> W(N);
    for (int n = 0; n < N; ++n) W[n].re = Lanes4{0, 0, 0, x[n]};
    e.matrix.solve(W.data());
    for (int n = 0; n < N; ++n) x[n] = W[n].re[3];
}

/// The three functions above, compiled for one instruction set.
template <class SystemType>
struct Kernel {
    void (*factor)(Equations<SystemType>&, const RadauCoefficients&, double h);
    double (*newton_iteration)(Equations<SystemType>&, const SystemType&, const RadauCoefficients&, double t, double h);
    void (*solve_real)(const Equations<SystemType>&, double*);
};

#define POLHODE_RADAU_KERNEL(NAME, TARGET)                                                                            \
    template <class SystemType>                                                                                       \
    struct NAME {                                                                                                     \
        using E = Equations<SystemType>;                                                                              \
        TARGET [[gnu::flatten]] static void factor_equations(E& e, const RadauCoefficients& radau, double h) {        \
            factor(e, radau, h);                                                                                      \
        }                                                                                                             \
        TARGET [[gnu::flatten]] static double iterate_equations(E& e, const SystemType& system,                       \
                                                                const RadauCoefficients& radau, double t, double h) { \
            return newton_iteration(e, system, radau, t, h);                                                          \
        }                                                                                                             \
        TARGET [[gnu::flatten]] static void solve_equations(const E& e, double* x) { solve_real(e, x); }              \
        static constexpr Kernel<SystemType> kernel{factor_equations, iterate_equations, solve_equations};             \
    };
POLHODE_RADAU_KERNEL(PlainKernel, )
POLHODE_RADAU_KERNEL(Avx2Kernel, POLHODE_TARGET_AVX2)
POLHODE_RADAU_KERNEL(Avx512Kernel, POLHODE_TARGET_AVX512)
#undef POLHODE_RADAU_KERNEL

template <class SystemType>
const Kernel<SystemType>& select_kernel(InstructionSet set) {
    constexpr const Kernel<SystemType>* all[] = {&PlainKernel<SystemType>::kernel, &Avx2Kernel<SystemType>::kernel,
                                                 &Avx512Kernel<SystemType>::kernel};
    return *all[static_cast<std::size_t>(set)];
}

/// The state on one segment and the data of one step. Steppers of one run share `equations_`, which hold no data
/// between attempts.
template <class SystemType>
class Radau {
  public:
    Radau(const Problem& problem, int stages)
        : problem_(&problem),
          system_(problem),
          kernel_(select_kernel<SystemType>(instruction_set())),
          radau_(&radau_coefficients(stages)),
          equations_(std::make_shared<Equations<SystemType>>(system_.size())) {
        system_.scales(scales_.data());
        restart();
    }
    void restart() {
        system_.initial(y_.data());
        std::fill(rounding_error_.begin(), rounding_error_.end(), 0);
        evaluations_ = 0;
        last_h_ = 0;
    }
    void enter(const Segment& segment) {
        if (system_.enter(segment, y_.data())) std::fill(rounding_error_.begin(), rounding_error_.end(), 0);
        last_h_ = 0;
    }
    const double* state() const { return y_.data(); }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }

  protected:
    struct Newton {
        bool converged = false, finite = true;
        int iterations = 0;
        double expected = 0;  ///< expected error after the last allowed iteration, in units of `newton_tolerance`
    };

    using Values = Numbers<SystemType::dimension>;

    double norm(const Values& v) const {
        const int N = system_.size();
        double sum = 0;
        for (int i = 0; i < N; ++i) sum += (v[i] * equations_->weight[i]) * (v[i] * equations_->weight[i]);
        return std::sqrt(sum / N);
    }

    /// Sets the weight of component i to 1 / (unit (scale_i + |y_i|)).
    void set_weights(double unit) {
        for (int i = 0; i < system_.size(); ++i) {
            equations_->y[i] = y_[i];
            equations_->weight[i] = 1 / (unit * (scales_[i] + std::abs(y_[i])));
        }
    }

    void compute_jacobian(const Values& y) { jacobian(system_, 0, y.data(), equations_->J.data()); }

    /// Sets up the equations. Z is extrapolated from the previous step's polynomial unless the step grows too much.
    /// The Jacobian is evaluated at the predicted middle of the step; in a fast spin this halves the iterations
    /// compared with a Jacobian at the start.
    void set_up_step(double h) {
        constexpr double max_step_ratio = 8;
        Equations<SystemType>& e = *equations_;
        const int N = system_.size();
        Values middle(N);
        const double ratio = h / last_h_;
        const bool has_polynomial = last_h_ > 0 && ratio <= max_step_ratio;
        const Lanes8 x = ratio * radau_->nodes;
        for (int n = 0; n < N; ++n) {
            Lanes8 sum{};
            double half = 0;
            for (int k = has_polynomial ? radau_->stages : 0; k-- > 0;) {
                sum = (sum + polynomial_[n][k]) * x;
                half = (half + polynomial_[n][k]) * (ratio / 2);
            }
            e.Z[n].lane = sum, middle[n] = y_[n] + half;
        }
        compute_jacobian(middle);
        kernel_.factor(e, *radau_, h);
    }

    /// Iterates until the next change is expected below `newton_tolerance`, or until only rounding remains: changes
    /// near `noise` that no longer shrink.
    Newton solve(double t, double h, double newton_tolerance, double noise, int max_iterations) {
        Newton newton;
        // The first changes may come from components that converge faster than others. Near rounding level, where the
        // remaining error accumulates over all steps, no better ratio than this is assumed (a fast top: 3e-13 instead
        // of 1e-11).
        const double min_change_ratio = newton_tolerance < 2 * noise ? 0.3 : 0;
        double last = 0, last_rate = 0, change_ratio = std::max({0.01, std::pow(change_ratio_, 0.8), min_change_ratio});
        for (; newton.iterations < max_iterations;) {
            const double change = kernel_.newton_iteration(*equations_, system_, *radau_, t, h);
            evaluations_ += radau_->stages;
            ++newton.iterations;
            if (!std::isfinite(change)) {
                newton.finite = false;
                return newton;
            }
            if (newton.iterations > 1) {
                const double now = change / last, rate = newton.iterations == 2 ? now : std::sqrt(now * last_rate);
                last_rate = now;
                // Slow convergence continues until the changes are at noise level.
                if (now > 0.2 && change <= (now > 0.7 ? 64 : 4) * noise) {
                    newton.converged = true;
                    return newton;
                }
                if (!(rate < 0.99)) {
                    newton.expected = 1e4;
                    return newton;
                }
                change_ratio = std::max(rate / (1 - rate), min_change_ratio);
                newton.expected =
                    change_ratio * change * std::pow(rate, max_iterations - newton.iterations) / newton_tolerance;
            }
            last = change;
            if (change_ratio * change <= newton_tolerance) {
                newton.converged = true;
                change_ratio_ = change_ratio;
                return newton;
            }
            if (newton.expected >= 1) return newton;
        }
        return newton;
    }

    /// Adds Z_s to y with compensation. Keeps the polynomial through the stages for begin() of the next step.
    void accept_step(double h) {
        const int s = radau_->stages;
        for (int n = 0; n < system_.size(); ++n) {
            const Lanes8& Z = equations_->Z[n].lane;
            const double change = Z[s - 1] + rounding_error_[n], sum = y_[n] + change;
            rounding_error_[n] = change - (sum - y_[n]);
            y_[n] = sum;
            Lanes8 coefficients{};
            for (int j = 0; j < s; ++j) coefficients += Z[j] * radau_->power[j];
            for (int k = 0; k < s; ++k) polynomial_[n][k] = coefficients[k];
        }
        last_h_ = h;
        if (project_step(system_, y_.data())) std::fill(rounding_error_.begin(), rounding_error_.end(), 0);
    }

    const Problem* problem_;
    SystemType system_;
    Kernel<SystemType> kernel_;
    const RadauCoefficients* radau_;
    std::shared_ptr<Equations<SystemType>> equations_;
    Values scales_{system_.size()}, y_ = scales_, rounding_error_ = scales_;
    Numbers<SystemType::dimension, std::array<double, 8>> polynomial_{
        system_.size()};       ///< powers x, x^2, ..: y at 1 + x, in units of the last step, minus y at its end
    double last_h_ = 0;        ///< last step size; 0: no polynomial
    double change_ratio_ = 1;  ///< sum of later changes relative to the last one
    long evaluations_ = 0;
};

template <class SystemType>
class FixedRadau : public Radau<SystemType> {
  public:
    FixedRadau(const Problem& problem, const int& stages) : Radau<SystemType>(problem, stages) {}

    void restart() {
        Radau<SystemType>::restart();
        failure_time_.reset();
    }
    void step(double t, double h) {
        constexpr int max_iterations = 50;
        if (failure_time_) return;
        this->set_weights(1);
        this->set_up_step(h);
        const auto newton = this->solve(t, h, epsilon / 8, epsilon, max_iterations);
        if (!newton.converged)
            failure_time_ = t;
        else
            this->accept_step(h);
    }
    bool failed() const { return failure_time_.has_value(); }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::failed;
        trajectory.message =
            fmt::format("Newton's iteration for the stages did not converge at t = {:g} s", *failure_time_);
    }

  private:
    std::optional<double> failure_time_;
};

/// Step size control of Hairer & Wanner (1996), IV.8, and (1999).
template <class SystemType>
class ControlledRadau : public Radau<SystemType> {
    using Base = Radau<SystemType>;
    using Base::equations_, Base::evaluations_, Base::radau_, Base::system_, Base::y_;
    using typename Base::Values;

  public:
    ControlledRadau(const Problem& problem, double tolerance, int stages) : Base(problem, stages) {
        // The error estimate has order s, the error that it stands for has order 2 s - 1.
        const double s = stages;
        error_unit_ = 0.1 * std::pow(tolerance, (s + 1) / (2 * s));
        newton_tolerance_ = std::max(epsilon / error_unit_, 0.01 * std::sqrt(error_unit_));
        max_iterations_ = 7 + 5 * (stages - 3) / 2;
        restart();
    }
    void restart() {
        Base::restart();
        newton_failures_ = 0;
        reset_control();
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        reset_control();
    }
    std::vector<double> switch_values() const requires SwitchingSystem<SystemType> {
        return system_.switch_values(y_.data());
    }
    std::string cross_switch(std::size_t which) requires SwitchingSystem<SystemType> {
        reset_control();
        return system_.cross_switch(which, y_.data());
    }
    long newton_failures() const { return newton_failures_; }

    /// First step size, from the time scale |y'| / |y''| of the initial motion.
    double first_step(double t) {
        this->set_weights(error_unit_);
        compute_rate(t);
        this->compute_jacobian(y_);
        const int N = system_.size();
        Values second(N);
        for (int i = 0; i < N; ++i) {
            second[i] = 0;
            for (int j = 0; j < N; ++j) second[i] += equations_->J[i * N + j] * rate_[j];
        }
        const double T = this->problem_->scene.duration;
        const double h = std::pow(error_unit_, 1.0 / (radau_->stages + 1)) * this->norm(rate_) / this->norm(second);
        // A right-hand side that is not finite is detected and reported at the first attempt.
        return h > 0 && h < T / 10 ? h : T / 10;
    }

    Attempt attempt(double& t, double& h) {
        const int s = radau_->stages;
        this->set_weights(error_unit_);
        if (!has_rate_) compute_rate(t);
        this->set_up_step(h);
        const auto newton = this->solve(t, h, newton_tolerance_, epsilon / error_unit_, max_iterations_);
        if (!newton.finite) return not_finite(h);
        if (!newton.converged) {
            ++newton_failures_;
            h *= std::min(
                0.5, 0.8 * std::pow(std::max(newton.expected, 1.0), -1.0 / (4 + max_iterations_ - newton.iterations)));
            return Attempt::rejected;
        }
        const double error = std::max(estimate(t, h), min_error);
        if (!std::isfinite(error)) return not_finite(h);

        const double power = 1.0 / (s + 1);
        const double safety = 0.9 * (1 + 2.0 * max_iterations_) / (newton.iterations + 2.0 * max_iterations_);
        double ratio = std::clamp(safety * std::pow(error, -power), min_ratio, max_ratio);
        if (error >= 1) {
            h *= first_ ? 0.1 : ratio;
            rejected_ = true;
            return Attempt::rejected;
        }
        if (!first_) {
            // Gustafsson 1994: use the trend of the last two errors.
            const double predicted = 0.9 * h / last_size_ * std::pow(error * error / last_error_, -power);
            ratio = std::min(ratio, std::clamp(predicted, min_ratio, max_ratio));
        }
        if (rejected_) ratio = std::min(ratio, 1.0);
        last_error_ = std::max(error, 0.01), last_size_ = h;
        this->accept_step(h);
        t += h, h *= ratio;
        first_ = rejected_ = has_rate_ = false;
        return Attempt::accepted;
    }

  private:
    // Far beyond the usual 8: after a decay within 1e-8 s, five steps are enough to return to a step of 1 s.
    static constexpr double min_ratio = 0.125, max_ratio = 100, min_error = 1e-18;

    void reset_control() { first_ = true, rejected_ = has_rate_ = false; }
    void compute_rate(double t) {
        system_.derivative(t, y_.data(), rate_.data());
        ++evaluations_;
        has_rate_ = true;
    }
    static Attempt not_finite(double& h) {
        h *= 0.1;
        return Attempt::not_finite;
    }

    /// Error estimate (gamma - h J)^-1 h (f(y) - p'(0)) with the collocation polynomial p: the distance to the
    /// formula of order s that includes f(y). If it would reject a first step or a step after a rejection, it is
    /// filtered once more.
    double estimate(double t, double h) {
        const int N = system_.size();
        Values slope(N), error(N), z(N), rate(N);
        for (int n = 0; n < N; ++n) {
            slope[n] = 0;
            for (int j = 0; j < radau_->stages; ++j) slope[n] += radau_->slope_at_0[j] * equations_->Z[n].lane[j];
            slope[n] /= h;
            error[n] = rate_[n] - slope[n];
        }
        this->kernel_.solve_real(*equations_, error.data());
        if (!(this->norm(error) >= 1) || !(first_ || rejected_)) return this->norm(error);
        for (int n = 0; n < N; ++n) z[n] = y_[n] + error[n];
        system_.derivative(t, z.data(), rate.data());
        ++evaluations_;
        for (int n = 0; n < N; ++n) error[n] = rate[n] - slope[n];
        this->kernel_.solve_real(*equations_, error.data());
        return this->norm(error);
    }

    double error_unit_;        ///< tolerance of the error estimate
    double newton_tolerance_;  ///< tolerance of the Newton iteration, in these units
    int max_iterations_;
    Values rate_{system_.size()};  ///< f at the start of the step
    double last_error_ = 1, last_size_ = 1;
    bool first_ = true, rejected_ = false, has_rate_ = false;
    long newton_failures_ = 0;
};

int stages_for(double tolerance) {
    // Order 9 takes a half to nine tenths of the time of order 13 at 1e-3, and more from 1e-5 on.
    return tolerance > 3e-5 ? 5 : 7;
}

std::unique_ptr<SystemSteps> radau_steps(const Problem& problem, double tolerance) {
    using Stepper = ControlledRadau<ErasedSystem>;
    return std::make_unique<ControlledSteps<Stepper>>(
        problem, Stepper(problem, local_tolerance(tolerance), stages_for(tolerance)));
}

Trajectory solve_stages(const Problem& problem, const Settings& settings, int stages) {
    if (settings.tolerance && !is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    if (!settings.step && has_formula_loads(problem.scene) && has_switches(problem))
        return march_controlled(problem, settings,
                                ControlledRadau<SwitchedSystem>(problem, local_tolerance(*settings.tolerance), stages));
    return with_system(problem, [&]<class SystemType>() {
        if (settings.step) return march<FixedRadau<SystemType>>(problem, settings, stages);
        return march_controlled(problem, settings,
                                ControlledRadau<SystemType>(problem, local_tolerance(*settings.tolerance), stages));
    });
}

template <int stages>
Trajectory solve_radau(const Problem& problem, const Settings& settings) {
    return solve_stages(problem, settings, stages);
}

Trajectory solve_any_order(const Problem& problem, const Settings& settings) {
    if (contact::has_events(problem.scene) && is_reachable(*settings.tolerance))
        return contact::solve_events(problem, settings, radau_steps);
    return solve_stages(problem, settings, stages_for(*settings.tolerance));
}

std::string radau_refusal(const Problem& problem) {
    if (std::string why = no_jacobian_of_user_torque(problem); !why.empty()) return why;
    return contact::event_refusal(problem);
}

constexpr std::string_view radau_source =
    "E. Hairer and G. Wanner 1999, Stiff differential equations solved by Radau methods, J. Comput. Appl. Math. 111, "
    "93-111; Solving Ordinary Differential Equations II, 1996, IV.5 and IV.8";

constexpr std::string_view fixed_order_documentation =
    "Radau IIA collocation of one order, at fixed steps with the stages solved to round-off, or by tolerance as "
    "`radau`.";

constexpr Method radau_variants[] = {
    {.name = "radau",
     .documentation =
         "Radau IIA collocation of order 13 (7 stages), or of order 9 (5 stages) at tolerances above 3e-5, for stiff "
         "motion. L-stable: decaying components are damped at any step size, and the remaining smooth motion is "
         "integrated in the long steps of the high order, so that stiffness costs nothing. The stages are solved by "
         "simplified Newton iteration with the exact Jacobian, all stages side by side in vector registers (AVX-512, "
         "AVX2 or neither, with the same bits), and the linear systems by elimination without row exchanges in the "
         "order p, v, q, omega. Relative tolerance R, absolute tolerance R times the component's scale. Samples inside "
         "a step are computed by separate steps. The sum over steps is compensated. |q| is not projected; it stays 1 "
         "to within the tolerance. User-defined torques are `unsupported`, because they have no Jacobian. Right-hand "
         "sides are counted, Jacobians (one per attempt) are not. Events of contacts and joints are located on a "
         "collocation polynomial of each step.",
     .control = Control::tolerance,
     .solve = solve_any_order,
     .steps = radau_steps},
    {.name = "radau5",
     .documentation = fixed_order_documentation,
     .order = 5,
     .solve = solve_radau<3>,
     .amplification = radau_amplification<3>},
    {.name = "radau9",
     .documentation = fixed_order_documentation,
     .order = 9,
     .solve = solve_radau<5>,
     .amplification = radau_amplification<5>},
    {.name = "radau13",
     .documentation = fixed_order_documentation,
     .order = 13,
     .solve = solve_radau<7>,
     .amplification = radau_amplification<7>},
};

constexpr auto radau_list = apply_defaults({.source = radau_source,
                                            .conserves = "nothing",
                                            .control = Control::fixed_step_or_tolerance,
                                            .general_systems = true,
                                            .family = Family::runge_kutta,
                                            .refusal = radau_refusal},
                                           radau_variants);

}  // namespace

extern const std::span<const Method> radau_methods{radau_list};

}  // namespace polhode
