#include "text/csv_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t longest_line = 64u << 10;

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

CsvLines::CsvLines(std::string_view text, const std::string& file) : rest_(text), file_(file) {
    if (!rest_.starts_with("\xef\xbb\xbf")) return;
    rest_.remove_prefix(3);
    note("line 1 begins with a byte order mark");
}

bool CsvLines::next() {
    const auto place = [&] { return fmt::format("line {}", number_); };
    for (;;) {
        if (rest_.empty()) return false;
        const std::size_t end = rest_.find('\n');
        line_ = rest_.substr(0, end);
        rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
        ++number_;
        if (!line_.empty() && line_.back() == '\r') {
            line_.remove_suffix(1);
            if (!returns_) note(fmt::format("line {} ends in a carriage return", number_));
            returns_ = true;
        }
        if (line_.size() > longest_line)
            throw InputError(file_, place(), "has more than 64 KiB", "give lines of a few hundred characters");
        if (const std::size_t zero = line_.find('\0'); zero != line_.npos)
            throw InputError(file_, fmt::format("line {}, character {}", number_, zero + 1), "is a zero byte",
                             "give a text file");
        if (line_.starts_with('#')) continue;
        if (!trimmed(line_).empty()) break;
        // blank lines may stand at the end alone
        if (rest_.find_first_not_of(" \t\r\n") == rest_.npos) return false;
        throw InputError(file_, place(), "is blank", "leave the line out");
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
            throw InputError(file_, place, cells_[i].empty() ? "has no name" : "is named " + one_line(cells_[i], 60),
                             fmt::format("{}{}known columns: {}", meant, meant.empty() ? "" : " ", listed(names)));
        }
        const std::size_t index = static_cast<std::size_t>(found - names.begin());
        if (std::find(places.begin(), places.end(), index) != places.end())
            throw InputError(file_, place, fmt::format("is a second column {}", names[index]), "give each column once");
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
