// The attempt for several spheres with planes and with each other. Each working precision is instantiated in its own
// file. The formulations differ in the equations of each sphere and in the impulse of a pair (sphere_impact.h).
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "integrators/contact/cluster_form.h"
#include "integrators/contact/follow_spheres.h"
#include "integrators/truth/attempt_contact.h"
#include "integrators/truth/cluster_multiplier_form.h"

namespace polhode::truth {

template <unsigned working>
Attempt attempt_by_sphere_contacts(const Problem& problem, const std::vector<double>& sample_times,
                                   double local_digits) {
    using P = Real<working>;
    const TaylorRuns runs(local_digits, most_taylor_steps);
    const auto stop = [] { return Allowance::is_spent() ? Allowance::fault : nullptr; };
    const auto settings = [&](const TaylorSettings& s) {
        return contact::ContactSettings{s.order, local_digits, s.digits, s.step_factor, s.max_steps, stop};
    };
    auto pending = in_thread([&] {
        return contact::SphereDriver<P, MultiplierForm<P>, ClusterMultiplierForm<P>, contact::PhasedImpact>(
                   problem.scene, sample_times, settings(runs.coarse))
            .run();
    });
    contact::SphereRun<P> first =
        contact::SphereDriver<P, contact::ReducedForm<P>, contact::ClusterForm<P>, contact::ClosedFormImpact>(
            problem.scene, sample_times, settings(runs.fine))
            .run();
    contact::SphereRun<P> second = pending.get();
    const std::string& fault = first.fault.empty() ? second.fault : first.fault;
    if (!fault.empty()) return failed_attempt(fault);
    P time(0), impulse(0), largest(0);
    for (std::size_t i = 0; i < first.records.size(); ++i) {
        const EventDifference<P> events = match_events(first.records[i], second.records[i]);
        if (!events.fault.empty()) return failed_attempt(events.fault);
        time = std::max(time, events.time), impulse = std::max(impulse, events.impulse);
        largest = std::max(largest, events.largest_impulse);
    }
    contact::Run<P> merged;
    merged.record = contact::merge_records(first.records);
    const int digits = static_cast<int>(working);
    Attempt attempt = compare_runs(
        problem, sample_times, Run<P, Motions<P>>{"", std::move(first.motions), {}, first.steps},
        Run<P, Motions<P>>{"", std::move(second.motions), {}, second.steps},
        fmt::format("contact modes of spheres by Taylor series in {} digits: {} at order {} in {} steps, {} at order "
                    "{} in {} steps; {} events, times differ by at most {:.1e} s",
                    working, contact::ReducedForm<P>::name, runs.fine.order, first.steps, MultiplierForm<P>::name,
                    runs.coarse.order, second.steps, merged.record.events.size(), time.template convert_to<double>()),
        digits);
    if (!attempt.fault.empty()) return attempt;
    P worst = time / P(problem.scene.duration);
    if (largest > P(0)) worst = std::max(worst, P(impulse / largest));
    if (worst > P(0)) {
        const double size = worst.template convert_to<double>();
        attempt.agreed_digits = std::min(attempt.agreed_digits, -std::log10(size));
        attempt.truth.reference.bound = std::max(attempt.truth.reference.bound, size);
    }
    write_contacts(attempt.truth, merged, digits);
    return attempt;
}

}  // namespace polhode::truth
