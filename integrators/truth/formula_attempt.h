// Taylor series of the two formulations with formula loads (formula_form.h), for attempt_formula.h.
//
// FormulaRun follows one formulation. Each step ends at the first crossing of a switching point, where the sign of the
// switch changes and the equations are recorded again. Orders and steps are those of taylor.h.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/series/singular_step.h"
#include "integrators/truth/attempt_formula.h"
#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/formula_form.h"
#include "integrators/truth/switches.h"

namespace polhode::truth {

/// One run of a formulation with formula loads.
template <class P, class Form>
class FormulaRun {
    using T = typename SeriesScalar<P>::Type;
    using Output = Run<P, decltype(std::declval<const Form&>().motion(static_cast<const P*>(nullptr)))>;

  public:
    /// `blocks`: of the form's state, without the time.
    FormulaRun(const Scene& scene, const std::vector<double>& sample_times, Form form, std::vector<Block> blocks,
               const TaylorSettings& settings)
        : scene_(scene),
          settings_(settings),
          form_(std::move(form)),
          blocks_(std::move(blocks)),
          y_(static_cast<std::size_t>(form_.dimension())),
          at_sample_(y_.size()),
          samples_(sample_times) {
        scales_.assign(y_.size(), 1.0);
    }

    Output run() {
        form_.initial(y_.data());
        const auto enter = [&](const Leg& leg) {
            form_.enter(leg.begin, y_.data());
            return true;
        };
        const auto show = [&](double) {
            run_.motions.push_back(form_.motion(y_.data()));
            return true;
        };
        follow(itinerary(scene_), samples_, enter, show, [&](const Leg& leg) { return run_leg(leg); });
        return std::move(run_);
    }

  private:
    static constexpr long most_switches = 100'000;

    const Scene& scene_;
    const TaylorSettings& settings_;
    Form form_;
    std::vector<Block> blocks_;
    std::vector<P> y_, at_sample_;
    SampleQueue samples_;
    Output run_;
    long switches_ = 0;
    std::vector<double> scales_;               // by component
    std::optional<SingularStep<P>> singular_;  // made when first needed

    bool fail(const std::string& fault, const P& t) {
        run_.fault = fmt::format("{} at t = {:.10g} s", fault, t.template convert_to<double>());
        return false;
    }
    Series<T> record_equations() const {
        return {cast_recording<T>(record<P>(form_, form_.dimension())), settings_.order};
    }

    bool run_leg(const Leg& leg) {
        Series<T> series = record_equations();
        P t(leg.begin);
        while (t < leg.end) {
            if (run_.steps++ >= settings_.max_steps) return fail("the step limit is reached", t);
            if (Allowance::is_spent()) {
                run_.fault = Allowance::fault;
                return false;
            }
            series.expand(y_.data());
            const double step = step_size(series);
            if (std::isnan(step)) {
                if (!form_.terms().has_roots() || !take_singular_step(leg, t))
                    return fail("the motion is not finite", t);
                continue;
            }
            const P remaining = P(leg.end) - t;
            const bool to_end = remaining <= step;
            P h = to_end ? remaining : P(step);
            P reached = to_end ? P(leg.end) : t + h;
            const auto points = form_.switching_points();
            auto crossing = find_first_crossing(series, points, h);
            if (crossing) h = crossing->after, reached = t + h;
            bool at_zero = false;
            if (form_.terms().has_roots()) {
                const P whole = h;
                if (!end_at_root_zero(series, h, at_zero)) {
                    if (!take_singular_step(leg, t)) return fail("the motion is not finite", t);
                    continue;
                }
                if (h < whole) crossing.reset(), reached = t + h;
            }
            if (leaves_threshold(series, points, h)) return fail("chattering along a switching surface", t);
            if (!crossing && reached <= t) return fail("step size below the spacing of numbers", t);
            for (; samples_.due(leg, reached); samples_.pop()) {
                series.evaluate(P(P(samples_.front()) - t), at_sample_.data());
                run_.motions.push_back(form_.motion(at_sample_.data()));
            }
            series.evaluate(h, y_.data());
            form_.refresh(y_.data());
            t = reached;
            if (at_zero && t < leg.end && !take_singular_step(leg, t)) return fail("the motion is not finite", t);
            if (!crossing) continue;
            if (++switches_ > most_switches) return fail("too many switches", t);
            if (const std::string fault = form_.cross_switch(crossing->which, y_.data()); !fault.empty())
                return fail(fault, t);
            series = record_equations();
        }
        return true;
    }

