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

#include "integrators/truth/attempt_formula.h"
#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/formula_form.h"
#include "integrators/truth/switches.h"
#include "motion/formula_potential.h"

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
          samples_(sample_times) {}

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
            if (std::isnan(step)) return fail("the motion is not finite", t);
            const P remaining = P(leg.end) - t;
            const bool to_end = remaining <= step;
            P h = to_end ? remaining : P(step);
            P reached = to_end ? P(leg.end) : t + h;
            const auto points = form_.switching_points();
            const auto crossing = find_first_crossing(series, points, h);
            if (crossing) h = crossing->after, reached = t + h;
            if (leaves_threshold(series, points, h)) return fail("chattering along a switching surface", t);
            if (!to_end && !crossing && reached <= t) return fail("step size below the spacing of numbers", t);
            for (; samples_.due(leg, reached); samples_.pop()) {
                series.evaluate(P(P(samples_.front()) - t), at_sample_.data());
                run_.motions.push_back(form_.motion(at_sample_.data()));
            }
            series.evaluate(h, y_.data());
            form_.refresh(y_.data());
            t = reached;
            if (!crossing) continue;
            if (++switches_ > most_switches) return fail("too many switches", t);
            if (const std::string fault = form_.cross_switch(crossing->which, y_.data()); !fault.empty())
                return fail(fault, t);
            series = record_equations();
        }
        return true;
    }

    // |c_k| h^k <= 10^-digits scale for the last four coefficients, because one may vanish by symmetry
    double step_size(const Series<T>& series) {
        for (Block& block : blocks_) {
            const double size =
                std::exp2(log2_size(block, [&](int i) -> const P& { return y_[static_cast<std::size_t>(i)]; }));
            block.scale = std::max(block.scale, size);
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
    // compare_runs() adds the potentials of all other loads
    std::vector<ReferenceSample>& samples = attempt.truth.reference.samples;
    if (has_formula_potential(scene))
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Motion<P>& m = first.motions[i];
            const P energy = P(samples[i].energy.high) + P(samples[i].energy.low) +
                             formula_potential<P>(scene, sample_times[i], m.q, m.position_W);
            samples[i].energy = pair_of(energy);
        }
    return attempt;
}

}  // namespace polhode::truth
