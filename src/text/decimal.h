// Conversion of numbers to text and back without loss of bits.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// The shortest decimal that reads back to the same binary64. Minus zero is "-0.0", so that JSON keeps its sign.
inline std::string shortest_decimal(double value) {
    char buffer[32];
    const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, value);
    std::string text(buffer, end.ptr);
    return text == "-0" ? "-0.0" : text;
}

/// The binary64 nearest to a decimal such as "-1.5e-3"; one leading "+" is allowed. Returns zero or infinity if the
/// magnitude is below or beyond the range of binary64. Accepts "inf" and "nan" in any case. Returns nothing unless
/// the whole text is a number.
std::optional<double> parse_decimal(std::string_view text);

}  // namespace polhode
