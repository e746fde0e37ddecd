// Rows of fixed-step methods at the steps of a plan, shared by several kinds.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "experiment/kinds/cells.h"
#include "experiment/run/result.h"

namespace polhode {

/// The steps of the plan, s, from coarse to fine.
inline std::vector<double> all_steps(const Plan& plan) {
    for (const PlannedCurve& curve : plan.curves)
        if (curve.kind == SettingKind::step) return curve.settings;
    return {};
}

/// The error of a run, or its status if it is not `ok`.
inline Cell error_cell(const Result& row, const char* measure) {
    if (row.status != Status::ok) return std::string(name_of(row.status));
    return cell_of(row.errors[measure].max);
}

/// The row with this step, or null.
inline const Result* find_step(const std::vector<const Result*>& rows, double step) {
    const auto found = std::ranges::find_if(rows, [&](const Result* row) { return row->setting == step; });
    return found == rows.end() ? nullptr : *found;
}

/// The median time per step, ns.
inline std::optional<double> step_nanoseconds(const std::vector<const Result*>& rows) {
    std::vector<double> all;
    for (const Result* row : rows)
        if (const auto seconds = step_seconds(*row)) all.push_back(1e9 * *seconds);
    return optional_median(all);
}

}  // namespace polhode
