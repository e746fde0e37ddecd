// Steps of a method through the smooth system of one mode, with a polynomial of each step.
//
// Drivers of events integrate by Taylor series, or by the steps of another method (motion/system_steps.h). For its
// dense output, or, where it has none, a collocation polynomial, the states at Chebyshev points are found, and the
// functions whose zeros are events are evaluated there. The collocation equations
//   Y_j = y_0 + h sum of I_ji f(Y_i)
// are solved by Picard's iteration from the cubic through the ends of the step; a step for which it does not converge
// to the end of the step, or whose polynomial has highest terms above the tolerance, is repeated with half the length.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/mode_series.h"
#include "integrators/contact/step_polynomial.h"
#include "integrators/series/limb_real.h"
#include "integrators/series/series.h"
#include "motion/dual.h"
#include "motion/system_steps.h"
#include "motion/traced.h"
#include "motion/user_system.h"

namespace polhode::contact {

/// Order of the Taylor series that shows how event functions start in the first step of a mode by another method. They
/// have zeros of third order at most.
inline constexpr int order_of_starts = 5;

/// The scale of each component of a state. `rest`: of components that no block contains.
inline std::vector<double> scales_of(const std::vector<Block>& blocks, std::size_t components, double rest) {
    std::vector<double> scales(components, rest);
    for (const Block& block : blocks) std::fill_n(scales.begin() + block.first, block.size, block.scale);
    return scales;
}

/// The system of a mode as a user-defined one. `Form`: see follow_contacts.h; must outlive the model.
template <class Form>
class ModeModel : public ErasedModel {
  public:
    /// `start`: the state, without integrals of functions.
    ModeModel(const Form& form, std::vector<double> start, std::vector<double> scales)
        : form_(&form),
          start_(std::move(start)),
          scales_(std::move(scales)),
          all_(static_cast<std::size_t>(form.dimension())) {}

    int dimension() const override { return static_cast<int>(start_.size()); }
    void initial(double* y) const override { std::copy(start_.begin(), start_.end(), y); }
    void derivative(const double* y, double* dy) const override {
        all_rates(y, all_.data());
        std::copy_n(all_.begin(), start_.size(), dy);
    }
    void derivative(const Dual<jacobian_directions>* y, Dual<jacobian_directions>* dy) const override {
        std::vector<Dual<jacobian_directions>> all(all_.size());
        form_->derivative(y, all.data());
        std::copy_n(all.begin(), start_.size(), dy);
    }
    void derivative(const Traced<double>*, Traced<double>*) const override { not_recorded(); }
    void derivative(const Traced<long double>*, Traced<long double>*) const override { not_recorded(); }
    std::vector<double> scales() const override { return scales_; }
    std::vector<Sample> motion(const double*) const override { return {Sample{}}; }
    std::vector<Reaction<double>> reactions(const double*) const override { return {}; }
    std::vector<double> events() const override { return {}; }
    bool projects() const override { return false; }
    void project(double*) const override {}
    double kinetic_energy(const Bodies&) const override { return 0; }
    double energy_bound() const override { return std::numeric_limits<double>::infinity(); }
    std::shared_ptr<const ErasedModel> enter_event(double, double*) const override { return nullptr; }

    /// Rates of the state and values of the functions.
    void all_rates(const double* y, double* dy) const {
        ++evaluations_;
        form_->derivative(y, dy);
    }
    long evaluations() const { return evaluations_; }
    const Form& form() const { return *form_; }
    /// Whether functions may change while the state does not.
    bool has_formulas() const {
        if constexpr (requires { form_->has_formulas(); }) return form_->has_formulas();
        return false;
    }

  private:
    const Form* form_;
    std::vector<double> start_, scales_;
    mutable std::vector<double> all_;
    mutable long evaluations_ = 0;

    [[noreturn]] static void not_recorded() { throw std::logic_error("only Taylor series record modes"); }
};

/// Steps of a method through one mode after another, in binary64. Other scalars are not supported.
template <class P, class Form>
class ModeSteps {
  public:
    ModeSteps(MakeSystemSteps make, double, double) {
        if (make) throw std::logic_error("methods step in binary64");
    }
    bool is_running() const { return false; }
    void end_mode() {}
    void start(const Form&, const P*, const std::vector<double>&, const std::vector<double>& = {}) {}
    double step(double) { return 0; }
    std::string fault() const { return ""; }
    const StepPolynomial& polynomial() const { return polynomial_; }
    long evaluations() const { return 0; }

  private:
    StepPolynomial polynomial_;
};
template <class Form>
class ModeSteps<double, Form> {
  public:
    /// `duration`: of the run, s.
    ModeSteps(MakeSystemSteps make, double tolerance, double duration)
        : make_(make), tolerance_(tolerance), duration_(duration) {}

