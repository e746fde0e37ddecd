#include "integrators/contact/solve_joints.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "integrators/contact/follow_joints.h"
#include "integrators/contact/joint_tree_form.h"
#include "integrators/run/processor_time.h"
#include "motion/mechanism.h"
#include "text/interruption.h"

namespace polhode::contact {
namespace {

constexpr const char* joint_time_limit = "the time limit is reached";

JointSettings joint_settings_for(const Settings& settings) {
    JointSettings result;
    // below 13.5 digits only rounding remains
    result.digits = std::clamp(-std::log10(settings.tolerance.value_or(default_tolerance)) + 0.5, 3.0, 13.5);
    result.event_digits = std::min(result.digits + 1, 12.5);
    result.order = static_cast<int>(std::ceil(1.15 * result.digits)) + 6;
    result.max_steps = std::min(settings.max_steps, settings.max_evaluations);
    const double end = processor_time() + settings.seconds_limit;
    result.stop = [end]() -> const char* {
        return processor_time() > end || Interruption::is_requested() ? joint_time_limit : nullptr;
    };
    return result;
}

}  // namespace

JointRun<double> follow_joints_in_binary64(const Problem& problem, const Settings& settings) {
    const std::vector<double> times =
        settings.times.empty() ? sample_times(problem.scene.duration, settings.samples) : settings.times;
    JointTreeForm<double> form(problem.scene);
    std::vector<Block> blocks = form.blocks(mechanism_of(problem).scales());
    return JointDriver<double, JointTreeForm<double>>(problem.scene, problem.scales, std::move(form), std::move(blocks),
                                                      times, joint_settings_for(settings))
        .run();
}

Trajectory solve_joints(const Problem& problem, const Settings& settings) {
    Trajectory trajectory;
    const auto start = std::chrono::steady_clock::now();
    const JointRun<double> run = follow_joints_in_binary64(problem, settings);
    trajectory.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    trajectory.steps = trajectory.rhs_evaluations = run.steps;
    trajectory.bodies = static_cast<int>(problem.scene.bodies.size());
    const std::size_t count = run.motions.size(), first = settings.record || count == 0 ? 0 : count - 1;
    for (std::size_t i = first; i < count; ++i) {
        const double t = settings.times.empty()
                             ? sample_time(problem.scene.duration, static_cast<long>(i), settings.samples)
                             : settings.times[i];
        Moment moment{samples_of_bodies(t, run.motions[i]), {}};
        if (problem.reactions) moment.reactions = run.reactions[i];
        trajectory.append(moment);
    }
    if (run.fault.empty()) return trajectory;
    trajectory.status = Status::failed, trajectory.message = run.fault;
    trajectory.limit_reached = run.fault == joint_time_limit || run.fault.starts_with("the step limit");
    return trajectory;
}

}  // namespace polhode::contact
