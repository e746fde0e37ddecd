// The range of a plot's axis and its tics.
#pragma once

#include <string>
#include <vector>

namespace polhode {

struct Tic {
    std::string position;  ///< decimal
    std::string label;     ///< in gnuplot's enhanced text, "10^{−12}"; empty for a minor tic
};

struct Axis {
    bool logarithmic = false;
    double low = 0, high = 1;
    int factor_exponent = 0;  ///< the labels of a linear axis times 10^this are its values
    std::vector<Tic> tics;
};

/// Whether an axis can show the value: finite, of magnitude at most 1e300, and at least 1e-300 on a logarithmic axis.
bool drawable(double value, bool logarithmic);

/// An axis about drawable data in [low, high], with about `labels` labels at most. Logarithmic: decades are labelled,
/// or 1, 2, 3, 5 and 7 times a power of ten where there are fewer than two. `padding`: the share of the range that
/// stays free at either end.
Axis make_axis(bool logarithmic, double low, double high, int labels, double padding);

/// Where a value is on the axis: 0 at its low end, 1 at its high end.
double fraction(const Axis& axis, double value);

}  // namespace polhode
