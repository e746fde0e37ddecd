// The attempt for one body in contact with planes. Each working precision is instantiated in its own file.
//
// Both runs pass through the same events, except that a series of impacts with a limit may end a few impacts earlier in
// one of them, and that events at one time may be in another order. match_events() pairs the events and measures the
// differences of their times and impulses, which count in the bound.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/follow_contacts.h"
#include "integrators/contact/reduced_form.h"
#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/multiplier_form.h"

namespace polhode::truth {

/// Differences of the events of two runs.
template <class P>
struct EventDifference {
    P time{0};                                     ///< largest difference of times, s
    P impulse{0};                                  ///< largest difference of impulses, N s
    P largest_impulse{0};                          ///< N s
    std::string fault;                             ///< why the events do not match; empty if they do
    std::vector<P> first_impacts, second_impacts;  ///< times of the matched impacts
};

/// Events near the limit of infinitely many impacts. Runs differ in the number of impacts before the limit, and so in
/// the events of other contacts that these impacts cause.
template <class P>
struct LimitGroup {
    std::size_t end;  ///< index after the group
    bool has_limit = false;
    static constexpr int many = 5;  ///< this many impacts within the window are near their limit

    /// The group contains all events within `window` (s) of `begin`. Those from `next` on are not matched yet.
    LimitGroup(const std::vector<contact::Event<P>>& events, std::size_t next, const P& begin, const P& window)
        : end(next) {
        while (end < events.size() && events[end].t - begin <= window) ++end;
        int impacts = 0;
        for (std::size_t i = end; i-- > 0 && begin - events[i].t <= window;) {
            // impacts without restitution land; a few may follow each other at one time on another one with restitution
            impacts += events[i].kind == contact::EventKind::impact || events[i].kind == contact::EventKind::lands;
            has_limit = has_limit || events[i].kind == contact::EventKind::accumulates || impacts == many;
        }
    }
};

template <class P>
EventDifference<P> match_events(const contact::Record<P>& a, contact::Record<P> b) {
    using Kind = contact::EventKind;
    EventDifference<P> result;
    std::size_t i = 0, j = 0;
    // skips events near a limit of impacts; returns false if there is none
    const auto skip_group = [&](const P& begin) {
        const P window = P(1e-20) * begin;
        const LimitGroup<P> first(a.events, i, begin, window), second(b.events, j, begin, window);
        if (!first.has_limit || !second.has_limit) return false;
        if (first.end > 0 && second.end > 0)
            result.time = std::max(result.time, P(abs(a.events[first.end - 1].t - b.events[second.end - 1].t)));
        i = first.end, j = second.end;
        return true;
    };
    // moves the event of b that matches the next one of a to the front of those at the same time
    const auto reorder = [&] {
        const contact::Event<P>& x = a.events[i];
        for (std::size_t k = j + 1; k < b.events.size() && b.events[k].t - b.events[j].t <= P(1e-20) * x.t; ++k) {
            if (b.events[k].kind != x.kind || b.events[k].plane != x.plane) continue;
            const auto begin = b.events.begin();
            std::rotate(begin + static_cast<std::ptrdiff_t>(j), begin + static_cast<std::ptrdiff_t>(k),
                        begin + static_cast<std::ptrdiff_t>(k) + 1);
            return true;
        }
        return false;
    };
    while (i < a.events.size() || j < b.events.size()) {
        if (i == a.events.size() || j == b.events.size()) {
            if (!skip_group(i < a.events.size() ? a.events[i].t : b.events[j].t)) break;
            continue;
        }
        const contact::Event<P>&x = a.events[i], &y = b.events[j];
        // one run may count a few more impacts before their limit
        if (x.kind == Kind::impact && y.kind == Kind::accumulates) {
            ++i;
            continue;
        }
        if (x.kind == Kind::accumulates && y.kind == Kind::impact) {
            ++j;
            continue;
        }
        if (x.kind != y.kind || x.plane != y.plane) {
            if (!skip_group(std::min(x.t, y.t)) && !reorder()) break;
            continue;
        }
        result.time = std::max(result.time, P(abs(x.t - y.t)));
        result.largest_impulse = std::max(result.largest_impulse, x.normal_impulse);
        result.impulse = std::max({result.impulse, P(abs(x.normal_impulse - y.normal_impulse)),
                                   P(length(x.tangential_impulse_W - y.tangential_impulse_W))});
        if (x.kind == Kind::impact || x.kind == Kind::lands)
            result.first_impacts.push_back(x.t), result.second_impacts.push_back(y.t);
        ++i, ++j;
    }
    if (i < a.events.size() || j < b.events.size()) {
        const contact::Event<P>& next = i < a.events.size() ? a.events[i] : b.events[j];
        result.fault = fmt::format("the two formulations disagree about the event at t = {:.10g} s",
                                   next.t.template convert_to<double>());
    }
    return result;
}

/// Writes events, intervals and forces of a run as decimals.
template <class P>
void write_contacts(Truth& truth, const contact::Run<P>& run, int digits) {
    for (const contact::Event<P>& e : run.record.events) {
        const Vector3<P>& J = e.tangential_impulse_W;
        truth.contact_events.push_back(
            {decimal_of(e.t, digits),
             e.plane,
             contact::event_names[static_cast<std::size_t>(e.kind)],
             decimal_of(e.normal_impulse, digits),
             {decimal_of(J[0], digits), decimal_of(J[1], digits), decimal_of(J[2], digits)}});
    }
    for (const contact::Interval<P>& in : run.record.intervals)
        truth.contact_intervals.push_back({decimal_of(in.from, digits), decimal_of(in.to, digits), in.plane,
                                           contact::mode_names[static_cast<std::size_t>(in.mode)], in.largest_ratio});
    for (std::size_t i = 0; i < run.forces_W.size(); ++i)
        for (std::size_t plane = 0; plane < run.forces_W[i].size(); ++plane) {
            ReactionDecimals decimals{"0", "0", "0", "0", "0", "0"};
            const Vector3<P>& torque = run.torques_W[i][plane];
            for (std::size_t c = 0; c < 3; ++c) {
                decimals[c] = decimal_of(run.forces_W[i][plane][c], digits);
                if (!(torque[c] == P(0))) decimals[c + 3] = decimal_of(torque[c], digits);
            }
            truth.reaction_decimals.push_back(decimals);
        }
}

/// The motions of a run with contacts, and the times of its matched impacts.
template <class P>
Run<P> plain_run(const contact::Run<P>& run, std::vector<P> impacts) {
    return {run.fault, run.motions, std::move(impacts), run.steps};
}

template <unsigned working>
Attempt attempt_by_contact_modes(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const auto stop = [] { return Allowance::is_spent() ? Allowance::fault : nullptr; };
    const auto settings = [&](const TaylorSettings& s) {
        return contact::ContactSettings{s.order, local_digits, s.digits, s.step_factor, s.max_steps, stop};
    };
    const auto follow_with = [&]<class Form>(const TaylorSettings& s) {
        return contact::ContactDriver<P, Form>(problem.scene, sample_times, settings(s)).run();
    };
    auto pending = in_thread([&] { return follow_with.template operator()<MultiplierForm<P>>(runs.coarse); });
    const contact::Run<P> first = follow_with.template operator()<contact::ReducedForm<P>>(runs.fine);
    const contact::Run<P> second = pending.get();
    const std::string& fault = first.fault.empty() ? second.fault : first.fault;
    if (!fault.empty()) return failed_attempt(fault);
    const EventDifference<P> events = match_events(first.record, second.record);
    if (!events.fault.empty()) return failed_attempt(events.fault);
    const Run<P> one = plain_run(first, events.first_impacts), other = plain_run(second, events.second_impacts);
    P difference(disagreement(one, other));
    difference = std::max(difference, P(events.time / P(sample_times.back() > 0 ? sample_times.back() : 1)));
    if (events.largest_impulse > 0) difference = std::max(difference, P(events.impulse / events.largest_impulse));
    const int digits = static_cast<int>(working);
    Truth truth = make_truth(problem, sample_times, one, digits);
    add_formula_potentials(truth.reference, problem.scene, sample_times, one.motions);
    write_contacts(truth, first, digits);
    return make_attempt(
        std::move(truth), one, other, difference.template convert_to<double>(),
        fmt::format("contact modes by Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} "
                    "steps; {} events, times differ by at most {:.1e} s",
                    working, contact::ReducedForm<P>::name, runs.fine.order, first.steps, MultiplierForm<P>::name,
                    runs.coarse.order, second.steps, first.record.events.size(),
                    events.time.template convert_to<double>()),
        digits);
}

}  // namespace polhode::truth
