#include "check/engine_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/orientation.h"
#include "check/attitude_update.h"

namespace polhode {
namespace {

using Explained = std::optional<Explanation>;

// The least of f on a grid of at least three, refined between the neighbours of its best point (golden section).
template <class F>
std::pair<double, double> least(const F& f, const std::vector<double>& grid) {
    std::size_t best = 0;
    std::vector<double> values;
    for (const double x : grid) values.push_back(f(x));
    for (std::size_t i = 1; i < grid.size(); ++i)
        if (values[i] < values[best]) best = i;
    double a = grid[best > 0 ? best - 1 : 0], b = grid[std::min(best + 1, grid.size() - 1)];
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    double x = b - ratio * (b - a), y = a + ratio * (b - a), fx = f(x), fy = f(y);
    for (int i = 0; i < 20; ++i) {
        if (fx < fy)
            b = y, y = x, fy = fx, x = b - ratio * (b - a), fx = f(x);
        else
            a = x, x = y, fx = fy, y = a + ratio * (b - a), fy = f(y);
    }
    std::pair<double, double> result{grid[best], values[best]};
    if (fx < result.second) result = {x, fx};
    if (fy < result.second) result = {y, fy};
    return result;
}

// the rate in world axes stays, as it does without the gyroscopic term
std::string steadiness(const ComparedRows& rows) {
    if (!rows.file().has_angular_velocity) return "";
    double change = 0, scale = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        change = std::max(change, length(rows.row(k).angular_velocity_W - rows.row(0).angular_velocity_W));
        scale = std::max(scale, length(rows.row(k).angular_velocity_W));
    }
    if (!(change < 1e-3 * scale)) return "";
    return fmt::format(" (w in world axes stays constant within {:.1g} of itself)", change / scale);
}

// whether a second fault, the missing gyroscopic term, is not enough alone to explain what both do
bool is_needed(const ComparedRows& rows, double both) {
    const double one = rows.error_without_gyroscopic_term();
    return one > explained_wholly * rows.error() && 3 * both < one;
}

// An alteration with a number x that is fitted on a grid, alone and, where that does not explain the file, with the
// gyroscopic term missing as well.
struct FittedAlteration {
    std::vector<double> grid;
    std::function<void(Alteration&, double)> set;
    std::function<std::string(double)> what;
    std::string remedy, remedy_of_both;  // the latter follows where the gyroscopic term is missing as well
};

Explained fitted_alteration(const ComparedRows& rows, const FittedAlteration& f, double factor) {
    for (const double gyroscopic : {1.0, 0.0}) {
        const auto altered = [&](double x) {
            Alteration a;
            a.gyroscopic = gyroscopic;
            f.set(a, x);
            return a;
        };
        const auto [x, explained] =
            least([&](double at) { return rows.attitude_error(rows.scene(), altered(at)); }, f.grid);
        const bool missing = gyroscopic == 0;
        if (missing && !is_needed(rows, explained)) return {};
        if (!(factor * explained <= rows.error())) continue;
        return Explanation{rows.error(),
                           explained,
                           f.what(x) + (missing ? ", and the gyroscopic term is missing" : ""),
                           f.remedy + (missing ? f.remedy_of_both : ""),
                           "",
                           "",
                           [&rows, a = altered(x)] { return rows.rates_left(rows.scene(), a); }};
    }
    return {};
}

// the largest rate of the file: by its columns, or by how far the attitude turns between rows. Not the first rows:
// a start beyond the limit may stand there
double largest_rate(const ComparedRows& rows) {
    double largest = 0;
    for (std::size_t k = 2; k < rows.size(); ++k)
        largest = std::max(largest, rows.file().has_angular_velocity
                                        ? length(rows.row(k).angular_velocity_W)
                                        : rotation_angle_between(rows.row(k).q, rows.row(k - 1).q) /
                                              (rows.times()[k] - rows.times()[k - 1]));
    return largest;
}

}  // namespace

Explained first_order(const ComparedRows& rows) {
    if (!rows.file().has_angular_velocity) return {};
    const std::optional<FirstOrderUpdate> update = first_order_update(rows.file(), rows.last_index() + 1);
    if (!update) return {};
    return Explanation{
        update->error,
        update->explained,
        fmt::format(
            "first-order quaternion update: the attitude goes on by q + (h/2) w q with h = {:.4g} s, a turn of 2 "
            "atan(|w| h/2) and not |w| h",
            update->step),
        "turn by the exponential of w h, or take smaller steps",
        "",
        " a row that the file's own w leaves"};
}

