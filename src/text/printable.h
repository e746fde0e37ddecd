// What a terminal may be shown of a text that somebody else wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace polhode {

/// Length of the UTF-8 sequence that begins at `text` (not empty), 0 where none does (RFC 3629: no surrogates, no
/// overlong forms); its code point in `point`.
std::size_t sequence_length(std::string_view text, std::uint32_t& point);

/// Whether a code point is shown as a sign and does nothing else: no control character (C0, DEL, C1), no separator of
/// lines, none that turns the direction of writing.
bool is_printable(std::uint32_t point);

/// Offset of the first code point that is not printable, or of a byte that is no UTF-8, or npos; tabs and ends of lines
/// are let pass.
std::size_t first_unprintable(std::string_view text);

}  // namespace polhode
