#include "experiment/plan/experiment_keys.h"

namespace polhode {

std::span<const FileKey> experiment_keys() {
    static constexpr FileKey all[] = {
        {"experiment", "name", "text", "", "required", "\"mine\"",
         "1 to 64 letters, digits, _ or -; the name of its tables"},
        {"experiment", "about", "text", "", "none", "\"RK4 against CVODE\"", "one sentence"},
        {"experiment", "kind", "text", "", "\"sweep\"", "\"convergence\"", "how the rows are evaluated, see below"},
        {"experiment", "scenes", "list of texts", "", "required by most kinds", "[\"lagrange_top\", \"/^free/\"]",
         "names, paths of scene files, or regular expressions over the catalogue between slashes"},
        {"experiment", "methods", "list of texts", "", "required by most kinds", "[\"taylor\", \"/^cvode/\"]",
         "names, or regular expressions over polhode list methods between slashes"},
        {"experiment", "settings", "object", "", "required where a method takes one", "{\"tolerances\": [1e-6, 1e-9]}",
         "the steps and tolerances to run at"},
        {"experiment", "vary", "object", "", "none", "{\"/loads/0/stiffness\": [1, 10]}",
         "JSON pointers into the scene and the values each takes in turn; all combinations are run"},
        {"experiment", "samples", "whole number", "", "100", "200", "how many samples the errors are measured at"},
        {"experiment", "repeats", "whole number", "", "5", "3",
         "at most this many rounds of timing; methods take turns within a round"},
        {"experiment", "seconds_per_run", "number > 0", "s", "10", "2",
         "a run beyond it is failed, and its curve is marked as cut there"},
        {"experiment", "max_steps", "whole number", "", "10^9", "100000",
         "steps after which a run fails; the same on every machine"},
        {"experiment", "max_evaluations", "whole number", "", "none", "1000000",
         "right-hand-side evaluations after which a run fails"},

        {"settings", "steps", "list or range", "s", "none", "[0.1, 0.01]", "of methods that take a step"},
        {"settings", "tolerances", "list or range", "", "none", "{\"from\": 1e-2, \"to\": 1e-14, \"count\": 7}",
         "relative, of methods that take a tolerance"},
        {"settings", "evaluations_per_revolution", "list or range", "", "none", "[50, 100]",
         "in a conservation: steps and tolerances are found from it for each method"},

        {"range", "from", "number > 0", "", "required", "1e-2", "the first value"},
        {"range", "to", "number > 0", "", "required", "1e-14", "the last value"},
        {"range", "count", "whole number", "", "required", "7", "how many, evenly in their logarithms"},
    };
    return all;
}

}  // namespace polhode
