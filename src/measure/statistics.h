// The few statistics that several measures share.
#pragma once

#include <span>
#include <utility>
#include <vector>

namespace polhode {

/// y = y_mean + slope (x - x_mean), by least squares.
struct Line {
    double x_mean, y_mean, slope;

    double at(double x) const { return y_mean + slope * (x - x_mean); }
};

/// Through points (x, y), at least one; the slope is not a number where all have one x.
Line least_squares_line(std::span<const std::pair<double, double>> points);

/// The middle value, or the mean of the two middle ones; at least one value.
double median(std::vector<double> values);

}  // namespace polhode
