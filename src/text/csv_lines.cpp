#include "text/csv_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t longest_line = 64u << 10, block = 256u << 10;

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

CsvLines::CsvLines(std::string_view text, const std::string& file) : rest_(text), file_(file) {
    skip_byte_order_mark();
}

CsvLines::CsvLines(Source source, const std::string& file)
    : source_(std::move(source)), held_(longest_line + 2 + block, '\0'), file_(file) {
    // a pipe may return one byte at a time
    while (rest_.size() < 3 && refill()) continue;
    skip_byte_order_mark();
}

void CsvLines::skip_byte_order_mark() {
    if (!rest_.starts_with("\xef\xbb\xbf")) return;
    rest_.remove_prefix(3);
    note("line 1 begins with a byte order mark");
}

// Reads more text behind the unread rest. Returns false at the end.
bool CsvLines::refill() {
    if (!source_) return false;
    const std::size_t unread = rest_.size();
    if (unread > 0) std::memmove(held_.data(), rest_.data(), unread);
    const std::size_t count = source_(held_.data() + unread, block);
    rest_ = std::string_view(held_).substr(0, unread + count);
    if (count == 0) source_ = nullptr;
    return count > 0;
}

// Whether the remaining lines are all blank.
bool CsvLines::is_exhausted() {
    do {
        if (rest_.find_first_not_of(" \t\r\n") != rest_.npos) return false;
        rest_ = {};
    } while (refill());
    return true;
}

bool CsvLines::next() {
    const auto place = [&] { return fmt::format("line {}", number_); };
    for (;;) {
        if (rest_.empty() && !refill()) return false;
        std::size_t end = rest_.find('\n');
        // a line that is too long is refused once its start exceeds the limit
        while (end == rest_.npos && rest_.size() <= longest_line + 1 && refill()) end = rest_.find('\n');
        line_ = rest_.substr(0, end);
        rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
        ++number_;
        if (!line_.empty() && line_.back() == '\r') {
            line_.remove_suffix(1);
            if (!has_carriage_returns_) note(fmt::format("line {} ends in a carriage return", number_));
            has_carriage_returns_ = true;
        }
        if (line_.size() > longest_line)
            throw InputError(file_, place(), "is longer than 64 KiB", "check the line breaks of the file");
        if (const std::size_t zero = line_.find('\0'); zero != line_.npos)
            throw InputError(file_, fmt::format("line {}, character {}", number_, zero + 1), "is a zero byte",
                             "give a text file");
        if (line_.starts_with('#')) continue;
        if (!trimmed(line_).empty()) break;
        // blank lines are allowed only at the end
        if (is_exhausted()) return false;
        throw InputError(file_, place(), "is blank", "remove the line");
    }
    split();
    return true;
}

void CsvLines::split() {
    cells_.clear();
    for (std::size_t begin = 0;;) {
        const std::size_t comma = line_.find(',', begin);
        cells_.push_back(trimmed(line_.substr(begin, comma - begin)));
        if (comma == line_.npos) return;
        begin = comma + 1;
    }
}

std::vector<std::size_t> CsvLines::header(const std::vector<std::string>& names) const {
    refuse_other_separators();
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const std::string place = fmt::format("line {}, column {}", number_, i + 1);
        const auto found = std::find(names.begin(), names.end(), cells_[i]);
        if (found == names.end()) {
            const std::string meant = did_you_mean(cells_[i], names);
            throw InputError(
                file_, place, cells_[i].empty() ? "has no name" : "is named " + one_line(cells_[i], 60),
                fmt::format("{}{}known columns: {}", meant, meant.empty() ? "" : " ", join_with_commas(names)));
        }
        const std::size_t index = static_cast<std::size_t>(found - names.begin());
        if (std::find(places.begin(), places.end(), index) != places.end())
            throw InputError(file_, place, fmt::format("repeats the column {}", names[index]), "give each column once");
        places.push_back(index);
    }
    return places;
}

void CsvLines::refuse_other_separators() const {
    if (cells_.size() != 1) return;
    for (const auto& [separator, name] : {std::pair(';', "semicolons"), std::pair('\t', "tabs")})
        if (line_.find(separator) != line_.npos)
            throw InputError(file_, fmt::format("line {}, column 1", number_),
                             fmt::format("has {} between the columns", name),
                             "separate them by commas, and write decimals with a point");
}

}  // namespace polhode
