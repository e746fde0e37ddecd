// Maps of outcomes: every fixed-step method on a grid of step x stiffness and on one of step x spin.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "body/elementary.h"
#include "experiment/kinds/stability.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/truth/reference.h"
#include "measure/stability.h"
#include "text/parallel.h"

namespace polhode {
namespace {

/// One column of a map: a scene, and the samples of its runs.
struct MapColumn {
    double x = 0;
    Problem problem;
    Reference truth;
    Vector3<double> momentum_W;  ///< kg m^2/s, of the truth at its end
    double energy = 0;           ///< J, kinetic, likewise
};

struct StepMap {
    std::string name, title, x_label;
    long samples = 0;
    double interval = 0;  ///< s, between two samples: of every column
    std::vector<MapColumn> columns;
    std::vector<long> divisions;  ///< whole steps for one interval, from fine to coarse
    double step(std::size_t row) const { return interval / static_cast<double>(divisions[row]); }
};

/// What became of one run.
struct MapCell {
    Outcome outcome = Outcome::unsupported;
    double attitude_error = std::numeric_limits<double>::quiet_NaN();  ///< rad, largest
    // of a run that reached its end, against the truth's end
    double energy_ratio = std::numeric_limits<double>::quiet_NaN();
    double momentum_ratio = std::numeric_limits<double>::quiet_NaN();  ///< of lengths
    double momentum_angle = std::numeric_limits<double>::quiet_NaN();  ///< rad, between the vectors
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

Vector3<double> momentum_W(const Problem& problem, const Quaternion<double>& q, const Vector3<double>& w_B) {
    return (1 / squared_norm(q)) * rotate(q, problem.body.inertia_B * w_B);
}
double kinetic_energy(const Problem& problem, const Vector3<double>& w_B) {
    return 0.5 * dot(w_B, problem.body.inertia_B * w_B);
}

MapColumn column_of(const Scene& scene, double x, long samples) {
    MapColumn column{x, pose(scene), reference(scene, samples), {}, 0};
    if (!column.truth.available) return column;
    const Sample end = column.truth.samples.back().rounded();
    column.momentum_W = momentum_W(column.problem, end.q, end.angular_velocity_B);
    column.energy = kinetic_energy(column.problem, end.angular_velocity_B);
    return column;
}

/// Drag c about a principal axis of a body of three moments, and the torque that keeps 1 rad/s: from 2 rad/s on the
/// motion has turned by about 2 rad at its end, however stiff.
StepMap stiffness_map(int jobs, bool quick) {
    StepMap map{"stiffness", "step against stiffness",        "drag / moment (1/s)", 2, 1,
                {},          divisions(10'000, quick ? 1 : 5)};
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

/// A free body of three moments, spun about no axis of its own.
StepMap spin_map(int jobs, bool quick) {
    StepMap map{"spin", "step against spin", "spin (rad/s)", 20, 0.1, {}, divisions(1000, quick ? 2 : 7)};
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
    // a run stays far below both; a method whose step never ends is `failed`
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
    const Sample& end = run.samples.back();
    const Vector3<double> L = momentum_W(column.problem, end.q, end.angular_velocity_B);
    cell.energy_ratio = kinetic_energy(column.problem, end.angular_velocity_B) / column.energy;
    cell.momentum_ratio = hypotenuse(L) / hypotenuse(column.momentum_W);
    cell.momentum_angle = std::atan2(hypotenuse(cross(L, column.momentum_W)), dot(L, column.momentum_W));
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
        // from the coarsest on: what is refused is refused at every step
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

// neighbours in steps that ended alike are one row
void add_rows(Table& table, const StepMap& map, const std::vector<MethodMap>& maps) {
    const std::size_t columns = map.columns.size(), rows = map.divisions.size();
    for (const MethodMap& m : maps)
        for (std::size_t i = 0; i < columns; ++i)
            for (std::size_t begin = 0, end = 0; begin < rows; begin = end) {
                const Outcome outcome = m.cells[begin * columns + i].outcome;
                double least = std::numeric_limits<double>::infinity(), most = -least;
                for (end = begin; end < rows && m.cells[end * columns + i].outcome == outcome; ++end) {
                    const double error = m.cells[end * columns + i].attitude_error;
                    if (std::isfinite(error)) least = std::min(least, error), most = std::max(most, error);
                }
                if (outcome == Outcome::unsupported || outcome == Outcome::no_truth) continue;
                const auto known = [](double v) { return std::isfinite(v) ? Cell(v) : Cell(); };
                table.rows.push_back({std::string(m.method->name), map.name, map.columns[i].x, map.step(begin),
                                      map.step(end - 1), std::string(name_of(outcome)), known(least), known(most)});
            }
}

// a class of the pictures and of the table of shares, from good to bad
constexpr std::array shown{Outcome::accurate,       Outcome::close,    Outcome::wrong_but_bounded,
                           Outcome::damped_to_rest, Outcome::diverged, Outcome::failed};
constexpr std::array<int, shown.size()> shades{0, 1, 2, 4, 6, 7};

int class_of(Outcome outcome) {
    // a solver's word for a fixed step whose equations it could not solve
    if (outcome == Outcome::tolerance_not_met) outcome = Outcome::failed;
    const auto at = std::find(shown.begin(), shown.end(), outcome);
    return at == shown.end() ? -1 : static_cast<int>(at - shown.begin());
}

void add_shares(Table& table, const StepMap& map, const std::vector<MethodMap>& maps) {
    for (const MethodMap& m : maps) {
        std::array<long, shown.size()> count{};
        long runs = 0;
        for (const MapCell& cell : m.cells)
            if (const int c = class_of(cell.outcome); c >= 0) ++count[static_cast<std::size_t>(c)], ++runs;
        std::vector<Cell> row{std::string(m.method->name), map.name, runs};
        for (const long n : count) row.emplace_back(n);
        row.push_back(cell_of(real_interval(*m.method)));
        row.push_back(cell_of(imaginary_interval(*m.method)));
        for (Cell& cell : row)
            if (const double* value = std::get_if<double>(&cell); value && std::isinf(*value))
                cell = std::string("any");
        table.rows.push_back(std::move(row));
    }
}

void add_figures(std::vector<NamedFigure>& figures, const StepMap& map, const std::vector<MethodMap>& maps) {
    constexpr std::size_t page = 16;
    std::vector<MapClass> classes;
    for (std::size_t c = 0; c < shown.size(); ++c) classes.push_back({name_of(shown[c]), shades[c]});
    classes[0].label = "within 0.001 rad", classes[1].label = "within 0.1 rad";
    const std::size_t rows = map.divisions.size();
    const std::size_t pages = (maps.size() + page - 1) / page;
    for (std::size_t p = 0; p < pages; ++p) {
        Figure figure;
        figure.title = fmt::format("What comes of a run: {}{}", map.title,
                                   pages > 1 ? fmt::format(" ({} of {})", p + 1, pages) : "");
        figure.columns = 4, figure.shared_axes = true;
        bool theory = false;
        for (std::size_t k = p * page; k < std::min(maps.size(), (p + 1) * page); ++k) {
            const Method& method = *maps[k].method;
            Panel panel{std::string(method.name), map.x_label, "step (s)", true, true, {}};
            OutcomeMap outcomes;
            outcomes.classes = classes;
            for (const MapColumn& column : map.columns) outcomes.x.push_back(column.x);
            for (std::size_t row = 0; row < rows; ++row) outcomes.y.push_back(map.step(row));
            for (const MapCell& cell : maps[k].cells) outcomes.cells.push_back(class_of(cell.outcome));
            const std::optional<double> interval =
                map.name == "stiffness" ? real_interval(method) : std::optional<double>();
            if (interval && *interval > 0 && std::isfinite(*interval)) {
                Curve limit;
                limit.label = "linear theory's limit", limit.color = 1, limit.points = false;
                for (const double x : decades(std::log10(outcomes.x.front()), std::log10(outcomes.x.back()), 4))
                    if (const double h = *interval / x; h >= outcomes.y.front() && h <= outcomes.y.back())
                        limit.x.push_back(x), limit.y.push_back(h);
                if (!limit.x.empty()) panel.curves.push_back(std::move(limit)), theory = true;
            }
            panel.map = std::move(outcomes);
            figure.panels.push_back(std::move(panel));
        }
        figure.note = map.name == "stiffness"
                          ? "A body about a principal axis under drag and the torque that keeps 1 rad/s, from 2 rad/s, "
                            "2 s; three samples."
                          : "A free body of moments 1, 2, 3, w = (2, 6, 3)/7 of the spin, 2 s; twenty-one samples.";
        if (theory) figure.note += " Without a line the limit is none, or beyond the map.";
        figures.push_back({fmt::format("stability_map_{}{}", map.name, pages > 1 ? fmt::format("_{}", p + 1) : ""),
                           std::move(figure)});
    }
}

// the row of least h w whose cell passes, and that cell
struct Found {
    double turned = std::numeric_limits<double>::infinity();  ///< h w, rad a step
    const MapCell* cell = nullptr;
};
template <class Passes>
Found least_turn(const StepMap& map, const MethodMap& m, const Passes& passes) {
    Found found;
    const std::size_t columns = map.columns.size();
    for (std::size_t k = 0; k < m.cells.size(); ++k) {
        const double turned = map.step(k / columns) * map.columns[k % columns].x;
        if (turned < found.turned && passes(m.cells[k])) found = {turned, &m.cells[k]};
    }
    return found;
}

NamedTable gyroscopic_table(const StepMap& map, const std::vector<MethodMap>& maps) {
    NamedTable named =
        headed_table("gyroscopic",
                     "What the gyroscopic updates of game engines do to a free body: least step times spin (rad) at "
                     "which it happens within 2 s",
                     {{"method", "method"},
                      {"blows_up_from", "diverges from (rad)"},
                      {"damps_from", "loses 10 % of its energy from (rad)"},
                      {"energy_left", "energy left there"},
                      {"momentum_off_there", "direction of L off there (rad)"},
                      {"gains_from", "gains 10 % from (rad)"},
                      {"attitude_alone_from", "|L| within 1e-6, attitude 0.1 rad off from (rad)"},
                      {"momentum_off_then", "direction of L off then (rad)"},
                      {"attitude_off_then", ""},
                      {"runs_within_0.1", "share of runs within 0.1 rad"}});
    for (const MethodMap& m : maps) {
        if (m.method->family != Family::engine_update) continue;
        const Found blown = least_turn(map, m, [](const MapCell& c) { return c.outcome == Outcome::diverged; });
        const Found damped = least_turn(map, m, [](const MapCell& c) { return c.energy_ratio < 0.9; });
        const Found gaining = least_turn(map, m, [](const MapCell& c) { return c.energy_ratio > 1.1; });
        const Found alone = least_turn(
            map, m, [](const MapCell& c) { return std::abs(c.momentum_ratio - 1) < 1e-6 && c.attitude_error > 0.1; });
        const auto turned = [](const Found& found) { return found.cell ? Cell(found.turned) : Cell(); };
        const auto of = [](const Found& found, double MapCell::*what) {
            return found.cell ? Cell(found.cell->*what) : Cell();
        };
        const auto close =
            std::count_if(m.cells.begin(), m.cells.end(), [](const MapCell& c) { return c.outcome <= Outcome::close; });
        named.table.rows.push_back(
            {std::string(m.method->name), turned(blown), turned(damped), of(damped, &MapCell::energy_ratio),
             of(damped, &MapCell::momentum_angle), turned(gaining), turned(alone), of(alone, &MapCell::momentum_angle),
             of(alone, &MapCell::attitude_error), static_cast<double>(close) / static_cast<double>(m.cells.size())});
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
    NamedTable shares{"maps_shares", "How the runs of the maps ended", {{"method", "map", "runs"}, {}}};
    for (const Outcome outcome : shown) shares.table.columns.emplace_back(name_of(outcome));
    shares.table.columns.insert(shares.table.columns.end(), {"real_interval", "imaginary_interval"});
    NamedTable gyroscopic;
    for (const StepMap& map : {stiffness_map(jobs, quick), spin_map(jobs, quick)}) {
        const std::vector<MethodMap> maps = run_map(map, methods, jobs);
        add_rows(rows.table, map, maps);
        add_shares(shares.table, map, maps);
        add_figures(result.figures, map, maps);
        if (map.name == "spin") gyroscopic = gyroscopic_table(map, maps);
    }
    result.tables = {std::move(rows), std::move(shares), std::move(gyroscopic)};
    return result;
}

}  // namespace polhode
