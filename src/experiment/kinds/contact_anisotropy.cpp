// The kind `contact_anisotropy`: friction of a block on a level plane in several directions to the axes of friction
// pyramids, by each method of the plan at its settings. contact_probes.h has the motions and their closed forms.
#include <algorithm>
#include <cmath>
#include <string>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/contact_probes.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"

namespace polhode {
namespace {

using ProbeValue = std::optional<double> DirectionProbe::*;

// The columns of one quantity, by angle, shown on the page if `heading` is not empty.
void add_angles(std::vector<ColumnChoice>& columns, const std::string& name, const std::string& heading) {
    for (const double angle : direction_angles)
        columns.push_back({fmt::format("{} at {:g}", name, angle),
                           heading.empty() ? "" : fmt::format("{} at {:g}°", heading, angle)});
}
void add_cells(std::vector<Cell>& row, const std::vector<DirectionProbe>& probes, ProbeValue value) {
    for (const DirectionProbe& probe : probes) row.push_back(cell_of(probe.*value));
}
// The largest magnitude over all angles.
Cell largest_cell(const std::vector<DirectionProbe>& probes, ProbeValue value) {
    std::vector<double> all;
    for (const DirectionProbe& probe : probes)
        if (const std::optional<double>& x = probe.*value) all.push_back(std::abs(*x));
    return max_cell(all);
}

// The table of one motion.
NamedTable make_direction_table(const char* name, const char* title, const char* quantity, const char* heading) {
    std::vector<ColumnChoice> columns{{"method", "method"}, {"setting_kind", ""}, {"setting", "step or tolerance"}};
    add_angles(columns, quantity, heading);
    columns.push_back({"direction_error_max", "direction (°)"});
    add_angles(columns, "direction_error", "");
    columns.push_back({"message", "remark"});
    return make_named_table(name, title, columns);
}

void add_direction_row(Table& table, const PlannedCurve& curve, double setting,
                       const std::vector<DirectionProbe>& probes, ProbeValue value, ProbeValue direction) {
    std::vector<Cell> row{std::string(curve.method->name), std::string(name_of(curve.kind)), setting};
    add_cells(row, probes, value);
    row.push_back(largest_cell(probes, direction));
    add_cells(row, probes, direction);
    std::string message;
    for (const DirectionProbe& probe : probes)
        if (message.empty()) message = probe.fault;
    row.emplace_back(message);
    table.rows.push_back(std::move(row));
}

}  // namespace

Findings run_contact_anisotropy(const Plan& plan, const RunOptions&) {
    NamedTable slides = make_direction_table("", "A block slides to rest: its path over v^2 / (2 mu g)",
                                             "distance_ratio", "path"),
               pushed = make_direction_table("pushed", "A block pushed with 1.25 mu m g: its speed over the exact one",
                                             "speed_ratio", "speed");
    for (const PlannedCurve& curve : plan.curves)
        for (const double setting : curve.settings) {
            Settings settings;
            (curve.kind == SettingKind::step ? settings.step : settings.tolerance) = setting;
            const std::vector<DirectionProbe> probes = probe_directions(*curve.method, settings);
            add_direction_row(slides.table, curve, setting, probes, &DirectionProbe::distance,
                              &DirectionProbe::distance_direction);
            add_direction_row(pushed.table, curve, setting, probes, &DirectionProbe::pushed,
                              &DirectionProbe::pushed_direction);
        }
    return {{std::move(slides), std::move(pushed)}};
}

}  // namespace polhode
