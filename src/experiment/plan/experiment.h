// An experiment: scenes, methods, settings, and the kind that evaluates the rows.
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

/// A JSON pointer into the scene and its values, as JSON texts.
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
    /// Kind `conservation` only: right-hand-side evaluations per revolution. calibrate() finds each method's step or
    /// tolerance from it.
    std::vector<double> evaluations_per_revolution;
    std::vector<Variation> vary;  ///< all combinations are run
    long samples = 100;
    int repeats = 5;                 ///< largest number of timing rounds
    double seconds_per_run = 10;     ///< a longer run is `failed`, and its curve is cut there
    long max_steps = 1'000'000'000;  ///< steps after which a run fails
    /// Right-hand-side evaluations after which a run fails. Unlike a time limit, it gives the same rows on every
    /// machine and for any number of jobs.
    long max_evaluations = std::numeric_limits<long>::max();
    std::string text{};  ///< the file's text; empty if the experiment was not read from a file
};

/// Parses the text of an experiment file; `file` names it in errors. Throws InputError.
Experiment parse_experiment(std::string_view text, const std::string& file);

/// Finds a built-in experiment by name, or reads the file at that path. Throws InputError.
Experiment find_experiment(const std::string& name_or_path);

/// A scene of the plan, with its variation applied.
struct PlannedScene {
    std::string label;  ///< NAME, or NAME{/pointer=value}
    Scene scene;
    std::string canonical;  ///< canonical JSON, part of the key of stored cases
};

enum class SettingKind { none, step, tolerance };
const char* name_of(SettingKind kind);

/// One method with one kind of setting: one curve of a figure.
struct PlannedCurve {
    const Method* method;
    MethodStyle style;
    SettingKind kind;
    std::vector<double> settings;  ///< a single NaN if the kind is `none`
    Formulation formulation = Formulation::reduced;
    bool calibrated = false;  ///< `settings` are evaluations per revolution; see calibrate()
};

struct Plan {
    Experiment experiment;
    std::vector<PlannedScene> scenes;
    std::vector<PlannedCurve> curves;
    bool quick = false;  ///< reduced settings and limits; see make_plan()
    std::string file{};  ///< the path of the experiment's file, or the name of a built-in experiment
};

/// Whether Method::origin is set for any method of the plan.
bool has_source_descriptions(const Plan& plan);

/// Which files `scenes` may name.
enum class NamedFiles {
    beside,    ///< files in the directory of the experiment's file and below, unless allow_outside_files() is set
    anywhere,  ///< all files; for experiments that the caller wrote
};

/// Resolves names, patterns and variations. Throws InputError (file = `file`) if a name is unknown, a pattern matches
/// nothing, a pointer does not exist in a scene, a file is not allowed by `which`, or a limit of plan_limits.h is
/// exceeded. `quick` keeps every third setting, from the coarsest, and limits repeats to 3 and runs to 10^5
/// evaluations.
Plan make_plan(const Experiment& experiment, const std::string& file, bool quick,
               NamedFiles which = NamedFiles::beside);

}  // namespace polhode
