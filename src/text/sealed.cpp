#include "text/sealed.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>

#include "text/content_hash.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::string_view seal_mark = "# checksum ";
constexpr std::size_t seal_length = seal_mark.size() + 32 + 1;  // 32 digits and the line end

std::string seal_of(std::string_view text) { return std::string(seal_mark) + content_hash(text) + "\n"; }

}  // namespace

std::string seal(std::string_view text) { return std::string(text) + seal_of(text); }

std::optional<std::string> unseal(std::string_view text) {
    if (text.size() < seal_length) return {};
    const std::string_view body = text.substr(0, text.size() - seal_length);
    if (text.substr(body.size()) != seal_of(body)) return {};
    return std::string(body);
}

std::optional<std::string> read_sealed(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    const std::string text(std::istreambuf_iterator<char>(file), {});
    std::optional<std::string> body = unseal(text);
    if (!body) warn_damaged(path);
    return body;
}

void warn_damaged(const std::string& path) {
    static std::mutex mutex;
    static std::set<std::string> reported;
    const std::lock_guard lock(mutex);
    if (!reported.insert(path).second) return;
    const std::string line = "polhode: " + one_line(path, 500) +
                             ": corrupted (wrong checksum); it is treated as missing and recomputed when needed\n";
    static_cast<void>(std::fputs(line.c_str(), stderr));  // a failure cannot be reported anywhere
}

}  // namespace polhode
