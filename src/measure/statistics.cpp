#include "measure/statistics.h"

#include <algorithm>

namespace polhode {

Line least_squares_line(std::span<const std::pair<double, double>> points) {
    const double n = static_cast<double>(points.size());
    double x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& p : points) x += p.first / n, y += p.second / n;
    for (const auto& p : points) {
        xx += (p.first - x) * (p.first - x);
        xy += (p.first - x) * (p.second - y);
    }
    return {x, y, xy / xx};
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace polhode
