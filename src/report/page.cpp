#include "report/page.h"

#include <fmt/format.h>
#include <zlib.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "text/message.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

std::string gzip(std::string_view text) {
    z_stream stream{};
    // 15 window bits plus 16 for a gzip header. Its time is zero, so the same document gives the same bytes.
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib cannot start compression");
    std::string out(deflateBound(&stream, text.size()) + 32, '\0');
    // zlib does not write to its input
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));  // NOLINT
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());  // NOLINT
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("zlib cannot compress the page's document");
    return out;
}

std::string base64(const std::string& bytes) {
    namespace it = boost::archive::iterators;
    using Encoder = it::base64_from_binary<it::transform_width<std::string::const_iterator, 6, 8>>;
    std::string text(Encoder(bytes.begin()), Encoder(bytes.end()));
    text.append((4 - text.size() % 4) % 4, '=');
    return text;
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    return out;
}

void replace_once(std::string& page, std::string_view mark, std::string_view text) {
    const std::size_t place = page.find(mark);
    if (place == std::string::npos || page.find(mark, place + 1) != std::string::npos)
        throw std::runtime_error(
            fmt::format("the page's front-end must contain {} exactly once; build it again", mark));
    page.replace(place, mark.size(), text);
}

}  // namespace

std::string page_template_path() {
    if (const char* named = std::getenv("POLHODE_REPORT_PAGE"); named && *named) {
        if (!fs::is_regular_file(named))
            throw std::runtime_error(
                fmt::format("POLHODE_REPORT_PAGE is {}, which is not a file; unset it", one_line(named, 300)));
        return named;
    }
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const char* place : {"report/page.html", "../share/polhode/report/page.html"})
        if (const fs::path path = program / place; fs::is_regular_file(path, error)) return path.string();
    throw std::runtime_error(
        "the page's front-end is not built; run src/report/page/build (needs Node.js and npm), or install polhode's "
        "package, which contains it");
}

std::string fill_page(std::string_view page_template, std::string_view title, std::string_view document) {
    std::string page(page_template);
    replace_once(page, "<!--polhode:data-->", base64(gzip(document)));
    replace_once(page, "<!--polhode:title-->", escaped(title));
    return page;
}

}  // namespace polhode
