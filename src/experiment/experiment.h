// An experiment: which scenes by which methods at which settings, and what is made of the rows.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/method.h"
#include "scene/scene.h"

namespace polhode {

/// What is made of the rows: `sweep` draws error against run time, `convergence` fits orders and draws error against
/// step and tolerance, `drift` keeps the errors over time.
enum class Kind { sweep, convergence, drift };

/// A JSON pointer into the scene and the values (JSON texts) it takes in turn.
struct Variation {
    std::string pointer;
    std::vector<std::string> values;
};

struct Experiment {
    std::string name, about;
    Kind kind = Kind::sweep;
    std::vector<std::string> scenes, methods;  ///< names, paths of scenes, or /regular expressions/
    std::vector<double> steps;                 ///< s, from coarse to fine
    std::vector<double> tolerances;            ///< relative, from coarse to fine
    std::vector<Variation> vary;               ///< all combinations are run
    long samples = 100;
    int repeats = 5;                 ///< rounds of timing, at the most
    double seconds_per_run = 10;     ///< a run beyond it is `failed`, and its curve is cut there
    long max_steps = 1'000'000'000;  ///< likewise
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
    int color;  ///< the method's place in methods(): its colour in every picture
    SettingKind kind;
    std::vector<double> settings;  ///< one entry, not a number, where the kind is `none`
};

struct Plan {
    Experiment experiment;
    std::vector<PlannedScene> scenes;
    std::vector<PlannedCurve> curves;
};

/// Resolves names and patterns and all variations. Throws InputError (file = `file`) on a name or pattern that
/// matches nothing, or a pointer that no scene has. `quick` keeps every third setting, from the coarsest, and cuts
/// repeats to 3 and runs to 0.05 s.
Plan make_plan(const Experiment& experiment, const std::string& file, bool quick);

}  // namespace polhode
