// A joint with limits or friction changes its mode at events only, so its mode between two events follows from any
// sample between them: it rests at a limit or sticks if its rate is zero there.
#include "report/motion_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "integrators/analysis/joint_history.h"
#include "integrators/contact/solve_joints.h"
#include "motion/problem.h"
#include "report/timeline.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr double joint_run_seconds = 2, joint_run_tolerance = 1e-12;
constexpr std::size_t curve_samples = 320, most_curves = 16, most_shown_events = 200;
constexpr int curve_digits = 5;
// time between an event and the samples before and after it, relative to the duration: rates jump there
constexpr double event_margin = 1e-9;
// a joint rests, or is at its limit, below this ratio to its largest rate or coordinate
constexpr double rest_ratio = 1e-8;
// values below this ratio to the largest one are rounding
constexpr double curve_rounding = 1e-12;

Settings run_settings(std::vector<double> times) {
    Settings settings;
    settings.times = std::move(times), settings.tolerance = joint_run_tolerance,
    settings.seconds_limit = joint_run_seconds;
    return settings;
}

std::vector<double> sorted_times(std::vector<double> times, double duration) {
    std::erase_if(times, [&](double t) { return !(t >= 0 && t <= duration); });
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

// Times of the curves: evenly spaced, on both sides of each event, and in the middle between events.
std::vector<double> curve_times(double duration, const std::vector<double>& events) {
    std::vector<double> times = sample_times(duration, static_cast<long>(curve_samples));
    double last = 0;
    for (std::size_t i = 0; i < std::min(events.size(), most_shown_events); ++i) {
        times.insert(times.end(), {events[i] - event_margin * duration, events[i] + event_margin * duration,
                                   0.5 * (last + events[i])});
        last = events[i];
    }
    times.push_back(0.5 * (last + duration));
    return sorted_times(std::move(times), duration);
}

Trajectory trajectory_of(const Reference& truth, std::size_t most) {
    Trajectory trajectory;
    const std::size_t bodies = static_cast<std::size_t>(truth.bodies);
    for (const std::size_t k : spread_indices(truth.moments(), most)) {
        std::vector<Sample> samples;
        for (std::size_t b = 0; b < bodies; ++b) samples.push_back(truth.samples[k * bodies + b].rounded());
        trajectory.append(samples);
    }
    return trajectory;
}

bool is_turning(JointType type) { return type == JointType::revolute || type == JointType::universal; }

std::size_t coordinate_count(JointType type) {
    return type == JointType::universal ? 2 : type == JointType::revolute || type == JointType::prismatic ? 1 : 0;
}

// One coordinate of a joint over time.
struct JointCurve {
    std::size_t joint = 0, coordinate = 0;
    std::vector<double> x, rate;
};

JointCurve curve_of(const JointHistory<double>& history, std::size_t joints, std::size_t joint,
                    std::size_t coordinate) {
    JointCurve curve{joint, coordinate, {}, {}};
    for (std::size_t i = joint; i < history.motions.size(); i += joints) {
        curve.x.push_back(history.motions[i].coordinate[coordinate]);
        curve.rate.push_back(history.motions[i].rate[coordinate]);
    }
    return curve;
}

// Joints with limits or friction first, so that they are kept if there are too many.
std::vector<std::size_t> order_of_joints(const Scene& scene) {
    std::vector<std::size_t> order;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) order.push_back(j);
    std::ranges::stable_sort(
        order, {}, [&](std::size_t j) { return scene.joints[j].limits.any() || scene.joints[j].friction > 0 ? 0 : 1; });
    return order;
}

double largest_size(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

// The mode of a joint between two of its events, which do not belong to the interval.
const char* mode_between(const contact::EventJoint<double>& joint, const std::vector<double>& times,
                         const JointCurve& curve, double from, double to) {
    const double still = rest_ratio * largest_size(curve.rate);
    const double near = rest_ratio * std::max({largest_size(curve.x), std::abs(joint.lower.coordinate),
                                               std::abs(joint.upper.coordinate)});
    bool rests = true, is_lower = joint.lower.exists, is_upper = joint.upper.exists;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
        if (!(times[k] > from && times[k] < to)) continue;
        rests = rests && std::abs(curve.rate[k]) <= still;
        is_lower = is_lower && std::abs(curve.x[k] - joint.lower.coordinate) <= near;
        is_upper = is_upper && std::abs(curve.x[k] - joint.upper.coordinate) <= near;
    }
    if (rests && is_lower) return "at lower limit";
    if (rests && is_upper) return "at upper limit";
    if (joint.friction > 0) return rests ? "sticks" : "slides";
    return "free";
}

// The name of a joint and of those that are coupled with it.
std::string names_of_group(const Scene& scene, std::size_t joint) {
    std::vector<std::string> names;
    for (const CoupledJoint<double>& one : coupled_joints<double>(scene, joint))
        names.push_back(one_line(scene.joints[one.joint].name, 60));
    return join_with_commas(names);
}

