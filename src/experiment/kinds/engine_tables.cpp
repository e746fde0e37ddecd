// The kind `engines`: ranking of the engines, and errors for each scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "measure/observed_order.h"

namespace polhode {
namespace {

const PlannedCurve* curve_of_engine(const Plan& plan, const EngineMethod& engine) {
    for (const PlannedCurve& curve : plan.curves)
        if (curve.method == engine.method.get()) return &curve;
    return nullptr;
}

std::optional<double> order_of(const std::vector<const Result*>& rows) {
    std::vector<double> step, error;
    for (const Result* row : rows)
        if (row->status == Status::ok && row->errors["attitude"].max)
            step.push_back(row->step_taken.value_or(row->setting)), error.push_back(*row->errors["attitude"].max);
    const auto observed = observed_order(step, error, attitude_error_cap);
    // errors that do not converge have no order
    return observed && observed->order > 0.5 ? std::optional(observed->order) : std::nullopt;
}

// The largest step such that, at it and at every smaller step, the error is within `accuracy` on at least half of the
// scenes.
std::optional<double> step_within(const std::map<double, std::vector<double>>& errors, double accuracy,
                                  std::size_t scenes) {
    std::optional<double> largest;
    for (const auto& [step, all] : errors) {
        const auto count = std::ranges::count_if(all, [&](double error) { return error <= accuracy; });
        if (2 * static_cast<std::size_t>(count) < scenes) break;
        largest = step;
    }
    return largest;
}

}  // namespace

const char* const leaderboard_rule =
    "On each scene and at each step, all engines with all their settings are ranked by their largest attitude error "
    "over the run. Errors within a factor of 1.1 share a place, and so do all errors above 1 rad. Incomplete runs and "
    "unsupported scenes rank last. The overall ranking is by the median of these places over all scenes and steps, "
    "then by their mean, so that no single scene decides it.";

double capped_error(const Result& row) {
    if (row.status != Status::ok || !row.errors["attitude"].max) return std::numeric_limits<double>::infinity();
    return std::min(*row.errors["attitude"].max, attitude_error_cap);
}

double place_of(const Result& row, const std::vector<Result>& rows, const std::function<double(const Result&)>& error) {
    const auto is_better = [&, own = error(row)](const Result& other) {
        return other.scene == row.scene && other.setting == row.setting &&
               other.method.find(':') != std::string::npos && error(other) * tie_factor < own;
    };
    return static_cast<double>(std::ranges::count_if(rows, is_better) + 1);
}

bool is_step(const Result& row, double step) { return std::abs(row.setting / step - 1) < 1e-3; }

std::string step_name(double step) {
    const double rate = 1 / step;
    return std::abs(rate - std::round(rate)) < 1e-6 * rate ? fmt::format("1/{:.0f} s", rate)
                                                           : fmt::format("{:.3g} s", step);
}

std::vector<EnginePlace> engine_places(const Plan& plan, const std::vector<Result>& rows,
                                       const std::vector<EngineFacts>& facts) {
    std::vector<EnginePlace> places;
    for (const EngineFacts& known : facts) {
        EnginePlace place;
        place.facts = &known;
        const PlannedCurve& curve = *curve_of_engine(plan, *known.engine);
        std::vector<double> standing, attitude, fine, momentum, energy, orders, seconds;
        std::map<double, std::vector<double>> errors;  // by step
        std::size_t scenes = 0;
        for (const PlannedScene& scene : plan.scenes) {
            const std::vector<const Result*> own = select_rows(rows, scene, curve);
            if (const auto order = order_of(own)) orders.push_back(*order);
            bool represented = false;
            for (const Result* row : own) {
                const double error = capped_error(*row);
                standing.push_back(place_of(*row, rows, capped_error));
                represented = represented || row->status != Status::unsupported;
                errors[row->setting].push_back(error);
                if (const auto time = step_seconds(*row)) seconds.push_back(*time);
                if (is_step(*row, fine_step) && row->status == Status::ok) fine.push_back(error);
                if (!is_step(*row, default_engine_step) || row->status != Status::ok) continue;
                ++place.scenes, attitude.push_back(error);
                if (const auto e = row->errors["momentum"].max) momentum.push_back(*e);
                if (const auto e = row->errors["energy"].max) energy.push_back(*e);
            }
            scenes += represented;
        }
        place.median_place = standing.empty() ? 0 : median(standing);
        if (!standing.empty())
            place.mean_place =
                std::accumulate(standing.begin(), standing.end(), 0.0) / static_cast<double>(standing.size());
        place.attitude = optional_median(attitude), place.fine_attitude = optional_median(fine);
        place.momentum = optional_median(momentum), place.energy = optional_median(energy);
        place.order = optional_median(orders), place.step_seconds = optional_median(seconds);
        for (int i = 0; i < 3; ++i)
            if (scenes > 0) place.within[i] = step_within(errors, accuracies[i], scenes);
        places.push_back(place);
    }
    sort_places(places);
    return places;
}

NamedTable leaderboard_table(const std::vector<EnginePlace>& places) {
    NamedTable named = make_named_table("leaderboard", "Ranking of the engines",
                                        {{"place", "place"},
                                         {"engine", "engine"},
                                         {"setting", "setting"},
                                         {"median_place", "median place"},
                                         {"scenes", "scenes"},
                                         {"attitude_error", "attitude at 1/60 s (rad)"},
                                         {"fine_attitude_error", "attitude at 1/1000 s (rad)"},
                                         {"momentum_error", "momentum"},
                                         {"energy_error", "energy"},
                                         {"order", "order"},
                                         {"step_nanoseconds", "ns per step"},
                                         {"within_0.1", "largest step for 0.1 rad"},
                                         {"within_0.01", "largest step for 0.01 rad"},
                                         {"within_0.001", "largest step for 0.001 rad"},
                                         {"message", "not compared because"}});
    named.table.columns.insert(named.table.columns.begin() + 4, "mean_place");
    for (const EnginePlace& p : places) {
        const auto step = [&](int i) { return p.within[i] ? Cell(step_name(*p.within[i])) : Cell(); };
        const bool here = p.facts->is_available();
        named.table.rows.push_back(
            {here ? Cell(p.place) : Cell(), p.facts->engine->engine, p.facts->engine->setting,
             here ? Cell(p.median_place) : Cell(), here ? Cell(p.mean_place) : Cell(), here ? Cell(p.scenes) : Cell(),
             cell_of(p.attitude), cell_of(p.fine_attitude), cell_of(p.momentum), cell_of(p.energy), cell_of(p.order),
             p.step_seconds ? Cell(*p.step_seconds * 1e9) : Cell(), step(0), step(1), step(2), p.facts->report.fault});
    }
    return named;
}

NamedTable engine_scenes_table(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<double> steps;
    for (const PlannedCurve& curve : plan.curves)
        if (engine_of(*curve.method)) steps = curve.settings;
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    for (const double step : steps) {
        const std::string name = step_name(step);
        columns.push_back({"attitude_error at " + name, name + " (rad)"});
    }
    for (const ColumnChoice& more : {ColumnChoice{"order", "order"},
                                     {"attitude_error_final", "at the end, 1/60 s (rad)"},
                                     {"position_error", "position"},
                                     {"momentum_error", "momentum"},
                                     {"energy_error", "energy"},
                                     {"step_nanoseconds", "ns per step"},
                                     {"float32_floor", "float32 floor (rad)"},
                                     {"message", "remark"}})
        columns.push_back(more);
    NamedTable named = make_named_table("scenes", "Errors for each scene", columns);
    for (const PlannedScene& scene : plan.scenes)
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::step) continue;
            const std::vector<const Result*> own = select_rows(rows, scene, curve);
            if (own.empty()) continue;
            std::vector<Cell> row{scene.label, std::string(curve.method->name)};
            const Result* usual = own.front();
            std::vector<double> seconds;
            std::string message;
            for (const double step : steps) {
                Cell cell;
                for (const Result* r : own)
                    if (r->setting == step) {
                        if (r->status == Status::ok)
                            cell = cell_of(r->errors["attitude"].max);
                        else
                            cell = std::string(name_of(r->status));
                        if (r->status != Status::ok && message.empty()) message = r->message;
                        if (is_step(*r, default_engine_step)) usual = r;
                        if (const auto time = step_seconds(*r)) seconds.push_back(*time);
                    }
                row.push_back(cell);
            }
            row.push_back(cell_of(order_of(own)));
            row.push_back(cell_of(usual->errors["attitude"].final));
            for (const char* measure : {"position", "momentum", "energy"})
                row.push_back(cell_of(usual->errors[measure].max));
            row.push_back(seconds.empty() ? Cell() : Cell(1e9 * median(seconds)));
            row.push_back(cell_of(usual->floors.float32)), row.push_back(message);
            named.table.rows.push_back(std::move(row));
        }
    return named;
}