Explained without_gyroscopic_term(const ComparedRows& rows) {
    return Explanation{rows.error(),
                       rows.error_without_gyroscopic_term(),
                       "the gyroscopic term is missing" + steadiness(rows),
                       "turn the engine's gyroscopic term on",
                       "",
                       "",
                       [&rows] { return rows.rates_left(rows.scene(), {.gyroscopic = 0}); }};
}

Explained reversed_gyroscopic_term(const ComparedRows& rows) {
    return Explanation{rows.error(),
                       rows.attitude_error(rows.scene(), {.gyroscopic = -1}),
                       "the gyroscopic term has the wrong sign",
                       "let I dw/dt = tau - w x I w",
                       "",
                       "",
                       [&rows] { return rows.rates_left(rows.scene(), {.gyroscopic = -1}); }};
}

Explained clamped_speed(const ComparedRows& rows) {
    const double largest = largest_rate(rows), own = rows.largest_own_rate();
    // the scene wants to turn faster than the file ever does
    if (!(largest > 0 && largest < 0.99 * own)) return {};
    return fitted_alteration(
        rows,
        {{0.98 * largest, 0.99 * largest, largest, 1.01 * largest, 1.02 * largest},
         [](Alteration& a, double limit) { a.speed_limit = limit; },
         [own](double limit) {
             return fmt::format("the speed is clamped at {:.4g} rad/s, where the scene reaches {:.4g}", limit, own);
         },
         "raise the engine's limit on angular speed",
         " and turn its gyroscopic term on"},
        alike);
}

Explained left_damping(const ComparedRows& rows) {
    std::vector<double> grid;  // of the rate's logarithm
    for (int i = 0; i <= 16; ++i) grid.push_back(std::log(std::pow(10.0, -3 + 0.25 * i) / rows.times().back()));
    return fitted_alteration(rows,
                             {grid, [](Alteration& a, double log_rate) { a.damping = std::exp(log_rate); },
                              [](double log_rate) {
                                  return fmt::format(
                                      "damping is left on: w dies away at {:.3g} 1/s more than in the scene",
                                      std::exp(log_rate));
                              },
                              "turn the engine's angular damping off", " and its gyroscopic term on"},
                             fitted_alike);
}

Explained wrong_time(const ComparedRows& rows) {
    // a grid fine enough for cubic interpolation: h w = 0.05 leaves (h w)^4 / 384 = 2e-8 rad
    constexpr double most_s = 4;
    // rows a radian and more apart fit many a time
    if (rows.turned() > static_cast<double>(rows.size())) return {};
    const double end = rows.times().back() * most_s;
    const double count = std::ceil(2 * end * rows.largest_own_rate() / 0.05);
    if (!(count >= 1 && count <= 40000)) return {};
    std::vector<double> grid_times;
    for (int i = 0; i <= static_cast<int>(count); ++i) grid_times.push_back(end * i / count);
    const std::vector<Sample> dense = rows.motion(rows.scene(), {}, grid_times);
    if (dense.size() < grid_times.size()) return {};
    const auto error = [&](double s) {
        return root_mean_square(rows.size(), [&](std::size_t k) {
            return rotation_angle_between(interpolated_attitude(dense, end / count, s * rows.times()[k]),
                                          rows.row(k).q);
        });
    };
    std::vector<double> grid;
    for (double s = 0.25; s <= most_s; s *= 1.03) grid.push_back(s);
    for (int i = -10; i <= 10; ++i) grid.push_back(1 + 0.1 * i / std::max(rows.turned(), 1.0));
    std::sort(grid.begin(), grid.end());
    const std::pair<double, double> best = least([&](double x) { return error(std::clamp(x, 0.0, most_s)); }, grid);
    const double s = best.first, explained = best.second;
    // methods of low order run fast or slow by a little as well; a small turn fits many a time
    if (std::abs(s - 1) < 0.02 || rows.turned() < 1) return {};
    // the scene's w at those times, from the nearest of the grid
    const auto rate_at = [&rows, dense, s, count, end](std::size_t k) {
        const double place = std::round(s * rows.times()[k] * count / end);
        return world_rate(dense[static_cast<std::size_t>(std::clamp(place, 0.0, count))]);
    };
    return Explanation{rows.error(),
                       explained,
                       fmt::format("the time is wrong: the body moves as the scene does, {:.5g} times as fast", s),
                       fmt::format("multiply the step by {:.5g}, or the times by {:.5g}", 1 / s, s),
                       "",
                       "",
                       [&rows, rate_at] { return rows.rates_left(rate_at); }};
}

}  // namespace polhode
