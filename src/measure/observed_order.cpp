#include "measure/observed_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "measure/statistics.h"

namespace polhode {
namespace {

using Point = std::pair<double, double>;  // log step, log error

double slope(const std::vector<Point>& points, std::size_t begin, std::size_t end) {
    return least_squares_line(std::span(points).subspan(begin, end - begin)).slope;
}

// prefer converging over saturated, then long over short, then steep over flat
std::tuple<bool, int, double> rank(const ObservedOrder& window) {
    return {window.order > 0.5, window.points, window.order};
}

}  // namespace

std::optional<ObservedOrder> observed_order(const std::vector<double>& step, const std::vector<double>& error,
                                            double saturation) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < std::min(step.size(), error.size()); ++i)
        if (step[i] > 0 && error[i] > 0 && std::isfinite(step[i]) && std::isfinite(error[i]))
            points.emplace_back(std::log(step[i]), std::log(error[i]));
    std::sort(points.begin(), points.end());
    points.erase(
        std::unique(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.first == b.first; }),
        points.end());
    // beyond the first saturated point, errors are below saturation only by chance
    const auto saturated =
        std::ranges::find_if(points, [&](const Point& p) { return p.second > std::log(saturation); });
    points.erase(saturated, points.end());
    const auto converged = [&](const Point& point) { return point.second <= std::log(saturation / 10); };
    if (points.size() < 3 || std::ranges::none_of(points, converged)) return {};

    std::optional<ObservedOrder> best, steadiest;
    double least_spread = std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0; begin + 3 <= points.size(); ++begin) {
        double low = slope(points, begin, begin + 2), high = low;
        for (std::size_t end = begin + 3; end <= points.size(); ++end) {
            const double local = slope(points, end - 2, end);
            low = std::min(low, local), high = std::max(high, local);
            const ObservedOrder window{slope(points, begin, end), static_cast<int>(end - begin),
                                       std::exp(points[begin].first), std::exp(points[end - 1].first)};
            if (high - low < least_spread) least_spread = high - low, steadiest = window;
            if (high - low > 0.03 * std::max(1.0, std::abs(high))) break;
            if (!best || rank(window) > rank(*best)) best = window;
        }
    }
    return best ? best : steadiest;
}

}  // namespace polhode
