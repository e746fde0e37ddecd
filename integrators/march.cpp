#include "integrators/march.h"

#include <fmt/format.h>

#include <ctime>

namespace polhode {
namespace {

// s, of this thread alone: what other work on the machine takes away does not count
double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Budget::Budget(const Settings& settings)
    : max_steps_(settings.max_steps > std::numeric_limits<long>::max() / settings.repetitions
                     ? settings.max_steps
                     : settings.max_steps * settings.repetitions),
      repetitions_(settings.repetitions),
      timed_(std::isfinite(settings.seconds_limit)),
      seconds_limit_(settings.seconds_limit * settings.repetitions),
      start_(std::chrono::steady_clock::now()),
      processor_start_(timed_ ? processor_time() : 0) {}

void Budget::stop(Trajectory& trajectory) const {
    trajectory.status = Status::failed, trajectory.message = message_, trajectory.limit_reached = true;
}

void Budget::forbid(Trajectory& trajectory) const {
    trajectory.status = Status::failed, trajectory.limit_reached = true;
    trajectory.message = fmt::format("needs more than the limit of {} steps", max_steps_ / repetitions_);
}

bool Budget::refuse() {
    --steps_;
    message_ = fmt::format("stopped at the limit of {} steps", max_steps_ / repetitions_);
    return false;
}

bool Budget::in_time() {
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    // the wall clock is read fast; a thread's own time is not, but cannot be longer
    if (spent <= seconds_limit_ || processor_time() - processor_start_ <= seconds_limit_) return true;
    message_ = fmt::format("stopped at the limit of {} s", seconds_limit_ / repetitions_);
    return false;
}

long steps_per_sample(double interval, double step) {
    const double ratio = interval / step, whole = std::round(ratio);
    if (!(ratio < 9e18)) return std::numeric_limits<long>::max();
    // a ratio that misses a whole number by rounding only is that number
    const double steps = std::abs(ratio - whole) <= 1e-9 * ratio ? whole : std::ceil(ratio);
    return steps < 1 ? 1 : static_cast<long>(steps);
}

bool record(const Problem& problem, const Sample& sample, double bound, Trajectory& trajectory) {
    const Vector3<double>& w = sample.angular_velocity_B;
    double kinetic = dot(w, problem.body.inertia_B * w) / 2;
    if (!problem.body.pivoted) kinetic += problem.body.mass * dot(sample.velocity_W, sample.velocity_W) / 2;
    const double norm = squared_norm(sample.q), place = dot(sample.position_W, sample.position_W);
    if (std::isfinite(kinetic) && std::isfinite(norm) && std::isfinite(place) && norm > 0 && kinetic <= bound) {
        trajectory.samples.push_back(sample);
        return true;
    }
    trajectory.status = Status::diverged;
    trajectory.message =
        std::isfinite(kinetic) && std::isfinite(norm) && std::isfinite(place) && norm > 0
            ? fmt::format("kinetic energy {:.3g} J at t = {:g} s, more than 10^6 times the scene's own", kinetic,
                          sample.t)
            : fmt::format("not finite at t = {:g} s", sample.t);
    return false;
}

Trajectory unsupported(std::string message) {
    Trajectory trajectory;
    trajectory.status = Status::unsupported, trajectory.message = std::move(message);
    return trajectory;
}

}  // namespace polhode
