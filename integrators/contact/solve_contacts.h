// Contacts and events of joints in binary64, for methods and descriptions.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/contact/contact_record.h"
#include "integrators/method.h"
#include "integrators/run/processor_time.h"
#include "text/interruption.h"

namespace polhode::contact {

/// Message of a run that ends at its time limit.
inline constexpr const char* time_limit = "the time limit is reached";

/// The settings of an event driver in binary64. `DriverSettings`: ContactSettings or JointSettings. `steps`: of a
/// method; null: Taylor series.
template <class DriverSettings>
DriverSettings driver_settings(const Settings& settings, MakeSystemSteps steps) {
    DriverSettings result;
    result.steps = steps, result.tolerance = settings.tolerance.value_or(default_tolerance);
    // below 13.5 digits only rounding remains
    result.digits = std::clamp(-std::log10(result.tolerance) + 0.5, 3.0, 13.5);
    result.event_digits = std::min(result.digits + 1, 12.5);
    // events remain separate at loose tolerances
    result.event_digits = std::max(result.event_digits, 9.0);
    if (steps) result.step_error = 10 * result.tolerance;
    result.order = static_cast<int>(std::ceil(1.15 * result.digits)) + 6;
    result.max_steps = std::min(settings.max_steps, settings.max_evaluations);
    const double end = processor_time() + settings.seconds_limit;
    result.stop = [end]() -> const char* {
        return processor_time() > end || Interruption::is_requested() ? time_limit : nullptr;
    };
    return result;
}

/// Sets the status of a trajectory by the reason why its run stopped early, if there is one.
inline void set_status(Trajectory& trajectory, const std::string& fault) {
    if (fault.empty()) return;
    trajectory.status = Status::failed, trajectory.message = fault;
    trajectory.limit_reached = fault == time_limit || fault.starts_with("the step limit");
}

/// The sample times of `settings`, s.
inline std::vector<double> times_of_samples(const Problem& problem, const Settings& settings) {
    return settings.times.empty() ? sample_times(problem.scene.duration, settings.samples) : settings.times;
}

/// Follows one body to the tolerance of `settings`, at their samples, by steps of a method or by Taylor series.
Run<double> follow_in_binary64(const Problem& problem, const Settings& settings, MakeSystemSteps steps = nullptr);

/// Events and modes of one body or of several spheres; otherwise as follow_in_binary64().
Record<double> record_contacts(const Problem& problem, const Settings& settings, MakeSystemSteps steps);

/// Why a method that supports user-defined torques does not support a scene's planes or loads; empty if it does.
std::string event_refusal(const Problem& problem);

/// Whether a scene has contacts, or joints with limits, friction or prescribed motions, which only event drivers
/// follow.
bool has_events(const Scene& scene);
/// Follows a scene that has_events() to the tolerance of `settings`, by steps of a method or by Taylor series.
Trajectory solve_events(const Problem& problem, const Settings& settings, MakeSystemSteps steps = nullptr);

}  // namespace polhode::contact
