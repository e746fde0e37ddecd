// The truth as a method of its own, so that it can be solved for, timed and tabulated like any other.
#include "integrators/method.h"
#include "integrators/truth/attempt.h"

namespace polhode {
namespace {

Sample rounded(const ReferenceSample& truth) {
    const auto vector = [](const Vector3<Pair>& v) { return Vector3<double>(v[0].high, v[1].high, v[2].high); };
    Sample sample;
    sample.t = truth.t;
    sample.q = {truth.q.w.high, truth.q.x.high, truth.q.y.high, truth.q.z.high};
    sample.angular_velocity_B = vector(truth.angular_velocity_B);
    sample.position_W = vector(truth.position_W);
    sample.velocity_W = vector(truth.velocity_W);
    return sample;
}

Trajectory solve_truth(const Problem& problem, const Settings& settings) {
    constexpr int digits = 25;
    const truth::Truth truth = truth::find_truth(problem.scene, settings.samples, digits, settings.seconds_limit);
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
    for (const ReferenceSample& sample : truth.reference.samples) trajectory.samples.push_back(rounded(sample));
    if (!settings.record) trajectory.samples.erase(trajectory.samples.begin(), trajectory.samples.end() - 1);
    return trajectory;
}

constexpr Method each[] = {{
    .name = "truth",
    .documentation = "The reference that errors are measured against, rounded to binary64. Taylor series in "
                     "multiprecision, or Radau IIA collocation where the motion is stiff, each in two formulations "
                     "with two orders and steps that agree to at least 25 digits. Its time is that of the first "
                     "computation; later runs take the samples from a cache on disk.",
    .source = "R. E. Moore 1966; A. Jorba and M. Zou 2005, Exp. Math. 14, 99; E. Hairer and G. Wanner 1996",
    .conserves = "everything the motion does, to 25 digits",
    .control = Control::none,
    .planes = true,
    .solve = solve_truth,
}};

constexpr auto truth_methods = sharing({.family = Family::reference, .precision = Precision::multiprecision}, each);

}  // namespace

extern const std::span<const Method> truth_method_methods{truth_methods};

}  // namespace polhode
