#include "text/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "text/printable.h"

namespace polhode {
namespace {

std::string shorten(std::string_view text, std::size_t limit) {
    if (text.size() <= limit) return std::string(text);
    const auto inside_sequence = [&](std::size_t i) {
        return i > 0 && i < text.size() && (static_cast<unsigned char>(text[i]) & 0xc0u) == 0x80u;
    };
    const std::size_t available = limit > 3 ? limit - 3 : 0;
    std::size_t head = available * 2 / 3, tail = text.size() - (available - head);
    while (inside_sequence(head)) --head;
    while (inside_sequence(tail)) ++tail;
    return std::string(text.substr(0, head)) + "..." + std::string(text.substr(tail));
}

// Edit distance with insertion, deletion, substitution and transposition of neighbours (Damerau 1964), row by row.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before.swap(last), last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

}  // namespace

std::string one_line(std::string_view text, std::size_t limit) {
    // a long text is cut before escaping, to bound the work
    std::string escaped, source = shorten(text, limit);
    for (std::string_view rest = source; !rest.empty();) {
        std::uint32_t point = 0;
        const std::size_t length = sequence_length(rest, point);
        if (length > 0 && is_printable(point)) {
            escaped += rest.substr(0, length);
        } else if (rest[0] == '\n') {
            escaped += "\\n";
        } else if (rest[0] == '\t') {
            escaped += "\\t";
        } else if (rest[0] == '\r') {
            escaped += "\\r";
        } else if (length > 1) {
            escaped += fmt::format("\\u{:04x}", point);
        } else {
            escaped += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(rest[0])));
        }
        rest.remove_prefix(length > 0 ? length : 1);
    }
    return shorten(escaped, limit);
}

std::size_t first_invalid_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        std::uint32_t point = 0;
        const std::size_t length = sequence_length(text.substr(i), point);
        if (length == 0) return i;
        i += length;
    }
    return std::string_view::npos;
}

std::vector<std::string> near_misses(std::string_view word, const std::vector<std::string>& candidates) {
    std::vector<std::pair<std::size_t, std::string>> ranked;
    if (word.empty() || word.size() > 100) return {};
    for (const std::string& candidate : candidates) {
        // skip the edit distance if the lengths alone exclude a match
        const std::size_t longer = std::max(word.size(), candidate.size());
        const std::size_t gap = longer - std::min(word.size(), candidate.size());
        std::size_t distance = 3 * gap <= longer ? edit_distance(word, candidate) : longer;
        const bool contained = word.size() >= 3 && candidate.size() >= 3 &&
                               (candidate.find(word) != std::string::npos || word.find(candidate) != std::string::npos);
        if (contained) distance = std::min(distance, std::size_t{2});
        if (contained || (distance < word.size() && 3 * distance <= std::max(word.size(), candidate.size())))
            ranked.emplace_back(distance, candidate);
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> nearest;
    for (std::size_t i = 0; i < ranked.size() && i < 3 && ranked[i].first <= ranked[0].first + 1; ++i)
        nearest.push_back(ranked[i].second);
    return nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::vector<std::string> nearest = near_misses(word, candidates);
    return nearest.empty() ? std::string() : fmt::format("did you mean {}?", fmt::join(nearest, " or "));
}

std::string join_with_commas(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

InputError::InputError(const std::string& file, const std::string& place, Rest rest)
    : std::runtime_error(one_line(file, 200) + ": " + (place.empty() ? "" : one_line(place, 300) + ": ") + rest.text),
      place_(place),
      rest_(std::move(rest)) {}

InputError::InputError(const std::string& file, const std::string& place, const std::string& fault,
                       const std::string& remedy)
    : InputError(file, place, Rest{one_line(fault, 300) + "; " + one_line(remedy, 400)}) {}

InputError::InputError(const std::string& file, const std::string& place, const InputError& inner)
    : InputError(file, one_line(place, 100), Rest{one_line(inner.what(), 900)}) {}

InputError InputError::relocate(const std::string& file, const std::string& place) const {
    return {file, place, rest_};
}

}  // namespace polhode