    // Whether the rates at the end of a step differ from those of its polynomial: a square root has passed zero, where
    // its series changes sign.
    bool has_defect(const Series<T>& series, const P& h) {
        std::vector<P> y(y_.size()), rates(y_.size());
        series.evaluate(h, y.data());
        form_.derivative_by(y.data(), rates.data(), true);
        const double allowed = std::pow(10.0, 3 - settings_.digits);
        for (int i = 0; i < form_.time_index(); ++i) {
            P slope(0);
            for (int k = settings_.order; k > 0; --k) slope = slope * h + P(k) * P(series.coefficient(i, k));
            const P defect = (rates[static_cast<std::size_t>(i)] - slope) * h;
            if (!(std::abs(defect.template convert_to<double>()) <= allowed * scales_[static_cast<std::size_t>(i)]))
                return true;
        }
        return false;
    }
    // Shortens a step to the first zero of a square root. Returns false if there is no series at the start.
    bool end_at_root_zero(const Series<T>& series, P& h, bool& at_zero) {
        constexpr int most_halvings = 60;
        constexpr double smallness = 1e-30;
        std::vector<P> y(y_.size());
        const auto at = [&](const P& after) {
            series.evaluate(after, y.data());
            return form_.terms().root_arguments(form_.formula_state(y.data()));
        };
        for (int k = 0; k < most_halvings; ++k) {
            if (!has_defect(series, h)) return true;
            if (const auto zero = find_root_zero<P>(at, h, smallness)) {
                h = *zero, at_zero = true;
                return true;
            }
            h = h / P(2);
        }
        return false;
    }
    // A step from a state at which a square root has no series. Returns false if there is none.
    bool take_singular_step(const Leg& leg, P& t) {
        constexpr int stages = 24;
        if (!singular_) singular_.emplace(stages);
        const std::vector<SwitchOf<P>> points = form_.switching_points();
        std::vector<P> scratch;
        const auto accepts = [&](const std::vector<P>& end) {
            scratch = end;
            form_.refresh(scratch.data());
            return std::ranges::all_of(points, [&](const SwitchOf<P>& point) {
                return P(point.sign) * (scratch[static_cast<std::size_t>(point.component)] - point.threshold) >= 0;
            });
        };
        const auto derivative = [&](const P* y, P* dy) { form_.derivative_by(y, dy, true); };
        const auto h =
            singular_->solve(derivative, y_, P((P(leg.end) - t) / P(16)), scales_, settings_.digits + 2, accepts);
        if (!h || !(t + *h > t)) return false;
        const P reached = t + *h;
        const auto set = [&](const P& theta, std::vector<P>& y) {
            singular_->evaluate(theta, y.data());
            form_.refresh(y.data());
        };
        for (; samples_.due(leg, reached); samples_.pop()) {
            set(P((P(samples_.front()) - t) / *h), at_sample_);
            run_.motions.push_back(form_.motion(at_sample_.data()));
        }
        set(P(1), y_);
        t = reached;
        return true;
    }

    // |c_k| h^k <= 10^-digits scale for the last four coefficients, because one may vanish by symmetry
    double step_size(const Series<T>& series) {
        for (Block& block : blocks_) {
            const double size =
                std::exp2(log2_size(block, [&](int i) -> const P& { return y_[static_cast<std::size_t>(i)]; }));
            block.scale = std::max(block.scale, size);
            std::fill_n(scales_.begin() + block.first, block.size, block.scale);
        }
        double log2_step = std::numeric_limits<double>::infinity();
        for (const Block& block : blocks_)
            for (int k = settings_.order - 3; k <= settings_.order; ++k) {
                const double size = log2_size(block, [&](int i) -> const T& { return series.coefficient(i, k); });
                const double allowed = std::log2(block.scale) - settings_.digits * std::log2(10.0);
                if (std::isnan(size)) return size;
                log2_step = std::min(log2_step, (allowed - size) / k);
            }
        return settings_.step_factor * std::exp2(log2_step);
    }
};

template <unsigned working>
Attempt attempt_by_formula_series(const Problem& problem, const std::vector<double>& sample_times,
                                  double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    const Vector3<double>& moments = problem.body.principal.moments;
    const auto run = [&]<class Form>(Form form, const TaylorSettings& settings) {
        std::vector<Block> blocks = form.blocks(problem.scales, moments);
        return FormulaRun<P, Form>(scene, sample_times, std::move(form), std::move(blocks), settings).run();
    };
    auto second = in_thread([&] { return run(FormulaMomentumForm<P>(scene), runs.coarse); });
    const Run<P> first = run(FormulaEulerForm<P>(scene), runs.fine);
    const Run<P> other = second.get();
    Attempt attempt = compare_runs(
        problem, sample_times, first, other,
        fmt::format("Taylor series with formula loads in {} digits: {} at order {} in {} steps, {} at order {} in {} "
                    "steps",
                    working, FormulaEulerForm<P>::name, runs.fine.order, first.steps, FormulaMomentumForm<P>::name,
                    runs.coarse.order, other.steps),
        static_cast<int>(working));
    add_formula_potentials(attempt.truth.reference, scene, sample_times, first.motions);
    return attempt;
}

}  // namespace polhode::truth
