// Content hash: 32 hexadecimal digits.
#pragma once

#include <string>
#include <string_view>

namespace polhode {

/// 128-bit FNV-1a (Fowler, Noll & Vo). It identifies contents, but is not cryptographic.
std::string content_hash(std::string_view content);

/// Computes content_hash() incrementally.
class ContentHash {
  public:
    /// Appends a piece.
    void add(std::string_view piece);
    /// The hash of all pieces added so far.
    std::string text() const;

  private:
    __extension__ using Number = unsigned __int128;
    Number hash_ = (Number(0x6C62272E07BB0142) << 64) | 0x62B821756295C58D;
};

}  // namespace polhode
