// Writes the page's document (ReportData of src/report/page/source/data.ts) from a result directory.
//
// DocumentWriter first selects the rows that `Detail` permits, then writes each section: methods, scenes with their
// fastest runs, findings, rows by column, orders, errors over time, stability maps, tables, the comparison, motions.
// Rows are referred to by their index in the page. Each reduction of the data adds a remark.
#include "report/document.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <map>
#include <set>

#include "experiment/plan/method_style.h"
#include "experiment/run/fastest.h"
#include "figure/curve_style.h"
#include "integrators/method.h"
#include "measure/stability.h"
#include "report/findings.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

struct FamilyWords {
    Family family;
    const char *name, *label;
};
constexpr FamilyWords families[] = {{Family::unnamed, "unnamed", "Others"},
                                    {Family::closed_form, "closed_form", "Closed form"},
                                    {Family::series, "series", "Taylor series"},
                                    {Family::extrapolation, "extrapolation", "Extrapolation"},
                                    {Family::runge_kutta, "runge_kutta", "Runge\u2013Kutta"},
                                    {Family::multistep, "multistep", "Multistep"},
                                    {Family::splitting, "splitting", "Splitting"},
                                    {Family::rotation_group, "rotation_group", "Rotation group"},
                                    {Family::published_update, "published_update", "Published updates"},
                                    {Family::engine_update, "engine_update", "Engine updates"},
                                    {Family::points, "points", "Point masses"},
                                    {Family::reference, "reference", "Reference"},
                                    {Family::engine, "engine", "Engines"}};

std::string first_sentence(std::string_view text) {
    const std::size_t end = text.find(". ");
    std::string sentence(text.substr(0, end == std::string_view::npos ? text.size() : end + 1));
    std::erase(sentence, '`');
    return sentence;
}

class DocumentWriter {
  public:
    DocumentWriter(const ReportContent& content, const Detail& detail)
        : content_(content), folder_(content.folder), detail_(detail) {}

    Json document() {
        choose_rows();
        Json json{{"format", 1},
                  {"folder", folder_.name},
                  {"made", now()},
                  {"version", POLHODE_VERSION},
                  {"experiments", experiments(folder_)},
                  {"families", families_json()},
                  {"methods", methods_json()},
                  {"scenes", scenes_json()},
                  {"findings", findings_json()},
                  {"rows", rows_json()},
                  {"orders", orders_json()},
                  {"drift", drift_json()},
                  {"maps", maps_json()},
                  {"tables", tables_json()},
                  {"comparison", comparison_json()},
                  {"checks", content_.checks},
                  {"motions", motions_json()},
                  {"lessons", content_.lessons},
                  {"lesson_page", content_.lesson_page}};
        remarks_.insert(remarks_.end(), folder_.remarks.begin(), folder_.remarks.end());
        remarks_.insert(remarks_.end(), content_.motions.omissions.begin(), content_.motions.omissions.end());
        json["remarks"] = remarks_;
        return json;
    }

  private:
    static std::string now() {
        const std::time_t time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
    }

    Json number(double value) const { return number_json(value, detail_.digits); }

    // Selects the rows of the page: all, or some of each curve and all rows that scenes_json() refers to.
    void choose_rows() {
        const auto by_scene = rows_by_scene(folder_);
        std::set<std::size_t> needed;
        for (const auto& rows : by_scene) {
            std::vector<Fastest>& fastest = fastest_.emplace_back();
            for (const double error : accuracy_levels) {
                fastest.push_back(fastest_within(folder_, rows, error));
                for (const auto& row : {fastest.back().row, fastest.back().runner_up})
                    if (row) needed.insert(*row);
            }
        }
        const std::size_t total = folder_.rows.size();
        const std::size_t stride = (total + detail_.rows - 1) / std::max<std::size_t>(1, detail_.rows);
        std::map<FolderRow::Curve, std::size_t> counts;
        std::vector<std::size_t> selected;
        for (std::size_t r = 0; r < total; ++r) {
            if (stride <= 1 || counts[folder_.rows[r].curve()]++ % stride == 0 || needed.contains(r))
                selected.push_back(r);
        }
        // many curves of a single row: keep only some of them
        const std::size_t again = 2 * selected.size() > 3 * detail_.rows
                                      ? (selected.size() + detail_.rows - 1) / std::max<std::size_t>(1, detail_.rows)
                                      : 1;
        for (std::size_t i = 0; i < selected.size(); ++i)
            if (again <= 1 || i % again == 0 || needed.contains(selected[i])) {
                place_[selected[i]] = static_cast<int>(shown_.size());
                shown_.push_back(selected[i]);
            }
        if (shown_.size() < total)
            remarks_.push_back(
                fmt::format("This page contains {} of {} result rows, spread over each curve; the directory has all.",
                            shown_.size(), total));
        if (detail_.digits < 4)
            remarks_.push_back(fmt::format("Numbers are rounded to {} significant digits.", detail_.digits));
    }