    bool is_running() const { return steps_ != nullptr; }
    void end_mode() {
        count_evaluations();
        steps_.reset(), model_.reset();
    }
    /// Starts a mode from the state y of `scales.size()` components. `form` must not change until end_mode().
    /// `function_scales`: sizes of the functions after the state, whose polynomials must be as accurate as the state;
    /// empty or zero: not required.
    void start(const Form& form, const double* y, std::vector<double> scales,
               std::vector<double> function_scales = {}) {
        end_mode();
        function_scales_ = std::move(function_scales);
        std::vector<double> state(y, y + scales.size());
        for (double& scale : scales)
            if (!(scale > 0) || !std::isfinite(scale)) scale = 1;
        form_ = &form;
        scales_ = std::move(scales), state_ = std::move(state);
        restart();
        longest_ = resolved_ = std::numeric_limits<double>::infinity();
        rates_at_start_.resize(static_cast<std::size_t>(form.dimension()));
        model_->all_rates(state_.data(), rates_at_start_.data());
    }
    /// Takes a step of at most `longest`. Returns its length; 0 on a fault.
    double step(double longest) {
        constexpr int most_halvings = 60;
        longest = std::min(longest, longest_);
        for (int i = 0; i < most_halvings; ++i) {
            const double h = steps_->step(longest);
            if (!(h > 0)) {
                fault_ = steps_->fault();
                return 0;
            }
            if (expand(h)) {
                state_ = states_.back(), rates_at_start_ = rates_.back();
                // methods with dense output start with short steps, and increase them by their own error estimate
                resolved_ *= 1.1;
                if (model_->has_formulas())
                    longest_ = steps_->dense_degree() > 0 ? resolved_ : std::min(2 * h, resolved_);
                return h;
            }
            // methods with dense output cannot return to the start of a step
            resolved_ = h / 2;
            if (steps_->dense_degree() > 0)
                restart();
            else
                steps_->undo();
            longest = h / 2;
        }
        fault_ = "the polynomial of a step does not converge at any step size";
        return 0;
    }
    const std::string& fault() const { return fault_; }
    const StepPolynomial& polynomial() const { return polynomial_; }
    long evaluations() const {
        return evaluations_ + (model_ ? model_->evaluations() : 0) + (steps_ ? steps_->evaluations() : 0);
    }

  private:
    MakeSystemSteps make_;
    double tolerance_, duration_;
    double longest_ = 0,
           resolved_ =
               0;  // limits of the next step if functions depend on time: the used one, and that of steps that failed
    const Form* form_ = nullptr;
    std::shared_ptr<ModeModel<Form>> model_;
    Problem problem_;
    std::unique_ptr<SystemSteps> steps_;
    std::vector<double> scales_, function_scales_, state_, rates_at_start_;
    std::vector<std::vector<double>> states_, rates_;  // at the points of the step
    StepPolynomial polynomial_;
    std::string fault_;
    long evaluations_ = 0;

