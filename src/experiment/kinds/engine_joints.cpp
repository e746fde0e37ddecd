// The kind `engine_joints`: ranking of engines by their joints, and gaps and errors for each scene.
#include "experiment/kinds/engine_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "figure/curve_style.h"
#include "measure/observed_order.h"
#include "text/message.h"

namespace polhode {
namespace {

std::optional<double> order_in(const std::vector<const Result*>& rows, const char* measure, double lost) {
    std::vector<double> step, error;
    for (const Result* row : rows)
        if (const auto e = largest_error(*row, measure); e && *e > 1e-12)
            step.push_back(row->step_taken.value_or(row->setting)), error.push_back(*e);
    const auto observed = observed_order(step, error, lost);
    // errors that do not converge have no order
    return observed && observed->order > 0.5 ? std::optional(observed->order) : std::nullopt;
}

void place_among(JointPlace& place, const Plan& plan, const std::vector<Result>& rows) {
    std::vector<double> standing, attitude, gap, turn, energy, fine_attitude, fine_gap, orders, gap_orders, seconds;
    for (const PlannedScene& scene : plan.scenes) {
        const std::vector<const Result*> own = select_rows(rows, scene, *place.curve);
        if (place.curve->kind == SettingKind::step) {
            gather(orders, order_in(own, "attitude", attitude_error_cap));
            gather(gap_orders, order_in(own, "joint_gap", std::numeric_limits<double>::infinity()));
        }
        for (const Result* row : own) {
            standing.push_back(place_of(*row, rows, capped_error));
            if (const auto time = step_seconds(*row)) seconds.push_back(*time);
            const bool by_step = place.curve->kind == SettingKind::step;
            if (by_step && is_step(*row, fine_step)) {
                gather(fine_attitude, largest_error(*row, "attitude")),
                    gather(fine_gap, largest_error(*row, "joint_gap"));
            }
            // for runs by tolerance use the loosest one
            if (by_step ? !is_step(*row, default_engine_step) : row != own.front()) continue;
            add_incomplete(place, *row, scene.label);
            if (row->status != Status::ok) continue;
            ++place.scenes;
            gather(attitude, largest_error(*row, "attitude")), gather(gap, largest_error(*row, "joint_gap"));
            gather(turn, largest_error(*row, "joint_turn")), gather(energy, largest_error(*row, "energy"));
            if (const auto g = largest_error(*row, "joint_gap"); g && *g >= place.worst_gap.value_or(0))
                place.worst_gap = g, place.worst_gap_scene = scene.label;
        }
    }
    set_places(place, standing);
    place.attitude = optional_median(attitude), place.gap = optional_median(gap), place.turn = optional_median(turn);
    place.energy = optional_median(energy), place.fine_attitude = optional_median(fine_attitude);
    place.fine_gap = optional_median(fine_gap), place.order = optional_median(orders);
    place.gap_order = optional_median(gap_orders), place.step_seconds = optional_median(seconds);
}

std::vector<ColumnChoice> place_columns(bool engines) {
    std::vector<ColumnChoice> columns{{"scenes", "scenes"},
                                      {"attitude_error", "attitude at 1/60 s (rad)"},
                                      {"fine_attitude_error", "attitude at 1/1000 s (rad)"},
                                      {"joint_gap", "gap at 1/60 s (m)"},
                                      {"fine_joint_gap", "gap at 1/1000 s (m)"},
                                      {"worst_joint_gap", "worst gap (m)"},
                                      {"joint_turn", "turn (rad)"},
                                      {"energy_error", "energy"},
                                      {"order", "order"},
                                      {"step_nanoseconds", "ns per step"}};
    if (engines) {
        columns.insert(
            columns.begin(),
            {{"place", "place"}, {"engine", "engine"}, {"setting", "setting"}, {"median_place", "median place"}});
        columns.push_back({"message", "not compared because"});
    } else {
        columns.insert(columns.begin(), {"method", "method"});
    }
    return columns;
}

NamedTable places_table(const std::vector<JointPlace>& places, bool engines) {
    NamedTable named = engines ? make_named_table("leaderboard", "Ranking of the engines", place_columns(true))
                               : make_named_table("solvers", "Published joint solvers", place_columns(false));
    for (const JointPlace& p : places) {
        if ((p.engine != nullptr) != engines) continue;
        std::vector<Cell> row{p.scenes,
                              cell_of(p.attitude),
                              cell_of(p.fine_attitude),
                              cell_of(p.gap),
                              cell_of(p.fine_gap),
                              cell_of(p.worst_gap),
                              cell_of(p.turn),
                              cell_of(p.energy),
                              cell_of(p.order),
                              p.step_seconds ? Cell(1e9 * *p.step_seconds) : Cell()};
        if (engines) {
            row.insert(row.begin(), {p.place > 0 ? Cell(p.place) : Cell(), p.engine->engine, p.engine->setting,
                                     p.place > 0 ? Cell(p.median_place) : Cell()});
            row.push_back(p.report.fault);
        } else {
            row.insert(row.begin(), curve_label(*p.curve));
        }
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

// For each scene and method: errors at each step, and joint, energy and momentum errors at the usual step.
NamedTable joint_scenes_table(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<ColumnChoice> columns{{"scene", "scene"}, {"method", "method"}};
    const std::vector<double>& steps = plan.experiment.steps;
    for (const double step : steps)
        columns.push_back({fmt::format("attitude_{:.6g}", step), "attitude at " + step_name(step)});
    for (const double step : steps) columns.push_back({fmt::format("gap_{:.6g}", step), "gap at " + step_name(step)});
    for (const char* name : {"joint_turn", "energy_error", "final_energy_error", "momentum_error"})
        columns.push_back({name, name});
    columns.insert(columns.end(), {{"step_nanoseconds", "ns per step"}, {"message", "message"}});
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
            for (const char* measure : {"attitude", "joint_gap"})
                for (const double step : steps) {
                    const auto at = std::ranges::find_if(own, [&](const Result* r) { return is_step(*r, step); });
                    row.push_back(at == own.end() ? Cell() : cell_of(largest_error(**at, measure)));
                }
            for (const Result* r : own) {
                if (is_step(*r, default_engine_step)) usual = r;
                if (message.empty() && r->status != Status::ok) message = one_line(r->message, 100);
                if (const auto time = step_seconds(*r)) seconds.push_back(*time);
            }
            row.push_back(cell_of(largest_error(*usual, "joint_turn"))),
                row.push_back(cell_of(largest_error(*usual, "energy")));
            row.push_back(cell_of(usual->errors["energy"].final));
            row.push_back(cell_of(largest_error(*usual, "momentum")));
            row.push_back(seconds.empty() ? Cell() : Cell(1e9 * median(seconds)));
            row.push_back(message);
            named.table.rows.push_back(std::move(row));
        }
    return named;
}

// Energy error over time at the usual step: one panel per scene, each engine with its setting "best" or else "default".
std::vector<NamedFigure> energy_figures(const Plan& plan, const std::vector<Result>& rows) {
    Figure figure;
    figure.title =
        fmt::format("{}: energy error against time at {}", plan.experiment.name, step_name(default_engine_step));
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel;
        panel.title = scene.scene.name, panel.x_label = "time (s)", panel.y_label = "|E - E_ref| / max E";
        panel.log_x = false;
        int place = 0;
        for (const PlannedCurve& planned : plan.curves) {
            const EngineMethod* engine = engine_of(*planned.method);
            if (!engine) continue;
            const bool is_chosen =
                engine->setting == "best" ||
                (engine->setting == "default" && std::ranges::none_of(plan.curves, [&](const PlannedCurve& other) {
                     const EngineMethod* one = engine_of(*other.method);
                     return one && one->engine == engine->engine && one->setting == "best";
                 }));
            if (!is_chosen) continue;
            // all engines belong to one family, so here each one has its own colour
            const PlainStyle style = plain_style(place++);
            for (const Result* row : select_rows(rows, scene, planned)) {
                if (!is_step(*row, default_engine_step) || row->series.t.empty()) continue;
                Curve curve;
                curve.label = std::string(planned.method->name), curve.points = false;
                set_style(curve, style);
                curve.group = name_of(planned.method->family);
                const std::vector<double>& energy = row->series["energy"];
                const std::size_t count = std::min(energy.size(), row->series.t.size());
                curve.x.assign(row->series.t.begin(), row->series.t.begin() + static_cast<long>(count));
                curve.y.assign(energy.begin(), energy.begin() + static_cast<long>(count));
                panel.curves.push_back(std::move(curve));
            }
        }
        if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
    }
    if (figure.panels.empty()) return {};
    add_figure_notes(figure, plan);
    return {{plan.experiment.name + "_energy", std::move(figure)}};
}

}  // namespace

std::vector<JointPlace> joint_places(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<JointPlace> places;
    for (const PlannedCurve& curve : plan.curves) {
        if (!has_rows(curve, rows)) continue;
        JointPlace place;
        static_cast<EngineStanding&>(place) = inspect_curve(curve);
        if (place.engine && place.is_available() && place.report.hello.joints.empty())
            place.report.fault = "its driver does not support joints";
        place_among(place, plan, rows);
        places.push_back(std::move(place));
    }
    sort_places(places);
    return places;
}

Findings conclude_engine_joints(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<JointPlace> places = joint_places(plan, rows);
    Findings findings{{places_table(places, true), places_table(places, false), joint_scenes_table(plan, rows)}};
    findings.figures = energy_figures(plan, rows);
    findings.page = engine_joints_page(plan, places, findings);
    return findings;
}

}  // namespace polhode