NamedTable identity_table(const std::vector<EngineFacts>& facts) {
    NamedTable named = make_named_table("identity", "Engines, versions and settings",
                                        {{"engine", "engine"},
                                         {"setting", "setting"},
                                         {"version", "version"},
                                         {"precision", "precision"},
                                         {"about", "description"},
                                         {"gyroscopic_term", "gyroscopic term"},
                                         {"follows", "matching update"},
                                         {"follows_to", "difference (rad)"},
                                         {"readback_difference", "difference on readback"},
                                         {"repeats", "reproducible"},
                                         {"message", "not compared because"}});
    for (const EngineFacts& f : facts) {
        const bool here = f.is_available();
        const std::string term = !f.gyroscopic_fraction          ? ""
                                 : *f.gyroscopic_fraction > 0.5  ? "acts"
                                 : *f.gyroscopic_fraction < -0.5 ? "acts with the wrong sign"
                                                                 : "does not act";
        named.table.rows.push_back(
            {f.engine->engine, f.engine->setting, f.report.hello.version,
             std::string(f.engine->method->precision == Precision::binary32 ? "binary32" : "binary64"),
             f.setting_description, term, f.matching_update,
             f.matching_update.empty() || f.matching_update == no_update ? Cell() : Cell(f.update_difference),
             cell_of(f.report.difference),
             std::string(!here       ? ""
                         : f.repeats ? "yes"
                                     : "no"),
             f.report.fault});
    }
    return named;
}

}  // namespace polhode
