// The kind `engine_contact`: ranking of engines on planes with friction, and tables of motions with known results.
//
// Rows of the sweep give the ranking and the errors for each scene. The other tables come from probe_contact(), which
// runs each method at the usual and at the fine step.
#include "experiment/kinds/engine_contact.h"

#include <fmt/format.h>

#include <array>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/contact_tables.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/step_rows.h"
#include "figure/curve_style.h"

namespace polhode {
namespace {

constexpr double position_cap = 1;  // m; larger position errors are ranked alike

double capped_position(const Result& row) {
    const auto error = largest_error(row, "position");
    return error ? std::min(*error, position_cap) : std::numeric_limits<double>::infinity();
}
// Errors below rounding in binary32 are ranked alike.
double ranked_error(const Result& row, double (*error)(const Result&)) { return std::max(error(row), 1e-6); }
double ranked_attitude(const Result& row) { return ranked_error(row, capped_error); }
double ranked_position(const Result& row) { return ranked_error(row, capped_position); }

void place_on_scenes(ContactPlace& place, const Plan& plan, const std::vector<Result>& rows) {
    std::vector<double> standing, attitude, position, fine_attitude, fine_position, seconds;
    std::vector<const Result*> usual;
    for (const PlannedScene& scene : plan.scenes)
        for (const Result* row : select_rows(rows, scene, *place.curve)) {
            standing.push_back(place_of(*row, rows, ranked_attitude));
            standing.push_back(place_of(*row, rows, ranked_position));
            gather(seconds, step_seconds(*row));
            if (is_step(*row, fine_step))
                gather(fine_attitude, largest_error(*row, "attitude")),
                    gather(fine_position, largest_error(*row, "position"));
            if (!is_step(*row, default_engine_step)) continue;
            add_incomplete(place, *row, scene.label);
            if (row->status != Status::ok) continue;
            ++place.scenes, usual.push_back(row);
            gather(attitude, largest_error(*row, "attitude")), gather(position, largest_error(*row, "position"));
        }
    set_places(place, standing);
    place.attitude = optional_median(attitude), place.position = optional_median(position);
    place.fine_attitude = optional_median(fine_attitude), place.fine_position = optional_median(fine_position);
    place.step_seconds = optional_median(seconds);
    const ContactExtremes most = contact_extremes(usual);
    place.penetration = most.penetration, place.slip = most.slip, place.energy_gain = most.energy_gain;
}

NamedTable contact_places_table(const std::vector<ContactPlace>& places, bool engines) {
    std::vector<ColumnChoice> columns{{"scenes", "scenes"},
                                      {"attitude_error", "attitude at 1/60 s (rad)"},
                                      {"fine_attitude_error", "attitude at 1/1000 s (rad)"},
                                      {"position_error", "position at 1/60 s (m)"},
                                      {"fine_position_error", "position at 1/1000 s (m)"},
                                      {"penetration", "penetration (m)"},
                                      {"slip", "slip (m/s)"},
                                      {"energy_gain", "energy gain (J)"},
                                      {"step_nanoseconds", "ns per step"}};
    if (engines) {
        columns.insert(columns.begin(), {{"place", "place"},
                                         {"engine", "engine"},
                                         {"setting", "setting"},
                                         {"median_place", "median place"},
                                         {"mean_place", "mean place"}});
        columns.push_back({"message", "not compared because"});
    } else {
        columns.insert(columns.begin(), {"method", "method"});
    }
    NamedTable named = engines ? make_named_table("leaderboard", "Ranking of the engines", columns)
                               : make_named_table("solvers", "Published contact solvers", columns);
    for (const ContactPlace& p : places) {
        if ((p.engine != nullptr) != engines) continue;
        std::vector<Cell> row{p.scenes,
                              cell_of(p.attitude),
                              cell_of(p.fine_attitude),
                              cell_of(p.position),
                              cell_of(p.fine_position),
                              cell_of(p.penetration),
                              cell_of(p.slip),
                              cell_of(p.energy_gain),
                              p.step_seconds ? Cell(1e9 * *p.step_seconds) : Cell()};
        if (engines) {
            const bool is_ranked = p.place > 0;
            row.insert(row.begin(),
                       {is_ranked ? Cell(p.place) : Cell(), p.engine->engine, p.engine->setting,
                        is_ranked ? Cell(p.median_place) : Cell(), is_ranked ? Cell(p.mean_place) : Cell()});
            row.push_back(p.report.fault);
        } else {
            row.insert(row.begin(), std::string(p.curve->method->name));
        }
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

/// A column of a table of probes, at the usual and at the fine step.
struct ProbeColumn {
    const char* name;
    const char* heading;
    Cell (*cell)(const ContactProbe&);
};

template <std::optional<double> ContactProbe::*member>
Cell probe_cell(const ContactProbe& probe) {
    return cell_of(probe.*member);
}
Cell friction_at(const ContactProbe& probe, std::size_t angle) {
    return probe.friction.empty() ? Cell() : Cell(probe.friction[angle]);
}
Cell reversal_cell(const ContactProbe& probe) {
    return probe.keeps_spin ? Cell("no reversal") : cell_of(probe.reversal);
}

constexpr ProbeColumn friction_columns[] = {
    {"cone", "cone", [](const ContactProbe& p) { return Cell(describe_cone(p)); }},
    {"friction_0", "friction at 0 degrees", [](const ContactProbe& p) { return friction_at(p, 0); }},
    {"friction_45", "at 45 degrees", [](const ContactProbe& p) { return friction_at(p, 3); }},
    {"deviation", "deviation (degrees)", probe_cell<&ContactProbe::deviation>},
    {"pushed", "block pushed diagonally", probe_cell<&ContactProbe::pushed>}};
constexpr ProbeColumn hold_columns[] = {
    {"hold", "0.99, 1.01 of the critical slope", [](const ContactProbe& p) { return Cell(describe_hold(p)); }},
    {"held_path", "path at 0.99 (m)", probe_cell<&ContactProbe::held>},
    {"slipped_path", "path at 1.01 / exact", probe_cell<&ContactProbe::slipped>}};
constexpr ProbeColumn rolling_columns[] = {
    {"rolling", "acceleration / (5/7 g sin a)", probe_cell<&ContactProbe::rolling>},
    {"slow_path", "path of a slow ball / exact", probe_cell<&ContactProbe::slow_path>},
    {"drift", "drift at rest (m)", probe_cell<&ContactProbe::drift>},
    {"depth", "depth at rest (m)", probe_cell<&ContactProbe::depth>}};
constexpr ProbeColumn bounce_columns[] = {{"first_bounce", "after 1 impact", probe_cell<&ContactProbe::first_bounce>},
                                          {"fifth_bounce", "after 5", probe_cell<&ContactProbe::fifth_bounce>}};
constexpr ProbeColumn spin_columns[] = {
    {"disc_height", "height of Euler's disc after 1 s", probe_cell<&ContactProbe::disc_height>},
    {"reversal", "rattleback reverses at (s)", reversal_cell},
    {"throw_error", "direction after a billiard hit (degrees)", probe_cell<&ContactProbe::throw_error>}};

/// A table of probes.
struct ProbeTable {
    const char *name, *title;
    std::span<const ProbeColumn> columns;
};
constexpr ProbeTable probe_tables[] = {{"friction", "Friction of a sliding ball, over mu m g", friction_columns},
                                       {"static_friction", "A block on a slope, 2 s", hold_columns},
                                       {"rolling", "Rolling and rest", rolling_columns},
                                       {"bounces", "Height of a bouncing ball, over its first height", bounce_columns},
                                       {"spin", "Spinning bodies and a billiard hit", spin_columns}};

NamedTable probe_table(const ProbeTable& table, const std::vector<ContactPlace>& places) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const ProbeColumn& column : table.columns)
        for (const double step : {default_engine_step, fine_step})
            columns.push_back({fmt::format("{} at {}", column.name, step_name(step)),
                               fmt::format("{}, {}", column.heading, step_name(step))});
    NamedTable named = make_named_table(table.name, table.title, columns);
    for (const ContactPlace& place : places) {
        if (place.usual.friction.empty() && place.fine.friction.empty()) continue;
        std::vector<Cell> row{std::string(place.curve->method->name)};
        for (const ProbeColumn& column : table.columns)
            row.insert(row.end(), {column.cell(place.usual), column.cell(place.fine)});
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

// Attitude error against the step: one panel per scene, each engine with the setting "best" or else "default".
bool is_shown(const Plan& plan, const EngineMethod& engine) {
    if (engine.setting == "best" || engine.setting == "elliptic") return true;
    return engine.setting == "default" && std::ranges::none_of(plan.curves, [&](const PlannedCurve& other) {
               const EngineMethod* one = engine_of(*other.method);
               return one && one->engine == engine.engine && one->setting != "default";
           });
}

std::vector<NamedFigure> engine_contact_figures(const Plan& plan, const std::vector<Result>& rows) {
    Figure figure;
    figure.title = fmt::format("{}: attitude error against step", plan.experiment.name);
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel{scene.label, "step (s)", "largest attitude error (rad)", true, true, {}};
        int place = 0;
        for (const PlannedCurve& planned : plan.curves) {
            const EngineMethod* engine = engine_of(*planned.method);
            if (!engine || !is_shown(plan, *engine)) continue;
            const PlainStyle style = plain_style(place++);
            Curve curve;
            curve.label = std::string(planned.method->name);
            set_style(curve, style);
            curve.group = name_of(planned.method->family);
            for (const Result* row : select_rows(rows, scene, planned))
                if (const auto error = largest_error(*row, "attitude"); error && *error > 0)
                    curve.x.push_back(row->step_taken.value_or(row->setting)), curve.y.push_back(*error);
            if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
        }
        if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
    }
    if (figure.panels.empty()) return {};
    add_figure_notes(figure, plan);
    return {{plan.experiment.name + "_attitude", std::move(figure)}};
}

}  // namespace

const char* const contact_ranking_rule =
    "On each scene and at each step, all engines with all their settings are ranked twice: by their largest attitude "
    "error and by their largest position error over the run. Errors within a factor of 1.1 share a place, and so do "
    "errors above 1 rad or 1 m and errors below 1e-6. Incomplete runs and unsupported scenes rank last. The overall "
    "ranking is by the median of these places over all scenes and steps, then by their mean.";

std::vector<ContactPlace> contact_places(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<ContactPlace> places;
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::step || !has_rows(curve, rows)) continue;
        ContactPlace place;
        static_cast<EngineStanding&>(place) = inspect_curve(curve);
        if (place.engine && place.is_available() && !curve.method->planes)
            place.report.fault = "its driver does not support planes";
        place_on_scenes(place, plan, rows);
        if (place.is_available()) {
            place.usual = probe_contact(*curve.method, default_engine_step);
            place.fine = probe_contact(*curve.method, fine_step);
        }
        places.push_back(std::move(place));
    }
    sort_places(places);
    return places;
}

Findings conclude_engine_contact(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<ContactPlace> places = contact_places(plan, rows);
    Findings findings{{contact_places_table(places, true), contact_places_table(places, false)}};
    for (const ProbeTable& table : probe_tables) findings.tables.push_back(probe_table(table, places));
    findings.tables.push_back(published_contact_table(places));
    findings.tables.push_back(contact_scenes_table(plan, rows, {"attitude", "position"}));
    findings.figures = engine_contact_figures(plan, rows);
    findings.page = engine_contact_page(plan, places, findings);
    return findings;
}

}  // namespace polhode
