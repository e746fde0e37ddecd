#include "experiment/run/result.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace polhode {
namespace {

std::string text(const Table& table, std::size_t row, const char* column) {
    return text_of(table.rows[row][column_index(table, column)]);
}

bool has_column(const Table& table, const std::string& column) {
    return std::find(table.columns.begin(), table.columns.end(), column) != table.columns.end();
}

std::optional<double> number(const std::string& text) {
    if (text.empty()) return {};
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) throw std::invalid_argument("not a number");
    return value;
}

std::optional<long> count(const std::string& text) {
    if (text.empty()) return {};
    long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) throw std::invalid_argument("not a count");
    return value;
}

Status status_named(const std::string& name) {
    for (Status s : {Status::ok, Status::unsupported, Status::diverged, Status::tolerance_not_met, Status::failed})
        if (name == name_of(s)) return s;
    throw std::invalid_argument("not a status");
}

SettingKind setting_kind_named(const std::string& name) {
    for (SettingKind k : {SettingKind::none, SettingKind::step, SettingKind::tolerance})
        if (name == name_of(k)) return k;
    throw std::invalid_argument("not a kind of setting");
}

Formulation formulation_named(const std::string& name) {
    for (Formulation f : {Formulation::reduced, Formulation::full_principal, Formulation::full})
        if (name == name_of(f)) return f;
    throw std::invalid_argument("not a formulation: " + name);
}

std::optional<double> error_over_tolerance(const Result& r) {
    if (r.setting_kind != SettingKind::tolerance || !(r.setting > 0) || !r.errors.attitude_max) return {};
    return *r.errors.attitude_max / r.setting;
}

const std::vector<std::string> series_columns{
    "t", "attitude_error", "omega_error", "energy_error", "momentum_error", "norm_error", "float64_floor"};

}  // namespace

std::vector<std::string> result_columns() {
    return {"experiment",
            "scene",
            "method",
            "setting_kind",
            "setting",
            "status",
            "seconds_min",
            "seconds_median",
            "repeats",
            "steps",
            "rhs_evaluations",
            "attitude_error_final",
            "attitude_error_max",
            "omega_error_max",
            "energy_error_max",
            "momentum_error_max",
            "norm_error_max",
            "message",
            "step_taken",
            "cut",
            "formulation",
            "evaluations_per_revolution",
            "revolutions",
            "float64_floor",
            "float32_floor",
            "float64_floor_final",
            "float32_floor_final",
            "rejected_steps",
            "newton_failures",
            "order_reductions",
            "error_over_tolerance"};
}

std::vector<Cell> row_of(const std::string& experiment, const Result& r) {
    return {experiment,
            r.scene,
            r.method,
            std::string(name_of(r.setting_kind)),
            r.setting_kind == SettingKind::none ? Cell() : Cell(r.setting),
            std::string(name_of(r.status)),
            cell_of(r.seconds_min),
            cell_of(r.seconds_median),
            r.repeats,
            cell_of(r.steps),
            cell_of(r.rhs_evaluations),
            cell_of(r.errors.attitude_final),
            cell_of(r.errors.attitude_max),
            cell_of(r.errors.omega_max),
            cell_of(r.errors.energy_max),
            cell_of(r.errors.momentum_max),
            cell_of(r.errors.norm_max),
            r.message,
            cell_of(r.step_taken),
            std::string(r.cut ? "cut" : ""),
            std::string(name_of(r.formulation)),
            cell_of(r.evaluations_per_revolution),
            cell_of(r.revolutions),
            cell_of(r.floors.float64),
            cell_of(r.floors.float32),
            cell_of(r.floors.float64_final),
            cell_of(r.floors.float32_final),
            cell_of(r.counts.rejected_steps),
            cell_of(r.counts.newton_failures),
            cell_of(r.counts.order_reductions),
            cell_of(error_over_tolerance(r))};
}

Result result_of(const Table& table, std::size_t row) {
    const auto at = [&](const char* column) { return text(table, row, column); };
    Result r;
    r.scene = at("scene");
    r.method = at("method");
    r.setting_kind = setting_kind_named(at("setting_kind"));
    r.setting = number(at("setting")).value_or(0);
    r.status = status_named(at("status"));
    r.seconds_min = number(at("seconds_min"));
    r.seconds_median = number(at("seconds_median"));
    r.repeats = count(at("repeats")).value_or(0);
    r.steps = count(at("steps"));
    r.rhs_evaluations = count(at("rhs_evaluations"));
    r.errors.attitude_final = number(at("attitude_error_final"));
    r.errors.attitude_max = number(at("attitude_error_max"));
    r.errors.omega_max = number(at("omega_error_max"));
    r.errors.energy_max = number(at("energy_error_max"));
    r.errors.momentum_max = number(at("momentum_error_max"));
    r.errors.norm_max = number(at("norm_error_max"));
    r.message = at("message");
    r.step_taken = number(at("step_taken"));
    r.cut = at("cut") == "cut";
    r.formulation = formulation_named(at("formulation"));
    r.evaluations_per_revolution = number(at("evaluations_per_revolution"));
    r.revolutions = number(at("revolutions"));
    if (has_column(table, "float64_floor"))
        r.floors = {number(at("float64_floor")), number(at("float32_floor")), number(at("float64_floor_final")),
                    number(at("float32_floor_final"))};
    if (has_column(table, "rejected_steps"))
        r.counts = {count(at("rejected_steps")), count(at("newton_failures")), count(at("order_reductions"))};
    return r;
}

Table series_table(const ErrorSeries& s) {
    Table table{series_columns, {}};
    for (std::size_t k = 0; k < s.t.size(); ++k) {
        const auto at = [&](const std::vector<double>& v) { return k < v.size() ? Cell(v[k]) : Cell(); };
        table.rows.push_back(
            {s.t[k], at(s.attitude), at(s.omega), at(s.energy), at(s.momentum), at(s.norm), at(s.float64_floor)});
    }
    return table;
}

ErrorSeries series_of(const Table& table) {
    ErrorSeries s;
    std::vector<double>* const blocks[] = {&s.t,        &s.attitude, &s.omega,        &s.energy,
                                           &s.momentum, &s.norm,     &s.float64_floor};
    for (std::size_t k = 0; k < table.rows.size(); ++k)
        for (std::size_t c = 0; c < series_columns.size(); ++c) {
            if (c == series_columns.size() - 1 && !has_column(table, series_columns[c])) break;
            const auto value = number(text(table, k, series_columns[c].c_str()));
            if (!value && c == 0) throw std::invalid_argument("a sample without its time");
            if (value && blocks[c]->size() < k) throw std::invalid_argument("an error behind a gap");
            if (value) blocks[c]->push_back(*value);
        }
    return s;
}

Table drift_table(const std::string& experiment, const std::vector<Result>& results) {
    Table table{{"scene", "method", "setting"}, {}};
    table.columns.insert(table.columns.end(), series_columns.begin(), series_columns.end());
    table.columns.push_back("experiment");
    for (const Result& r : results)
        for (const std::vector<Cell>& line : series_table(r.series).rows) {
            std::vector<Cell> row{r.scene, r.method, r.setting_kind == SettingKind::none ? Cell() : Cell(r.setting)};
            row.insert(row.end(), line.begin(), line.end());
            row.push_back(experiment);
            table.rows.push_back(std::move(row));
        }
    return table;
}

}  // namespace polhode
