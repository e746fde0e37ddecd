#include "measure/stability.h"

#include <algorithm>

namespace polhode {
namespace {

// hypotenuse: rates up to 1e308, whose squares overflow
double true_rate(const ReferenceSample& sample) {
    const auto& w = sample.angular_velocity_B;
    return hypotenuse(Vector3<double>{w[0].high, w[1].high, w[2].high});
}

}  // namespace

const char* name_of(Outcome outcome) {
    constexpr const char* names[] = {"accurate",          "close",  "wrong but bounded", "damped to rest", "diverged",
                                     "tolerance_not_met", "failed", "unsupported",       "no truth"};
    return names[static_cast<std::size_t>(outcome)];
}

bool is_stable(const Errors& of_run) {
    constexpr double largest_rate_error = 4, largest_energy_error = 8;
    return of_run["omega"].max && *of_run["omega"].max <= largest_rate_error && of_run["energy"].max &&
           *of_run["energy"].max <= largest_energy_error;
}

bool is_damped_to_rest(const Trajectory& trajectory, const Reference& reference) {
    constexpr double rest = 0.1, moving = 1e-3;
    const std::size_t count = reference.samples.size();
    if (trajectory.samples.size() != count || count < 2) return false;
    double largest = 0;
    for (const ReferenceSample& sample : reference.samples) largest = std::max(largest, true_rate(sample));
    if (!(largest > 0)) return false;
    // in units of the largest rate, to avoid overflow and underflow
    double rotation = 0, truth = 0;
    const std::size_t begin = count - std::max<std::size_t>(1, count / 4);
    for (std::size_t k = begin; k < count; ++k) {
        const Vector3<double>& w = trajectory.samples[k].angular_velocity_B;
        const double rate = hypotenuse(w) / largest, true_one = true_rate(reference.samples[k]) / largest;
        rotation += rate * rate, truth += true_one * true_one;
    }
    return truth >= moving * moving * static_cast<double>(count - begin) && rotation < rest * rest * truth;
}

Outcome outcome_of(const Trajectory& trajectory, const Errors& errors, const Reference& reference) {
    switch (trajectory.status) {
        case Status::ok:
            break;
        case Status::unsupported:
            return Outcome::unsupported;
        case Status::diverged:
            return Outcome::diverged;
        case Status::tolerance_not_met:
            return Outcome::tolerance_not_met;
        case Status::failed:
            return Outcome::failed;
    }
    if (!errors["attitude"].max) return Outcome::no_truth;
    if (!is_stable(errors)) return Outcome::diverged;
    // first: at rest the attitude may be close by chance
    if (is_damped_to_rest(trajectory, reference)) return Outcome::damped_to_rest;
    if (*errors["attitude"].max <= accurate_attitude) return Outcome::accurate;
    return *errors["attitude"].max <= close_attitude ? Outcome::close : Outcome::wrong_but_bounded;
}

}  // namespace polhode
