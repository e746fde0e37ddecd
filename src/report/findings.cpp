// Findings of a result directory. Each function .._finding computes one finding from the rows, series or tables, or
// returns nullopt if they do not contain the data. make_findings() takes the first three in a fixed order of
// importance.
#include "report/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "integrators/method.h"
#include "measure/growth.h"
#include "measure/observed_order.h"
#include "measure/statistics.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

// Percent-encodes a value of the page's state for a URL fragment.
std::string in_fragment(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'a' && byte <= 'z') ||
                           (byte >= 'A' && byte <= 'Z') || c == '_' || c == '-' || c == '.';
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return out;
}

// Two significant digits, exponents without padding: "0.12", "7.2e-4".
std::string plain(double value) {
    std::string text = fmt::format("{:.2g}", value);
    const std::size_t power = text.find('e');
    if (power == std::string::npos) return text;
    const std::size_t digits = text.find_first_not_of("+-0", power + 1);
    return text.substr(0, power + 1) + (text[power + 1] == '-' ? "-" : "") + text.substr(digits);
}

std::string shown(const std::string& name) { return one_line(name, 60); }

std::string library_of(const ResultFolder& folder, const FolderRow& row) {
    const Method* const method = find_method(folder.methods[row.method]);
    return method ? std::string(method->library) : "";
}

