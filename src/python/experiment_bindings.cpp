// Experiments: runs a description and writes files, which Python reads as tables.
#include <thread>

#include "experiment/plan/experiment.h"
#include "experiment/run/run_experiment.h"
#include "python/bindings.h"

namespace polhode::python {
namespace {

// Runs one experiment at a time, because timings must not share the machine and an interruption stops all runs.
bool run_text(const std::string& text, const std::string& file, const std::string& directory, const std::string& filter,
              int jobs, bool quick, bool quiet, bool own) {
    static std::mutex one_at_a_time;
    RunOptions options;
    options.directory = directory, options.filter = filter, options.quick = quick, options.quiet = quiet;
    options.jobs = jobs > 0 ? jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    return call_in_thread(
        [&] {
            const std::lock_guard lock(one_at_a_time);
            allow_sweeps();
            const Plan plan =
                make_plan(parse_experiment(text, file), file, quick, own ? NamedFiles::anywhere : NamedFiles::beside);
            return run_experiment(plan, options, "polhode.run(" + plan.experiment.name + ")");
        },
        interrupt_sweep);
}

}  // namespace

void bind_experiments(py::module_& module) { module.def("run", &run_text); }

}  // namespace polhode::python
