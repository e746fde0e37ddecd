// Rows of results as tables and back. make_columns() lists all columns; writing and reading use this list only.
#include "experiment/run/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "text/message.h"

namespace polhode {
namespace {

bool has_column(const Table& table, const std::string& column) {
    return std::find(table.columns.begin(), table.columns.end(), column) != table.columns.end();
}

// parses a number; returns nothing for an empty cell
template <class Number>
std::optional<Number> number(const std::string& text) {
    if (text.empty()) return {};
    Number value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        throw std::invalid_argument(one_line(text, 60) + " is not a number");
    return value;
}

template <class Enumeration>
Enumeration named(const std::string& name, std::initializer_list<Enumeration> all) {
    for (const Enumeration one : all)
        if (name == name_of(one)) return one;
    throw std::invalid_argument(one_line(name, 60) + " is an unknown name");
}

std::optional<double> error_over_tolerance(const Result& r) {
    const std::optional<double>& attitude = r.errors["attitude"].max;
    if (r.setting_kind != SettingKind::tolerance || !(r.setting > 0) || !attitude) return {};
    return *attitude / r.setting;
}

std::vector<std::size_t> standard_measure_indices() {
    std::vector<std::size_t> result;
    for (const std::string_view name : standard_measures) result.push_back(measure_index(name));
    return result;
}
std::vector<std::size_t> extra_measures() {
    std::vector<std::size_t> result;
    const std::vector<std::size_t> before = standard_measure_indices();
    for (std::size_t m = 0; m < measures().size(); ++m)
        if (measures()[m].tabled && std::ranges::find(before, m) == before.end()) result.push_back(m);
    return result;
}

std::vector<std::size_t> system_measures() {
    std::vector<std::size_t> result;
    for (std::size_t m = 0; m < measures().size(); ++m)
        if (measures()[m].tabled_of_systems) result.push_back(m);
    return result;
}

// "attitude_error"
std::string series_name(std::size_t measure) {
    return std::string(measures()[measure].name) + std::string(measures()[measure].suffix);
}

bool has_joint_errors(const Result& result) { return !result.series["joint_turn"].empty(); }

template <class Number>
Cell cell(const std::optional<Number>& value) {
    return cell_of(value);
}
Cell cell(long value) { return value; }
Cell cell(const std::string& value) { return value; }
template <class Enumeration>
requires std::is_enum_v<Enumeration> Cell cell(Enumeration value) { return std::string(name_of(value)); }

template <class Number>
void read(const std::string& text, std::optional<Number>& value) {
    value = number<Number>(text);
}
void read(const std::string& text, long& value) { value = number<long>(text).value_or(0); }
void read(const std::string& text, std::string& value) { value = text; }
void read(const std::string& text, Status& value) {
    value = named(text, {Status::ok, Status::unsupported, Status::diverged, Status::tolerance_not_met, Status::failed});
}
void read(const std::string& text, SettingKind& value) {
    value = named(text, {SettingKind::none, SettingKind::step, SettingKind::tolerance});
}
void read(const std::string& text, Formulation& value) {
    value = named(text, {Formulation::reduced, Formulation::full_principal, Formulation::full});
}

// a column of one member, given by a pointer to it or by a function that returns it
template <class At>
ResultColumn column(std::string name, At at, std::string meaning = "", std::string page_name = "",
                    int page_digits = 0) {
    return {std::move(name),
            [at](const Result& r) { return cell(std::invoke(at, r)); },
            [at](const std::string& text, Result& r) { read(text, std::invoke(at, r)); },
            std::move(meaning),
            std::move(page_name),
            page_digits};
}

// appends the columns of errors at contacts with planes
void append_contact_errors(std::vector<ResultColumn>& all) {
    const auto append = [&](const char* name, std::optional<double> ContactErrors::*value, const char* meaning) {
        ResultColumn one = column(
            name, [value](auto& r) -> auto& { return r.contacts.*value; }, meaning);
        one.is_error = one.only_planes = true;
        all.push_back(std::move(one));
    };
    append("event_time_error_max", &ContactErrors::event_time,
           "Largest error of the times of contact events, matched with the truth's in order, s: all events of methods "
           "that record them, impacts and landings of other methods that report them");
    append("penetration_max", &ContactErrors::penetration, "Largest depth of the body in a plane, over all samples, m");
    append("slip_error_max", &ContactErrors::slip,
           "Largest speed of the contact point in the plane, over the samples where the truth rolls or sticks, m/s");
    append("contact_energy_gain", &ContactErrors::energy_gain,
           "Largest increase of the energy between two samples, J; empty if a load can increase the energy");
}

// appends the error columns of measures; the report's document has those that are in every table
void append_errors(std::vector<ResultColumn>& all, const std::vector<std::size_t>& these) {
    for (const std::size_t m : these) {
        const Measure& measure = measures()[m];
        const auto append = [&](const char* suffix, const char* when, std::optional<double> ErrorOfRun::*value) {
            ResultColumn one = column(
                series_name(m) + suffix, [ m, value ](auto& r) -> auto& { return r.errors[m].*value; },
                fmt::format("{}, {}{}", measure.meaning, when, measure.unit == "rad" ? ", rad" : ""));
            one.is_error = true;
            if (measure.tabled) {
                one.page_name = std::string(measure.name) + (value == &ErrorOfRun::final ? suffix : "");
                one.page_digits = measure.unit == "rad" ? 0 : measure.unit == "relative" ? -1 : -2;
            }
            all.push_back(std::move(one));
        };
        if (measure.tabled_at_end) append("_final", "at T", &ErrorOfRun::final);
        append("_max", "maximum over all samples", &ErrorOfRun::max);
    }
}

std::vector<ResultColumn> make_columns() {
    std::vector<ResultColumn> all{
        column("scene", &Result::scene),
        column("method", &Result::method),
        column("setting_kind", &Result::setting_kind),
        {"setting", [](const Result& r) { return r.setting_kind == SettingKind::none ? Cell() : Cell(r.setting); },
         [](const std::string& text, Result& r) { r.setting = number<double>(text).value_or(0); }, "", "setting", 5},
        column("status", &Result::status),
        column("seconds_min", &Result::seconds_min,
               "Wall clock time of the integration alone, minimum of the repeats, s", "seconds_min"),
        column("seconds_median", &Result::seconds_median,
               "Wall clock time of the integration alone, median of the repeats, s", "seconds"),
        column("repeats", &Result::repeats),
        column("steps", &Result::steps, "Number of steps", "steps", 7),
        column("rhs_evaluations", &Result::rhs_evaluations, "Number of evaluations of the right-hand side",
               "evaluations", 7)};
    append_errors(all, standard_measure_indices());
    all.insert(all.end(), {column("message", &Result::message),
                           column("step_taken", &Result::step_taken),
                           {"cut", [](const Result& r) { return Cell(std::string(r.cut ? "cut" : "")); },
                            [](const std::string& text, Result& r) { r.cut = text == "cut"; }},
                           column("formulation", &Result::formulation),
                           column("evaluations_per_revolution", &Result::evaluations_per_revolution),
                           column("revolutions", &Result::revolutions)});
    const std::size_t first_optional = all.size();
    const auto floor = [](const char* name, std::optional<double> Floors::*value, const char* page_name = "") {
        return column(
            name, [value](auto& r) -> auto& { return r.floors.*value; }, "", page_name, 3);
    };
    const auto count = [](const char* name, std::optional<long> SolverCounts::*value) {
        return column(
            name, [value](auto& r) -> auto& { return r.counts.*value; });
    };
    all.insert(all.end(),
               {floor("float64_floor", &Floors::float64, "floor"),
                floor("float32_floor", &Floors::float32, "floor32"),
                floor("float64_floor_final", &Floors::float64_final),
                floor("float32_floor_final", &Floors::float32_final),
                count("rejected_steps", &SolverCounts::rejected_steps),
                count("newton_failures", &SolverCounts::newton_failures),
                count("order_reductions", &SolverCounts::order_reductions),
                {"error_over_tolerance", [](const Result& r) { return cell_of(error_over_tolerance(r)); }, {}}});
    append_errors(all, extra_measures());
    const std::size_t first_systems_only = all.size();
    append_errors(all, system_measures());
    all.push_back(column(
        "worst_body", [](auto& r) -> auto& { return r.errors.worst_body; }));
    for (std::size_t i = first_systems_only; i < all.size(); ++i) {
        all[i].only_systems = true;
        all[i].only_planes = all[i].name == "position_error_max";
    }
    append_contact_errors(all);
    all.push_back(column("machine", &Result::machine));
    all.back().only_stored = true;
    for (std::size_t i = first_optional; i < all.size(); ++i) all[i].optional = true;
    return all;
}

bool includes_column(const ResultColumn& column, TableKind which) {
    if (column.only_stored) return which == TableKind::stored;
    if (!column.only_systems && !column.only_planes) return true;
    const bool all_scenes = which == TableKind::stored || which == TableKind::all_scenes;
    return all_scenes || (column.only_systems && which == TableKind::systems) ||
           (column.only_planes && which == TableKind::planes);
}

struct SeriesColumn {
    std::string name;
    std::function<std::vector<double>&(ErrorSeries&)> values;
    bool optional = false;
};

enum class SeriesKind { single_bodies, joints_only, all };

std::vector<SeriesColumn> series_columns(SeriesKind which) {
    using Values = std::vector<double>;
    std::vector<SeriesColumn> all{{"t", &ErrorSeries::t}};
    const auto add = [&](const std::vector<std::size_t>& these, bool optional) {
        for (const std::size_t m : these)
            all.push_back({series_name(m), [m](ErrorSeries& s) -> Values& { return s[m]; }, optional});
    };
    if (which != SeriesKind::joints_only) {
        add(standard_measure_indices(), false);
        all.push_back({"float64_floor", &ErrorSeries::float64_floor, true});
        add(extra_measures(), true);
    }
    if (which != SeriesKind::single_bodies) add(system_measures(), true);
    return all;
}

}  // namespace

std::optional<double> step_seconds(const Result& result) {
    if (result.status != Status::ok || !result.seconds_min || result.steps.value_or(0) == 0) return {};
    return *result.seconds_min / static_cast<double>(*result.steps);
}

const std::vector<ResultColumn>& result_column_table() {
    static const std::vector<ResultColumn> columns = make_columns();
    return columns;
}

std::size_t result_column_index(std::string_view name) {
    static const auto places = [] {
        std::map<std::string_view, std::size_t> all;
        for (const ResultColumn& c : result_column_table()) all.emplace(c.name, all.size());
        return all;
    }();
    const auto place = places.find(name);
    if (place == places.end()) throw std::invalid_argument(fmt::format("{} is not a column of results", name));
    return place->second;
}

std::vector<std::string> result_columns(TableKind which) {
    std::vector<std::string> names{"experiment"};
    for (const ResultColumn& c : result_column_table())
        if (includes_column(c, which)) names.push_back(c.name);
    return names;
}

std::vector<Cell> result_row(const std::string& experiment, const Result& r, TableKind which) {
    std::vector<Cell> row{experiment};
    for (const ResultColumn& c : result_column_table())
        if (includes_column(c, which)) row.push_back(c.cell(r));
    return row;
}

Result parse_result(const Table& table, std::size_t row) {
    Result r;
    for (const ResultColumn& c : result_column_table())
        if (c.read && (!c.optional || has_column(table, c.name)))
            c.read(text_of(table.rows[row][column_index(table, c.name)]), r);
    return r;
}

namespace {

Table series_table(const ErrorSeries& series, SeriesKind which) {
    Table table;
    ErrorSeries s = series;
    for (const SeriesColumn& column : series_columns(which)) {
        table.columns.push_back(column.name);
        const std::vector<double>& values = column.values(s);
        table.rows.resize(s.t.size());
        for (std::size_t k = 0; k < s.t.size(); ++k)
            table.rows[k].push_back(k < values.size() ? Cell(values[k]) : Cell());
    }
    return table;
}

// the series of the results that satisfy has()
template <class Has>
Table drift_table(const std::string& experiment, const std::vector<Result>& results, SeriesKind which, const Has& has) {
    Table table{{"scene", "method", "setting"}, {}};
    for (const SeriesColumn& column : series_columns(which)) table.columns.push_back(column.name);
    table.columns.emplace_back("experiment");
    for (const Result& r : results) {
        if (!has(r)) continue;
        for (const std::vector<Cell>& line : series_table(r.series, which).rows) {
            std::vector<Cell> row{r.scene, r.method, r.setting_kind == SettingKind::none ? Cell() : Cell(r.setting)};
            row.insert(row.end(), line.begin(), line.end());
            row.push_back(experiment);
            table.rows.push_back(std::move(row));
        }
    }
    return table;
}

}  // namespace

Table series_table(const ErrorSeries& series) {
    return series_table(series, series["joint_turn"].empty() ? SeriesKind::single_bodies : SeriesKind::all);
}

ErrorSeries parse_series(const Table& table) {
    ErrorSeries s;
    for (const SeriesColumn& column : series_columns(SeriesKind::all)) {
        if (column.optional && !has_column(table, column.name)) continue;
        const std::size_t index = column_index(table, column.name);
        std::vector<double>& values = column.values(s);
        for (std::size_t k = 0; k < table.rows.size(); ++k) {
            const auto value = number<double>(text_of(table.rows[k][index]));
            if (!value && &values == &s.t) throw std::invalid_argument("a sample has no time");
            if (value && values.size() < k) throw std::invalid_argument("a column has a gap before a value");
            if (value) values.push_back(*value);
        }
    }
    return s;
}

Table drift_table(const std::string& experiment, const std::vector<Result>& results) {
    return drift_table(experiment, results, SeriesKind::single_bodies, [](const Result&) { return true; });
}

Table joint_drift_table(const std::string& experiment, const std::vector<Result>& results) {
    return drift_table(experiment, results, SeriesKind::joints_only, has_joint_errors);
}

}  // namespace polhode