    // starts the method from state_
    void count_evaluations() { evaluations_ = evaluations(); }
    void restart() {
        count_evaluations();
        steps_.reset();
        model_ = std::make_shared<ModeModel<Form>>(*form_, state_, scales_);
        problem_ = pose_model(model_, duration_);
        steps_ = make_(problem_, tolerance_);
    }
    // Forms the polynomial of a step of length h from state_.
    bool expand(double h) {
        const int dense = steps_->dense_degree();
        const ChebyshevPoints& points =
            ChebyshevPoints::of_degree(dense > 0 && !model_->has_formulas() ? dense + 2 : ChebyshevPoints::most_degree);
        const std::size_t count = static_cast<std::size_t>(points.count());
        states_.assign(count, state_), rates_.assign(count, rates_at_start_);
        std::copy_n(steps_->state(), state_.size(), states_.back().begin());
        model_->all_rates(states_.back().data(), rates_.back().data());
        if (dense > 0) {
            for (std::size_t j = 1; j + 1 < count; ++j) {
                steps_->inside(points.point(static_cast<int>(j)) * h, states_[j].data());
                model_->all_rates(states_[j].data(), rates_[j].data());
            }
        } else if (!collocate(points, h)) {
            return false;
        }
        polynomial_.fit(points, h, static_cast<int>(state_.size()), states_, rates_,
                        std::max(1e-2 * tolerance_, 1e-15));
        return (dense > 0 || is_resolved()) && resolves_functions();
    }
    // whether the highest terms of the states are below the tolerance
    bool is_resolved() const {
        for (std::size_t i = 0; i < state_.size(); ++i)
            if (polynomial_.last_term(static_cast<int>(i)) >
                std::max(0.1 * tolerance_, 1e-14) * (scales_[i] + std::abs(state_[i])))
                return false;
        return true;
    }
    // whether the highest terms of the functions are below the tolerance
    bool resolves_functions() const {
        const std::vector<double> scales =
            function_scales_.empty() && model_->has_formulas() ? largest_functions() : function_scales_;
        // dense output has errors of the tolerance's size, which functions of the state increase
        const bool has_noise = !function_scales_.empty() && steps_->dense_degree() > 0;
        const double allowed = std::max((has_noise ? 100 : 0.1) * tolerance_, 1e-12);
        for (std::size_t f = 0; f < scales.size(); ++f)
            if (scales[f] > 0 && polynomial_.last_term(static_cast<int>(state_.size() + f)) > allowed * scales[f])
                return false;
        return true;
    }
    // the largest values of the functions in the step
    std::vector<double> largest_functions() const {
        const std::size_t first = state_.size();
        std::vector<double> sizes(rates_.front().size() - first, 0.0);
        for (const std::vector<double>& rates : rates_)
            for (std::size_t f = 0; f < sizes.size(); ++f) sizes[f] = std::max(sizes[f], std::abs(rates[first + f]));
        // a function may be zero up to rounding
        constexpr double least = 1e-3;
        double largest = *std::max_element(scales_.begin(), scales_.end());
        for (const double size : sizes) largest = std::max(largest, size);
        for (double& size : sizes) size = std::max(size, least * largest);
        return sizes;
    }
    // the cubic through the states and rates at both ends
    void start_from_cubic(const ChebyshevPoints& points, double h) {
        for (std::size_t j = 1; j + 1 < states_.size(); ++j) {
            const double x = points.point(static_cast<int>(j)), y = 1 - x;
            for (std::size_t i = 0; i < state_.size(); ++i)
                states_[j][i] = y * y * (1 + 2 * x) * states_.front()[i] + x * x * (1 + 2 * y) * states_.back()[i] +
                                h * x * y * (y * rates_.front()[i] - x * rates_.back()[i]);
        }
    }
    // Solves the collocation equations. Returns false if the iteration does not converge to the end of the step.
    bool collocate(const ChebyshevPoints& points, double h) {
        // changes may grow in the first iterations; later only rounding increases them
        constexpr int most_iterations = 30, first_iterations = 6;
        start_from_cubic(points, h);
        const std::size_t last = states_.size() - 1;
        const double small = std::max(1e-2 * tolerance_, 4e-15);
        double former = std::numeric_limits<double>::infinity();
        for (int iteration = 0; iteration < most_iterations; ++iteration) {
            for (std::size_t j = 1; j < last; ++j) model_->all_rates(states_[j].data(), rates_[j].data());
            double change = 0;
            for (std::size_t j = 1; j <= last; ++j)
                for (std::size_t i = 0; i < state_.size(); ++i) {
                    double increment = 0;
                    for (std::size_t l = 0; l <= last; ++l)
                        increment += points.integral(static_cast<int>(j), static_cast<int>(l)) * rates_[l][i];
                    const double next = states_.front()[i] + h * increment;
                    // not finite if the iteration diverges
                    const double moved = std::abs(next - states_[j][i]) / (scales_[i] + std::abs(next));
                    if (!std::isfinite(moved)) return false;
                    if (j < last) {
                        states_[j][i] = next;
                        change = std::max(change, moved);
                    } else if (change <= small && moved > std::max(10 * tolerance_, 1e-13)) {
                        return false;
                    }
                }
            if (change <= small) return true;
            if (iteration > first_iterations && change > former) return change <= 10 * tolerance_;
            former = change;
        }
        return false;
    }
};

/// The polynomial of a step: a Taylor series, or that of a method's step, in binary64.
template <class P>
class StepExpansion {
    using T = typename SeriesScalar<P>::Type;

  public:
    // NOLINTNEXTLINE(google-explicit-constructor)
    StepExpansion(const Series<T>& series) : series_(&series) {}
    // NOLINTNEXTLINE(google-explicit-constructor)
    StepExpansion(const BinarySeries& series) requires std::same_as<P, double> : compiled_(&series) {}
    // NOLINTNEXTLINE(google-explicit-constructor)
    StepExpansion(const StepPolynomial& polynomial) : polynomial_(&polynomial) {}

    int order() const {
        if constexpr (std::same_as<P, double>) {
            if (polynomial_) return polynomial_->order();
            if (compiled_) return compiled_->order();
        }
        return series_->order();
    }
    bool is_of_method() const { return polynomial_ != nullptr; }
    /// The k-th coefficient of component i.
    P coefficient(int i, int k) const {
        if constexpr (std::same_as<P, double>) {
            if (polynomial_) return polynomial_->coefficient(i, k);
            if (compiled_) return compiled_->coefficient(i, k);
        }
        return static_cast<P>(series_->coefficient(i, k));
    }
    void evaluate(const P& s, P* y) const {
        if constexpr (std::same_as<P, double>) {
            if (polynomial_) return polynomial_->evaluate(s, y);
            if (compiled_) return compiled_->evaluate(s, y);
        }
        series_->evaluate(s, y);
    }

    /// The order of the last term of component i that is not negligible at s.
    int last_term(int i, const P& s) const {
        if constexpr (std::same_as<P, double>)
            return order();
        else
            return series_->last_term(i, log2_magnitude(s));
    }

  private:
    // exactly one is not null
    const Series<T>* series_ = nullptr;
    const BinarySeries* compiled_ = nullptr;
    const StepPolynomial* polynomial_ = nullptr;
};

}  // namespace polhode::contact
