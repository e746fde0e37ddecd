// DOP853 with step size control, in registers for rotations and for any right-hand side otherwise.
//
// GeneralDop853 and RotationDop853 perform one step and form its dense output. ControlledDop853 selects the step
// sizes by the error estimate of dop853.f (Hairer, Norsett & Wanner 1993, II.5 and II.10).
#include <algorithm>

#include "integrators/contact/solve_contacts.h"
#include "integrators/own/compensated_state.h"
#include "integrators/own/dop853_interpolant.h"
#include "integrators/own/dormand_prince.h"
#include "integrators/run/amplification.h"
#include "integrators/run/controlled_steps.h"
#include "integrators/run/march_controlled.h"
#include "integrators/run/tolerance.h"
#include "motion/formula_model.h"

namespace polhode {
namespace {

/// The allowed error of a component is increased by this factor times its increment.
constexpr double dop853_rounding = 0x1p-52;

struct PairErrors {
    double fifth, third;  ///< squared, in units of the allowed error
};

template <class SystemType>
class GeneralDop853 : public GeneralState<SystemType> {
    using Base = GeneralState<SystemType>;
    using Y = typename Base::Y;

  public:
    using Base::Base;

    PairErrors attempt(double t, double h) {
        const int N = this->system_.size();
        std::array<Y, dop853_stages>& k = rates_;
        this->system_.derivative(t, this->y_.data(), k[0].data());
        Y y(N);
        for (int s = 1; s < dop853_stages; ++s) {
            for (int i = 0; i < N; ++i) y[i] = this->y_[i] + h * weighted_sum(k, dop853.a[s], s, i);
            this->system_.derivative(t + dop853.c[s] * h, y.data(), k[s].data());
        }
        PairErrors errors{0, 0};
        for (int i = 0; i < N; ++i) {
            const double slope = weighted_sum(k, dop853.b, dop853_stages, i), change = h * slope;
            const double fifth = h * weighted_sum(k, dop853.fifth_error, dop853_stages, i);
            const double third = h * (slope - weighted_sum(k, dop853.third, dop853_stages, i));
            const double allowed = this->squared_scale_[i] + dop853_rounding * change * (dop853_rounding * change);
            errors.fifth += fifth * fifth / allowed;
            errors.third += third * third / allowed;
            this->add(i, change, 0);
        }
        return errors;
    }
    void accept() {
        start_ = this->y_, lost_at_start_ = this->lost_;
        Base::accept();
    }
    /// Forms the dense output of the last accepted step, from t to t + h (s).
    void interpolate(double t, double h) {
        Y change(this->system_.size());
        // next_ is the end state before projection.
        for (int i = 0; i < this->system_.size(); ++i)
            change[i] = (this->next_[i] - start_[i]) + (this->next_lost_[i] - lost_at_start_[i]);
        interpolant_.form(this->system_, t, h, start_.data(), change, rates_);
    }
    /// The state at the fraction x of that step.
    Y state_inside(double x) const {
        Y y = interpolant_.change(x);
        for (int i = 0; i < this->system_.size(); ++i) y[i] = start_[i] + (lost_at_start_[i] + y[i]);
        project_step(this->system_, y.data());
        return y;
    }
    /// The motion at t (s), at the fraction x of that step.
    auto motion_inside(double t, double x) const { return this->system_.motion(t, state_inside(x).data()); }

  private:
    std::array<Y, dop853_stages> rates_ = copies_of<dop853_stages>(Y(this->system_.size()));
    Y start_{this->system_.size()}, lost_at_start_ = start_;
    Dop853Interpolant<Y> interpolant_{this->system_.size()};

    static double weighted_sum(const std::array<Y, dop853_stages>& k, const double* weights, int count, int i) {
        double sum = 0;
        for (int j = 0; j < count; ++j)
            if (weights[j] != 0) sum += weights[j] * k[j][i];
        return sum;
    }
};

template <class SystemType>
class RotationDop853 : public RotationLanes<SystemType> {
    using Base = RotationLanes<SystemType>;

  public:
    RotationDop853(const Problem& problem, double tolerance)
        : Base(problem, tolerance, dop853_rounding), step_(dop853_step(instruction_set())) {}

    PairErrors attempt(double, double h) {
        step_(this->coefficients_, this->allowance_, this->state_, h, next_);
        return {next_.squared_error, next_.squared_error_before};
    }
    void accept() { start_ = this->state_, this->state_ = next_.state; }
    /// Forms the dense output of the last accepted step, from t to t + h (s).
    void interpolate(double t, double h) {
        Y change(SystemType::dimension);
        for (std::size_t i = 0; i < change.size(); ++i)
            change[i] = (this->state_.y[i] - start_.y[i]) + (this->state_.lost[i] - start_.lost[i]);
        interpolant_.form(this->system_, t, h, start_.y, change, next_.rates);
    }
    /// The motion at t (s), at the fraction x of that step.
    auto motion_inside(double t, double x) const {
        Y y = interpolant_.change(x);
        for (std::size_t i = 0; i < y.size(); ++i) y[i] = start_.y[i] + (start_.lost[i] + y[i]);
        return this->system_.motion(t, y.data());
    }

  private:
    using Y = Numbers<SystemType::dimension>;

    Dop853Step* step_;
    Dop853RotationStep next_;
    RotationState start_;
    Dop853Interpolant<Y> interpolant_{SystemType::dimension};
};

/// Step control of dop853.f. Both estimates combine into an error of order 8; h_new = 0.9 h error^(-1/8), limited to
/// h/3 to 6 h, with no growth after a rejection.
template <class State>
class ControlledDop853 {
  public:
    ControlledDop853(const Problem& problem, double tolerance)
        : duration_(problem.scene.duration), state_(problem, tolerance) {}