    static Json experiments(const ResultFolder& folder) {
        Json list = Json::array();
        for (const FolderExperiment& e : folder.experiments) {
            Json facts = Json::array();
            for (const auto& [name, value] : e.facts) facts.push_back(Json::array({name, value}));
            list.push_back({{"name", e.name},
                            {"about", e.about},
                            {"kind", e.kind},
                            {"date", e.date},
                            {"quick", e.quick},
                            {"facts", std::move(facts)}});
        }
        return list;
    }

    static Json families_json() {
        Json list = Json::array();
        for (const FamilyWords& f : families) {
            Method any;
            any.family = f.family;
            const int color = method_style(any).color;
            list.push_back({{"name", f.name},
                            {"label", f.label},
                            {"color", color_of(color)},
                            {"color_dark", dark_color_of(color)}});
        }
        return list;
    }

    Json methods_json() const {
        Json list = Json::array();
        int unknown = 0;
        for (const std::string& name : folder_.methods.names()) {
            const Method* const method = find_method(name);
            Json json{
                {"name", name},        {"family", 0},     {"mark", method ? method_style(*method).mark : unknown++},
                {"library", ""},       {"precision", ""}, {"order", 0},
                {"documentation", ""}, {"source", ""},    {"conserves", ""}};
            if (method) {
                for (std::size_t f = 0; f < std::size(families); ++f)
                    if (families[f].family == method->family) json["family"] = f;
                json["library"] = method->library.empty() ? "polhode" : std::string(method->library);
                constexpr const char* precisions[] = {"binary64", "binary32", "multiprecision"};
                json["precision"] = precisions[static_cast<int>(method->precision)];
                json["order"] = method->order;
                json["documentation"] = first_sentence(method->documentation);
                json["source"] = std::string(method->source);
                json["conserves"] = std::string(method->conserves);
            }
            list.push_back(std::move(json));
        }
        return list;
    }

    Json scenes_json() const {
        std::vector<std::set<int>> experiments(folder_.scenes.names().size());
        std::vector<double> floors(folder_.scenes.names().size(), absent);
        for (const FolderRow& row : folder_.rows) {
            experiments[static_cast<std::size_t>(row.scene)].insert(row.experiment);
            if (row.floor() > 0) floors[static_cast<std::size_t>(row.scene)] = row.floor();
        }
        for (const FolderSeries& series : folder_.series)
            experiments[static_cast<std::size_t>(series.scene)].insert(series.experiment);
        Json list = Json::array();
        for (std::size_t s = 0; s < folder_.scenes.names().size(); ++s) {
            const std::string& name = folder_.scenes.names()[s];
            const auto scene = content_.scenes.find(name);
            const bool known = scene != content_.scenes.end();
            Json fastest = Json::array();
            const auto place = [&](const std::optional<std::size_t>& row) {
                return row ? Json(place_.at(*row)) : Json();
            };
            for (std::size_t i = 0; i < std::size(accuracy_levels); ++i)
                if (fastest_[s][i].row)
                    fastest.push_back({{"error", accuracy_levels[i]},
                                       {"row", place(fastest_[s][i].row)},
                                       {"runner_up", place(fastest_[s][i].runner_up)}});
            const auto motion = content_.motions.of_scene.find(static_cast<int>(s));
            list.push_back({{"name", name},
                            {"about", known ? scene->second.about : ""},
                            {"source", known ? scene->second.source : ""},
                            {"duration", known ? number(scene->second.duration) : Json()},
                            {"experiments", experiments[s]},
                            {"fastest", std::move(fastest)},
                            {"floor", number(floors[s])},
                            {"motion", motion == content_.motions.of_scene.end() ? Json() : Json(motion->second)}});
        }
        return list;
    }

