#include "experiment/kinds/stability_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiment/kinds/cells.h"

namespace polhode {
namespace {

Cell setting_of(const StabilityRun* run) { return run ? Cell(run->result.setting) : Cell(); }

Cell evaluations_of(const StabilityRun* run) { return run ? cell_of(run->result.rhs_evaluations) : Cell(); }

std::string method_name(const StabilityFinding& finding) { return std::string(finding.method->name); }

// The q-th part of the sorted values lies below.
double quantile(std::vector<double> values, double q) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size()))) - 1];
}

// every family in the order of its first member
std::vector<std::string> families(const StabilityFindings& found) {
    std::vector<std::string> names;
    for (const StabilityScene& scene : found.scenes)
        if (std::find(names.begin(), names.end(), scene.family) == names.end()) names.push_back(scene.family);
    return names;
}

// The smallest of the attitude errors of the runs that are stable.
std::optional<double> smallest_error(const StabilityFinding& finding) {
    std::optional<double> smallest;
    for (const StabilityRun& run : finding.runs) {
        const std::optional<double>& error = run.result.errors["attitude"].max;
        if (run.outcome <= Outcome::damped_to_rest && error && (!smallest || *error < *smallest)) smallest = error;
    }
    return smallest;
}

}  // namespace

Table limits_table(const StabilityFindings& found) {
    Table table{{"scene", "family", "parameter", "method", "duration", "fastest_rate", "stable_step",
                 "stable_step_times_rate", "close_step", "close_evaluations", "accurate_step", "accurate_evaluations",
                 "beyond_step", "beyond", "beyond_message", "float64_floor"},
                {}};
    for (const StabilityFinding& f : found.findings) {
        if (f.kind != SettingKind::step || !was_run(f)) continue;
        const StabilityScene& scene = *f.scene;
        table.rows.push_back(
            {scene.label, scene.family, cell_of(scene.parameter), method_name(f), scene.duration, scene.fastest_rate,
             setting_of(f.stable), f.stable ? Cell(f.stable->result.setting * scene.fastest_rate) : Cell(),
             setting_of(f.close), evaluations_of(f.close), setting_of(f.accurate), evaluations_of(f.accurate),
             setting_of(f.beyond), f.beyond ? Cell(std::string(name_of(f.beyond->outcome))) : Cell(),
             f.beyond ? Cell(f.beyond->result.message) : Cell(), cell_of(scene.floors.float64)});
    }
    return table;
}

Table families_table(const StabilityFindings& found) {
    Table table{
        {"family", "method", "scenes", "stable_on", "stable_step_times_rate_least", "stable_step_times_rate_most",
         "close_on", "accurate_on", "accurate_step_times_rate_least", "accurate_evaluations_median", "beyond"},
        {}};
    for (const std::string& family : families(found)) {
        std::vector<const Method*> order;
        std::map<const Method*, std::vector<const StabilityFinding*>> members;
        for (const StabilityFinding& f : found.findings) {
            if (f.kind != SettingKind::step || f.scene->family != family || !was_run(f)) continue;
            if (!members.contains(f.method)) order.push_back(f.method);
            members[f.method].push_back(&f);
        }
        for (const Method* method : order) {
            std::vector<double> stable, accurate, evaluations;
            long close = 0;
            std::map<std::string, long> beyond;
            for (const StabilityFinding* f : members[method]) {
                const double rate = f->scene->fastest_rate;
                if (f->stable) stable.push_back(f->stable->result.setting * rate);
                if (f->close) ++close;
                if (f->accurate) {
                    accurate.push_back(f->accurate->result.setting * rate);
                    evaluations.push_back(static_cast<double>(f->accurate->result.rhs_evaluations.value_or(0)));
                }
                if (f->beyond) ++beyond[name_of(f->beyond->outcome)];
            }
            table.rows.push_back({family, std::string(method->name), static_cast<long>(members[method].size()),
                                  static_cast<long>(stable.size()), least(stable), most(stable), close,
                                  static_cast<long>(accurate.size()), least(accurate), middle(evaluations),
                                  listed_counts(beyond)});
        }
    }
    return table;
}

