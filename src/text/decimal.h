// Numbers as text that reads back to the same bits.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// The shortest decimal that reads back to the same binary64 ("-0.0" for minus zero, so that JSON keeps its sign).
inline std::string shortest_decimal(double value) {
    char buffer[32];
    const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, value);
    std::string text(buffer, end.ptr);
    return text == "-0" ? "-0.0" : text;
}

/// The binary64 nearest to a decimal such as "-1.5e-3", one leading "+" allowed: zero for one too small for binary64,
/// infinite for one too large; also "inf" and "nan", in any case. Nothing where the whole text is no number.
std::optional<double> parse_decimal(std::string_view text);

}  // namespace polhode
