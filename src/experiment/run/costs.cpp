// Costs of plans. Expected times come from stored durations of earlier runs (case_store.h). assign_shards() distributes
// the work by Graham's rule: longest first, each to the shard with the least work.
#include "experiment/run/costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "experiment/run/case.h"
#include "experiment/run/case_store.h"
#include "measure/statistics.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr const char* truth_method = "truth";
constexpr double assumed_seconds = 1;

std::string setting_text(const PlannedCurve& curve, std::size_t rank) {
    return curve.kind == SettingKind::none || std::isnan(curve.settings[rank]) ? ""
                                                                               : shortest_decimal(curve.settings[rank]);
}

// the cells that identify a case
std::vector<std::string> case_identity(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve,
                                       std::size_t rank) {
    return {plan.experiment.name,
            scene.label,
            std::string(curve.method->name),
            name_of(curve.formulation),
            std::string(name_of(curve.kind)) + (curve.calibrated ? " calibrated" : ""),
            setting_text(curve, rank)};
}

// the description under which the time for a scene's truth is stored
std::string truth_description(const Plan& plan, const PlannedScene& scene) {
    return fmt::format("{} {} {}", plan.experiment.name, scene.label, truth_method);
}

std::vector<std::string> truth_identity(const Plan& plan, const PlannedScene& scene) {
    return {plan.experiment.name, scene.label, truth_method, "", "", ""};
}

std::string join_cells(const std::vector<std::string>& cells) {
    std::string whole;
    for (const std::string& cell : cells) whole += std::to_string(cell.size()) + ":" + cell;
    return whole;
}

std::optional<double> parse_seconds(const std::string& text) {
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value < 0) return {};
    return value;
}

// Measured times, by setting and by method.
class MeasuredTimes {
  public:
    void add(const std::vector<std::string>& identity, double seconds) {
        by_setting_[setting_key(identity)].push_back(seconds);
        by_method_[identity[2]].push_back(seconds);
        if (identity[2] != truth_method) all_.push_back(seconds);
    }
    // the expected seconds and their source
    std::pair<double, std::string> expected(const std::vector<std::string>& identity) const {
        if (const auto known = by_setting_.find(setting_key(identity)); known != by_setting_.end())
            return {median(known->second), "other scenes at this setting"};
        if (const auto known = by_method_.find(identity[2]); known != by_method_.end())
            return {median(known->second), "this method at other settings"};
        if (!all_.empty()) return {median(all_), "all other cases"};
        return {assumed_seconds, "assumed"};
    }

  private:
    static std::string setting_key(const std::vector<std::string>& identity) {
        return join_cells({identity.begin() + 2, identity.end()});
    }
    std::map<std::string, std::vector<double>> by_setting_, by_method_;
    std::vector<double> all_;
};

}  // namespace

const std::vector<std::string>& Costs::columns() {
    static const std::vector<std::string> names{"experiment",   "scene",   "method",           "formulation",
                                                "setting_kind", "setting", "expected_seconds", "source"};
    return names;
}

Costs::Costs(const Table& table, const std::string& file) {
    const std::vector<std::string>& names = columns();
    for (const std::string& name : names)
        if (std::find(table.columns.begin(), table.columns.end(), name) == table.columns.end())
            throw InputError(file, "line 1", "has no column " + name,
                             "give a plan written by `polhode run --dry-run --plan FILE`");
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        const auto cell = [&](const std::string& name) { return text_of(table.rows[r][column_index(table, name)]); };
        const std::string line = fmt::format("line {}", r + 2);
        const auto seconds = parse_seconds(cell("expected_seconds"));
        if (!seconds)
            throw InputError(file, line, "expected_seconds is " + one_line(cell("expected_seconds"), 40),
                             "give a finite number of seconds, 0 or more");
        std::vector<std::string> key;
        for (std::size_t k = 0; k < 6; ++k) key.push_back(cell(names[k]));
        if (!seconds_.emplace(join_cells(key), *seconds).second)
            throw InputError(file, line, "repeats a case of an earlier line", "give each case once");
    }
}

double Costs::truth_seconds(const Plan& plan, const PlannedScene& scene) const {
    const auto known = seconds_.find(join_cells(truth_identity(plan, scene)));
    return known == seconds_.end() ? 0 : known->second;
}

