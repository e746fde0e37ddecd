#include "check/known_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "body/orientation.h"
#include "integrators/method.h"

namespace polhode {
namespace {

constexpr std::size_t most_rows = 240;

// Whether rows are at 0, h, 2 h, .. as far as a clock in binary32 tells.
bool evenly_spaced(const TrajectoryFile& file, std::size_t rows, double h) {
    for (std::size_t k = 0; k < rows; ++k)
        if (!(std::abs(file.rows[k].t - static_cast<double>(k) * h) <= 1e-5 * h + 1e-6 * file.rows[k].t)) return false;
    return true;
}

// The largest angle between a run and the file's rows, or the run's and the motion's.
template <class At>
double farthest(const Trajectory& run, std::size_t rows, const At& q_at) {
    if (run.status != Status::ok || run.samples.size() < rows) return std::numeric_limits<double>::infinity();
    double largest = 0;
    for (std::size_t k = 0; k < rows; ++k) {
        const double angle = rotation_angle_between(run.samples[k].q, q_at(k));
        if (!(angle <= largest)) largest = angle;
    }
    return largest;
}

std::string hertz(double step) { return fmt::format("{:.4g} Hz", 1 / step); }

}  // namespace

std::optional<FollowedUpdate> followed_update(const Scene& scene, const TrajectoryFile& file, int steps,
                                              bool in_binary32) {
    const std::size_t rows = std::min(file.rows.size(), most_rows);
    if (rows < 8) return {};
    const double row = file.rows[rows - 1].t / static_cast<double>(rows - 1), step = row / steps;
    if (!(step > 0) || !evenly_spaced(file, rows, row)) return {};
    Scene timed = scene;
    timed.duration = file.rows[rows - 1].t;
    const Problem problem = pose(timed);
    const auto run = [&](const Method& method, double h) {
        Settings settings;
        settings.samples = static_cast<long>(rows - 1);
        settings.max_steps = 2'000'000;
        if (takes_tolerance(method))
            settings.tolerance = 1e-11;
        else if (takes_step(method))
            settings.step = h;
        return solve(timed, method, settings);
    };
    const Trajectory truth = run(*choose_method(problem).method, step);
    if (truth.status != Status::ok) return {};
    const auto of_file = [&](std::size_t k) { return file.rows[k].q; };
    const auto of_truth = [&](std::size_t k) { return truth.samples[k].q; };
    FollowedUpdate best;
    best.error = farthest(truth, rows, of_file), best.step = step;
    best.distance = std::numeric_limits<double>::infinity();
    const Method* nearest = nullptr;
    std::vector<const Method*> updates;
    for (const Method* method : methods())
        if ((method->family == Family::engine_update || method->family == Family::published_update) &&
            method->control == Control::fixed_step && (in_binary32 || method->precision == Precision::binary64))
            updates.push_back(method);
    // of two that are as near but for rounding, the engines' own name it
    std::stable_partition(updates.begin(), updates.end(),
                          [](const Method* m) { return m->family == Family::engine_update; });
    constexpr double rounding = 1e-12;
    for (const Method* method : updates) {
        const double distance = farthest(run(*method, step), rows, of_file);
        if (distance < 0.9 * best.distance && best.distance > rounding) best.distance = distance, nearest = method;
    }
    if (!nearest || !(10 * best.distance <= best.error)) return {};
    best.method = nearest->name;
    const auto error = [&](const Method& method, double h) {
        const double value = farthest(run(method, h), rows, of_truth);
        return std::isfinite(value) ? fmt::format("{:.2g} rad", value) : std::string("no motion");
    };
    std::string others;
    for (const char* name : {"gyroscopic_explicit", "gyroscopic_implicit", "gyroscopic_rescaled_momentum", "buss"})
        if (const Method* other = find_method(name); other && other != nearest)
            others += fmt::format(", {} {}", name, error(*other, step));
    best.message = fmt::format(
        "this is the update {} at {}: the file follows it to {:.2g} rad over its first {} rows, and its error there, "
        "{:.2g} rad, is the step's. Half the step gives {}, an eighth {}{}",
        best.method, hertz(step), best.distance, rows, best.error, error(*nearest, step / 2), error(*nearest, step / 8),
        others.empty() ? "" : "; at the same step" + others.substr(1));
    return best;
}

}  // namespace polhode