// A joint with limits or friction, and those that are coupled with it.
struct EventGroup {
    contact::EventJoint<double> laws;
    std::vector<std::size_t> joints;
};

std::vector<EventGroup> event_groups(const Scene& scene) {
    std::vector<EventGroup> groups;
    for (const contact::EventJoint<double>& laws : contact::event_joints<double>(scene)) {
        groups.push_back({laws, {}});
        for (const CoupledJoint<double>& one : coupled_joints<double>(scene, laws.joint))
            groups.back().joints.push_back(one.joint);
    }
    return groups;
}

// Adds the row of a group: its modes between its events, and the events.
void add_group(const Scene& scene, const EventGroup& group, const JointHistory<double>& history,
               const std::vector<contact::JointEvent<double>>& events, Timeline& timeline) {
    const std::size_t first = group.laws.joint;
    const bool turns = is_turning(scene.joints[first].type);
    const std::optional<std::size_t> row = timeline.row(names_of_group(scene, first), turns ? "N m s" : "N s");
    if (!row) return;
    const JointCurve curve = curve_of(history, scene.joints.size(), first, 0);
    double last = 0;
    const auto add_until = [&](double t) {
        if (t > last)
            timeline.add_mode(*row, last, t, mode_between(group.laws, history.times, curve, last, t)), last = t;
    };
    std::size_t shown = 0;
    for (const contact::JointEvent<double>& event : events) {
        if (++shown > most_shown_events) return;
        if (std::ranges::find(group.joints, event.joint) != group.joints.end()) add_until(event.t);
    }
    add_until(history.times.back());
}

Json timeline_json(const Scene& scene, const JointHistory<double>& history,
                   const std::vector<contact::JointEvent<double>>& events) {
    Timeline timeline;
    const std::vector<EventGroup> groups = event_groups(scene);
    for (const EventGroup& group : groups) add_group(scene, group, history, events, timeline);
    for (const contact::JointEvent<double>& event : events)
        for (const EventGroup& group : groups)
            if (std::ranges::find(group.joints, event.joint) != group.joints.end())
                timeline.add_event(event.t, timeline.row(names_of_group(scene, group.laws.joint), ""),
                                   contact::joint_event_names[static_cast<std::size_t>(event.kind)], event.impulse, 0);
    return timeline.json();
}

// Values that are only rounding become zero.
std::vector<double> without_rounding(std::vector<double> values) {
    const double zero = curve_rounding * largest_size(values);
    for (double& value : values)
        if (std::abs(value) < zero) value = 0;
    return values;
}

Json curve_json(const Scene& scene, const JointCurve& curve) {
    const Joint& joint = scene.joints[curve.joint];
    std::string name = one_line(joint.name, 60);
    if (joint.type == JointType::universal) name += curve.coordinate == 0 ? ", angle 1" : ", angle 2";
    return {{"name", name},
            {"joint", curve.joint},
            {"unit", is_turning(joint.type) ? "rad" : "m"},
            {"lower", number_json(joint.limits.lower, 6)},
            {"upper", number_json(joint.limits.upper, 6)},
            {"x", numbers_json(without_rounding(curve.x), curve_digits)},
            {"rate", numbers_json(without_rounding(curve.rate), curve_digits)}};
}

Json curves_json(const Scene& scene, const JointHistory<double>& history) {
    Json curves = Json::array();
    std::size_t total = 0;
    for (const std::size_t j : order_of_joints(scene))
        for (std::size_t i = 0; i < coordinate_count(scene.joints[j].type); ++i)
            if (++total <= most_curves)
                curves.push_back(curve_json(scene, curve_of(history, scene.joints.size(), j, i)));
    if (total == 0) return nullptr;
    return {{"t", numbers_json(history.times, 8)}, {"curves", std::move(curves)}, {"total", total}};
}

}  // namespace

MotionDetails joints_of_motion(const Scene& scene, const Reference& truth, const Tolerance& tolerance) {
    MotionDetails details;
    const Problem problem = pose(scene);
    const bool has_events = contact::has_joint_events(scene);
    std::vector<contact::JointEvent<double>> events;
    Trajectory trajectory;
    if (has_events) {
        contact::JointRun<double> run =
            contact::follow_joints_in_binary64(problem, run_settings(times_of_reference(truth)));
        if (!is_near_truth(run.motions, truth, tolerance)) {
            details.remark =
                "Joint coordinates are not shown: they are computed in binary64, and this motion is too sensitive for "
                "that.";
            return details;
        }
        events = std::move(run.events);
        std::vector<double> event_times;
        for (const contact::JointEvent<double>& event : events) event_times.push_back(event.t);
        trajectory = contact::solve_joints(problem, run_settings(curve_times(scene.duration, event_times)), nullptr);
    } else {
        trajectory = trajectory_of(truth, curve_samples);
    }
    const JointHistory<double> history = joint_history(problem, nullptr, {}, trajectory);
    if (!history.fault.empty() || history.times.empty()) return details;
    if (has_events) details.timeline = timeline_json(scene, history, events);
    details.coordinates = curves_json(scene, history);
    return details;
}

}  // namespace polhode
