#include "measure/growth.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "measure/statistics.h"

namespace polhode {
namespace {

using Point = std::pair<double, double>;  // log t, log envelope

constexpr double decades = 2;
constexpr double points_per_decade = 20;

}  // namespace

Envelope error_envelope(const std::vector<double>& t, const std::vector<double>& error, double from) {
    Envelope envelope;
    double largest = 0, next = from;
    for (std::size_t i = 0; i < std::min(t.size(), error.size()); ++i) {
        largest = std::max(largest, std::abs(error[i]));
        if (!(t[i] > 0) || t[i] < next * (1 - 1e-12) || !(largest > 0)) continue;
        envelope.t.push_back(t[i]), envelope.error.push_back(largest);
        next = t[i] * std::pow(10, 1 / points_per_decade);
    }
    return envelope;
}

std::optional<Growth> error_growth(const std::vector<double>& t, const std::vector<double>& error, double saturation) {
    // errors beyond saturation are meaningless
    const std::size_t count = std::min(t.size(), error.size());
    std::size_t last = 0;
    while (last < count && std::abs(error[last]) <= saturation) ++last;
    if (last < 2) return {};
    const double to = t[last - 1];
    const Envelope envelope =
        error_envelope({t.begin(), t.begin() + static_cast<long>(last)}, error, to * std::pow(10, -decades));
    std::vector<Point> points;
    for (std::size_t i = 0; i < envelope.t.size(); ++i)
        points.emplace_back(std::log(envelope.t[i]), std::log(envelope.error[i]));
    if (points.size() < 4 || points.back().first - points.front().first < std::log(10.0)) return {};
    const double middle = (points.front().first + points.back().first) / 2;
    const auto half = std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.first >= middle; });
    const std::span<const Point> all(points);
    const std::size_t mid = static_cast<std::size_t>(half - points.begin());
    Growth growth{least_squares_line(all).slope, 0, envelope.t.front(), to};
    if (mid >= 2 && all.size() - mid >= 2)
        growth.uncertainty =
            std::abs(least_squares_line(all.first(mid)).slope - least_squares_line(all.subspan(mid)).slope) / 2;
    return growth;
}

}  // namespace polhode
