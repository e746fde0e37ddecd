// Runs experiments. Kinds with `conclude`: a sweep, then tables from the finished cases in the directory. Kinds with
// `make`: the kind computes its tables, under a claim and the machine's lock. Locks make one process at a time write
// the tables.
#include "experiment/run/run_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <set>
#include <thread>

#include "experiment/plan/kind.h"
#include "experiment/run/case_store.h"
#include "experiment/run/fastest.h"
#include "experiment/run/locks.h"
#include "experiment/run/merge.h"
#include "experiment/run/report.h"
#include "integrators/run/march.h"
#include "integrators/sundials/build.h"
#include "text/claims.h"
#include "text/content_hash.h"
#include "text/interruption.h"
#include "text/message.h"
#include "text/terminal.h"

namespace polhode {
namespace {

const std::atomic<bool> never_stop{false};

bool has_systems(const Plan& plan) {
    return std::ranges::any_of(plan.scenes, [](const PlannedScene& s) { return is_mechanism(s.scene); });
}

bool has_planes(const Plan& plan) {
    return std::ranges::any_of(plan.scenes, [](const PlannedScene& s) { return !s.scene.planes.empty(); });
}

TableKind table_kind(const Plan& plan) {
    if (has_planes(plan)) return has_systems(plan) ? TableKind::all_scenes : TableKind::planes;
    return has_systems(plan) ? TableKind::systems : TableKind::single_bodies;
}

// The columns that the page shows; the CSV file has all. If a method of the plan has a description in a source text, a
// column "described as" follows the methods.
Table page_of_rows(const Plan& plan, const Table& rows) {
    std::vector<ColumnChoice> choice{{"scene", "scene"},
                                     {"method", "method"},
                                     {"setting_kind", "setting"},
                                     {"setting", "value"},
                                     {"status", "status"},
                                     {"seconds_median", "time (s)"},
                                     {"steps", "steps"},
                                     {"rhs_evaluations", "evaluations"},
                                     {"attitude_error_final", "attitude, end (rad)"},
                                     {"attitude_error_max", "attitude, max (rad)"},
                                     {"float64_floor", "float64 floor (rad)"},
                                     {"float32_floor", "float32 floor (rad)"},
                                     {"momentum_error_max", "momentum"},
                                     {"energy_error_max", "energy"}};
    if (has_systems(plan))
        choice.insert(choice.end(), {{"worst_body", "worst body"},
                                     {"position_error_max", "position (m)"},
                                     {"joint_gap_max", "joint gap (m)"},
                                     {"joint_turn_max", "joint turn (rad)"},
                                     {"reaction_error_max", "reactions"}});
    if (has_planes(plan) && !has_systems(plan)) choice.push_back({"position_error_max", "position (m)"});
    if (has_planes(plan))
        choice.insert(choice.end(), {{"event_time_error_max", "event times (s)"},
                                     {"penetration_max", "penetration (m)"},
                                     {"slip_error_max", "slip (m/s)"},
                                     {"contact_energy_gain", "energy gain (J)"}});
    choice.push_back({"message", "message"});
    Table page = select(rows, choice);
    if (!has_source_descriptions(plan)) return page;
    const auto behind_method = static_cast<long>(column_index(page, "method")) + 1;
    page.columns.insert(page.columns.begin() + behind_method, "described as");
    for (auto& row : page.rows) {
        const std::string name = text_of(row[static_cast<std::size_t>(behind_method - 1)]);
        const auto curve = std::find_if(plan.curves.begin(), plan.curves.end(),
                                        [&](const PlannedCurve& c) { return c.method->name == name; });
        row.insert(row.begin() + behind_method, std::string(curve == plan.curves.end() ? "" : curve->method->origin));
    }
    return page;
}

/// The key of a study that is computed as a whole: a hash of program, experiment, scenes and curves.
std::string study_key(const Plan& plan, bool quick) {
    const Experiment& e = plan.experiment;
    std::string text = fmt::format("{}\n{}\n{}\n{}\n{} {} {} {} {}\n", running_program_key(), e.name, e.about,
                                   e.kind->name, quick, e.repeats, e.samples, e.seconds_per_run, e.max_evaluations);
    for (const PlannedScene& scene : plan.scenes) text += scene.label + "\n" + scene.canonical + "\n";
    for (const PlannedCurve& curve : plan.curves) {
        text += fmt::format("{} {} {}", curve.method->name, curve.method->identity, name_of(curve.kind));
        for (const double setting : curve.settings) text += fmt::format(" {}", setting);
        text += "\n";
    }
    return content_hash(text);
}

void write_and_print(const Plan& plan, const Findings& findings, const RunOptions& options,
                     const std::string& command_line, const std::string& done) {
    const auto remarks = write_report(plan, findings, options.directory, command_line, options.quick, options.formats);
    if (!options.quiet) fmt::print(stderr, "{}: {}\n", plan.experiment.name, one_line(done, 1000));
    for (const std::string& remark : remarks) fmt::print(stderr, "polhode: {}\n", one_line(remark, 500));
}

// Runs a kind with `make`. Returns the number of missing rows, or nothing if it was interrupted.
std::optional<long> run_study(const Plan& plan, const RunOptions& options, const std::string& command_line) {
    const std::string& name = plan.experiment.name;
    const ExperimentKind& kind = *plan.experiment.kind;
    const std::string key = study_key(plan, options.quick);
    const auto is_complete = [&] {
        return is_done(options.directory, key) && has_table_formats(options.directory, name, options.formats);
    };
    bool done = is_complete();
    // One process computes the study and others wait for it. Processes of a resumable kind share its searches.
    const Claims claims(claims_file(options.directory));
    std::optional<Claims::Claim> claim;
    if (!done && !kind.resumable && options.shard == 1) {
        while (!(claim = claims.take(key)) && !sweep_interrupted())
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        done = is_complete();
    }
    if (done || (options.shard > 1 && !kind.resumable)) {
        if (!options.quiet)
            fmt::print(stderr, "{}: {}\n", name, done ? "already complete" : "runs in the first shard only");
        return 0;
    }
    Findings findings;
    double seconds = 0;
    {
        const FileLock exclusive_lock(machine_lock_file(), FileLock::Kind::exclusive, never_stop);
        const Stopwatch stopwatch;
        findings = kind.make(plan, options);
        seconds = stopwatch.seconds();
    }
    if (Interruption::is_requested() || (kind.resumable && sweep_interrupted())) {
        fmt::print(stderr, "polhode: {} interrupted; run again to continue\n", name);
        return {};
    }
    const FileLock report_lock(report_lock_file(options.directory), FileLock::Kind::exclusive, never_stop);
    write_and_print(plan, findings, options, command_line,
                    fmt::format("{} tables and {} figures in {}, {:.3g} s", findings.tables.size(),
                                findings.figures.size(), options.directory, seconds));
    if (!options.only_gather) save_duration(options.directory, name, seconds);
    // the first shard also computes the parts that are not searches
    if (findings.missing == 0 && options.shard == 1) save_done(options.directory, key);
    return findings.missing;
}

// the plan, and its follow-up if its kind has one
std::vector<Plan> expand_plan(const Plan& plan) {
    std::vector<Plan> plans{plan};
    if (const auto follow_up = plan.experiment.kind->follow_up) plans.push_back(follow_up(plan));
    return plans;
}

void conclude_cases(const Plan& plan, const RunOptions& options, const std::string& command_line, long run) {
    const FileLock report_lock(report_lock_file(options.directory), FileLock::Kind::exclusive, never_stop);
    const Findings findings = conclude_finished(plan, options.directory);
    write_and_print(
        plan, findings, options, command_line,
        fmt::format("{} rows in {}, {} run now", findings.tables.front().table.rows.size(), options.directory, run));
    if (!options.quiet)
        fmt::print(stderr, "{}",
                   run_table(finished_results(plan, options.directory), {terminal_width(2, 100), wants_color(2)}));
}

bool run_cases(const Plan& plan, const RunOptions& options, const std::string& command_line) {
    SweepCount count;
    for (const Plan& part : expand_plan(plan)) count.run += run_sweep(part, options).run;
    if (sweep_interrupted()) {
        fmt::print(stderr, "polhode: {} interrupted after {} cases; run again to continue\n", plan.experiment.name,
                   count.run);
        return false;
    }
    conclude_cases(plan, options, command_line, count.run);
    return true;
}

}  // namespace

Findings conclude(const Plan& plan, const std::vector<Result>& rows) {
    const TableKind which = table_kind(plan);
    Table table{result_columns(which), {}};
    std::set<std::string> machines;
    for (const Result& r : rows) {
        table.rows.push_back(result_row(plan.experiment.name, r, which));
        if (r.seconds_min) machines.insert(r.machine);
    }
    // identify the machine of each row if there are several
    if (machines.size() > 1) {
        table.columns.emplace_back("machine");
        for (std::size_t i = 0; i < rows.size(); ++i) table.rows[i].emplace_back(rows[i].machine);
    }
    const std::string caption = plan.experiment.about + (sundials_unoptimised() ? " (SUNDIALS unoptimised)" : "");
    Findings findings = plan.experiment.kind->conclude(plan, rows);
    findings.machines.assign(machines.begin(), machines.end());
    for (NamedTable& named : findings.tables) named.title = fmt::format("{}: {}", named.title, caption);
    Table page = page_of_rows(plan, table);
    findings.tables.insert(findings.tables.begin(),
                           {.name = "", .title = caption, .table = std::move(table), .page = std::move(page)});
    return findings;
}

Findings conclude_finished(const Plan& plan, const std::string& directory) {
    Findings findings;
    for (const Plan& part : expand_plan(plan)) {
        const std::vector<Result> rows = finished_results(part, directory);
        // the rows of a follow-up have no table of their own
        Findings more = findings.tables.empty() ? conclude(part, rows) : part.experiment.kind->conclude(part, rows);
        std::move(more.tables.begin(), more.tables.end(), std::back_inserter(findings.tables));
        std::move(more.figures.begin(), more.figures.end(), std::back_inserter(findings.figures));
        findings.page += more.page;
        findings.machines.insert(findings.machines.end(), more.machines.begin(), more.machines.end());
    }
    return findings;
}

std::vector<PendingCase> pending_work(const Plan& plan, const RunOptions& options) {
    if (!plan.experiment.kind->make) {
        std::vector<PendingCase> pending;
        for (const Plan& part : expand_plan(plan))
            for (PendingCase& one : pending_cases(part, options)) pending.push_back(std::move(one));
        return pending;
    }
    if (is_done(options.directory, study_key(plan, options.quick))) return {};
    return {{plan.experiment.name, load_duration(options.directory, plan.experiment.name)}};
}

GatherResult gather_results(const Plan& plan, const RunOptions& options, const std::string& command_line) {
    RunOptions gathering = options;
    gathering.only_gather = true, gathering.shard = gathering.shards = 1;
    if (plan.experiment.kind->make) {
        const long missing = run_study(plan, gathering, command_line).value_or(0);
        return {missing, missing > 0 ? plan.experiment.name : ""};
    }
    conclude_cases(plan, gathering, command_line, 0);
    const std::vector<PendingCase> pending = pending_work(plan, options);
    return {static_cast<long>(pending.size()), pending.empty() ? "" : pending.front().description};
}

bool is_study_done(const Plan& plan, const std::string& directory) {
    return is_done(directory, study_key(plan, plan.quick));
}

void save_study_done(const Plan& plan, const std::string& directory) {
    save_done(directory, study_key(plan, plan.quick));
}

Table work_cost_table(const Plan& plan, const std::string& measured) {
    Table costs{Costs::columns(), {}};
    std::set<std::vector<std::string>> known;
    for (const Plan& part : expand_plan(plan))
        for (std::vector<Cell>& row : cost_table(part, measured).rows) {
            std::vector<std::string> identity;
            for (std::size_t c = 0; c + 2 < row.size(); ++c) identity.push_back(text_of(row[c]));
            // a follow-up may need truths of the first plan
            if (known.insert(std::move(identity)).second) costs.rows.push_back(std::move(row));
        }
    return costs;
}

bool run_experiment(const Plan& plan, const RunOptions& options, const std::string& command_line) {
    remove_abandoned_files(options.directory);
    record_experiment(plan, options.directory);
    const bool ended = plan.experiment.kind->make ? run_study(plan, options, command_line).has_value()
                                                  : run_cases(plan, options, command_line);
    // of other runs in the directory that were killed meanwhile
    remove_abandoned_files(options.directory);
    return ended;
}

}  // namespace polhode
