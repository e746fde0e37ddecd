// An experiment: which scenes by which methods at which settings, and what is made of the rows.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/plan/kind.h"
#include "experiment/plan/method_style.h"
#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// A JSON pointer into the scene and the values (JSON texts) it takes in turn.
struct Variation {
    std::string pointer;
    std::vector<std::string> values;
};

struct Experiment {
    std::string name, about;
    const ExperimentKind* kind = &kinds().front();
    std::vector<std::string> scenes, methods;  ///< names, paths of scenes, or /regular expressions/
    std::vector<double> steps;                 ///< s, from coarse to fine
    std::vector<double> tolerances;            ///< relative, from coarse to fine
    /// Of a `conservation` experiment: right-hand sides a revolution; steps and tolerances are found for each method.
    std::vector<double> evaluations_per_revolution;
    std::vector<Variation> vary;  ///< all combinations are run
    long samples = 100;
    int repeats = 5;                 ///< largest number of rounds of timing
    double seconds_per_run = 10;     ///< a run beyond it is `failed`, and its curve is cut there
    long max_steps = 1'000'000'000;  ///< steps after which a run fails
    /// Likewise, of right-hand sides: unlike the clock it says the same on every machine and for any number of jobs.
    long max_evaluations = std::numeric_limits<long>::max();
    std::string text{};  ///< of its file, as it was read; empty where it was made otherwise
};

/// An experiment file's text; `file` is named in errors. Throws InputError.
Experiment parse_experiment(std::string_view text, const std::string& file);

/// A built-in experiment by name, or the file at that path. Throws InputError.
Experiment find_experiment(const std::string& name_or_path);

/// A scene of the plan, as varied.
struct PlannedScene {
    std::string label;  ///< NAME, or NAME{/pointer=value}
    Scene scene;
    std::string canonical;  ///< its canonical JSON: its identity
};

enum class SettingKind { none, step, tolerance };
const char* name_of(SettingKind kind);

/// One method by one kind of setting: a curve of the picture.
struct PlannedCurve {
    const Method* method;
    MethodStyle style;  ///< what it looks like in pictures
    SettingKind kind;
    std::vector<double> settings;  ///< one entry, not a number, where the kind is `none`
    Formulation formulation = Formulation::reduced;
    bool calibrated = false;  ///< `settings` are evaluations a revolution, to be turned into steps or tolerances
};

struct Plan {
    Experiment experiment;
    std::vector<PlannedScene> scenes;
    std::vector<PlannedCurve> curves;
    bool quick = false;  ///< a part of what the experiment asks for
    std::string file{};  ///< what the experiment was read from, or the name of a built-in one
};

/// Whether any method of the plan is described by another name in the text that it is from.
bool is_described(const Plan& plan);

/// Which files `scenes` may name.
enum class NamedFiles {
    beside,    ///< those in the folder of the experiment's file, and below it, if allow_outside_files() allows no more
    anywhere,  ///< all: the experiment is the caller's own
};

/// Resolves names and patterns and all variations. Throws InputError (file = `file`) on a name or pattern that
/// matches nothing, a pointer that no scene has, or a file outside the folder of `file` where `which` says so, or
/// what is beyond plan_limits.h. `quick` keeps every third setting, from the coarsest, and cuts
/// repeats to 3 and runs to 10^5 evaluations.
Plan make_plan(const Experiment& experiment, const std::string& file, bool quick,
               NamedFiles which = NamedFiles::beside);

}  // namespace polhode
