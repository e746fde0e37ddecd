// Times of the same work without Python, to measure the overhead of the module within one process.
#include <limits>

#include "integrators/own/ensemble.h"
#include "python/bindings.h"

namespace polhode::python {
namespace {

// Returns the shortest time (s) of `repeats` calls of solve() with the posed problem, as from a C++ program.
double seconds_of_solve(const ReadScene& scene, const std::string& method, const Settings& settings, int repeats) {
    return call([&] {
        const std::shared_ptr<const Problem> problem = scene.problem(Formulation::reduced, false);
        const Method& taken = method_by_name(method);
        double shortest = std::numeric_limits<double>::infinity();
        for (int i = 0; i < repeats; ++i) {
            const Stopwatch stopwatch;
            const Trajectory trajectory = solve(*problem, taken, settings);
            shortest = std::min(shortest, stopwatch.seconds());
        }
        return shortest;
    });
}

// Returns the shortest time (s) of `repeats` calls of solve_ensemble(), one body per angular velocity in `rates`.
double seconds_of_ensemble(const ReadScene& scene, const py::array_t<double, py::array::c_style>& rates, int threads,
                           int repeats) {
    const double* w = rates.data();
    const auto count = static_cast<std::size_t>(rates.shape(0));
    return call([&] {
        std::vector<EnsembleBody> bodies(count, ensemble_body(scene.scene()));
        for (std::size_t i = 0; i < count; ++i) bodies[i].angular_velocity = {w[3 * i], w[3 * i + 1], w[3 * i + 2]};
        EnsembleSettings settings;
        settings.threads = threads;
        double shortest = std::numeric_limits<double>::infinity();
        for (int i = 0; i < repeats; ++i) {
            const Stopwatch stopwatch;
            const std::vector<EnsembleRow> rows = solve_ensemble(scene.scene(), bodies, settings);
            shortest = std::min(shortest, stopwatch.seconds());
        }
        return shortest;
    });
}

}  // namespace

void bind_measuring(py::module_& module) {
    module.def("seconds_of_solve", &seconds_of_solve);
    module.def("seconds_of_ensemble", &seconds_of_ensemble);
}

}  // namespace polhode::python
