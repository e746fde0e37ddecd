// A name for a content: 32 hexadecimal digits.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// FNV-1a over 128 bits (Fowler, Noll & Vo): for telling contents apart, not against an adversary.
std::string content_hash(std::string_view content);

/// The same of a content that comes piece by piece.
class ContentHash {
  public:
    /// Goes on by a piece.
    void add(std::string_view piece);
    /// The name of what was added so far.
    std::string text() const;

  private:
    __extension__ using Number = unsigned __int128;
    Number hash_ = (Number(0x6C62272E07BB0142) << 64) | 0x62B821756295C58D;
};

}  // namespace polhode
