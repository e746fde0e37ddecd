// Contacts of one body with planes in binary64, for methods and descriptions.
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

/// The settings of an event driver in binary64. `DriverSettings`: ContactSettings or JointSettings.
template <class DriverSettings>
DriverSettings driver_settings(const Settings& settings) {
    DriverSettings result;
    // below 13.5 digits only rounding remains
    result.digits = std::clamp(-std::log10(settings.tolerance.value_or(default_tolerance)) + 0.5, 3.0, 13.5);
    result.event_digits = std::min(result.digits + 1, 12.5);
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

/// Follows the body with Taylor series to the tolerance of `settings`. The samples are those of `settings`.
Run<double> follow_in_binary64(const Problem& problem, const Settings& settings);

/// Why torsional and rolling friction of the scene's planes is not supported; empty if it is or if no plane has it.
std::string rotation_friction_refusal(const Scene& scene);

/// Why the contact modes do not support the scene's planes or loads; empty if they do or if there are no planes.
std::string contact_refusal(const Scene& scene);

/// The trajectory of follow_in_binary64(), as a method returns it.
Trajectory solve_contacts(const Problem& problem, const Settings& settings);

}  // namespace polhode::contact
