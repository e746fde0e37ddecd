#include "text/decimal.h"

#include <algorithm>
#include <cmath>

namespace polhode {
namespace {

// A decimal beyond the range of binary64: returns zero if it is too small and infinity if it is too large.
double beyond_binary64(std::string_view decimal) {
    // larger than the number of digits of any text, and far from the limits of long
    constexpr long furthest = 1'000'000'000'000;
    const bool negative = decimal[0] == '-';
    const std::size_t mark = std::min(decimal.find_first_of("eE"), decimal.size());
    long exponent = 0;
    if (mark < decimal.size()) {
        std::string_view digits = decimal.substr(mark + 1);
        if (digits[0] == '+') digits.remove_prefix(1);
        if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc())
            exponent = digits[0] == '-' ? -furthest : furthest;
        exponent = std::clamp(exponent, -furthest, furthest);
    }
    // the place of the first nonzero digit
    const std::size_t point = std::min(decimal.find('.'), mark);
    const std::size_t first = decimal.substr(0, mark).find_first_of("123456789");
    if (first == decimal.npos) return negative ? -0.0 : 0.0;
    const long place = first < point ? static_cast<long>(point - first) : -static_cast<long>(first - point);
    const double limit = place + exponent < 0 ? 0 : HUGE_VAL;
    return negative ? -limit : limit;
}

}  // namespace

std::optional<double> parse_decimal(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size() || error == std::errc::invalid_argument) return {};
    return error == std::errc::result_out_of_range ? beyond_binary64(text) : value;
}

}  // namespace polhode
