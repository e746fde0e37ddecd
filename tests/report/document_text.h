// Reads the document from a page, independently of the code that writes it: with zlib and a separate base64 decoder.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace polhode {

/// The template of these tests; the document is between "<data>" and "</data>".
inline constexpr const char* page_template =
    "<title><!--polhode:title--></title>\n<data><!--polhode:data--></data>\n<p>the rest</p>\n";

inline std::string from_base64(std::string_view text) {
    std::string out;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        const std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        const std::size_t value = letters.find(c);
        if (value == std::string_view::npos) throw std::invalid_argument("not base64");
        bits = bits << 6 | static_cast<std::uint32_t>(value), count += 6;
        if (count >= 8) out += static_cast<char>(bits >> (count -= 8) & 0xff);
    }
    return out;
}

inline std::string from_gzip(const std::string& bytes) {
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::runtime_error("zlib");
    std::string in = bytes, out;
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(in.size());
    char buffer[65536];
    int status = Z_OK;
    while (status == Z_OK) {
        stream.next_out = reinterpret_cast<Bytef*>(buffer), stream.avail_out = sizeof buffer;
        status = inflate(&stream, Z_NO_FLUSH);
        out.append(buffer, sizeof buffer - stream.avail_out);
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("incomplete gzip stream");
    return out;
}

inline std::string document_text(const std::string& page) {
    const std::size_t begin = page.find("<data>") + 6, end = page.find("</data>");
    return from_gzip(from_base64(std::string_view(page).substr(begin, end - begin)));
}

}  // namespace polhode
