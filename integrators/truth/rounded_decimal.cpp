#include "integrators/truth/rounded_decimal.h"

#include <cstddef>

namespace polhode::truth {

std::string rounded_decimal(const std::string& number, int significant) {
    const std::size_t mark = number.find('e');
    if (mark == std::string::npos) return number;
    const bool negative = number[0] == '-';
    std::string digits;
    for (std::size_t i = 0; i < mark; ++i)
        if (number[i] >= '0' && number[i] <= '9') digits += number[i];
    int exponent = std::stoi(number.substr(mark + 1));
    const auto keep = static_cast<std::size_t>(significant);
    if (digits.size() > keep) {
        const bool up = digits[keep] >= '5';
        digits.resize(keep);
        std::size_t i = keep;
        while (up && i > 0 && digits[i - 1] == '9') digits[--i] = '0';
        if (up && i > 0) ++digits[i - 1];
        // all digits were 9 and became 0: set 1.00 with the next exponent
        if (up && i == 0) digits[0] = '1', ++exponent;
    }
    std::string text;
    if (negative) text += '-';
    text += digits[0];
    if (digits.size() > 1) text.append(".").append(digits, 1);
    return text.append("e").append(std::to_string(exponent));
}

}  // namespace polhode::truth
