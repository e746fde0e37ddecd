#include "body/wide_decimal.h"

#include <cstdlib>
#include <string>

namespace polhode {

Wide power_of_ten(int exponent) {
    Wide power = 1;
    for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
    return exponent < 0 ? 1 / power : power;
}

Wide parse_wide(std::string_view text) {
    const std::size_t mark = text.find_first_of("eE");
    int exponent = mark == text.npos ? 0 : std::stoi(std::string(text.substr(mark + 1)));
    Wide value = 0;
    bool fraction = false;
    for (const char c : text.substr(0, mark)) {
        if (c == '.') fraction = true;
        if (c < '0' || c > '9') continue;
        value = 10 * value + (c - '0');
        if (fraction) --exponent;
    }
    value *= power_of_ten(exponent);
    return text.starts_with('-') ? -value : value;
}

}  // namespace polhode