    Json findings_json() const {
        Json list = Json::array();
        for (const Finding& f : make_findings(folder_))
            list.push_back({{"title", f.title}, {"text", f.text}, {"link", f.link}});
        return list;
    }

    Json rows_json() const {
        Json json{{"count", shown_.size()}, {"total", folder_.rows.size()}};
        const auto column = [&](const std::string& name, const auto& value) {
            Json list = Json::array();
            for (const std::size_t r : shown_) list.push_back(value(folder_.rows[r]));
            json[name] = std::move(list);
        };
        column("experiment", [](const FolderRow& r) { return r.experiment; });
        column("scene", [](const FolderRow& r) { return r.scene; });
        column("method", [](const FolderRow& r) { return r.method; });
        column("setting_kind", [](const FolderRow& r) { return static_cast<int>(r.kind); });
        column("status", [](const FolderRow& r) { return static_cast<int>(r.status); });
        column("message", [](const FolderRow& r) { return r.message; });
        column("cut", [](const FolderRow& r) { return r.cut ? 1 : 0; });
        column("formulation", [](const FolderRow& r) { return r.formulation; });
        for (const ResultColumn& c : result_column_table()) {
            if (c.page_name.empty()) continue;
            const int digits = c.page_digits > 0 ? c.page_digits : std::max(2, detail_.digits + c.page_digits);
            column(c.page_name, [&](const FolderRow& r) { return number_json(r[c.name], digits); });
        }
        json["messages"] = folder_.messages.names();
        json["formulations"] = folder_.formulations.names();
        return json;
    }

    Json orders_json() const {
        Json list = Json::array();
        for (const FittedOrder& o : fit_orders(folder_))
            list.push_back({{"experiment", o.experiment},
                            {"scene", o.scene},
                            {"method", o.method},
                            {"setting_kind", static_cast<int>(o.kind)},
                            {"claimed", o.claimed > 0 ? Json(o.claimed) : Json()},
                            {"observed", number_json(o.observed.value_or(absent), 4)},
                            {"points", o.observed ? Json(o.points) : Json()},
                            {"from", number_json(o.from, 4)},
                            {"to", number_json(o.to, 4)}});
        return list;
    }

    Json drift_json() {
        Json list = Json::array();
        for (const FolderSeries& series : folder_.series) {
            if (list.size() == detail_.series) {
                remarks_.push_back(fmt::format("This page contains the first {} of {} runs with errors over time.",
                                               detail_.series, folder_.series.size()));
                break;
            }
            const std::vector<std::size_t> selected = spread_indices(series.t.size(), detail_.series_points);
            const auto thin = [&](const std::vector<double>& values, int digits) {
                Json numbers = Json::array();
                for (const std::size_t k : selected) numbers.push_back(number_json(values[k], digits));
                return numbers;
            };
            Json json{{"experiment", series.experiment},
                      {"scene", series.scene},
                      {"method", series.method},
                      {"setting", number(series.setting)},
                      {"t", thin(series.t, 6)}};
            Json growth = Json::object();
            const auto fits = fit_growth(series);
            for (std::size_t i = 0; i < standard_measures.size(); ++i) {
                json[std::string(standard_measures[i])] = thin(series.errors[i], 3);
                if (fits[i])
                    growth[std::string(standard_measures[i])] =
                        Json::array({number_json(fits[i]->first, 3), number_json(fits[i]->second, 2)});
            }
            json["growth"] = std::move(growth);
            json["thinned"] = selected.size() < series.t.size();
            list.push_back(std::move(json));
        }
        return list;
    }

