#include "text/content_hash.h"

namespace polhode {

std::string content_hash(std::string_view content) {
    __extension__ using Hash = unsigned __int128;
    constexpr Hash prime = (Hash(1) << 88) | 0x13B;
    Hash hash = (Hash(0x6C62272E07BB0142) << 64) | 0x62B821756295C58D;
    for (const char c : content) {
        hash ^= static_cast<unsigned char>(c);
        hash *= prime;
    }
    std::string text(32, '0');
    for (std::size_t i = 0; i < text.size(); ++i)
        text[i] = "0123456789abcdef"[static_cast<int>(hash >> (124 - 4 * i)) & 15];
    return text;
}

}  // namespace polhode
