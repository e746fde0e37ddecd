#include "check/known_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "body/elementary.h"
#include "body/orientation.h"
#include "integrators/method.h"

namespace polhode {
namespace {

// number of rows compared with all updates, and with the update that they match
constexpr std::size_t rows_to_choose = 240, rows_to_follow = 20'000;
constexpr std::size_t least_rows = 8;

// Whether rows are at 0, h, 2 h, .., up to the rounding of a binary32 clock.
bool evenly_spaced(const TrajectoryFile& file, std::size_t rows, double h) {
    for (std::size_t k = 0; k < rows; ++k)
        if (!(std::abs(file.rows[k].t - static_cast<double>(k) * h) <= 1e-5 * h + 1e-6 * file.rows[k].t)) return false;
    return true;
}

// Attitude differences between a run and q_at(k) at each row; empty if the run failed.
template <class At>
std::vector<double> angles(const Trajectory& run, std::size_t rows, const At& q_at) {
    std::vector<double> all;
    if (run.status != Status::ok || run.samples.size() < rows) return all;
    for (std::size_t k = 0; k < rows; ++k) all.push_back(rotation_angle_between(run.samples[k].q, q_at(k)));
    return all;
}

// Returns the largest angle. NaN counts as largest.
double largest_of(const std::vector<double>& all, std::size_t rows) {
    if (all.size() < rows) return std::numeric_limits<double>::infinity();
    double largest = 0;
    for (std::size_t k = 0; k < rows; ++k)
        if (!(all[k] <= largest)) largest = all[k];
    return largest;
}

// Largest attitude difference that rounding in each step explains at a row, rad.
double by_rounding(double noise, std::size_t row) { return 20 * noise * static_cast<double>(row + 10); }

// Number of rows from the first that match to rounding.
std::size_t rows_that_match(const std::vector<double>& all, double noise) {
    std::size_t k = 0;
    while (k < all.size() && all[k] <= by_rounding(noise, k)) ++k;
    return k;
}

// Describes a change of |w| at a row that is clearly larger than in the rows before.
std::string jump_at(const TrajectoryFile& file, std::size_t row) {
    if (!file.has_angular_velocity || row < 4) return "";
    const auto speed = [&](std::size_t k) { return length(file.rows[k].angular_velocity_W); };
    std::vector<double> before;
    for (std::size_t k = std::max<std::size_t>(row, 40) - 39; k + 1 < row; ++k)
        before.push_back(std::abs(speed(k) - speed(k - 1)));
    if (before.empty()) return "";
    std::ranges::sort(before);
    // if the attitude is one step late, w changes in the row before
    for (const std::size_t k : {row, row - 1}) {
        const double change = speed(k) - speed(k - 1);
        if (std::abs(change) > 5 * before.back() && std::abs(change) > 1e-6 * speed(k - 1))
            return fmt::format(", where |w| {} from {:.4g} to {:.4g} rad/s", change < 0 ? "drops" : "jumps",
                               speed(k - 1), speed(k));
    }
    return "";
}

std::string hertz(double step) { return fmt::format("{:.4g} Hz", 1 / step); }

// Runs a method over the first `rows` rows of a file. h: the step of methods that take one, s.
Trajectory run_over(const Scene& scene, const TrajectoryFile& file, const Method& method, double h, std::size_t rows) {
    Scene timed = scene;
    timed.duration = file.rows[rows - 1].t;
    Settings settings;
    settings.samples = static_cast<long>(rows - 1);
    settings.max_steps = 2'000'000;
    if (takes_tolerance(method))
        settings.tolerance = 1e-11;
    else if (takes_step(method))
        settings.step = h;
    return solve(timed, method, settings);
}

// The updates of the catalogue that a file with this rounding may follow.
std::vector<const Method*> possible_updates(const Scene& scene, double noise) {
    std::vector<const Method*> updates;
    for (const Method* method : methods())
        if ((method->family == Family::engine_update || method->family == Family::published_update) &&
            method->control == Control::fixed_step && (noise > 1e-9 || method->precision == Precision::binary64) &&
            // without planes, the updates with impacts equal those without
            (!method->planes || !scene.planes.empty()))
            updates.push_back(method);
    // if two updates differ by rounding only, prefer the update used by engines
    std::stable_partition(updates.begin(), updates.end(),
                          [](const Method* m) { return m->family == Family::engine_update; });
    return updates;
}

struct NearestUpdate {
    const Method* method = nullptr;
    int steps = 1;             // per row
    std::size_t matching = 0;  // number of rows that match to rounding
    double distance = std::numeric_limits<double>::infinity();
};

// The update nearest to the first `rows` rows of a file, which are `row` (s) apart, with one or `steps` steps per row.
NearestUpdate nearest_update(const Scene& scene, const TrajectoryFile& file, std::size_t rows, double row, int steps,
                             double noise) {
    const std::vector<const Method*> updates = possible_updates(scene, noise);
    const auto of_file = [&](std::size_t k) { return file.rows[k].q; };
    NearestUpdate nearest;
    for (const int count : {1, steps}) {
        if (count == 1 || count != nearest.steps)
            for (const Method* method : updates) {
                const std::vector<double> off =
                    angles(run_over(scene, file, *method, row / count, rows), rows, of_file);
                const NearestUpdate one{method, count, rows_that_match(off, noise), largest_of(off, rows)};
                constexpr double rounding = 1e-12;
                const bool nearer = one.distance < 0.9 * nearest.distance && nearest.distance > rounding;
                if (one.matching > nearest.matching + 4 || (one.matching + 4 >= nearest.matching && nearer))
                    nearest = one;
            }
        if (steps == 1) break;
    }
    return nearest;
}

// Errors over the first rows of a file with shorter steps and with other updates, as a sentence.
std::string compare_errors(const Scene& scene, const TrajectoryFile& file, const Method& method, double step,
                           const Trajectory& truth, std::size_t rows) {
    const auto of_truth = [&](std::size_t k) { return truth.samples[k].q; };
    const auto error_of = [&](const Method& one, double h) {
        const double value = largest_of(angles(run_over(scene, file, one, h, rows), rows, of_truth), rows);
        return std::isfinite(value) ? fmt::format("{:.2g} rad", value) : std::string("no result");
    };
    std::string others;
    for (const char* name : {"gyroscopic_explicit", "gyroscopic_implicit", "gyroscopic_rescaled_momentum", "buss"})
        if (const Method* other = find_method(name); other && other != &method)
            others += fmt::format(", {} {}", name, error_of(*other, step));
    return fmt::format(". Error with half the step: {}, with an eighth: {}{}", error_of(method, step / 2),
                       error_of(method, step / 8),
                       others.empty() ? "" : "; other updates at this step:" + others.substr(1));
}

}  // namespace

std::optional<UpdateMatch> identify_update(const Scene& scene, const TrajectoryFile& file, int steps, double noise) {
    const std::size_t all_rows = std::min(file.rows.size(), rows_to_follow), rows = std::min(all_rows, rows_to_choose);
    if (rows < least_rows) return {};
    const double row = file.rows[rows - 1].t / static_cast<double>(rows - 1);
    if (!(row > 0) || !evenly_spaced(file, rows, row)) return {};
    const Method& accurate = *choose_method(pose(scene)).method;
    Trajectory truth = run_over(scene, file, accurate, row, rows);
    if (truth.status != Status::ok) return {};
    const auto of_file = [&](std::size_t k) { return file.rows[k].q; };
    const std::vector<double> errors = angles(truth, rows, of_file);
    const double error = largest_of(errors, rows);
    // the attitude is correct to the precision of the file's numbers
    if (!(error > 10 * by_rounding(noise, rows))) return {};
    const NearestUpdate nearest = nearest_update(scene, file, rows, row, steps, noise);
    if (!nearest.method) return {};
    UpdateMatch best;
    best.method = nearest.method->name, best.step = row / nearest.steps;
    // rows that the scene's motion also matches are not evidence
    best.matches = nearest.matching >= least_rows && nearest.matching > rows_that_match(errors, noise) + least_rows / 2;
    if (!best.matches) {
        best.distance = nearest.distance, best.error = error;
        if (!(10 * best.distance <= best.error)) return {};
        best.message = fmt::format(
            "the file resembles the {} update at {}: over its first {} rows it differs from this update by at most "
            "{:.2g} rad, and from the reference by {:.2g} rad",
            best.method, hertz(best.step), rows, best.distance, best.error);
        return best;
    }
    // find the row at which the file departs
    std::size_t matching = nearest.matching;
    std::vector<double> off = angles(run_over(scene, file, *nearest.method, best.step, all_rows), all_rows, of_file);
    if (evenly_spaced(file, all_rows, row) && off.size() == all_rows) matching = rows_that_match(off, noise);
    if (matching > rows) truth = run_over(scene, file, accurate, row, matching);
    if (truth.status != Status::ok) return {};
    best.distance = largest_of(off, std::min(matching, off.size()));
    best.error = largest_of(angles(truth, matching, of_file), matching);
    const bool leaves = matching < all_rows;
    if (leaves) best.departure_time = file.rows[matching].t;
    best.message =
        fmt::format("the file matches the {} update at {} to {:.2g} rad", best.method, hertz(best.step), best.distance);
    best.message +=
        leaves ? fmt::format(
                     " and departs from it at t = {:.6g} s{}; until then its error of {:.2g} rad is the truncation "
                     "error at this step",
                     *best.departure_time, jump_at(file, matching), best.error)
               : fmt::format(" over {} rows; its error of {:.2g} rad is the truncation error at this step", matching,
                             best.error);
    best.message += compare_errors(scene, file, *nearest.method, best.step, truth, matching);
    return best;
}

}  // namespace polhode