Table outcomes_table(const Plan& plan, const StabilityFindings& found) {
    const Status statuses[] = {Status::ok, Status::unsupported, Status::diverged, Status::tolerance_not_met,
                               Status::failed};
    Table table{{"method", "setting_kind", "runs"}, {}};
    for (const Status status : statuses) table.columns.emplace_back(name_of(status));
    for (const Outcome outcome :
         {Outcome::accurate, Outcome::close, Outcome::wrong_but_bounded, Outcome::damped_to_rest, Outcome::no_truth})
        table.columns.emplace_back(name_of(outcome));
    table.columns.insert(table.columns.end(), {"cut", "largest_error_ok", "seconds_longest"});
    for (const PlannedCurve& curve : plan.curves) {
        long runs = 0, cut = 0;
        std::map<Status, long> by_status;
        std::map<Outcome, long> by_outcome;
        double longest = 0;
        std::vector<double> ok_errors;
        for (const StabilityFinding& f : found.findings) {
            if (f.method != curve.method || f.kind != curve.kind) continue;
            for (const StabilityRun& run : f.runs) {
                ++runs, ++by_status[run.result.status], ++by_outcome[run.outcome];
                cut += run.result.cut;
                longest = std::max(longest, run.result.seconds_min.value_or(0));
                if (run.result.status == Status::ok && run.result.errors["attitude"].max)
                    ok_errors.push_back(*run.result.errors["attitude"].max);
            }
        }
        std::vector<Cell> row{std::string(curve.method->name), std::string(name_of(curve.kind)), runs};
        for (const Status status : statuses) row.emplace_back(by_status[status]);
        for (const Outcome outcome : {Outcome::accurate, Outcome::close, Outcome::wrong_but_bounded,
                                      Outcome::damped_to_rest, Outcome::no_truth})
            row.emplace_back(by_outcome[outcome]);
        row.insert(row.end(), {cut, most(ok_errors), longest});
        table.rows.push_back(std::move(row));
    }
    return table;
}

Table tolerances_table(const Plan& plan, const StabilityFindings& found) {
    Table table{{"method", "tolerance", "scenes", "ok", "tolerance_not_met", "diverged", "failed",
                 "error_over_tolerance_median", "error_over_tolerance_90", "error_over_tolerance_worst", "worst_on"},
                {}};
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::tolerance) continue;
        for (const double tolerance : curve.settings) {
            std::map<Status, long> ended;
            long scenes = 0;
            std::vector<double> ratios;
            std::string worst;
            for (const StabilityFinding& f : found.findings) {
                if (f.method != curve.method || f.kind != curve.kind || !was_run(f)) continue;
                for (const StabilityRun& run : f.runs) {
                    if (run.result.setting != tolerance) continue;
                    ++scenes, ++ended[run.result.status];
                    if (run.result.status != Status::ok || !run.result.errors["attitude"].max) continue;
                    ratios.push_back(*run.result.errors["attitude"].max / tolerance);
                    if (ratios.back() >= *std::max_element(ratios.begin(), ratios.end())) worst = f.scene->label;
                }
            }
            const bool any = !ratios.empty();
            table.rows.push_back({std::string(curve.method->name), tolerance, scenes, ended[Status::ok],
                                  ended[Status::tolerance_not_met], ended[Status::diverged], ended[Status::failed],
                                  any ? Cell(quantile(ratios, 0.5)) : Cell(),
                                  any ? Cell(quantile(ratios, 0.9)) : Cell(), most(ratios), worst});
        }
    }
    return table;
}

Table counts_table(const StabilityFindings& found) {
    Table table{{"scene", "family", "parameter", "method", "tolerance", "status", "steps", "rhs_evaluations",
                 "evaluations_per_second", "rejected_steps", "newton_failures", "order_reductions",
                 "error_over_tolerance", "message"},
                {}};
    for (const StabilityFinding& f : found.findings) {
        if (f.kind != SettingKind::tolerance || !was_run(f)) continue;
        for (const StabilityRun& run : f.runs) {
            const Result& r = run.result;
            const auto& evaluations = r.rhs_evaluations;
            table.rows.push_back({f.scene->label, f.scene->family, cell_of(f.scene->parameter), method_name(f),
                                  r.setting, std::string(name_of(r.status)), cell_of(r.steps), cell_of(evaluations),
                                  evaluations ? Cell(static_cast<double>(*evaluations) / f.scene->duration) : Cell(),
                                  cell_of(r.counts.rejected_steps), cell_of(r.counts.newton_failures),
                                  cell_of(r.counts.order_reductions),
                                  r.errors["attitude"].max ? Cell(*r.errors["attitude"].max / r.setting) : Cell(),
                                  r.message});
        }
    }
    return table;
}

