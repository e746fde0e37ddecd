// Which code points of untrusted text may be shown on a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace polhode {

/// Length of the UTF-8 sequence at the start of `text` (not empty), or 0 if there is none (RFC 3629: no surrogates,
/// no overlong forms). Sets `point` to its code point.
std::size_t sequence_length(std::string_view text, std::uint32_t& point);

/// Whether a code point is safe to print: not a control character (C0, DEL, C1), a line separator or a bidirectional
/// control character.
bool is_printable(std::uint32_t point);

/// Offset of the first code point that is not printable or byte that is not UTF-8, or npos. Tabs and line ends are
/// accepted.
std::size_t first_unprintable(std::string_view text);

}  // namespace polhode
