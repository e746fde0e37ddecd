#include "integrators/own/mechanism_ensemble.h"

#include <cmath>
#include <exception>
#include <stdexcept>

#include "integrators/method.h"
#include "motion/problem.h"
#include "text/parallel.h"

namespace polhode {
namespace {

MechanismRow solved_row(const Scene& scene, long samples, const EnsembleSettings& settings) {
    MechanismRow row;
    try {
        const Problem problem = pose(scene);
        const Choice choice = choose_method(problem, settings.tolerance);
        Settings run;
        run.samples = samples, run.max_steps = settings.max_steps, run.seconds_limit = settings.seconds_limit;
        if (takes_tolerance(*choice.method)) run.tolerance = settings.tolerance;
        Trajectory trajectory = solve(problem, *choice.method, with_defaults(problem, *choice.method, run));
        row.status = trajectory.status;
        if (trajectory.status != Status::ok) row.message = std::move(trajectory.message);
        const std::ptrdiff_t start = std::ssize(scene.bodies);
        if (std::ssize(trajectory.samples) > start)
            row.samples.assign(trajectory.samples.begin() + start, trajectory.samples.end());
    } catch (const std::exception& error) {
        row.status = Status::failed, row.message = error.what();
    }
    return row;
}

}  // namespace

std::vector<MechanismRow> solve_mechanism_ensemble(const Scene& scene, const MechanismTable& table, long samples,
                                                   const EnsembleSettings& settings) {
    if (!(settings.tolerance > 0) || !std::isfinite(settings.tolerance))
        throw std::invalid_argument("an ensemble's tolerance is finite and > 0");
    if (settings.threads < 1 || settings.max_steps < 1 || !(settings.seconds_limit > 0) || samples < 1)
        throw std::invalid_argument("an ensemble has at least one thread, one step, one sample and some time");
    std::vector<MechanismRow> rows(table.rows());
    parallel_for(rows.size(), settings.threads,
                 [&](std::size_t k) { rows[k] = solved_row(table.scene_of(scene, k), samples, settings); });
    return rows;
}

}  // namespace polhode
