// Taylor series method for any polynomial formulation. The requested digits set the order; the last coefficients set
// the step (A. Jorba and M. Zou 2005, Exp. Math. 14, 99); samples come from the polynomial; steps end where loads
// change.
//
// taylor() records a formulation's right-hand side (Series), expands it at each step and returns a Run.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"
#include "integrators/series/series.h"
#include "integrators/truth/allowance.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"

namespace polhode::truth {

/// Result of a run. Sample is the type that the formulation's motion() returns.
template <class P, class Sample = Motion<P>>
struct Run {
    std::string fault;            ///< why the run stopped early; empty if it did not
    std::vector<Sample> motions;  ///< one per sample
    std::vector<P> impacts;       ///< times of impacts on planes, s
    long steps = 0;
};

struct TaylorSettings {
    int order;
    double digits;       ///< local error: 10^-digits of each block's scale
    double step_factor;  ///< ratio of the step to the one that just meets `digits`
    long max_steps;
};

/// Settings of the two runs of a reference with `digits` digits per step. The work order^2 / step is minimal near order
/// = ln(10) / 2 digits (Jorba & Zou 2005). The fine run has a higher order, a smaller tolerance and steps shortened by
/// the factor 0.93.
struct TaylorRuns {
    TaylorSettings coarse, fine;

    TaylorRuns(double digits, long max_steps)
        : coarse{static_cast<int>(std::ceil(1.15 * digits)) + 2, digits, 1, max_steps},
          fine{static_cast<int>(std::ceil(1.3 * digits)) + 5, digits + 2, 0.93, max_steps} {}
};

/// log2 of the largest component of a block of y.
template <class Component>
double log2_size(const Block& block, Component&& component) {
    double largest = -std::numeric_limits<double>::infinity();
    for (int i = block.first; i < block.first + block.size; ++i)
        largest = std::max(largest, log2_magnitude(component(i)));
    return largest;
}

/// Default handler of each step's polynomial: does nothing.
struct IgnoreStep {
    template <class P, class Step>
    void operator()(const P&, const P&, const Step&) const {}
};

/// Follows the legs with a formulation of one or several bodies. `blocks` initially hold estimates of the largest
/// lengths. on_step(t, h, series) receives the polynomial of the step from t to t + h.
template <class P, class Form, class OnStep = IgnoreStep>
auto taylor(Form form, const std::vector<Leg>& legs, const std::vector<double>& sample_times, std::vector<Block> blocks,
            const TaylorSettings& settings, const OnStep& on_step = {}) {
    using T = typename SeriesScalar<P>::Type;
    Run<P, decltype(form.motion(nullptr))> run;
    const int n = form.dimension();
    std::vector<P> y(n), at_sample(n);
    SampleQueue samples(sample_times);

    const auto enter = [&](const Leg& leg) {
        form.enter(leg.begin, y.data());
        return true;
    };
    const auto show = [&](double) {
        run.motions.push_back(form.motion(y.data()));
        return true;
    };
    form.initial(y.data());
    follow(legs, samples, enter, show, [&](const Leg& leg) {
        Series<T> series(cast_recording<T>(record<P>(form, n)), settings.order);
        P t(leg.begin);
        while (t < leg.end) {
            if (run.steps++ >= settings.max_steps) {
                run.fault = "the step limit is reached";
                return false;
            }
            if (Allowance::is_spent()) {
                run.fault = Allowance::fault;
                return false;
            }
            for (Block& block : blocks) {
                const double size = std::exp2(log2_size(block, [&](int i) -> const P& { return y[i]; }));
                block.scale = std::max(block.scale, size);
            }
            series.expand(y.data());
            // |c_k| h^k <= 10^-digits scale for the last four coefficients, because one may vanish by symmetry
            double log2_step = std::numeric_limits<double>::infinity();
            for (const Block& block : blocks)
                for (int k = settings.order - 3; k <= settings.order; ++k) {
                    const double size = log2_size(block, [&](int i) -> const T& { return series.coefficient(i, k); });
                    const double allowed = std::log2(block.scale) - settings.digits * std::log2(10.0);
                    log2_step = std::min(log2_step, (allowed - size) / k);
                }
            const P remaining = P(leg.end) - t;
            const double step = settings.step_factor * std::exp2(log2_step);
            if (std::isnan(step)) {
                run.fault = "the motion is not finite";
                return false;
            }
            const bool to_end = remaining <= step;
            const P h = to_end ? remaining : P(step);
            const P reached = to_end ? P(leg.end) : t + h;
            if (!to_end && reached <= t) {
                run.fault = "step size below the spacing of numbers";
                return false;
            }
            for (; samples.due(leg, reached); samples.pop()) {
                series.evaluate(P(P(samples.front()) - t), at_sample.data());
                run.motions.push_back(form.motion(at_sample.data()));
            }
            on_step(t, h, series);
            series.evaluate(h, y.data());
            t = reached;
        }
        return true;
    });
    return run;
}

/// Follows a scene with a formulation constructed from it. `moments`: any estimate of the principal moments.
template <class P, class Form, class OnStep = IgnoreStep>
auto taylor(const Scene& scene, const std::vector<double>& sample_times, const Scales& scales,
            const Vector3<double>& moments, const TaylorSettings& settings, const OnStep& on_step = {}) {
    Form form(scene);
    std::vector<Block> blocks = form.blocks(scales, moments);
    return taylor<P>(std::move(form), itinerary(scene), sample_times, std::move(blocks), settings, on_step);
}

}  // namespace polhode::truth
