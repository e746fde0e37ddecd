// The kind `ensembles`: bodies per second of an ensemble on one thread, against the largest error among its bodies,
// compared with solving the same motions one by one.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "integrators/method.h"
#include "integrators/own/mechanism_ensemble.h"
#include "measure/measures.h"
#include "measure/statistics.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr std::size_t ensemble_size = 512;
constexpr double ensemble_duration = 10;
constexpr double tolerances[] = {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 5e-11, 1e-11, 1e-12, 1e-13};
constexpr double error_levels[] = {1e-6, 1e-9, 1e-12};

/// Quasi-random numbers that are the same on every machine: multiples of irrational steps modulo 1 (H. Weyl 1916,
/// Mathematische Annalen 77, 313).
class Draw {
  public:
    double uniform(double from, double to) {
        constexpr double steps[] = {0.618033988749894903, 0.414213562373095145, 0.732050807568877193,
                                    0.236067977499789805, 0.645751311064590716, 0.316624790355399807,
                                    0.605551275463989124, 0.123105625617660509};
        const std::size_t turn = 1 + count_ / std::size(steps);
        const double x = static_cast<double>(turn) * steps[count_ % std::size(steps)];
        ++count_;
        return from + (to - from) * (x - std::floor(x));
    }

  private:
    std::size_t count_ = 0;
};

/// Many variants of one motion.
struct Ensemble {
    std::string name;
    std::vector<Scene> scenes;  ///< one per member
    /// Returns the final samples of each member, one per body; empty for a failed member.
    std::function<std::vector<std::vector<Sample>>(double tolerance)> solve;
};

Scene free_scene() {
    Scene scene;
    scene.name = "ensemble", scene.duration = ensemble_duration;
    return scene;
}
/// A top with I = (1, 1, 0.5) about its pivot and m g l = 5.
Scene top_scene() {
    Scene scene = free_scene();
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.loads = {Gravity{{0, 0, -10}, {}}};
    return scene;
}
std::vector<EnsembleBody> free_bodies() {
    Draw draw;
    std::vector<EnsembleBody> bodies(ensemble_size);
    for (EnsembleBody& b : bodies) {
        b.inertia_B = diagonal(Vector3<double>(draw.uniform(0.5, 0.7), draw.uniform(0.7, 0.9), draw.uniform(0.9, 1.1)));
        b.angular_velocity = {draw.uniform(-1.5, 1.5), draw.uniform(-1.5, 1.5), draw.uniform(-1.5, 1.5)};
        const double half_turn = draw.uniform(-3, 3);
        b.orientation = {std::cos(half_turn), std::sin(half_turn), 0, 0};
    }
    return bodies;
}
/// Tops with masses and moments that vary by about 10 %, tilted and spinning at 17 to 23 rad/s.
std::vector<EnsembleBody> tops(bool symmetric) {
    Draw draw;
    std::vector<EnsembleBody> bodies(ensemble_size);
    for (EnsembleBody& b : bodies) {
        const double across = draw.uniform(0.65, 0.85), other = draw.uniform(0.65, 0.85);
        b.mass = draw.uniform(0.9, 1.1);
        b.inertia_B = diagonal(Vector3<double>(across, symmetric ? across : other, draw.uniform(0.45, 0.55)));
        const double half_tilt = draw.uniform(0.1, 0.6);
        b.orientation = {std::cos(half_tilt), std::sin(half_tilt), 0, 0};
        b.angular_velocity = {draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3), draw.uniform(17, 23)};
    }
    return bodies;
}

Ensemble make_body_ensemble(std::string name, const Scene& scene, const std::vector<EnsembleBody>& bodies) {
    Ensemble ensemble{std::move(name), {}, {}};
    for (const EnsembleBody& b : bodies) {
        Scene one = scene;
        one.body.mass = b.mass, one.body.inertia_B = b.inertia_B;
        one.initial.orientation = b.orientation, one.initial.angular_velocity = b.angular_velocity;
        ensemble.scenes.push_back(std::move(one));
    }
    ensemble.solve = [scene, bodies](double tolerance) {
        std::vector<std::vector<Sample>> ends;
        for (const EnsembleRow& row : solve_ensemble(scene, bodies, {.tolerance = tolerance})) {
            ends.emplace_back();
            if (row.status == Status::ok) ends.back().push_back(row.end);
        }
        return ends;
    };
    return ensemble;
}

/// The built-in scene mechanisms/double_pendulum, with each bar within 1 rad of the downward vertical.
Ensemble make_pendulum_ensemble() {
    const Scene scene = find_scene("mechanisms/double_pendulum");
    MechanismTable table;
    for (const MechanismColumn& column : mechanism_columns(scene))
        if (column.name == "shoulder.angle" || column.name == "elbow.angle") table.columns.push_back(column);
    Draw draw;
    for (std::size_t i = 0; i < ensemble_size * table.columns.size(); ++i) table.numbers.push_back(draw.uniform(-1, 1));
    Ensemble ensemble{"double pendulums", {}, {}};
    for (std::size_t k = 0; k < ensemble_size; ++k) ensemble.scenes.push_back(table.scene_of(scene, k));
    ensemble.solve = [scene, table](double tolerance) {
        std::vector<std::vector<Sample>> ends;
        for (MechanismRow& row : solve_mechanism_ensemble(scene, table, 1, {.tolerance = tolerance}))
            ends.push_back(row.status == Status::ok ? std::move(row.samples) : std::vector<Sample>());
        return ends;
    };
    return ensemble;
}

