#include "integrators/analysis/joint_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "motion/problem.h"

namespace polhode {
namespace {

using Coordinates = std::vector<std::array<double, 2>>;

constexpr std::size_t most_fine_states = 4'000'000;

bool has_angles(const Scene& scene) {
    return std::ranges::any_of(scene.joints, [](const Joint& joint) {
        return joint.type == JointType::revolute || joint.type == JointType::universal;
    });
}

std::vector<BodyMotion<double>> unit_motions(const Bodies& bodies) {
    std::vector<BodyMotion<double>> motions;
    for (const Sample& sample : bodies) motions.push_back(sample), motions.back().q = normalized(sample.q);
    return motions;
}

std::vector<double> times_of(const Trajectory& trajectory) {
    std::vector<double> times;
    for (std::size_t k = 0; k < trajectory.moments(); ++k) times.push_back(trajectory.at(k)[0].t);
    return times;
}

// The number of parts into which the interval between samples must be divided, so that no joint rotates by more than
// about one radian in a part: the relative rate of two bodies is at most twice the largest rate of a body.
std::size_t parts_of_intervals(const Problem& problem, const std::vector<double>& times, double largest_rate) {
    if (times.empty() || !has_angles(problem.scene)) return 1;
    double longest = times.front();
    for (std::size_t k = 1; k < times.size(); ++k) longest = std::max(longest, times[k] - times[k - 1]);
    const double radians = 2 * std::max(largest_rate, problem.scales.angular_velocity) * longest;
    return std::isfinite(radians) ? static_cast<std::size_t>(std::clamp(std::ceil(radians), 1.0, 1e9)) : 1;
}

double largest_rate(const Trajectory& trajectory) {
    double largest = 0;
    for (const Sample& sample : trajectory.samples) largest = std::max(largest, length(sample.angular_velocity_B));
    return largest;
}

std::vector<double> divided(const std::vector<double>& times, std::size_t parts) {
    std::vector<double> fine;
    for (std::size_t k = 0; k + 1 < times.size(); ++k)
        for (std::size_t i = 0; i < parts; ++i)
            fine.push_back(times[k] +
                           (times[k + 1] - times[k]) * (static_cast<double>(i) / static_cast<double>(parts)));
    fine.push_back(times.back());
    return fine;
}

// The coordinates of all joints at every `parts`-th sample, followed through all samples.
std::vector<Coordinates> followed(const Scene& scene, const Trajectory& fine, std::size_t parts) {
    const JointKinematics<double> kinematics(scene);
    JointCoordinates tracked(scene);
    std::vector<Coordinates> all;
    for (std::size_t k = 0; k < fine.moments(); ++k) {
        const Bodies bodies = fine.at(k);
        kinematics.at(bodies[0].t, unit_motions(bodies), tracked);
        if (k % parts == 0) all.emplace_back(tracked.values().begin(), tracked.values().end());
    }
    return all;
}

// Coordinates that count the revolutions at `times`; empty if the samples suffice. Sets `fault` if there are too many.
std::vector<Coordinates> guides(const Problem& problem, const Method& method, Settings settings,
                                std::vector<double> times, std::size_t parts, std::string& fault) {
    if (parts <= 1) return {};
    if (parts > most_fine_states / (times.size() * problem.scene.bodies.size())) {
        fault = fmt::format(
            "angles of joints are ambiguous: bodies rotate by up to {} rad between samples; give more "
            "samples",
            parts);
        return {};
    }
    // revolutions count from the initial state
    const bool late = times.front() > 0;
    if (late) times.insert(times.begin(), 0);
    settings.times = divided(times, parts);
    std::vector<Coordinates> all = followed(problem.scene, solve(problem, method, settings), parts);
    if (late && !all.empty()) all.erase(all.begin());
    return all;
}

// The history of motions_at(k), the motions of all bodies at times[k].
template <class P, class MotionsAt>
JointHistory<P> history(const Scene& scene, std::vector<double> times, const std::vector<Coordinates>& guide,
                        std::string fault, const MotionsAt& motions_at) {
    JointHistory<P> result{std::move(times), {}, std::move(fault)};
    if (!result.fault.empty()) return result;
    const JointKinematics<P> kinematics(scene);
    JointCoordinates tracked(scene);
    std::vector<JointMotion<P>> last;
    for (std::size_t k = 0; k < result.times.size(); ++k) {
        const double t = result.times[k];
        if (!guide.empty() && k >= guide.size()) {
            result.fault = fmt::format("revolutions of joints could not be counted after t = {:g} s", t);
            return result;
        }
        if (!guide.empty()) tracked.set(t, guide[k]);
        last = kinematics.at(t, motions_at(k), tracked, last);
        for (std::size_t j = 0; !guide.empty() && j < last.size(); ++j)
            for (std::size_t i = 0; i < 2; ++i) {
                const bool angle = last[j].type == JointType::revolute || last[j].type == JointType::universal;
                // a guide further off than this may be off by a revolution
                if (angle && std::abs(static_cast<double>(last[j].coordinate[i]) - guide[k][j][i]) > 1) {
                    result.fault = fmt::format(
                        "the revolutions of joint {} could not be counted at t = {:g} s; give "
                        "more samples",
                        one_line(scene.joints[j].name, 100), t);
                    return result;
                }
            }
        result.motions.insert(result.motions.end(), last.begin(), last.end());
    }
    return result;
}

Wide wide(const Pair& pair) { return Wide(pair.high) + Wide(pair.low); }
Vector3<Wide> wide(const Vector3<Pair>& v) { return {wide(v[0]), wide(v[1]), wide(v[2])}; }

}  // namespace

JointHistory<double> joint_history(const Problem& problem, const Method* method, const Settings& settings,
                                   const Trajectory& trajectory) {
    std::vector<double> times = times_of(trajectory);
    std::string fault;
    std::vector<Coordinates> guide;
    if (method) {
        Settings again = settings;
        if (trajectory.step > 0) again.step = trajectory.step;
        std::size_t parts = parts_of_intervals(problem, times, largest_rate(trajectory));
        // no more parts than steps
        if (trajectory.step > 0 && times.size() > 1)
            parts = std::min(
                parts, static_cast<std::size_t>(std::max(1.0, std::round((times[1] - times[0]) / trajectory.step))));
        guide = guides(problem, *method, again, times, parts, fault);
    }
    return history<double>(problem.scene, std::move(times), guide, std::move(fault),
                           [&](std::size_t k) { return unit_motions(trajectory.at(k)); });
}

JointHistory<Wide> joint_history(const Scene& scene, const Reference& truth) {
    const std::size_t bodies = static_cast<std::size_t>(truth.bodies);
    std::vector<double> times;
    double largest = 0;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        if (i % bodies == 0) times.push_back(truth.samples[i].t);
        largest = std::max(largest, length(truth.samples[i].rounded().angular_velocity_B));
    }
    Scene timed = scene;
    if (!times.empty() && times.back() > 0) timed.duration = times.back();
    const Problem problem = pose(timed);
    const Method& method = *choose_method(problem).method;
    std::string fault;
    const std::vector<Coordinates> guide = guides(problem, method, with_defaults(problem, method, {}), times,
                                                  parts_of_intervals(problem, times, largest), fault);
    return history<Wide>(scene, std::move(times), guide, std::move(fault), [&](std::size_t k) {
        std::vector<BodyMotion<Wide>> motions;
        for (std::size_t b = 0; b < bodies; ++b) {
            const ReferenceSample& s = truth.samples[k * bodies + b];
            const Quaternion<Wide> q{wide(s.q.w), wide(s.q.x), wide(s.q.y), wide(s.q.z)};
            motions.push_back({normalized(q), wide(s.angular_velocity_B), wide(s.position_W), wide(s.velocity_W)});
        }
        return motions;
    });
}

std::string wide_decimal(Wide value, int digits) {
    const double rounded = static_cast<double>(value);
    if (rounded == 0 || !std::isfinite(rounded)) return rounded == 0 ? "0" : "";
    const bool negative = value < 0;
    if (negative) value = -value;
    int exponent = static_cast<int>(std::floor(std::log10(std::abs(rounded))));
    Wide power = 1;
    for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
    value = exponent < 0 ? value * power : value / power;
    if (value >= 10) value /= 10, ++exponent;
    if (value < 1) value *= 10, --exponent;
    // half a unit of the last digit
    Wide half = Wide(1) / 2;
    for (int i = 1; i < digits; ++i) half /= 10;
    value += half;
    if (value >= 10) value /= 10, ++exponent;
    std::string text = negative ? "-" : "";
    for (int i = 0; i < digits; ++i) {
        const int digit = static_cast<int>(value);
        text += static_cast<char>('0' + digit);
        if (i == 0 && digits > 1) text += '.';
        value = (value - digit) * 10;
    }
    return text + fmt::format("e{}", exponent);
}

}  // namespace polhode