double Costs::curve_seconds(const Plan& plan, const PlannedScene& scene, const PlannedCurve& curve) const {
    double sum = 0;
    for (std::size_t rank = 0; rank < curve.settings.size(); ++rank) {
        const auto known = seconds_.find(join_cells(case_identity(plan, scene, curve, rank)));
        if (known != seconds_.end()) sum += known->second;
    }
    return sum;
}

void save_truth_duration(const std::string& directory, const Plan& plan, const PlannedScene& scene, double seconds) {
    const std::string description = truth_description(plan, scene);
    if (seconds > load_duration(directory, description).value_or(0)) save_duration(directory, description, seconds);
}

Table cost_table(const Plan& plan, const std::string& measured) {
    struct CostLine {
        std::vector<std::string> identity;
        std::optional<double> seconds;
    };
    std::vector<CostLine> lines;
    MeasuredTimes known;
    const auto add = [&](std::vector<std::string> named, const std::string& description) {
        lines.push_back({std::move(named), load_duration(measured, description)});
        if (lines.back().seconds) known.add(lines.back().identity, *lines.back().seconds);
    };
    const ExperimentKind& kind = *plan.experiment.kind;
    if (kind.make && !kind.resumable)
        add({plan.experiment.name, "", "", "", "", ""}, plan.experiment.name);
    else
        for (const PlannedScene& scene : plan.scenes) {
            add(truth_identity(plan, scene), truth_description(plan, scene));
            for (const PlannedCurve& curve : plan.curves)
                for (std::size_t rank = 0; rank < curve.settings.size(); ++rank)
                    add(case_identity(plan, scene, curve, rank), describe_case(plan, Case{&scene, &curve, rank, {}}));
        }
    Table table{Costs::columns(), {}};
    for (const CostLine& line : lines) {
        auto [seconds, source] =
            line.seconds ? std::pair(*line.seconds, std::string("measured")) : known.expected(line.identity);
        std::vector<Cell> row(line.identity.begin(), line.identity.end());
        row.emplace_back(seconds), row.emplace_back(std::move(source));
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::vector<std::vector<int>> assign_shards(const Plan& plan, const Costs& costs, int shards) {
    struct Part {
        std::size_t scene;
        std::vector<std::size_t> curves;
        double seconds;
    };
    struct SceneCost {
        double truth = 0, curves = 0;
        std::vector<double> curve_seconds;
    };
    std::vector<SceneCost> scenes;
    double total = 0;
    for (const PlannedScene& scene : plan.scenes) {
        SceneCost cost;
        cost.truth = costs.truth_seconds(plan, scene);
        for (const PlannedCurve& curve : plan.curves)
            cost.curve_seconds.push_back(costs.curve_seconds(plan, scene, curve));
        cost.curves = std::accumulate(cost.curve_seconds.begin(), cost.curve_seconds.end(), 0.0);
        total += cost.truth + cost.curves;
        scenes.push_back(std::move(cost));
    }
    const double share = total / shards;
    std::vector<Part> parts;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        const SceneCost& cost = scenes[s];
        std::size_t count = 1;
        // each part needs the truth: if the truth alone exceeds a share, more parts do not help
        if (cost.truth + cost.curves > share)
            count = static_cast<std::size_t>(std::ceil(std::clamp(cost.curves / std::max(share - cost.truth, share / 4),
                                                                  1.0, static_cast<double>(plan.curves.size()))));
        std::vector<std::size_t> order(plan.curves.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return cost.curve_seconds[a] > cost.curve_seconds[b]; });
        std::vector<Part> pieces(count, Part{s, {}, cost.truth});
        for (const std::size_t c : order) {
            const auto least = std::min_element(pieces.begin(), pieces.end(),
                                                [](const Part& a, const Part& b) { return a.seconds < b.seconds; });
            least->curves.push_back(c), least->seconds += cost.curve_seconds[c];
        }
        std::move(pieces.begin(), pieces.end(), std::back_inserter(parts));
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.seconds > b.seconds; });
    using Busy = std::pair<double, int>;
    std::priority_queue<Busy, std::vector<Busy>, std::greater<>> loads;
    for (int shard = 0; shard < shards; ++shard) loads.emplace(0.0, shard);
    std::vector<std::vector<int>> assignment(scenes.size(), std::vector<int>(plan.curves.size(), 0));
    for (const Part& part : parts) {
        auto [seconds, shard] = loads.top();
        loads.pop();
        for (const std::size_t c : part.curves) assignment[part.scene][c] = shard;
        loads.emplace(seconds + part.seconds, shard);
    }
    return assignment;
}

}  // namespace polhode
