#include "experiment/run/fastest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace polhode {
namespace {

std::vector<std::string> scenes_of(const std::vector<Result>& results) {
    std::vector<std::string> scenes;
    for (const Result& r : results)
        if (std::ranges::find(scenes, r.scene) == scenes.end()) scenes.push_back(r.scene);
    return scenes;
}

bool has_several_methods(const std::vector<Result>& results) {
    std::set<std::string> methods;
    bool timed = false;
    for (const Result& r : results) {
        methods.insert(r.method);
        timed = timed || (r.status == Status::ok && r.seconds_median && r.errors["attitude"].max);
    }
    return timed && methods.size() > 1;
}

// formats with one digit: "1e-6", "3e-6"
std::string power_of_ten(double value) {
    std::string text = fmt::format("{:.0e}", value);
    if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
    return text;
}

std::string setting_of(const Result& r) {
    switch (r.setting_kind) {
        case SettingKind::step:
            return fmt::format("h {:.3g} s", r.setting);
        case SettingKind::tolerance:
            return "R " + power_of_ten(r.setting);
        case SettingKind::none:
            break;
    }
    return "";
}

// The cells of a line of run_table().
using RunRow = std::array<std::string, 7>;

std::vector<RunRow> run_rows(const std::vector<Result>& results) {
    std::vector<RunRow> rows;
    for (const std::string& scene : scenes_of(results)) {
        bool first = true;
        for (const double wanted : accuracy_levels) {
            const std::vector<const Result*> best = sort_by_time(results, scene, wanted);
            RunRow row{first ? scene : "", power_of_ten(wanted)};
            first = false;
            if (best.empty()) {
                row[2] = "none";
            } else {
                row[2] = best[0]->method, row[3] = setting_of(*best[0]);
                row[4] = format_seconds(*best[0]->seconds_median);
                if (best.size() > 1) {
                    row[5] = best[1]->method;
                    row[6] = fmt::format("{:.2f}", *best[1]->seconds_median / *best[0]->seconds_median);
                }
            }
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

// Shortens the names if the table is wider than `most` characters. Returns the widths of the columns.
std::array<std::size_t, 7> fit_width(const RunRow& head, std::vector<RunRow>& rows, std::size_t most) {
    std::array<std::size_t, 7> width{};
    const auto measure = [&] {
        for (std::size_t i = 0; i < head.size(); ++i) {
            width[i] = head[i].size();
            for (const RunRow& row : rows) width[i] = std::max(width[i], row[i].size());
        }
        std::size_t all = 2 * (head.size() - 1);
        for (const std::size_t one : width) all += one;
        return all;
    };
    for (std::size_t all = measure(); all > most; all = measure()) {
        // shorten the widest of the three columns with names, to not less than ten characters
        std::size_t widest = 0;
        for (const std::size_t i : {2, 5})
            if (width[i] > width[widest]) widest = i;
        if (width[widest] <= 10) break;
        const std::size_t allowed = std::max<std::size_t>(10, width[widest] - std::min(width[widest], all - most));
        for (RunRow& row : rows) row[widest] = shorten(row[widest], allowed);
        if (width[widest] == allowed) break;
    }
    return width;
}

std::string format_row(const RunRow& row, const std::array<std::size_t, 7>& width, bool heading, bool color) {
    std::string text;
    for (std::size_t i = 0; i < row.size(); ++i) {
        const bool number = i == 1 || i == 4 || i == 6;
        std::string cell = number ? fmt::format("{:>{}}", row[i], width[i]) : fmt::format("{:<{}}", row[i], width[i]);
        if (color && heading) cell = fmt::format("\x1b[1m{}\x1b[0m", cell);
        if (color && !heading && i == 2)
            cell = fmt::format("{}{}\x1b[0m", row[2] == "none" ? "\x1b[2m" : "\x1b[32m", cell);
        if (i > 0) text += "  ";
        text += cell;
    }
    if (!color) text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
}

}  // namespace

std::vector<const Result*> sort_by_time(const std::vector<Result>& results, const std::string& scene, double wanted) {
    std::vector<const Result*> best;
    for (const Result& r : results) {
        if (r.scene != scene || r.status != Status::ok || !r.seconds_median) continue;
        if (!r.errors["attitude"].max || *r.errors["attitude"].max > wanted) continue;
        const auto same = std::ranges::find(best, r.method, &Result::method);
        if (same == best.end())
            best.push_back(&r);
        else if (*r.seconds_median < *(*same)->seconds_median)
            *same = &r;
    }
    std::ranges::sort(best, {}, [](const Result* r) { return *r->seconds_median; });
    return best;
}

std::string format_seconds(double seconds) {
    constexpr std::array<const char*, 5> units = {"s", "ms", "us", "ns", "ps"};
    if (!std::isfinite(seconds)) return "-";
    std::size_t unit = 0;
    double value = seconds;
    // 999.6 us rounds to 1.00 ms
    while (value > 0 && value < 0.9995 && unit + 1 < units.size()) value *= 1000, ++unit;
    if (value == 0) return "0 s";
    if (value >= 999.5) return fmt::format("{:.0f} {}", value, units[unit]);
    const int decimals = value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f} {}", value, decimals, units[unit]);
}

std::string shorten(const std::string& text, std::size_t most) {
    if (text.size() <= most || most < 5) return text.substr(0, most);
    const std::size_t behind = (most - 2) / 2, before = most - 2 - behind;
    return text.substr(0, before) + ".." + text.substr(text.size() - behind);
}

std::string run_table(const std::vector<Result>& results, const RunTable& table) {
    if (!has_several_methods(results)) return "";
    const RunRow head{"scene", "error (rad)", "fastest", "setting", "time", "runner-up", "ratio"};
    std::vector<RunRow> rows = run_rows(results);
    const std::array<std::size_t, 7> width = fit_width(head, rows, static_cast<std::size_t>(std::max(80, table.width)));
    std::string text = format_row(head, width, true, table.color);
    for (const RunRow& row : rows) text += format_row(row, width, false, table.color);
    return text;
}

}  // namespace polhode
