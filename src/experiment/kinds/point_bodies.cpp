// The kind `point_bodies`: a rigid body as points at fixed distances, by springs, constraints and position-based
// dynamics, compared with the truth of the rigid body. Accuracy and cost against stiffness, and stability limits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "figure/curve_style.h"
#include "integrators/points/point_runs.h"
#include "integrators/points/stiffness.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"

namespace polhode {
namespace {

using Solve = PointRun (*)(const Problem&, const Settings&, const PointOptions&);

struct PointMethod {
    const char* name;
    Solve solve;
};
constexpr PointMethod rk4{"point_springs_rk4", point_springs_rk4};
constexpr PointMethod verlet{"point_springs_verlet", point_springs_verlet};
constexpr PointMethod cvode{"point_springs_cvode_bdf", point_springs_cvode_bdf};
constexpr PointMethod ida{"point_constraints_ida", point_constraints_ida};
constexpr PointMethod xpbd{"point_xpbd", point_xpbd};

// h times the frequency of the fastest vibration at which an explicit scheme becomes unstable
double stability_limit(const PointMethod& way) { return way.solve == point_springs_rk4 ? 2 * std::sqrt(2.0) : 2.0; }

struct PointOutcome {
    Trajectory trajectory;
    std::optional<double> attitude_error, stretch;
};

const std::vector<std::string> shared_columns = {
    "status", "attitude_error_max", "stretch_max", "steps", "rhs_evaluations", "seconds", "message"};

class Bench {
  public:
    Bench(const PlannedScene& planned, bool quick)
        : label(planned.label),
          problem(pose(planned.scene)),
          samples(quick ? 20 : 100),
          truth(reference(planned.scene, samples)) {}

    PointOutcome evaluate(const Trajectory& trajectory, std::optional<double> stretch) const {
        PointOutcome outcome{trajectory, {}, stretch};
        if (trajectory.status != Status::ok || !truth.available) return outcome;
        outcome.attitude_error =
            errors(error_series(problem.scene, trajectory, truth), trajectory, truth)["attitude"].max;
        return outcome;
    }
    PointOutcome run(const PointMethod& way, Settings settings, const PointOptions& options) const {
        settings.samples = samples;
        const PointRun found = way.solve(problem, settings, options);
        return evaluate(found.trajectory,
                        found.trajectory.status == Status::ok ? std::optional(found.largest_stretch) : std::nullopt);
    }
    // a method for the rigid body
    PointOutcome run(const char* method, Settings settings) const {
        settings.samples = samples;
        return evaluate(solve(problem, *find_method(method), settings), {});
    }
    double step(double h) const {
        return problem.scene.duration / std::ceil(problem.scene.duration / h / static_cast<double>(samples)) /
               static_cast<double>(samples);
    }

