#include "check/gaps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "text/csv_lines.h"
#include "text/decimal.h"

namespace polhode {
namespace {

// of the shortest spellings alone: what else is no number is the reader's to refuse
bool is_nan(std::string_view cell) {
    if (cell.size() < 3 || cell.size() > 5) return false;
    const std::optional<double> value = parse_decimal(cell);
    if (value) return std::isnan(*value);
    std::string plain;
    for (const char c : cell)
        if (c != '-' && c != '+') plain += static_cast<char>(c | 0x20);
    return plain == "nan";
}

}  // namespace

GappedTable without_nan(const std::string& text, const std::string& file) {
    GappedTable table;
    CsvLines lines(text, file);
    if (!lines.next()) return {text, {}};
    const auto time = std::ranges::find(lines.cells(), "t");
    if (time == lines.cells().end()) return {text, {}};
    const auto at = static_cast<std::size_t>(time - lines.cells().begin());
    std::set<std::string, std::less<>> lost;  // times, as they are written
    std::set<long> lost_lines;
    while (lines.next())
        if (lines.cells().size() > at && std::ranges::any_of(lines.cells(), is_nan)) {
            lost.emplace(lines.cells()[at]);
            lost_lines.insert(lines.number());
        }
    if (lost.empty()) return {text, {}};

    CsvLines again(text, file);
    again.next();
    std::vector<long> left_out;
    std::string last_time;
    std::size_t times = 0;
    bool open = false;
    while (again.next()) {
        const std::string_view t = again.cells().size() > at ? again.cells()[at] : std::string_view();
        if (lost_lines.contains(again.number()) || lost.contains(t)) {
            left_out.push_back(again.number());
            open = true;
            continue;
        }
        if (times == 0 || t != last_time) {
            if (open && times > 0) table.gaps.push_back(times);
            open = false;
            ++times, last_time = t;
        }
    }
    // a comment in the place of each
    long number = 1;
    auto next = left_out.begin();
    for (std::size_t begin = 0; begin < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1);
        if (next != left_out.end() && *next == number)
            table.text += "#\n", ++next;
        else
            table.text.append(text, begin, end + 1 - begin);
        begin = end + 1;
    }
    return table;
}

}  // namespace polhode