    // stability_maps.csv lists intervals of steps with the same outcome, for each method, map and x.
    Json maps_json() const {
        Json list = Json::array();
        const auto found = std::ranges::find(folder_.tables, "stability_maps", &FolderTable::name);
        if (found == folder_.tables.end()) return list;
        struct Interval {
            double x, least, largest;
            std::string outcome;
        };
        std::map<std::pair<std::string, std::string>, std::vector<Interval>> intervals;
        try {
            const Table& table = found->table;
            const std::size_t method = column_index(table, "method"), map = column_index(table, "map"),
                              x = column_index(table, "x"), least = column_index(table, "step_least"),
                              largest = column_index(table, "step_largest"), outcome = column_index(table, "outcome");
            for (const auto& row : table.rows) {
                const auto value = [&](std::size_t at) { return parse_decimal(text_of(row[at])).value_or(absent); };
                intervals[{text_of(row[method]), text_of(row[map])}].push_back(
                    {value(x), value(least), value(largest), text_of(row[outcome])});
            }
        } catch (const std::invalid_argument&) {
            return list;
        }
        std::vector<std::string> outcome_names;
        for (const Outcome outcome : outcomes) outcome_names.emplace_back(name_of(outcome));
        for (const auto& [key, of_map] : intervals) {
            std::set<double> xs, ys;
            for (const Interval& i : of_map) xs.insert(i.x), ys.insert(i.least), ys.insert(i.largest);
            const std::vector<double> x(xs.begin(), xs.end()), y(ys.begin(), ys.end());
            std::vector<int> cells(x.size() * y.size(), -1);
            for (const Interval& i : of_map) {
                const auto column = static_cast<std::size_t>(std::ranges::lower_bound(x, i.x) - x.begin());
                const auto word = std::ranges::find(outcome_names, i.outcome);
                for (std::size_t j = 0; j < y.size(); ++j)
                    if (y[j] >= i.least && y[j] <= i.largest && word != outcome_names.end())
                        cells[j * x.size() + column] = static_cast<int>(word - outcome_names.begin());
            }
            const int method = folder_.methods.find(key.first);
            if (method < 0) continue;
            list.push_back({{"method", method},
                            {"map", key.second},
                            {"x_label", key.second == "spin" ? "spin (rad/s)" : key.second},
                            {"y_label", "step (s)"},
                            {"x", numbers_json(x, 4)},
                            {"y", numbers_json(y, 4)},
                            {"outcome", cells},
                            {"outcomes", outcome_names}});
        }
        return list;
    }

    Json tables_json() const {
        Json list = Json::array();
        for (const FolderTable& table : folder_.tables) {
            const std::size_t columns = table.table.columns.size();
            std::vector<bool> numeric(columns, true), integral(columns, true), any(columns, false);
            for (const auto& row : table.table.rows)
                for (std::size_t c = 0; c < columns; ++c) {
                    if (std::holds_alternative<std::monostate>(row[c])) continue;
                    const auto value = parse_decimal(text_of(row[c]));
                    any[c] = true;
                    if (!value) numeric[c] = false;
                    if (!value || *value != std::trunc(*value)) integral[c] = false;
                }
            Json json{{"name", table.name},       {"title", table.title},  {"experiment", table.experiment},
                      {"columns", Json::array()}, {"rows", Json::array()}, {"total", table.total}};
            for (std::size_t c = 0; c < columns; ++c)
                json["columns"].push_back({{"name", table.table.columns[c]},
                                           {"numeric", numeric[c] && any[c]},
                                           {"integral", numeric[c] && any[c] && integral[c]}});
            for (std::size_t r = 0; r < std::min(table.table.rows.size(), detail_.table_rows); ++r) {
                Json cells = Json::array();
                for (std::size_t c = 0; c < columns; ++c) {
                    const std::string text = text_of(table.table.rows[r][c]);
                    if (text.empty())
                        cells.push_back(nullptr);
                    else if (numeric[c])
                        cells.push_back(number_json(parse_decimal(text).value_or(absent), 6));
                    else
                        cells.push_back(text);
                }
                json["rows"].push_back(std::move(cells));
            }
            list.push_back(std::move(json));
        }
        return list;
    }