std::string counted(std::size_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::optional<Finding> fastest_finding(const ResultFolder& folder) {
    const auto by_scene = rows_by_scene(folder);
    // from fine to coarse: a coarser accuracy is used only if it compares more than twice as many scenes
    std::optional<Finding> finding;
    std::size_t most = 0;
    for (const double error : {1e-9, 1e-6, 1e-3}) {
        std::map<std::string, int> wins;
        std::map<std::string, int> example;
        std::vector<double> factors;
        std::size_t scenes = 0;
        int peers_scene = 0;
        double largest_factor = 0;
        for (const std::vector<std::size_t>& rows : by_scene) {
            const Fastest best = fastest_within(folder, rows, error);
            if (!best.row || !best.runner_up) continue;
            ++scenes;
            const FolderRow& first = folder.rows[*best.row];
            const std::string& name = folder.methods[first.method];
            ++wins[name];
            example.try_emplace(name, first.scene);
            // the fastest method of another library
            std::optional<double> other;
            for (const std::size_t r : rows) {
                const FolderRow& row = folder.rows[r];
                if (!row.is_within(error)) continue;
                if (library_of(folder, row) == library_of(folder, first)) continue;
                if (!other || row.seconds() < *other) other = row.seconds();
            }
            if (!other) continue;
            factors.push_back(*other / first.seconds());
            if (factors.back() > largest_factor) largest_factor = factors.back(), peers_scene = first.scene;
        }
        if (scenes <= 2 * most) continue;
        most = scenes;
        const auto winner = std::ranges::max_element(wins, {}, [](const auto& w) { return w.second; });
        const std::string& scene = folder.scenes[example[winner->first]];
        Finding one;
        one.title = fmt::format("{} is the fastest to {} rad on {} of {} scenes", shown(winner->first), plain(error),
                                winner->second, scenes);
        std::vector<std::pair<int, std::string>> ranked;
        for (const auto& [name, count] : wins)
            if (name != winner->first) ranked.emplace_back(-count, name);
        std::ranges::sort(ranked);
        std::vector<std::string> others;
        for (const auto& [count, name] : ranked) others.push_back(fmt::format("{} on {}", shown(name), -count));
        if (others.size() > 4) others.resize(4), others.emplace_back("..");
        if (!others.empty()) one.text = fmt::format("Elsewhere: {}. ", join_with_commas(others));
        if (!factors.empty())
            one.text += fmt::format(
                "The fastest method of another library takes {} times as long (median of {}; at most {} times, on {}).",
                plain(median(factors)), counted(factors.size(), "scene", "scenes"), plain(largest_factor),
                shown(folder.scenes[peers_scene]));
        else
            one.text += "All compared methods are from one library.";
        one.link = "#section=work-precision&scene=" + in_fragment(scene);
        finding = one;
    }
    return finding;
}

std::optional<Finding> hidden_finding(const ResultFolder& folder) {
    std::set<std::string> methods;
    std::size_t runs = 0;
    const FolderRow* worst = nullptr;
    double plainest = -1;
    for (const FolderRow& row : folder.rows) {
        if (!(row.attitude() > 1 && row["energy_error_max"] < 1e-2) || row.status == Status::unsupported) continue;
        ++runs;
        methods.insert(folder.methods[row.method]);
        // the clearest example: a published update with a large momentum error
        const Method* const method = find_method(folder.methods[row.method]);
        const double plain =
            std::min(2.0, std::isfinite(row["momentum_error_max"]) ? row["momentum_error_max"] : 0) +
            (method && method->family == Family::published_update && method->precision == Precision::binary64 ? 3 : 0) +
            // extreme scenes are in subdirectories or are variations
            (folder.scenes[row.scene].find_first_of("/{") == std::string::npos ? 1 : 0);
        if (plain > plainest) plainest = plain, worst = &row;
    }
    if (!worst) return std::nullopt;
    return Finding{
        fmt::format("Energy hides a lost attitude in {}", counted(runs, "run", "runs")),
        fmt::format("{}: attitude error above 1 rad, energy error below 1 %. {} on {}{}: attitude {} rad, momentum {}, "
                    "energy {}.",
                    counted(methods.size(), "method", "methods"), shown(folder.methods[worst->method]),
                    shown(folder.scenes[worst->scene]),
                    worst->kind == SettingKind::none
                        ? ""
                        : fmt::format(" with a {} of {:.3g}{}", name_of(worst->kind), (*worst)["setting"],
                                      worst->kind == SettingKind::step ? " s" : ""),
                    plain(worst->attitude()), plain((*worst)["momentum_error_max"]),
                    plain((*worst)["energy_error_max"])),
        fmt::format("#section=motion&scene={}&motion_methods={}", in_fragment(folder.scenes[worst->scene]),
                    in_fragment(folder.methods[worst->method]))};
}

std::optional<Finding> growth_finding(const ResultFolder& folder) {
    constexpr std::size_t energy = 2;
    std::set<std::string> bounded, growing;
    const FolderSeries* example = nullptr;
    double longest = 0;
    for (const FolderSeries& series : folder.series) {
        const auto growth = fit_growth(series)[energy];
        if (!growth) continue;
        const std::string& name = folder.methods[series.method];
        if (growth->first < 0.2) bounded.insert(name);
        if (growth->first > 0.8) growing.insert(name);
        if (growth->first > 0.8 && series.t.back() > longest) example = &series, longest = series.t.back();
    }
    if (!example || bounded.empty()) return std::nullopt;
    for (const std::string& name : growing) bounded.erase(name);
    if (bounded.empty()) return std::nullopt;
    std::vector<std::string> kept(bounded.begin(), bounded.end());
    if (kept.size() > 5) kept.resize(5), kept.emplace_back("..");
    const std::string& scene = folder.scenes[example->scene];
    return Finding{fmt::format("{} without energy drift, {} with energy errors that grow in proportion to time",
                               counted(bounded.size(), "method", "methods"), growing.size()),
                   fmt::format("Without drift: {}. The longest run lasts {:.3g} s.", join_with_commas(kept), longest),
                   "#section=drift&scene=" + in_fragment(scene)};
}

std::optional<Finding> order_finding(const ResultFolder& folder) {
    std::size_t observed = 0, off = 0;
    const FittedOrder* worst = nullptr;
    const std::vector<FittedOrder> orders = fit_orders(folder);
    for (const FittedOrder& order : orders) {
        if (order.kind != SettingKind::step || order.claimed == 0 || !order.observed) continue;
        ++observed;
        const double difference = std::abs(*order.observed - order.claimed);
        if (difference > 0.2) ++off;
        if (!worst || difference > std::abs(*worst->observed - worst->claimed)) worst = &order;
    }
    if (observed < 3) return std::nullopt;
    const std::string& scene = folder.scenes[worst->scene];
    return Finding{off == 0
                       ? fmt::format("All {} observed orders match the claimed orders", observed)
                       : fmt::format("{} of {} observed orders match the claimed orders", observed - off, observed),
                   fmt::format("Matches are within 0.2. Largest difference: {} on {}, {:.2f} observed, {} claimed.",
                               shown(folder.methods[worst->method]), shown(scene), *worst->observed, worst->claimed),
                   "#section=convergence&scene=" + in_fragment(scene)};
}

std::optional<Finding> failure_finding(const ResultFolder& folder) {
    std::map<std::string, std::size_t> by_method;
    std::array<std::size_t, 5> by_status{};
    const FolderRow* example = nullptr;
    for (const FolderRow& row : folder.rows) {
        ++by_status[static_cast<std::size_t>(row.status)];
        if (row.status == Status::ok || row.status == Status::unsupported) continue;
        ++by_method[folder.methods[row.method]];
        if (!example) example = &row;
    }
    if (!example) return std::nullopt;
    const auto most = std::ranges::max_element(by_method, {}, [](const auto& m) { return m.second; });
    const auto of = [&](Status status) { return by_status[static_cast<std::size_t>(status)]; };
    return Finding{
        fmt::format("{} of {} runs did not succeed",
                    of(Status::diverged) + of(Status::tolerance_not_met) + of(Status::failed), folder.rows.size()),
        fmt::format("{} diverged, {} did not meet the tolerance, {} failed. The method with most of them is {} ({}).",
                    of(Status::diverged), of(Status::tolerance_not_met), of(Status::failed), shown(most->first),
                    most->second),
        "#section=work-precision&scene=" + in_fragment(folder.scenes[example->scene])};
}

std::optional<Finding> floor_finding(const ResultFolder& folder) {
    std::set<std::string> reached, all;
    const FolderRow* best = nullptr;
    for (const FolderRow& row : folder.rows) {
        if (row.status != Status::ok || !(row.floor() > 0) || !(row.attitude() >= 0)) continue;
        all.insert(folder.methods[row.method]);
        if (row.attitude() <= 10 * row.floor()) reached.insert(folder.methods[row.method]);
        if (!best || row.attitude() / row.floor() < best->attitude() / best->floor()) best = &row;
    }
    if (!best) return std::nullopt;
    return Finding{fmt::format("{} of {} methods reach the binary64 rounding floor", reached.size(), all.size()),
                   fmt::format("Their errors are at most 10 times the floor. The closest is {} on {}: error {} rad, "
                               "floor {} rad.",
                               shown(folder.methods[best->method]), shown(folder.scenes[best->scene]),
                               plain(best->attitude()), plain(best->floor())),
                   "#section=work-precision&scene=" + in_fragment(folder.scenes[best->scene])};
}

std::optional<Finding> gain_finding(const ResultFolder& folder) {
    for (const FolderTable& table : folder.tables) {
        if (!table.name.ends_with("_gain")) continue;
        try {
            const std::size_t gain = column_index(table.table, "gain"), scene = column_index(table.table, "scene"),
                              method = column_index(table.table, "method");
            std::vector<double> gains;
            double largest = 0;
            std::string where;
            for (const auto& row : table.table.rows)
                if (const auto value = parse_decimal(text_of(row[gain]))) {
                    gains.push_back(*value);
                    if (*value > largest)
                        largest = *value,
                        where = fmt::format("{} with {}", shown(text_of(row[scene])), shown(text_of(row[method])));
                }
            if (gains.empty()) continue;
            return Finding{
                fmt::format("The reduced formulation is {:.2g} times as fast as the full one", median(gains)),
                fmt::format("Median of {}. The largest factor is {:.3g}, on {}.",
                            counted(gains.size(), "pair", "pairs"), largest, where),
                "#section=leave-out"};
        } catch (const std::invalid_argument&) {
            continue;
        }
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::vector<std::size_t>> rows_by_scene(const ResultFolder& folder) {
    std::vector<std::vector<std::size_t>> places(folder.scenes.names().size());
    for (std::size_t r = 0; r < folder.rows.size(); ++r)
        places[static_cast<std::size_t>(folder.rows[r].scene)].push_back(r);
    return places;
}

Fastest fastest_within(const ResultFolder& folder, const std::vector<std::size_t>& rows, double error) {
    const int reduced = folder.formulations.find("reduced");
    Fastest best;
    const auto faster = [&](std::size_t row, const std::optional<std::size_t>& than) {
        return !than || folder.rows[row].seconds() < folder.rows[*than].seconds();
    };
    for (const bool runner_up : {false, true})
        for (const std::size_t r : rows) {
            const FolderRow& row = folder.rows[r];
            if (!row.is_within(error)) continue;
            if (row.formulation != reduced && reduced >= 0) continue;
            if (!runner_up) {
                if (faster(r, best.row)) best.row = r;
            } else if (best.row && row.method != folder.rows[*best.row].method && faster(r, best.runner_up)) {
                best.runner_up = r;
            }
        }
    return best;
}

std::vector<std::optional<std::pair<double, double>>> fit_growth(const FolderSeries& series) {
    std::vector<std::optional<std::pair<double, double>>> all;
    for (std::size_t i = 0; i < standard_measures.size(); ++i) {
        all.emplace_back();
        const std::vector<double>& error = series.errors[i];
        if (std::ranges::any_of(error, [](double e) { return !std::isfinite(e); })) continue;
        // attitude errors saturate at about 1 rad
        const auto growth =
            standard_measures[i] == "attitude" ? error_growth(series.t, error, 1.0) : error_growth(series.t, error);
        if (growth) all.back() = {growth->exponent, growth->uncertainty};
    }
    return all;
}

std::vector<FittedOrder> fit_orders(const ResultFolder& folder) {
    const bool some =
        std::ranges::any_of(folder.experiments, [](const FolderExperiment& e) { return e.kind == "convergence"; });
    struct Points {
        std::vector<double> setting, error;
    };
    std::map<FolderRow::Curve, Points> curves;
    for (const FolderRow& row : folder.rows) {
        const FolderExperiment& experiment = folder.experiments[static_cast<std::size_t>(row.experiment)];
        if ((some && experiment.kind != "convergence") || row.kind == SettingKind::none) continue;
        if (row.status != Status::ok || !std::isfinite(row["attitude_error_final"])) continue;
        // errors near the rounding floor have no order
        if (row["attitude_error_final"] < 100 * row["float64_floor_final"]) continue;
        Points& points = curves[row.curve()];
        points.setting.push_back(row["step_taken"] > 0 ? row["step_taken"] : row["setting"]);
        points.error.push_back(row["attitude_error_final"]);
    }
    std::vector<FittedOrder> orders;
    for (const auto& [key, points] : curves) {
        if (points.setting.size() < 4) continue;
        FittedOrder order{key[0], key[1], key[2], static_cast<SettingKind>(key[3]), 0, {}, 0};
        const Method* const method = find_method(folder.methods[key[2]]);
        if (method && order.kind == SettingKind::step) order.claimed = method->order;
        if (const auto observed = observed_order(points.setting, points.error, 1.0)) {
            order.observed = observed->order, order.points = observed->points;
            order.from = observed->from, order.to = observed->to;
        }
        orders.push_back(order);
    }
    return orders;
}

std::vector<Finding> make_findings(const ResultFolder& folder) {
    std::vector<Finding> findings;
    for (const auto find : {fastest_finding, hidden_finding, growth_finding, order_finding, failure_finding,
                            floor_finding, gain_finding}) {
        if (findings.size() == 3) break;
        if (auto one = find(folder)) findings.push_back(std::move(*one));
    }
    return findings;
}

}  // namespace polhode
