#include "figure/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace polhode {

namespace {

constexpr double largest = 1e300, smallest = 1e-300;

std::string replace_minus_sign(const std::string& number) {
    return number.starts_with('-') ? "−" + number.substr(1) : number;
}

double value_of(const std::string& decimal) {
    double value = 0;
    std::from_chars(decimal.data(), decimal.data() + decimal.size(), value);
    return value;
}

std::string power_of_ten(int exponent) {
    return fmt::format("10^{{{}}}", replace_minus_sign(fmt::format("{}", exponent)));
}

/// Label for digit * 10^exponent on a logarithmic axis.
std::string logarithmic_label(int digit, int exponent) {
    if (exponent >= -3 && exponent <= 3) {
        return fmt::format("{:.{}f}", value_of(fmt::format("{}e{}", digit, exponent)), std::max(0, -exponent));
    }
    return digit == 1 ? power_of_ten(exponent) : fmt::format("{}×{}", digit, power_of_ten(exponent));
}

/// The smallest step, in whole decades, that leaves at most `labels` labels.
int decade_step(int first, int last, int labels) {
    int step = 1;
    for (const int candidate : {2, 3, 4, 5, 6, 10, 15, 20, 25, 50, 100, 200}) {
        if (last / step - first / step + 1 <= labels) break;
        step = candidate;
    }
    return step;
}

void add_logarithmic_tics(Axis& axis, int labels) {
    const auto inside = [&](const std::string& position) {
        const double value = value_of(position);
        return axis.low <= value && value <= axis.high;
    };
    int first = static_cast<int>(std::floor(std::log10(axis.low)));
    int last = static_cast<int>(std::ceil(std::log10(axis.high)));
    const int before = first, behind = last;
    while (first <= last && !inside(fmt::format("1e{}", first))) ++first;
    while (first <= last && !inside(fmt::format("1e{}", last))) --last;
    const bool decades = last > first;
    const int step = decades ? decade_step(first, last, labels) : 1;
    for (int exponent = before; exponent <= behind; ++exponent) {
        for (int digit = 1; digit <= 9; ++digit) {
            if (digit > 1 && step > 1) continue;  // minor tics are then the decades in between
            const std::string position = fmt::format("{}e{}", digit, exponent);
            if (!inside(position)) continue;
            std::string label;
            if (decades && digit == 1 && exponent % step == 0) {
                label = power_of_ten(exponent);
            } else if (!decades && (digit <= 3 || digit == 5 || digit == 7)) {
                label = logarithmic_label(digit, exponent);
            }
            axis.tics.push_back({position, label});
        }
    }
}

void add_linear_tics(Axis& axis, int labels) {
    const double span = axis.high - axis.low;
    int exponent = static_cast<int>(std::floor(std::log10(span / labels)));
    const auto too_many = [&](long digit) { return span / value_of(fmt::format("{}e{}", digit, exponent)) > labels; };
    long digit = too_many(1) ? too_many(2) ? 5 : 2 : 1;
    if (digit == 5 && too_many(5)) {
        digit = 1;
        ++exponent;
    }
    // tics are integer multiples of digit * 10^exponent: exact as decimals
    const double step = value_of(fmt::format("{}e{}", digit, exponent));
    const long first = static_cast<long>(std::ceil(axis.low / step - 1e-9));
    const long last = static_cast<long>(std::floor(axis.high / step + 1e-9));
    const double largest_label = static_cast<double>(std::max(std::labs(first), std::labs(last))) * step;
    const int magnitude = static_cast<int>(std::floor(std::log10(largest_label) + 1e-9));
    if (magnitude < -2 || magnitude > 4) axis.factor_exponent = magnitude;
    const int label_exponent = exponent - axis.factor_exponent;
    for (long i = first; i <= last; ++i) {
        const double shown = value_of(fmt::format("{}e{}", i * digit, label_exponent));
        const std::string label = i == 0 ? "0" : fmt::format("{:.{}f}", shown, std::max(0, -label_exponent));
        axis.tics.push_back({fmt::format("{}e{}", i * digit, exponent), replace_minus_sign(label)});
    }
}

}  // namespace

bool drawable(double value, bool logarithmic) {
    if (!std::isfinite(value) || std::abs(value) > largest) return false;
    return !logarithmic || value >= smallest;
}

Axis make_axis(bool logarithmic, double low, double high, int labels, double padding) {
    Axis axis{logarithmic, low, high, 0, {}};
    if (logarithmic) {
        double from = std::log10(low), to = std::log10(high);
        // at least 0.7 decades, so that at least two labelled tics fit
        const double missing = std::max(0.0, 0.7 - (to - from));
        const double margin = padding * std::max(to - from, 0.7);
        from -= missing / 2 + margin;
        to += missing / 2 + margin;
        // the margin of a wide range could overflow binary64
        axis.low = std::pow(10.0, std::max(from, -307.0));
        axis.high = std::pow(10.0, std::min(to, 307.0));
        add_logarithmic_tics(axis, labels);
        return axis;
    }
    // data that agree to more digits than a label shows are drawn as one value
    const double magnitude = std::max(std::abs(low), std::abs(high));
    if (high - low <= 1e-9 * magnitude || magnitude < smallest) {
        const double widened = magnitude < smallest ? 1 : 0.1 * magnitude;
        axis.low -= widened;
        axis.high += widened;
    }
    const double margin = padding * (axis.high - axis.low);
    axis.low -= margin;
    axis.high += margin;
    add_linear_tics(axis, labels);
    return axis;
}

double fraction(const Axis& axis, double value) {
    if (!axis.logarithmic) return (value - axis.low) / (axis.high - axis.low);
    const double from = std::log10(axis.low), to = std::log10(axis.high);
    return (std::log10(value) - from) / (to - from);
}

}  // namespace polhode