    std::string label;
    Problem problem;
    long samples;
    Reference truth;
};

void add_row(Table& table, std::vector<Cell> row, const PointOutcome& outcome) {
    const Trajectory& t = outcome.trajectory;
    const bool has_counts = t.status == Status::ok || t.steps > 0;
    row.insert(row.end(), {std::string(name_of(t.status)), cell_of(outcome.attitude_error), cell_of(outcome.stretch),
                           has_counts ? Cell(t.steps) : Cell(), has_counts ? Cell(t.rhs_evaluations) : Cell(),
                           t.status == Status::ok ? Cell(t.seconds) : Cell(), t.message});
    table.rows.push_back(std::move(row));
}

Table make_point_table(std::vector<std::string> columns) {
    columns.insert(columns.end(), shared_columns.begin(), shared_columns.end());
    return {std::move(columns), {}};
}

std::vector<ColumnChoice> choose_page_columns(const Table& table) {
    std::vector<ColumnChoice> choices;
    for (const std::string& column : table.columns)
        if (column != "scene" && column != "message")
            choices.push_back({column, column == "attitude_error_max" ? "attitude error (rad)"
                                       : column == "stretch_max"      ? "largest stretch"
                                       : column == "seconds"          ? "time (s)"
                                       : column == "stiffness"        ? "stiffness (N/m)"
                                       : column == "rhs_evaluations"  ? "evaluations"
                                       : column == "damping_ratio"    ? "damping ratio"
                                                                      : column});
    return choices;
}

Settings step_settings(double h, long max_steps) {
    Settings settings;
    settings.step = h, settings.max_steps = max_steps;
    return settings;
}
Settings tolerance_settings(double R, long max_steps) {
    Settings settings;
    settings.tolerance = R, settings.max_steps = max_steps;
    return settings;
}

using Curves = std::vector<Curve>;

void add_point(Curves& curves, const std::string& name, double x, const PointOutcome& outcome) {
    if (!outcome.attitude_error) return;
    Curve& curve = find_or_add_curve(curves, name);
    curve.x.push_back(x), curve.y.push_back(*outcome.attitude_error);
}

// Spring methods with stiffness 10^2 to 10^10 N/m, explicit ones at half the stability limit of the step.
Table measure_stiffness(const Bench& bench, bool quick, Curves& curves) {
    Table table = make_point_table({"scene", "method", "stiffness", "damping_ratio", "setting_kind", "setting"});
    const long max_steps = quick ? 20000 : 5'000'000, max_implicit = quick ? 5000 : 30000;
    const PointBody body = point_body(bench.problem, {});
    for (int decade = 2; decade <= 10; decade += quick ? 2 : 1) {
        PointOptions options;
        options.stiffness = std::pow(10.0, decade);
        const double fastest = spring_frequencies(body, *options.stiffness).fastest;
        for (const PointMethod* way : {&rk4, &verlet}) {
            const double h = bench.step(0.5 * stability_limit(*way) / fastest);
            const PointOutcome outcome = bench.run(*way, step_settings(h, max_steps), options);
            add_row(table, {bench.label, way->name, *options.stiffness, 0.0, "step", h}, outcome);
            add_point(curves, way->name, *options.stiffness, outcome);
        }
        for (const double ratio : {0.0, 1.0})
            for (const double R : quick ? std::vector{1e-8} : std::vector{1e-6, 1e-8, 1e-10}) {
                options.damping_ratio = ratio;
                const PointOutcome outcome = bench.run(cvode, tolerance_settings(R, max_implicit), options);
                add_row(table, {bench.label, cvode.name, *options.stiffness, ratio, "tolerance", R}, outcome);
                add_point(curves, fmt::format("cvode_bdf {:g}{}", R, ratio == 0 ? "" : ", damped"), *options.stiffness,
                          outcome);
            }
    }
    return table;
}

// Explicit spring methods with the default stiffness, at steps around the stability limit.
Table measure_stability(const Bench& bench, bool quick) {
    Table table = make_point_table({"scene", "method", "h_over_limit", "setting"});
    const PointBody body = point_body(bench.problem, {});
    PointOptions options;
    options.stiffness = default_stiffness(bench.problem, body);
    const double fastest = spring_frequencies(body, *options.stiffness).fastest;
    for (const PointMethod* way : {&rk4, &verlet})
        for (const double share : {2.0, 1.2, 1.05, 0.95, 0.8, 0.5, 0.25}) {
            if (quick && share < 0.8) continue;
            const double h = bench.step(share * stability_limit(*way) / fastest);
            const PointOutcome outcome = bench.run(*way, step_settings(h, 1'000'000), options);
            add_row(table, {bench.label, way->name, h * fastest / stability_limit(*way), h}, outcome);
        }
    return table;
}

// Methods with hard distances, and rigid-body methods at the same settings.
Table measure_hard_distances(const Bench& bench, bool quick, Curves& curves) {
    Table table = make_point_table({"scene", "method", "iterations", "setting_kind", "setting"});
    const auto note = [&](const std::string& name, std::vector<Cell> row, const PointOutcome& outcome) {
        row.insert(row.begin(), bench.label);
        add_row(table, std::move(row), outcome);
        if (outcome.trajectory.seconds > 0) add_point(curves, name, outcome.trajectory.seconds, outcome);
    };
    for (int digits = 2; digits <= 12; digits += quick ? 4 : 2) {
        const double R = std::pow(10.0, -digits);
        const Settings settings = tolerance_settings(R, 100000);
        note(ida.name, {ida.name, {}, "tolerance", R}, bench.run(ida, settings, {}));
        note("rigid: cvode_bdf", {"cvode_bdf", {}, "tolerance", R}, bench.run("cvode_bdf", settings));
    }
    for (const long per_sample : quick ? std::vector<long>{5, 50} : std::vector<long>{1, 4, 16, 64, 256}) {
        const double h = bench.problem.scene.duration / static_cast<double>(bench.samples * per_sample);
        const Settings settings = step_settings(h, 100000);
        for (const int iterations : quick ? std::vector{1, 10} : std::vector{1, 2, 5, 10, 20}) {
            PointOptions options;
            options.iterations = iterations;
            note(fmt::format("{}, {} sweeps", xpbd.name, iterations),
                 {xpbd.name, static_cast<long>(iterations), "step", h}, bench.run(xpbd, settings, options));
        }
        note("rigid: odeint_rk4", {"odeint_rk4", {}, "step", h}, bench.run("odeint_rk4", settings));
    }
    return table;
}

// 8, 27 and 64 points with the same mass properties.
Table measure_counts(const Bench& bench, bool quick) {
    Table table = make_point_table(
        {"scene", "points", "links", "slowest_frequency", "fastest_frequency", "method", "setting_kind", "setting"});
    for (int n = 2; n <= (quick ? 3 : 4); ++n) {
        PointOptions options;
        options.arrangement.n = n;
        const PointBody body = point_body(bench.problem, options.arrangement);
        options.stiffness = default_stiffness(bench.problem, body);
        const SpringFrequencies w = spring_frequencies(body, *options.stiffness);
        const auto add = [&](const PointMethod& way, const char* kind, double setting, const Settings& settings) {
            add_row(table,
                    {bench.label, static_cast<long>(body.count()), static_cast<long>(body.links.size()), w.slowest,
                     w.fastest, way.name, kind, setting},
                    bench.run(way, settings, options));
        };
        for (const PointMethod* way : {&rk4, &verlet}) {
            const double h = bench.step(0.5 * stability_limit(*way) / w.fastest);
            add(*way, "step", h, step_settings(h, quick ? 20000 : 300000));
        }
        // only small n, because of LU factorisations with 6 n^3 unknowns
        if (n <= (quick ? 2 : 3)) add(cvode, "tolerance", 1e-8, tolerance_settings(1e-8, 20000));
        const double h = bench.step(1e-3);
        add(xpbd, "step", h, step_settings(h, 100000));
    }
    return table;
}

}  // namespace

Findings run_point_bodies(const Plan& plan, const RunOptions& options) {
    Findings result;
    Figure figure{"Attitude error of a rigid body made of points", 2, {}, ""};
    for (const PlannedScene& planned : plan.scenes) {
        const Bench bench(planned, options.quick);
        Curves by_stiffness, by_time;
        const std::string suffix = plan.scenes.size() > 1 ? "_" + planned.label : "";
        const auto add = [&](const char* name, const char* title, Table table) {
            std::vector<ColumnChoice> choices = choose_page_columns(table);
            result.tables.push_back(
                {name + suffix, fmt::format("{}: {}", planned.label, title), std::move(table), std::move(choices)});
        };
        add("",
            "springs of 10^2 to 10^10 N/m between the corners of the box; explicit steps at half the stability limit; "
            "damping ratio of the slowest vibration",
            measure_stiffness(bench, options.quick, by_stiffness));
        add("stability", "explicit steps around the stability limit of the fastest vibration (h w = 2.83, 2)",
            measure_stability(bench, options.quick));
        add("hard", "hard distances by IDA and by position-based dynamics, and the equations of the rigid body",
            measure_hard_distances(bench, options.quick, by_time));
        add("counts", "n^3 points with the same mass properties, on springs and at hard distances",
            measure_counts(bench, options.quick));
        figure.panels.push_back(
            {planned.label + ": springs", "stiffness (N/m)", "largest attitude error (rad)", true, true, by_stiffness});
        // continue the colours of the other panel, because the panels share one legend
        for (std::size_t i = 0; i < by_time.size(); ++i)
            set_style(by_time[i], plain_style(static_cast<int>(by_stiffness.size() + i)));
        figure.panels.push_back(
            {planned.label + ": hard distances", "run time (s)", "largest attitude error (rad)", true, true, by_time});
    }
    result.figures.push_back({"point_bodies", std::move(figure)});
    return result;
}

}  // namespace polhode
