// The reference as a method, so that it can be solved, timed and tabulated like any other.
#include "integrators/method.h"
#include "integrators/truth/attempt.h"

namespace polhode {
namespace {

Vector3<double> rounded(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

Trajectory solve_truth(const Problem& problem, const Settings& settings) {
    constexpr int digits = 25;
    const truth::Truth truth = settings.times.empty()
                                   ? truth::find_truth(problem.scene, settings.samples, digits, settings.seconds_limit)
                                   : truth::find_truth(problem.scene, settings.times, digits, settings.seconds_limit);
    Trajectory trajectory;
    trajectory.message = truth.reference.message;
    trajectory.steps = truth.steps;
    trajectory.seconds = truth.seconds;
    if (!truth.reference.available) {
        trajectory.status = problem.needs.user_torque ? Status::unsupported : Status::failed;
        trajectory.limit_reached = truth.limit_reached;
        return trajectory;
    }
    for (const Pair& t : truth.reference.impact_times) trajectory.impact_times.push_back(t.high);
    trajectory.bodies = truth.reference.bodies;
    for (const ReferenceSample& sample : truth.reference.samples) trajectory.samples.push_back(sample.rounded());
    for (const Reaction<Pair>& reaction : truth.reference.reactions)
        trajectory.reactions.push_back({rounded(reaction.force_W), rounded(reaction.torque_W)});
    if (!settings.record) {
        const auto keep_last = [moments = static_cast<long>(truth.reference.moments())](auto& all) {
            all.erase(all.begin(), all.end() - static_cast<long>(all.size()) / moments);
        };
        keep_last(trajectory.samples), keep_last(trajectory.reactions);
    }
    return trajectory;
}

constexpr Method each[] = {{
    .name = "truth",
    .documentation =
        "The reference solution that errors are measured against, rounded to binary64. Taylor series in "
        "multiprecision, or Radau IIA collocation if the motion is stiff, each in two formulations with two orders "
        "and steps that agree to at least 25 digits. Its time is that of the first computation; later runs read the "
        "samples from a cache on disk.",
    .source = "R. E. Moore 1966; A. Jorba and M. Zou 2005, Exp. Math. 14, 99; E. Hairer and G. Wanner 1996",
    .conserves = "all invariants of the motion, to 25 digits",
    .control = Control::none,
    .planes = true,
    .solve = solve_truth,
}};

constexpr auto truth_methods =
    apply_defaults({.family = Family::reference, .precision = Precision::multiprecision}, each);

}  // namespace

extern const std::span<const Method> truth_method_methods{truth_methods};

}  // namespace polhode
