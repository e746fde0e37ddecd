// Maps of outcomes for the kind `stability`: each fixed-step method on grids of step x stiffness and step x spin.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "body/elementary.h"
#include "experiment/kinds/cells.h"
#include "experiment/kinds/stability.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/truth/reference.h"
#include "measure/stability.h"
#include "text/parallel.h"

namespace polhode {
namespace {

/// Invariants of the free motion: L (kg m^2/s, world axes) and kinetic energy (J).
struct Invariants {
    Vector3<double> momentum;
    double energy = 0;
};

Invariants invariants_of(const Problem& problem, const Sample& sample) {
    const Vector3<double> L_B = problem.body.inertia_B * sample.angular_velocity_B;
    return {(1 / squared_norm(sample.q)) * rotate(sample.q, L_B), 0.5 * dot(sample.angular_velocity_B, L_B)};
}

/// One column of a map: a scene and its reference motion.
struct MapColumn {
    double x = 0;
    Problem problem;
    Reference truth;
    Invariants end{};  ///< invariants of the truth at the end
};

MapColumn column_of(const Scene& scene, double x, long samples) {
    MapColumn column{x, pose(scene), reference(scene, samples)};
    if (column.truth.available) column.end = invariants_of(column.problem, column.truth.samples.back().rounded());
    return column;
}

struct StepMap {
    std::string name, title, x_label, note;
    long samples = 0;
    double interval = 0;          ///< s, between two samples of any column
    std::vector<long> divisions;  ///< steps per interval, from fine to coarse
    std::vector<MapColumn> columns{};
    double step(std::size_t row) const { return interval / static_cast<double>(divisions[row]); }
};

/// The result of one run. The last three values compare its end with that of the truth; NaN if the run did not reach
/// it.
struct MapCell {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    Outcome outcome = Outcome::unsupported;
    double attitude_error = unknown;  ///< rad, largest
    double energy_ratio = unknown;
    double momentum_ratio = unknown;  ///< of lengths
    double momentum_angle = unknown;  ///< rad, between the vectors
};

/// The cells of one method, row by row.
struct MethodMap {
    const Method* method = nullptr;
    std::vector<MapCell> cells;
};

// 10^(from + k/per_decade) while at most 10^to
std::vector<double> decades(double from, double to, int per_decade) {
    std::vector<double> values;
    for (int k = 0; from + static_cast<double>(k) / per_decade <= to + 1e-9; ++k)
        values.push_back(std::pow(10.0, from + static_cast<double>(k) / per_decade));
    return values;
}

// the largest last, so that steps ascend
std::vector<long> divisions(long finest, int per_decade) {
    std::vector<long> found;
    for (const double value : decades(0, std::log10(static_cast<double>(finest)), per_decade))
        if (const long k = std::lround(value); found.empty() || found.back() != k) found.push_back(k);
    std::reverse(found.begin(), found.end());
    return found;
}

/// Drag about a principal axis of a body with three moments, and a torque that sustains 1 rad/s. Starting at 2 rad/s,
/// the body rotates by about 2 rad for any stiffness.
StepMap stiffness_map(int jobs, bool quick) {
    StepMap map{"stiffness",
                "step against stiffness",
                "drag / moment (1/s)",
                "A body rotates about a principal axis for 2 s under drag and a torque that sustains 1 rad/s, starting "
                "at 2 rad/s. Three samples.",
                2,
                1,
                divisions(10'000, quick ? 1 : 5)};
    const std::vector<double> rates = decades(0, 10, quick ? 1 : 2);
    map.columns.resize(rates.size());
    parallel_for(rates.size(), jobs, [&](std::size_t i) {
        constexpr double moment = 3;
        Scene scene;
        scene.name = "step_map_stiffness", scene.duration = 2;
        scene.body.inertia_B = diagonal(Vector3<double>(2, 2.5, moment));
        scene.initial.angular_velocity = {0, 0, 2};
        Drag drag;
        drag.rotational = {0, 0, moment * rates[i]};
        Torque torque;
        torque.vector = {0, 0, moment * rates[i]}, torque.frame = Frame::body;
        scene.loads = {drag, torque};
        map.columns[i] = column_of(scene, rates[i], map.samples);
    });
    return map;
}

/// A free body with three moments that does not spin about a principal axis.
StepMap spin_map(int jobs, bool quick) {
    StepMap map{"spin",
                "step against spin",
                "spin (rad/s)",
                "A free body with moments 1, 2, 3 for 2 s, starting at w = (2, 6, 3)/7 times the spin. 21 samples.",
                20,
                0.1,
                divisions(1000, quick ? 2 : 7)};
    const std::vector<double> spins = decades(-1, 3, quick ? 1 : 5);
    map.columns.resize(spins.size());
    parallel_for(spins.size(), jobs, [&](std::size_t i) {
        Scene scene;
        scene.name = "step_map_spin", scene.duration = 2;
        scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
        scene.initial.angular_velocity = (spins[i] / 7) * Vector3<double>(2, 6, 3);
        map.columns[i] = column_of(scene, spins[i], map.samples);
    });
    return map;
}

MapCell run_cell(const StepMap& map, const MapColumn& column, const Method& method, std::size_t row) {
    Settings settings;
    settings.step = map.step(row), settings.samples = map.samples;
    // no correct run reaches these limits; a method whose step does not end is `failed`
    settings.max_steps = 10 * map.samples * map.divisions.front();
    settings.seconds_limit = 2;
    const Trajectory run = solve(column.problem, method, settings);
    MapCell cell;
    Errors worst;
    if (run.status != Status::unsupported)
        worst = errors(error_series(column.problem.scene, run, column.truth), run, column.truth);
    cell.outcome = outcome_of(run, worst, column.truth);
    if (worst["attitude"].max) cell.attitude_error = *worst["attitude"].max;
    if (run.status != Status::ok || run.samples.empty()) return cell;
    const Invariants at_end = invariants_of(column.problem, run.samples.back()), &truth = column.end;
    cell.energy_ratio = at_end.energy / truth.energy;
    cell.momentum_ratio = hypotenuse(at_end.momentum) / hypotenuse(truth.momentum);
    cell.momentum_angle =
        std::atan2(hypotenuse(cross(at_end.momentum, truth.momentum)), dot(at_end.momentum, truth.momentum));
    return cell;
}

std::vector<MethodMap> run_map(const StepMap& map, std::span<const Method* const> methods, int jobs) {
    std::vector<MethodMap> maps;
    const std::size_t columns = map.columns.size(), rows = map.divisions.size();
    for (const Method* method : methods)
        if (takes_step(*method)) maps.push_back({method, std::vector<MapCell>(columns * rows)});
    parallel_for(maps.size() * columns, jobs, [&](std::size_t task) {
        MethodMap& own = maps[task / columns];
        const std::size_t i = task % columns;
        if (!map.columns[i].truth.available) return;
        // start with the coarsest step: an unsupported scene is unsupported at every step
        for (std::size_t row = rows; row-- > 0;) {
            own.cells[row * columns + i] = run_cell(map, map.columns[i], *own.method, row);
            if (own.cells[row * columns + i].outcome == Outcome::unsupported) return;
        }
    });
    std::erase_if(maps, [](const MethodMap& m) {
        return std::all_of(m.cells.begin(), m.cells.end(),
                           [](const MapCell& cell) { return cell.outcome == Outcome::unsupported; });
    });
    return maps;
}

// one row per interval of steps with the same outcome
void add_rows(Table& table, const StepMap& map, const std::vector<MethodMap>& maps) {
    const std::size_t columns = map.columns.size(), rows = map.divisions.size();
    for (const MethodMap& m : maps)
        for (std::size_t i = 0; i < columns; ++i)
            for (std::size_t begin = 0, end = 0; begin < rows; begin = end) {
                const Outcome outcome = m.cells[begin * columns + i].outcome;
                std::vector<double> errors;
                for (end = begin; end < rows && m.cells[end * columns + i].outcome == outcome; ++end)
                    if (const double error = m.cells[end * columns + i].attitude_error; std::isfinite(error))
                        errors.push_back(error);
                if (outcome == Outcome::unsupported || outcome == Outcome::no_truth) continue;
                table.rows.push_back({std::string(m.method->name), map.name, map.columns[i].x, map.step(begin),
                                      map.step(end - 1), std::string(name_of(outcome)), min_cell(errors),
                                      max_cell(errors)});
            }
}

// the classes of the figures, from best to worst
constexpr std::array shown{Outcome::accurate,       Outcome::close,    Outcome::wrong_but_bounded,
                           Outcome::damped_to_rest, Outcome::diverged, Outcome::failed};

std::vector<MapClass> map_classes() {
    return {{"within 0.001 rad", 0}, {"within 0.1 rad", 1},  {name_of(shown[2]), 2},
            {name_of(shown[3]), 4},  {name_of(shown[4]), 6}, {name_of(shown[5]), 7}};
}

int class_of(Outcome outcome) {
    // implicit methods report this if the equations of a fixed step have no solution
    if (outcome == Outcome::tolerance_not_met) outcome = Outcome::failed;
    const auto at = std::find(shown.begin(), shown.end(), outcome);
    return at == shown.end() ? -1 : static_cast<int>(at - shown.begin());
}

// the linear limit h = interval / rate within the map
std::optional<Curve> limit_curve(const StepMap& map, const Method& method, const OutcomeMap& outcomes) {
    const std::optional<double> interval = map.name == "stiffness" ? real_interval(method) : std::nullopt;
    if (!interval || *interval <= 0 || !std::isfinite(*interval)) return {};
    Curve limit;
    limit.label = "limit of linear theory", limit.color = 1, limit.points = false;
    for (const double x : decades(std::log10(outcomes.x.front()), std::log10(outcomes.x.back()), 4))
        if (const double h = *interval / x; h >= outcomes.y.front() && h <= outcomes.y.back())
            limit.x.push_back(x), limit.y.push_back(h);
    if (limit.x.empty()) return {};
    return limit;
}

Panel panel_of(const StepMap& map, const MethodMap& m) {
    Panel panel{std::string(m.method->name), map.x_label, "step (s)", true, true, {}};
    OutcomeMap outcomes;
    outcomes.classes = map_classes();
    for (const MapColumn& column : map.columns) outcomes.x.push_back(column.x);
    for (std::size_t row = 0; row < map.divisions.size(); ++row) outcomes.y.push_back(map.step(row));
    for (const MapCell& cell : m.cells) outcomes.cells.push_back(class_of(cell.outcome));
    if (auto limit = limit_curve(map, *m.method, outcomes)) panel.curves.push_back(std::move(*limit));
    panel.map = std::move(outcomes);
    return panel;
}

void add_figures(std::vector<NamedFigure>& figures, const StepMap& map, const std::vector<MethodMap>& maps) {
    constexpr std::size_t page = 16;
    const std::size_t pages = (maps.size() + page - 1) / page;
    for (std::size_t p = 0; p < pages; ++p) {
        Figure figure;
        figure.title =
            fmt::format("Outcome of a run: {}{}", map.title, pages > 1 ? fmt::format(" ({} of {})", p + 1, pages) : "");
        figure.columns = 4, figure.shared_axes = true;
        figure.note = map.note;
        bool theory = false;
        for (std::size_t k = p * page; k < std::min(maps.size(), (p + 1) * page); ++k) {
            figure.panels.push_back(panel_of(map, maps[k]));
            theory |= !figure.panels.back().curves.empty();
        }
        if (theory) figure.note += " Panels without a line have no limit, or one outside the map.";
        figures.push_back({fmt::format("stability_map_{}{}", map.name, pages > 1 ? fmt::format("_{}", p + 1) : ""),
                           std::move(figure)});
    }
}

/// The cell with the smallest h w that satisfies a condition.
struct CellAngle {
    double angle = std::numeric_limits<double>::infinity();  ///< h w, rad a step
    const MapCell* cell = nullptr;
};
template <class Passes>
CellAngle find_smallest_angle(const StepMap& map, const MethodMap& m, const Passes& passes) {
    CellAngle found;
    const std::size_t columns = map.columns.size();
    for (std::size_t k = 0; k < m.cells.size(); ++k) {
        const double angle = map.step(k / columns) * map.columns[k % columns].x;
        if (angle < found.angle && passes(m.cells[k])) found = {angle, &m.cells[k]};
    }
    return found;
}

NamedTable gyroscopic_table(const StepMap& map, const std::vector<MethodMap>& maps) {
    NamedTable named = make_named_table(
        "gyroscopic",
        "Gyroscopic updates of game engines on a free body: smallest step times spin (rad) at which each "
        "error occurs within 2 s",
        {{"method", "method"},
         {"blows_up_from", "diverges from (rad)"},
         {"damps_from", "loses 10 % of its energy from (rad)"},
         {"energy_left", "remaining energy at this point"},
         {"momentum_off_there", "error of the direction of L at this point (rad)"},
         {"gains_from", "gains 10 % energy from (rad)"},
         {"attitude_alone_from", "|L| within 1e-6 but attitude error above 0.1 rad from (rad)"},
         {"momentum_off_then", "error of the direction of L at that point (rad)"},
         {"attitude_off_then", ""},
         {"runs_within_0.1", "fraction of runs within 0.1 rad"}});
    for (const MethodMap& m : maps) {
        if (m.method->family != Family::engine_update) continue;
        const CellAngle diverging =
            find_smallest_angle(map, m, [](const MapCell& c) { return c.outcome == Outcome::diverged; });
        const CellAngle losing = find_smallest_angle(map, m, [](const MapCell& c) { return c.energy_ratio < 0.9; });
        const CellAngle gaining = find_smallest_angle(map, m, [](const MapCell& c) { return c.energy_ratio > 1.1; });
        const CellAngle attitude_only = find_smallest_angle(
            map, m, [](const MapCell& c) { return std::abs(c.momentum_ratio - 1) < 1e-6 && c.attitude_error > 0.1; });
        const auto angle = [](const CellAngle& found) { return found.cell ? Cell(found.angle) : Cell(); };
        const auto of = [](const CellAngle& found, double MapCell::*what) {
            return found.cell ? Cell(found.cell->*what) : Cell();
        };
        const auto close =
            std::count_if(m.cells.begin(), m.cells.end(), [](const MapCell& c) { return c.outcome <= Outcome::close; });
        named.table.rows.push_back({std::string(m.method->name), angle(diverging), angle(losing),
                                    of(losing, &MapCell::energy_ratio), of(losing, &MapCell::momentum_angle),
                                    angle(gaining), angle(attitude_only), of(attitude_only, &MapCell::momentum_angle),
                                    of(attitude_only, &MapCell::attitude_error),
                                    static_cast<double>(close) / static_cast<double>(m.cells.size())});
    }
    return named;
}

}  // namespace

Findings run_step_maps(std::span<const Method* const> methods, int jobs, bool quick) {
    Findings result;
    NamedTable rows{"maps",
                    "",
                    {{"method", "map", "x", "step_least", "step_largest", "outcome", "attitude_error_least",
                      "attitude_error_largest"},
                     {}}};
    rows.only_csv = true;
    NamedTable gyroscopic;
    for (const StepMap& map : {stiffness_map(jobs, quick), spin_map(jobs, quick)}) {
        const std::vector<MethodMap> maps = run_map(map, methods, jobs);
        add_rows(rows.table, map, maps);
        add_figures(result.figures, map, maps);
        if (map.name == "spin") gyroscopic = gyroscopic_table(map, maps);
    }
    result.tables = {std::move(rows), std::move(gyroscopic)};
    return result;
}

}  // namespace polhode