Table float32_table(const StabilityFindings& found) {
    Table table{{"scene", "family", "parameter", "method", "smallest_error_float64", "smallest_error_float32",
                 "float32_floor", "arithmetic_outweighs_below", "lost_for_good"},
                {}};
    for (const StabilityFinding& single : found.findings) {
        if (single.method->precision != Precision::binary32 || !was_run(single) || single.kind != SettingKind::step)
            continue;
        const std::string_view base = single.method->in_binary64;
        const auto pair = std::find_if(found.findings.begin(), found.findings.end(), [&](const StabilityFinding& f) {
            return f.scene == single.scene && f.method->name == base && f.kind == single.kind;
        });
        if (pair == found.findings.end()) continue;
        const std::optional<double> binary64 = smallest_error(*pair), binary32 = smallest_error(single);
        // at equal steps: the largest below which rounding does more than the method, at all steps tried by both
        std::optional<double> below;
        for (auto run = single.runs.rbegin(); run != single.runs.rend(); ++run) {
            const auto same = std::find_if(pair->runs.begin(), pair->runs.end(), [&](const StabilityRun& other) {
                return other.result.setting == run->result.setting;
            });
            if (same == pair->runs.end() || same->result.cut || run->result.cut) continue;
            const auto &error32 = run->result.errors["attitude"].max, &error64 = same->result.errors["attitude"].max;
            const bool outweighs = error64 && (!error32 || *error32 > 2 * *error64);
            if (!outweighs) break;
            below = run->result.setting;
        }
        const bool lost = binary64 && *binary64 <= close_attitude && (!binary32 || *binary32 > close_attitude);
        table.rows.push_back({single.scene->label, single.scene->family, cell_of(single.scene->parameter),
                              std::string(base), cell_of(binary64), cell_of(binary32),
                              cell_of(single.scene->floors.float32), cell_of(below), std::string(lost ? "lost" : "")});
    }
    return table;
}

Table lost_table(const Table& all) {
    const std::size_t scene = column_index(all, "scene"), name = column_index(all, "method"),
                      binary64 = column_index(all, "smallest_error_float64"),
                      binary32 = column_index(all, "smallest_error_float32"), lost = column_index(all, "lost_for_good");
    Table table{{"method", "scenes", "lost", "error_ratio_median", "lost_on"}, {}};
    std::vector<std::string> order;
    for (const auto& row : all.rows)
        if (std::find(order.begin(), order.end(), text_of(row[name])) == order.end())
            order.push_back(text_of(row[name]));
    for (const std::string& method : order) {
        long scenes = 0, gone = 0;
        std::vector<double> ratios;
        std::string where;
        for (const auto& row : all.rows) {
            if (text_of(row[name]) != method) continue;
            ++scenes;
            const double *of64 = std::get_if<double>(&row[binary64]), *of32 = std::get_if<double>(&row[binary32]);
            if (!text_of(row[lost]).empty())
                ++gone, where += fmt::format("{}{}", where.empty() ? "" : ", ", text_of(row[scene]));
            else if (of64 && of32 && *of64 > 0)
                ratios.push_back(*of32 / *of64);
        }
        table.rows.push_back({method, scenes, gone, middle(ratios), where});
    }
    return table;
}

Table damping_table(const Plan& plan, const StabilityFindings& found) {
    constexpr const char* name = "extreme/drag_torque_1e6";
    constexpr double wanted = 1e-10;  // rad
    Table table{{"method", "reaches_1e-10", "tolerance", "evaluations_per_second", "attitude_error", "status"}, {}};
    for (const PlannedCurve& curve : plan.curves) {
        if (curve.kind != SettingKind::tolerance) continue;
        for (const StabilityFinding& f : found.findings) {
            if (f.method != curve.method || f.kind != curve.kind || f.scene->label != name || !was_run(f)) continue;
            const StabilityRun* best = nullptr;
            const auto error = [](const StabilityRun* run) { return run->result.errors["attitude"].max.value_or(4); };
            for (const StabilityRun& run : f.runs) {
                const bool reaches = error(&run) <= wanted;
                const bool before = best && error(best) <= wanted;
                if (!best || (reaches && !before) || (!reaches && !before && error(&run) < error(best)) ||
                    (reaches && before &&
                     run.result.rhs_evaluations.value_or(0) < best->result.rhs_evaluations.value_or(0)))
                    best = &run;
            }
            if (!best) continue;
            const Result& r = best->result;
            table.rows.push_back(
                {std::string(curve.method->name), std::string(error(best) <= wanted ? "yes" : "no"), r.setting,
                 r.rhs_evaluations ? Cell(static_cast<double>(*r.rhs_evaluations) / f.scene->duration) : Cell(),
                 cell_of(r.errors["attitude"].max), std::string(name_of(r.status))});
        }
    }
    return table;
}

}  // namespace polhode
