// The range and the tics of a plot's axis.
#pragma once

#include <string>
#include <vector>

namespace polhode {

/// A tic of an axis.
struct Tic {
    std::string position;  ///< decimal
    std::string label;     ///< gnuplot enhanced text, "10^{−12}"; empty for a minor tic
};

/// The range of an axis and its tics.
struct Axis {
    bool logarithmic = false;
    double low = 0, high = 1;
    int factor_exponent = 0;  ///< value = label times 10^this, on a linear axis
    std::vector<Tic> tics;
};

/// Whether an axis can show the value: finite, magnitude at most 1e300, and at least 1e-300 on a logarithmic axis.
bool drawable(double value, bool logarithmic);

/// An axis for drawable data in [low, high], with at most about `labels` labels. A logarithmic axis labels decades,
/// or 1, 2, 3, 5 and 7 times powers of ten if there are fewer than two decades. `padding`: fraction of the range left
/// free at each end.
Axis make_axis(bool logarithmic, double low, double high, int labels, double padding);

/// Position of a value on the axis: 0 at its low end, 1 at its high end.
double fraction(const Axis& axis, double value);

}  // namespace polhode
