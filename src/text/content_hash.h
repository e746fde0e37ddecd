// A name for a content: 32 hexadecimal digits.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// FNV-1a over 128 bits (Fowler, Noll & Vo): for telling contents apart, not against an adversary.
std::string content_hash(std::string_view content);

}  // namespace polhode
