// Numbers as text that reads back to the same bits.
#pragma once

#include <charconv>
#include <string>

namespace polhode {

/// The shortest decimal that reads back to the same binary64 ("-0.0" for minus zero, so that JSON keeps its sign).
inline std::string shortest_decimal(double value) {
    char buffer[32];
    const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, value);
    std::string text(buffer, end.ptr);
    return text == "-0" ? "-0.0" : text;
}

}  // namespace polhode
