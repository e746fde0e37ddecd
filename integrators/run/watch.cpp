#include "integrators/run/watch.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "integrators/run/processor_time.h"
#include "motion/user_system.h"
#include "text/interruption.h"

namespace polhode {

Budget::Budget(const Settings& settings)
    : max_steps_(settings.max_steps > std::numeric_limits<long>::max() / settings.repetitions
                     ? settings.max_steps
                     : settings.max_steps * settings.repetitions),
      max_evaluations_(settings.max_evaluations),
      repetitions_(settings.repetitions),
      seconds_limit_(settings.seconds_limit * settings.repetitions),
      start_(std::chrono::steady_clock::now()),
      processor_start_(processor_time()) {}

void Budget::report_limit(Trajectory& trajectory) const {
    trajectory.status = Status::failed, trajectory.message = message_, trajectory.limit_reached = true;
}

void Budget::report_excess_steps(Trajectory& trajectory) const {
    trajectory.status = Status::failed, trajectory.limit_reached = true;
    trajectory.message = fmt::format("needs more than the limit of {} steps", max_steps_ / repetitions_);
}

bool Budget::report_step_limit() {
    message_ = fmt::format("stopped at the limit of {} steps", max_steps_ / repetitions_);
    return false;
}

bool Budget::report_evaluation_limit() {
    message_ = fmt::format("stopped at the limit of {} evaluations", max_evaluations_);
    return false;
}

double Budget::elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool Budget::check_time() {
    constexpr double check_interval = 0.01;  // s
    constexpr long most_steps = 1024;
    const double now = elapsed();
    if (Interruption::is_requested()) {
        until_check_ = 1;
        message_ = "interrupted";
        return false;
    }
    if (now > seconds_limit_) {
        // reading the wall clock is fast; reading the processor time is slow, but it never exceeds the wall clock
        if (processor_time() - processor_start_ > seconds_limit_) {
            until_check_ = 1;
            message_ = fmt::format("stopped at the limit of {} s", seconds_limit_ / repetitions_);
            return false;
        }
    }
    check_interval_ = now - checked_at_ < check_interval ? std::min(2 * check_interval_, most_steps)
                                                         : std::max(check_interval_ / 2, 1L);
    until_check_ = check_interval_, checked_at_ = now;
    return true;
}

std::string format_time(double t) { return fmt::format("t = {:.9g} s", t); }

std::string divergence(const Problem& problem, const Bodies& bodies, double bound) {
    const auto model = problem.model();
    double kinetic = model ? model->kinetic_energy(bodies) : 0;
    bool finite = true;
    for (const Sample& sample : bodies) {
        const Vector3<double>& w = sample.angular_velocity_B;
        if (!model) kinetic += dot(w, problem.body.inertia_B * w) / 2;
        if (!model && !problem.body.pivoted)
            kinetic += problem.body.mass * dot(sample.velocity_W, sample.velocity_W) / 2;
        const double norm = squared_norm(sample.q), place = dot(sample.position_W, sample.position_W);
        if (model) finite = finite && std::isfinite(dot(w, w) + dot(sample.velocity_W, sample.velocity_W));
        finite = finite && std::isfinite(kinetic) && std::isfinite(norm) && std::isfinite(place) && norm > 0;
    }
    const double t = bodies.front().t;
    if (finite && kinetic <= bound) return {};
    if (!finite) return "not finite at " + format_time(t);
    return fmt::format("kinetic energy {:.3g} J at {}, more than 10^6 times the scene's estimated maximum", kinetic,
                       format_time(t));
}

std::string last_state(const Bodies& bodies) {
    std::string text = fmt::format("; the last state, at {}: ", format_time(bodies.front().t));
    for (const Sample& sample : bodies) {
        const Vector3<double>& w = sample.angular_velocity_B;
        const Quaternion<double>& q = sample.q;
        if (&sample != &bodies.front()) text += "; ";
        text += fmt::format("w = ({:.6g}, {:.6g}, {:.6g}) rad/s, q = ({:.6g}, {:.6g}, {:.6g}, {:.6g})", w[0], w[1],
                            w[2], q.w, q.x, q.y, q.z);
    }
    return text;
}

void report_unsolved_step(Trajectory& trajectory, const Bodies& bodies) {
    trajectory.status = Status::failed;
    trajectory.message =
        "the implicit equations of the step were not solved: the step is too long" + last_state(bodies);
}

bool record(const Problem& problem, const Bodies& bodies, double bound, Trajectory& trajectory) {
    std::string what = divergence(problem, bodies, bound);
    if (what.empty()) {
        trajectory.append(bodies);
        return true;
    }
    if (!trajectory.samples.empty()) what += last_state(trajectory.at(trajectory.moments() - 1));
    trajectory.status = Status::diverged, trajectory.message = std::move(what);
    return false;
}

Trajectory unsupported(std::string message) {
    Trajectory trajectory;
    trajectory.status = Status::unsupported, trajectory.message = std::move(message);
    return trajectory;
}

}  // namespace polhode