    void restart() {
        state_.restart();
        evaluations_ = sample_evaluations_ = 0;
    }
    void enter(const Segment& segment) { state_.enter(segment); }
    double first_step(double t) {
        rejected_ = false;
        evaluations_ += 2;
        return 0.5 * state_.first_step(t, duration_);
    }
    Attempt attempt(double& t, double& h) {
        const PairErrors errors = state_.attempt(t, h);
        evaluations_ += dop853_stages;
        if (!std::isfinite(errors.fifth) || !std::isfinite(errors.third)) {
            h *= 0.1, rejected_ = true;
            return Attempt::not_finite;
        }
        const double both = errors.fifth + 0.01 * errors.third;
        const double squared_error = both > 0 ? errors.fifth * (errors.fifth / both) : 0;
        const double tried = h;
        const double factor = squared_error > 0 ? 0.9 * std::pow(squared_error, -1.0 / 16) : 6;
        const bool accepted = squared_error <= 1;
        h *= std::clamp(factor, 1.0 / 3, accepted && !rejected_ ? 6.0 : accepted ? 1.0 : 0.9);
        rejected_ = !accepted;
        if (!accepted) return Attempt::rejected;
        state_.accept();
        start_ = t, length_ = tried, has_interpolant_ = false;
        t += tried;
        return Attempt::accepted;
    }
    std::vector<double> switch_values() const requires SwitchingState<State> { return state_.switch_values(); }
    std::string cross_switch(std::size_t which) requires SwitchingState<State> { return state_.cross_switch(which); }
    auto sample(double t) const { return state_.sample(t); }
    auto sample_inside(double t) {
        interpolate();
        return state_.motion_inside(t, (t - start_) / length_);
    }
    static constexpr int dense_degree = 8;
    const double* state() const { return state_.state(); }
    /// Writes the state at the time s after the start of the last step.
    void state_inside(double s, double* y) requires requires(const State& state) { state.state_inside(0.5); }
    {
        interpolate();
        const auto inside = state_.state_inside(s / length_);
        std::copy(inside.begin(), inside.end(), y);
    }
    long rhs_evaluations() const { return evaluations_; }
    long sample_evaluations() const { return sample_evaluations_; }

  private:
    void interpolate() {
        if (has_interpolant_) return;
        state_.interpolate(start_, length_);
        sample_evaluations_ += Dop853Interpolant<Numbers<1>>::evaluations;
        has_interpolant_ = true;
    }

    double duration_;
    State state_;
    bool rejected_ = false, has_interpolant_ = false;
    double start_ = 0, length_ = 0;  // s, of the last accepted step
    long evaluations_ = 0, sample_evaluations_ = 0;
};

std::unique_ptr<SystemSteps> dop853_steps(const Problem& problem, double tolerance) {
    using Stepper = ControlledDop853<GeneralDop853<ErasedSystem>>;
    return std::make_unique<ControlledSteps<Stepper>>(problem, Stepper(problem, local_tolerance(tolerance)));
}

Trajectory solve_dop853(const Problem& problem, const Settings& settings) {
    const double tolerance = *settings.tolerance;
    if (!is_reachable(tolerance)) return unreachable_tolerance(tolerance);
    if (contact::has_events(problem.scene)) return contact::solve_events(problem, settings, dop853_steps);
    const double aim = local_tolerance(tolerance);
    if (has_formula_loads(problem.scene) && has_switches(problem))
        return march_controlled(problem, settings, ControlledDop853<GeneralDop853<SwitchedSystem>>(problem, aim));
    return with_system(problem, [&]<class SystemType>() {
        if constexpr (is_rotation<SystemType>)
            if (RotationLanes<SystemType>::supports(problem))
                return march_controlled(problem, settings, ControlledDop853<RotationDop853<SystemType>>(problem, aim));
        return march_controlled(problem, settings, ControlledDop853<GeneralDop853<SystemType>>(problem, aim));
    });
}

double dop853_amplification(std::complex<double> z) {
    return runge_kutta_amplification({&dop853.a[0][0], std::size_t{dop853_stages} * dop853_stages}, dop853.b, z);
}

constexpr Method dop853_variants[] = {
    {.name = "dop853",
     .documentation =
         "Dormand & Prince's method of order 8 with the error estimates of orders 5 and 3 of Hairer, Norsett & Wanner, "
         "step size by the tolerance, compensated summation; any right-hand side. Twelve right-hand sides per "
         "attempted step, and nine per step that has samples inside it, for dense output of order 8. Rotations under "
         "the loads of a scene file run in vector registers, with the same bits on every instruction set. Suited to "
         "loose tolerances and rough right-hand sides. Events of contacts and joints are located on the dense output.",
     .source = "Dormand & Prince 1981; Hairer, Norsett & Wanner 1993, II.5 and II.10 (DOP853)",
     .conserves = "nothing",
     .control = Control::tolerance,
     .general_systems = true,
     .order = 0,
     .solve = solve_dop853,
     .amplification = dop853_amplification,
     .steps = dop853_steps,
     .refusal = contact::event_refusal},
};

constexpr auto dop853_list = apply_defaults({.family = Family::runge_kutta}, dop853_variants);

}  // namespace

extern const std::span<const Method> dop853_methods{dop853_list};

}  // namespace polhode
