// Groups of rows, and cells that summarise values. The cell of an empty list is empty.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "measure/statistics.h"
#include "table/table.h"

namespace polhode {

inline Cell min_cell(const std::vector<double>& values) {
    return values.empty() ? Cell() : Cell(*std::min_element(values.begin(), values.end()));
}
inline Cell max_cell(const std::vector<double>& values) {
    return values.empty() ? Cell() : Cell(*std::max_element(values.begin(), values.end()));
}
/// The median, or nothing for an empty list.
inline std::optional<double> optional_median(const std::vector<double>& values) {
    return values.empty() ? std::nullopt : std::optional(median(values));
}
inline Cell median_cell(const std::vector<double>& values) { return values.empty() ? Cell() : Cell(median(values)); }

/// Groups elements by key. Groups are in the order of their first elements; elements keep their order.
template <class T, class GetKey>
auto group_by(const std::vector<T>& elements, const GetKey& get_key) {
    std::vector<std::pair<std::decay_t<std::invoke_result_t<GetKey, const T&>>, std::vector<T>>> groups;
    for (const T& element : elements) {
        const auto key = get_key(element);
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == key; });
        if (group == groups.end()) group = groups.insert(group, {key, {}});
        group->second.push_back(element);
    }
    return groups;
}

/// Formats counts: "3 diverged, 1 damped to rest".
inline std::string list_counts(const std::map<std::string, long>& counts) {
    std::string list;
    for (const auto& [name, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, name);
    return list;
}

}  // namespace polhode
