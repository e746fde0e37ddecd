#include "experiment/plan/experiment_keys.h"

namespace polhode {

std::span<const FileKey> experiment_keys() {
    static constexpr FileKey all[] = {
        {"experiment", "name", "text", "", "required", "\"mine\"",
         "1 to 64 letters, digits, _ or -; the name of its tables"},
        {"experiment", "about", "text", "", "none", "\"RK4 against CVODE\"",
         "one sentence about what the experiment shows"},
        {"experiment", "kind", "text", "", "\"sweep\"", "\"convergence\"", "how the rows are evaluated"},
        {"experiment", "scenes", "list of texts", "", "required by most kinds", "[\"lagrange_top\", \"/^free/\"]",
         "names, paths of scene files, or regular expressions between slashes, which select built-in scenes"},
        {"experiment", "methods", "list of texts", "", "required by most kinds", "[\"taylor\", \"/^cvode/\"]",
         "names, or regular expressions between slashes, which select methods"},
        {"experiment", "settings", "object", "", "required if a method takes one", "{\"tolerances\": [1e-6, 1e-9]}",
         "steps and tolerances of the runs"},
        {"experiment", "vary", "object", "", "none", "{\"/loads/0/stiffness\": [1, 10]}",
         "JSON pointers into the scene, with the values that each takes; all combinations are run"},
        {"experiment", "samples", "whole number", "", "100", "200",
         "number N of sample intervals; errors are measured at t = k T/N, k = 0..N"},
        {"experiment", "repeats", "whole number", "", "5", "3",
         "largest number of timing rounds; each round times every method once"},
        {"experiment", "seconds_per_run", "number > 0", "s", "10", "2",
         "time after which a run fails; its curve is marked as cut there"},
        {"experiment", "max_steps", "whole number", "", "10^9", "100000",
         "number of steps after which a run fails; the limit is the same on every machine"},
        {"experiment", "max_evaluations", "whole number", "", "none", "1000000",
         "number of right-hand-side evaluations after which a run fails"},

        {"settings", "steps", "list or range", "s", "none", "[0.1, 0.01]", "step sizes of methods that take a step"},
        {"settings", "tolerances", "list or range", "", "none", "{\"from\": 1e-2, \"to\": 1e-14, \"count\": 7}",
         "relative tolerances of methods that take a tolerance"},
        {"settings", "evaluations_per_revolution", "list or range", "", "none", "[50, 100]",
         "only for the kind conservation: evaluations per revolution, which determine each method's step or tolerance"},

        {"range", "from", "number > 0", "", "required", "1e-2", "first value"},
        {"range", "to", "number > 0", "", "required", "1e-14", "last value"},
        {"range", "count", "whole number", "", "required", "7", "number of values, spaced evenly in the logarithm"},
    };
    return all;
}

}  // namespace polhode
