#include "text/content_hash.h"

namespace polhode {

void ContentHash::add(std::string_view piece) {
    constexpr Number prime = (Number(1) << 88) | 0x13B;
    Number hash = hash_;
    for (const char c : piece) {
        hash ^= static_cast<unsigned char>(c);
        hash *= prime;
    }
    hash_ = hash;
}

std::string ContentHash::text() const {
    std::string text(32, '0');
    for (std::size_t i = 0; i < text.size(); ++i)
        text[i] = "0123456789abcdef"[static_cast<int>(hash_ >> (124 - 4 * i)) & 15];
    return text;
}

std::string content_hash(std::string_view content) {
    ContentHash hash;
    hash.add(content);
    return hash.text();
}

}  // namespace polhode
