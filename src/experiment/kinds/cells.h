// What many values come to, in one cell; empty where there is none.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "measure/statistics.h"
#include "table/table.h"

namespace polhode {

inline Cell least(const std::vector<double>& values) {
    return values.empty() ? Cell() : Cell(*std::min_element(values.begin(), values.end()));
}
inline Cell most(const std::vector<double>& values) {
    return values.empty() ? Cell() : Cell(*std::max_element(values.begin(), values.end()));
}
/// The median; nothing of no values.
inline std::optional<double> median_of(const std::vector<double>& values) {
    return values.empty() ? std::nullopt : std::optional(median(values));
}
inline Cell middle(const std::vector<double>& values) { return values.empty() ? Cell() : Cell(median(values)); }

/// "3 diverged, 1 damped to rest"
inline std::string listed_counts(const std::map<std::string, long>& counts) {
    std::string list;
    for (const auto& [name, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, name);
    return list;
}

}  // namespace polhode
