// The kind `conservation`: growth of errors over a long run.
#include <algorithm>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"
#include "measure/growth.h"

namespace polhode {
namespace {

const char* const quantities[] = {"energy", "momentum", "attitude", "norm"};
// rad; an attitude error above this no longer grows freely, because it cannot exceed pi
constexpr double saturation = 1;

}  // namespace

NamedTable growth_table(const Plan& plan, const std::vector<Result>& results) {
    std::vector<ColumnChoice> columns{
        {"scene", "scene"},   {"evaluations_per_revolution", "evaluations per revolution"},
        {"method", "method"}, {"setting_kind", "setting"},
        {"setting", "value"}, {"status", ""},
        {"revolutions", ""},  {"seconds_median", ""}};
    for (const std::string quantity : quantities) {
        columns.push_back({quantity + "_error", quantity == "attitude" ? "attitude (rad)" : quantity});
        columns.push_back({quantity + "_exponent", quantity + ", exponent"});
        columns.push_back({quantity + "_uncertainty", ""});
    }
    columns.push_back({"message", "message"});
    NamedTable named = make_named_table("growth", "Growth of errors", columns);
    for (const PlannedScene& scene : plan.scenes)
        for (const double cost : plan.experiment.evaluations_per_revolution)
            for (const Result& r : results) {
                if (r.scene != scene.label || r.evaluations_per_revolution != cost) continue;
                std::vector<Cell> row{r.scene,
                                      cost,
                                      r.method,
                                      std::string(name_of(r.setting_kind)),
                                      r.setting,
                                      std::string(name_of(r.status)),
                                      cell_of(r.revolutions),
                                      cell_of(r.seconds_median)};
                for (const char* quantity : quantities) {
                    const std::vector<double>& values = r.series[quantity];
                    const auto growth = error_growth(r.series.t, values, saturation);
                    std::optional<double> largest, exponent, uncertainty;
                    // energy and momentum are still meaningful if the attitude is wrong at the end
                    const bool whole = r.status == Status::ok || r.status == Status::tolerance_not_met;
                    if (whole && !values.empty()) largest = *std::max_element(values.begin(), values.end());
                    if (largest && growth) exponent = growth->exponent, uncertainty = growth->uncertainty;
                    for (const auto& value : {largest, exponent, uncertainty}) row.push_back(cell_of(value));
                }
                row.push_back(r.message);
                named.table.rows.push_back(std::move(row));
            }
    return named;
}

Findings conclude_conservation(const Plan& plan, const std::vector<Result>& rows) {
    return {{growth_table(plan, rows)}, conservation_figures(plan, rows)};
}

}  // namespace polhode
