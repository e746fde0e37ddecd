// Texts that tell by themselves whether they are as they were written.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// The text with a last line that holds the content_hash() of all before it.
std::string seal(std::string_view text);

/// The text that seal() was given; nothing where the last line does not fit what stands before it: a flipped bit, a
/// missing end, a text that nobody has sealed.
std::optional<std::string> unseal(std::string_view text);

/// What unseal() says of the file's text; nothing where there is no such file. Of a file that is there and damaged one
/// line on standard error tells, once in a process: what it held counts as missing.
std::optional<std::string> read_sealed(const std::string& path);

/// Tells of a damaged file on standard error as read_sealed() does.
void tell_damaged(const std::string& path);

}  // namespace polhode