    Json comparison_json() const {
        if (!content_.comparison || !content_.other) return nullptr;
        const FolderComparison& c = *content_.comparison;
        const auto bound = [](const std::optional<double>& value) { return number_json(value.value_or(absent), 4); };
        Json json{{"folder", content_.other->name}, {"experiments", experiments(*content_.other)},
                  {"same_bits", c.same_bits},       {"matched", c.pairs.size()},
                  {"only_here", c.only_here},       {"only_there", c.only_there},
                  {"methods", Json::array()},       {"pairs", Json::array()}};
        for (const FolderComparison::MethodComparison& m : c.methods)
            json["methods"].push_back({{"method", m.method},
                                       {"scenes", m.seconds.groups},
                                       {"pairs", m.pairs},
                                       {"ratio", number_json(m.seconds.ratio, 4)},
                                       {"low", bound(m.seconds.low)},
                                       {"high", bound(m.seconds.high)},
                                       {"error_ratio", bound(m.errors)}});
        for (const MatchedPair& pair : c.pairs) {
            const auto shown = place_.find(pair.row);
            const FolderRow& other = content_.other->rows[pair.other];
            if (shown != place_.end() && other.seconds() > 0)
                json["pairs"].push_back({{"row", shown->second},
                                         {"seconds", number(other.seconds())},
                                         {"error", number(other.attitude())}});
        }
        json["all"] = {{"ratio", number_json(c.all.ratio, 4)},
                       {"low", bound(c.all.low)},
                       {"high", bound(c.all.high)},
                       {"scenes", c.all.groups}};
        json["how"] =
            "The ratio is the geometric mean over scenes of each scene's geometric mean ratio of median run times. The "
            "interval is Student's 95 % confidence interval of the logarithms; it needs at least three scenes.";
        return json;
    }

    // Priority of a method if not all motions fit: updates of articles and engines, then other methods in binary64,
    // then other precisions, then unknown methods.
    static int rank(const std::string& name) {
        const Method* const method = find_method(name);
        if (!method) return 3;
        if (method->precision != Precision::binary64) return 2;
        return method->family == Family::published_update || method->family == Family::engine_update ? 0 : 1;
    }

    // Removes the curves of contacts and joints of the last motions if there are too many.
    void omit_curves(Json& list) {
        std::size_t curves = 0, dropped = 0;
        for (Json& motion : list) {
            if (!motion.contains("contacts")) continue;
            const std::size_t joints = motion["coordinates"].is_null() ? 0 : motion["coordinates"]["curves"].size();
            const std::size_t own = motion["contacts"].size() + joints;
            if (own == 0 || (curves += own) <= detail_.curves) continue;
            motion["contacts"] = Json::array(), motion["coordinates"] = nullptr;
            motion["remark"] = "Curves of contacts and joints are omitted to keep the page small.";
            ++dropped;
        }
        if (dropped > 0)
            remarks_.push_back(
                fmt::format("{} of {} motions have no curves of contacts and joints, to keep the page small.", dropped,
                            list.size()));
    }

    Json motions_json() {
        Json list = content_.motions.list;
        omit_curves(list);
        std::size_t tracks = 0, dropped = 0;
        for (const Json& motion : list)
            for (const Json& method : motion["methods"]) tracks += method["track"].is_null() ? 0 : 1;
        if (tracks <= detail_.tracks) return list;
        // every scene keeps the same number of motions
        const std::size_t share = detail_.tracks / std::max<std::size_t>(1, list.size());
        for (Json& motion : list) {
            std::vector<Json*> own;
            for (Json& method : motion["methods"])
                if (!method["track"].is_null() && method["method"] != -1) own.push_back(&method);
            std::ranges::stable_sort(own, {}, [](const Json* m) { return rank((*m)["label"].get<std::string>()); });
            for (std::size_t i = share; i < own.size(); ++i, ++dropped) {
                Json& method = *own[i];
                method["track"] = nullptr;
                const std::string before = method["message"].get<std::string>();
                method["message"] = before + (before.empty() ? "" : "; ") + "its motion is omitted from this page";
            }
        }
        remarks_.push_back(fmt::format(
            "{} of {} motions are omitted to keep the page small; their errors are included.", dropped, tracks));
        return list;
    }

    const ReportContent& content_;
    const ResultFolder& folder_;
    const Detail& detail_;
    std::vector<std::size_t> shown_;
    std::map<std::size_t, int> place_;  // index among the rows of the page
    std::vector<std::vector<Fastest>> fastest_;
    std::vector<std::string> remarks_;
};

}  // namespace

Json report_document(const ReportContent& content, const Detail& detail) {
    return DocumentWriter(content, detail).document();
}

}  // namespace polhode
