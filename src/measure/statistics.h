// Basic statistics shared by several measures.
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

/// Least-squares line through at least one point (x, y). The slope is NaN if all points have the same x.
Line least_squares_line(std::span<const std::pair<double, double>> points);

/// The median of at least one value: the middle value, or the mean of the two middle ones.
double median(std::vector<double> values);

}  // namespace polhode
