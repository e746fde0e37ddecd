// Taylor series method over any formulation of polynomial form: order fixed by the digits asked for, step from the
// last coefficients (Jorba & Zou 2005), samples from the polynomial, legs between events.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"
#include "integrators/series/series.h"
#include "integrators/truth/allowance.h"
#include "integrators/truth/motion.h"
#include "motion/contact.h"
#include "motion/problem.h"

namespace polhode::truth {

/// What a run came to. Sample: what the formulation makes of a state.
template <class P, class Sample = Motion<P>>
struct Run {
    std::string fault;            ///< why it stopped early; empty if it did not
    std::vector<Sample> motions;  ///< one a sample
    std::vector<P> impacts;       ///< s, times of impacts on planes
    long steps = 0;
};

struct TaylorSettings {
    int order;
    double digits;       ///< local error 10^-digits of each block's scale
    double step_factor;  ///< the step over the one that just meets `digits`
    long max_steps;
};

/// The settings of the two runs of a truth with `digits` digits a step. The work order^2 / step is least near order =
/// ln(10) / 2 digits (Jorba & Zou 2005); the other run goes by a higher order, a finer tolerance and a step shortened
/// by an odd factor.
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

/// A formulation that knows planes: `geometry()` in its body axes, `placement(y)`, `fastest(a, b, reach)`: a bound on
/// the speed of the body's points where the first block of y is no longer than a, that of translation no longer than b;
/// `meet(tolerance, y)`: the impact of what is that near.
template <class Form, class P>
concept MeetsPlanes = requires(Form form, const P& x, P* y) {
    form.geometry();
    form.placement(y);
    form.fastest(x, x);
    form.meet(x, y);
};

/// No component of the block at `first` of y(t + s), 0 <= s <= h, is longer together with its two neighbours.
template <class P, class T>
P block_bound(const Series<T>& series, int first, const P& h) {
    P squares(0);
    for (int i = first; i < first + 3; ++i) {
        P sum(0), power(1);
        for (int k = 0; k <= series.order(); ++k, power *= h) sum += abs(P(series.coefficient(i, k))) * power;
        squares += sum * sum;
    }
    return square_root(squares);
}

/// When the first gap closes within a step of length h: time after its begin.
template <class P, class T, class Form>
std::optional<P> impact_within(const Form& form, const Series<T>& series, const P& h) {
    std::vector<P> y(form.dimension());
    const auto at = [&](const P& s) {
        series.evaluate(s, y.data());
        return form.placement(y.data());
    };
    return first_contact(form.geometry(), at, P(0), h,
                         form.fastest(block_bound(series, 0, h), block_bound(series, 10, h)));
}

/// What is done with each step's polynomial: nothing.
struct ForgetStep {
    template <class P, class Step>
    void operator()(const P&, const P&, const Step&) const {}
};

/// The impact at t, in place; false, with a fault, where the motion cannot be followed beyond it.
template <class P, class Form, class Sample>
bool meet(const Form& form, const TaylorSettings& settings, const P& t, const Scales& scales, P* y,
          Run<P, Sample>& run) {
    constexpr std::size_t most_impacts = 100'000;
    run.impacts.push_back(t);
    const double reach = form.geometry().reach.template convert_to<double>();
    // gaps that differ by what the steps may have lost close together
    const ImpactOutcome outcome = form.meet(P(reach * std::pow(10.0, 6 - settings.digits)), y);
    // below this speed the parabola of a flight is no higher than what the steps lose
    const double resting = std::pow(10.0, -settings.digits / 2) * (scales.velocity + reach * scales.angular_velocity);
    const char* why = nullptr;
    if (!outcome.resolved)
        why = "the contacts that touch at once find no impulses";
    else if (!outcome.struck || outcome.separation <= resting)
        why = "the body comes to rest on a plane, and resting contact is not followed";
    else if (run.impacts.size() > most_impacts)
        why = "they do not end";
    if (why)
        run.fault = fmt::format("{} impact{} up to t = {:.10g} s: {}", run.impacts.size(),
                                run.impacts.size() == 1 ? "" : "s", t.template convert_to<double>(), why);
    return !why;
}

/// Follows the legs with a formulation, which may be of several bodies. `blocks` begin with estimates of the largest
/// lengths; `scales` are asked for only where the formulation meets planes. on_step(t, h, series): the polynomial of
/// the step from t to t + h.
template <class P, class Form, class OnStep = ForgetStep>
auto taylor(Form form, const std::vector<Leg>& legs, const std::vector<double>& sample_times, std::vector<Block> blocks,
            [[maybe_unused]] const Scales& scales, const TaylorSettings& settings, const OnStep& on_step = {}) {
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
                run.fault = "more steps than are allowed";
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
            // |c_k| h^k <= 10^-digits scale for the last coefficients; of four, since one may vanish by symmetry
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
            P h = to_end ? remaining : P(step);
            P reached = to_end ? P(leg.end) : t + h;
            bool impact = false;
            if constexpr (MeetsPlanes<Form, P>)
                if (form.geometry().any())
                    if (const std::optional<P> after = impact_within(form, series, h)) {
                        h = *after, reached = t + h;
                        impact = true;
                    }
            if (!to_end && !impact && reached <= t) {
                run.fault = "the step vanishes";
                return false;
            }
            for (; samples.due(leg, reached); samples.pop()) {
                series.evaluate(P(P(samples.front()) - t), at_sample.data());
                run.motions.push_back(form.motion(at_sample.data()));
            }
            on_step(t, h, series);
            series.evaluate(h, y.data());
            t = reached;
            if constexpr (MeetsPlanes<Form, P>)
                if (impact && !meet(form, settings, t, scales, y.data(), run)) return false;
        }
        return true;
    });
    return run;
}

/// The motion of a scene by a formulation that is made from it; `moments`: any estimate of the principal moments.
template <class P, class Form, class OnStep = ForgetStep>
auto taylor(const Scene& scene, const std::vector<double>& sample_times, const Scales& scales,
            const Vector3<double>& moments, const TaylorSettings& settings, const OnStep& on_step = {}) {
    Form form(scene);
    std::vector<Block> blocks = form.blocks(scales, moments);
    return taylor<P>(std::move(form), itinerary(scene), sample_times, std::move(blocks), scales, settings, on_step);
}

}  // namespace polhode::truth