/// One way to solve all members, timed round by round.
struct Setting {
    double tolerance;
    bool batched;  ///< true: as an ensemble; false: posed and solved one by one with the method `auto`
    double worst_error = 0;
    std::vector<double> rates{};  ///< members per second
};

std::vector<Sample> solve_end(const Scene& scene, const char* method, double tolerance) {
    const Problem problem = pose(scene);
    const Method* const by = method ? find_method(method) : choose_method(problem, tolerance).method;
    Settings settings;
    settings.samples = 1;
    if (takes_tolerance(*by)) settings.tolerance = tolerance;
    const Trajectory run = solve(problem, *by, with_defaults(problem, *by, settings));
    if (run.status != Status::ok) return {};
    return {run.samples.end() - static_cast<std::ptrdiff_t>(run.samples.size() / 2), run.samples.end()};
}

/// The largest attitude error of all bodies, rad; infinite if a member failed.
double largest_error_of(const std::vector<std::vector<Sample>>& ends, const std::vector<std::vector<Sample>>& exact) {
    double worst = 0;
    for (std::size_t k = 0; k < ends.size(); ++k) {
        if (ends[k].size() != exact[k].size()) return std::numeric_limits<double>::infinity();
        for (std::size_t b = 0; b < ends[k].size(); ++b) {
            const Quaternion<double>& q = exact[k][b].q;
            worst = std::max(worst, attitude_error(ends[k][b].q, {{q.w, 0}, {q.x, 0}, {q.y, 0}, {q.z, 0}}));
        }
    }
    return worst;
}

void time_settings(const Ensemble& ensemble, std::vector<Setting>& settings, std::size_t count, int rounds) {
    std::vector<std::vector<Sample>> exact;
    for (const Scene& scene : ensemble.scenes) exact.push_back(solve_end(scene, "taylor", 1e-16));
    for (int round = 0; round < rounds; ++round)
        for (Setting& setting : settings) {
            std::vector<std::vector<Sample>> ends;
            const std::size_t solved = setting.batched ? ensemble_size : count;
            const auto begin = std::chrono::steady_clock::now();
            if (setting.batched)
                ends = ensemble.solve(setting.tolerance);
            else
                for (std::size_t k = 0; k < solved; ++k)
                    ends.push_back(solve_end(ensemble.scenes[k], nullptr, setting.tolerance));
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            setting.rates.push_back(static_cast<double>(solved) / seconds);
            setting.worst_error = std::max(setting.worst_error, largest_error_of(ends, exact));
        }
}

}  // namespace

Findings run_ensembles(const Plan& plan, const RunOptions& options) {
    const int rounds = options.quick ? 2 : plan.experiment.repeats;
    const std::size_t alone = options.quick ? 16 : 128;
    NamedTable all = make_named_table("all", "Members per second on one thread, by tolerance",
                                      {{"ensemble", "ensemble"},
                                       {"tolerance", "tolerance"},
                                       {"way", "solved"},
                                       {"worst_error", "largest error (rad)"},
                                       {"rate_median", "members per second"},
                                       {"rate_max", "best round"}});
    NamedTable table = make_named_table("", "",
                                        {{"ensemble", "ensemble"},
                                         {"error", "largest error (rad)"},
                                         {"tolerance", "tolerance"},
                                         {"rate_median", "members per second"},
                                         {"rate_max", "best round"},
                                         {"one_by_one", "one by one"},
                                         {"ratio", "factor"}});
    const std::vector<Ensemble> ensembles{make_body_ensemble("free bodies", free_scene(), free_bodies()),
                                          make_body_ensemble("Lagrange tops", top_scene(), tops(true)),
                                          make_body_ensemble("asymmetric tops", top_scene(), tops(false)),
                                          make_pendulum_ensemble()};
    for (const Ensemble& ensemble : ensembles) {
        std::vector<Setting> settings;
        for (const bool batched : {true, false})
            for (const double tolerance : tolerances) settings.push_back({tolerance, batched});
        time_settings(ensemble, settings, alone, rounds);
        for (const Setting& s : settings)
            all.table.rows.push_back({ensemble.name, s.tolerance,
                                      std::string(s.batched ? "as an ensemble" : "one by one"), s.worst_error,
                                      median(s.rates), *std::ranges::max_element(s.rates)});
        for (const double error : error_levels) {
            const auto fastest = [&](bool batched) -> const Setting* {
                const Setting* best = nullptr;
                for (const Setting& s : settings)
                    if (s.batched == batched && s.worst_error <= error &&
                        (!best || median(s.rates) > median(best->rates)))
                        best = &s;
                return best;
            };
            const Setting *const batched = fastest(true), *const one = fastest(false);
            std::vector<Cell> row{ensemble.name, error};
            if (batched) {
                const double rate = median(batched->rates);
                row.insert(row.end(), {batched->tolerance, rate, *std::ranges::max_element(batched->rates)});
                row.push_back(one ? Cell(median(one->rates)) : Cell());
                row.push_back(one ? Cell(rate / median(one->rates)) : Cell());
            } else {
                row.resize(table.table.columns.size());
            }
            table.table.rows.push_back(std::move(row));
        }
    }
    return {{std::move(table), std::move(all)}, {}};
}

}  // namespace polhode
