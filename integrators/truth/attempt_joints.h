// The attempt for several bodies whose joints have limits or friction. Each working precision is instantiated in its
// own file.
//
// Both runs pass through the same events, except that a series of impacts with a limit may end a few impacts earlier in
// one of them, as may the changes of friction that these impacts cause. match_joint_events() removes the ends of such
// series, pairs the other events and measures the differences of their times and impulses, which count in the bound.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/follow_joints.h"
#include "integrators/contact/joint_maximal_form.h"
#include "integrators/contact/joint_tree_form.h"
#include "integrators/truth/attempt_taylor.h"
#include "motion/formula_mechanism.h"

namespace polhode::truth {

/// Differences of the joint events of two runs.
template <class P>
struct JointEventDifference {
    P time{0};          ///< largest difference of times, s
    P impulse{0};       ///< largest difference of impulses, relative to the largest impulse
    std::string fault;  ///< why the events do not match; empty if they do
};

/// Removes what depends on how late a run ends a series of impacts: of the events closer in time to an arrival at rest
/// on a limit than `tolerance` (s), one arrival remains for each joint, in the order of joints. An impact that moves a
/// held joint by less than the error of the steps does not count as a change of its mode, so friction is included.
template <class P>
std::vector<contact::JointEvent<P>> remove_ends_of_series(const std::vector<contact::JointEvent<P>>& events,
                                                          const P& tolerance) {
    using Kind = contact::JointEventKind;
    std::vector<contact::JointEvent<P>> left;
    for (std::size_t i = 0; i < events.size();) {
        std::size_t rest = i;
        while (rest < events.size() && events[rest].kind != Kind::rests && events[rest].t - events[i].t <= tolerance)
            ++rest;
        if (rest == events.size() || events[rest].t - events[i].t > tolerance) {
            left.push_back(events[i++]);
            continue;
        }
        // from an event shortly before an arrival to the last one shortly after it
        std::size_t end = rest + 1;
        for (; end < events.size() && events[end].t - events[rest].t <= tolerance; ++end)
            if (events[end].kind == Kind::rests) rest = end;
        std::map<std::size_t, contact::JointEvent<P>> arrivals;
        for (; i < end; ++i)
            if (events[i].kind == Kind::rests) arrivals.insert_or_assign(events[i].joint, events[i]);
        for (const auto& [joint, event] : arrivals) left.push_back(event);
    }
    return left;
}

template <class P>
JointEventDifference<P> match_joint_events(const std::vector<contact::JointEvent<P>>& all_a,
                                           const std::vector<contact::JointEvent<P>>& all_b, const P& tolerance) {
    const std::vector<contact::JointEvent<P>> a = remove_ends_of_series(all_a, tolerance),
                                              b = remove_ends_of_series(all_b, tolerance);
    JointEventDifference<P> result;
    P largest(0);
    std::size_t i = 0;
    for (; i < a.size() && i < b.size() && a[i].kind == b[i].kind && a[i].joint == b[i].joint; ++i) {
        result.time = std::max(result.time, P(abs(a[i].t - b[i].t)));
        result.impulse = std::max(result.impulse, P(abs(a[i].impulse - b[i].impulse)));
        largest = std::max(largest, P(abs(a[i].impulse)));
    }
    if (largest > P(0)) result.impulse = result.impulse / largest;
    if (i == a.size() && i == b.size()) return result;
    const contact::JointEvent<P>& next = i < a.size() ? a[i] : b[i];
    result.fault = fmt::format("the two formulations disagree about the joint event at t = {:.10g} s",
                               next.t.template convert_to<double>());
    return result;
}

inline contact::JointSettings joint_settings(const TaylorSettings& settings) {
    contact::JointSettings result;
    result.order = settings.order, result.digits = settings.digits, result.event_digits = settings.digits - 4;
    result.step_factor = settings.step_factor, result.max_steps = settings.max_steps;
    result.stop = []() -> const char* { return Allowance::is_spent() ? Allowance::fault : nullptr; };
    return result;
}

/// Separates a run into its motions and the other quantities.
template <class P>
std::pair<Run<P, Motions<P>>, MechanismOutputs<P>> split_joint_run(contact::JointRun<P>& run) {
    std::pair<Run<P, Motions<P>>, MechanismOutputs<P>> parts;
    parts.first.fault = std::move(run.fault), parts.first.steps = run.steps;
    parts.first.motions = std::move(run.motions);
    parts.second.reactions = std::move(run.reactions), parts.second.coordinates = std::move(run.coordinates);
    return parts;
}

template <unsigned working>
Attempt attempt_by_joint_events(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const Scene& scene = problem.scene;
    contact::JointTreeForm<P> tree(scene);
    const std::vector<P> start = tree.initial();
    const Motions<P> motions = tree.motion(start.data());
    const std::vector<std::array<P, 2>> coordinates = tree.joint_coordinates(start.data());
    auto second = in_thread([&] {
        contact::JointMaximalForm<P> bodies(scene, motions, coordinates);
        auto blocks = bodies.blocks(problem.scales);
        return contact::JointDriver<P, contact::JointMaximalForm<P>>(scene, problem.scales, std::move(bodies),
                                                                     std::move(blocks), sample_times,
                                                                     joint_settings(runs.coarse))
            .run();
    });
    auto blocks = tree.blocks(tree_scales(problem));
    contact::JointRun<P> first =
        contact::JointDriver<P, contact::JointTreeForm<P>>(scene, problem.scales, std::move(tree), std::move(blocks),
                                                           sample_times, joint_settings(runs.fine))
            .run();
    contact::JointRun<P> other = second.get();
    const auto parts = split_joint_run(first);
    const auto other_parts = split_joint_run(other);
    const bool ended = parts.first.fault.empty() && other_parts.first.fault.empty();
    // both runs end a series of impacts where the speed is below 10^-event_digits of the largest
    const P series_end =
        P(scene.duration) * pow(P(10), P(3 - static_cast<int>(joint_settings(runs.coarse).event_digits)));
    const JointEventDifference<P> events = match_joint_events(first.events, other.events, series_end);
    if (ended && !events.fault.empty()) return failed_attempt(events.fault);
    const double time = events.time.template convert_to<double>();
    Attempt attempt = compare_runs(
        problem, sample_times, parts.first, other_parts.first,
        fmt::format("Taylor series in {} digits: {} at order {} in {} steps, {} at order {} in {} steps; {} event{} of "
                    "joints, times differ by at most {:.1e} s",
                    working, contact::JointTreeForm<P>::name, runs.fine.order, parts.first.steps,
                    contact::JointMaximalForm<P>::name, runs.coarse.order, other_parts.first.steps, first.events.size(),
                    first.events.size() == 1 ? "" : "s", time),
        static_cast<int>(working), parts.second, other_parts.second);
    const double worst = std::max(time, events.impulse.template convert_to<double>());
    if (attempt.fault.empty() && worst > 0) {
        attempt.agreed_digits = std::min(attempt.agreed_digits, -std::log10(worst));
        attempt.truth.reference.bound = std::max(attempt.truth.reference.bound, worst);
    }
    for (const contact::JointEvent<P>& event : first.events) {
        const int digits = static_cast<int>(working);
        attempt.truth.contact_events.push_back({decimal_of(event.t, digits),
                                                event.joint,
                                                contact::joint_event_names[static_cast<std::size_t>(event.kind)],
                                                decimal_of(event.impulse, digits),
                                                {"0", "0", "0"}});
    }
    return attempt;
}

}  // namespace polhode::truth
