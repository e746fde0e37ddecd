// Texts with a checksum, so that corruption is detected.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace polhode {

/// Appends a last line with the content_hash() of everything before it.
std::string seal(std::string_view text);

/// The text that was passed to seal(). Returns nothing if the last line does not match the rest: a flipped bit, a
/// missing end, or a text without a seal.
std::optional<std::string> unseal(std::string_view text);

/// Reads and unseals the file. Returns nothing if the file does not exist or is corrupted. A corrupted file is also
/// reported on standard error, once per process.
std::optional<std::string> read_sealed(const std::string& path);

/// Reports a corrupted file on standard error, once per process, as read_sealed() does.
void warn_damaged(const std::string& path);

}  // namespace polhode
