// Diagnosis of a wrong trajectory: known faults of engines and files are tested as hypotheses, and the update that
// the engine uses is identified.
//
// A fault is diagnosed only if it improves the prediction of the file about ten times, summed over the questions of
// check/evidence.h, whatever the engine's update is. The truncation error of a sound method with a low order or a
// coarse step is not a fault; it is reported as an update.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// One fault that explains a file.
struct Diagnosis {
    std::string fault;       ///< identifier for programs: "gyroscopic_term_missing", ..
    std::string message;     ///< one line for users: fault, remedy, prediction errors
    std::string convention;  ///< the --convention that corrects the file; empty if there is none
    double error = 0;        ///< relative prediction error without the fault
    double explained = 0;    ///< relative prediction error with the fault
};

/// An update of the catalogue that a file follows.
struct UpdateMatch {
    std::string method;                    ///< its name
    std::string message;                   ///< one line for users
    double step = 0;                       ///< s
    double distance = 0;                   ///< largest attitude difference between file and method, rad
    double error = 0;                      ///< largest attitude error of the file over the same rows, rad
    bool matches = false;                  ///< the file matches the method to rounding; else it resembles it
    std::optional<double> departure_time;  ///< time of the first row that no longer matches, s
};

/// A hypothesis that was tested, and its prediction error.
struct TestedHypothesis {
    std::string fault, what;
    double decades = 0;  ///< log10 of the prediction error, summed over the questions
};

/// The result of a diagnosis.
struct FileDiagnosis {
    std::vector<Diagnosis> faults;             ///< the diagnoses; indistinguishable ones are marked
    std::optional<UpdateMatch> update;         ///< the update that the file follows, if there is no fault
    std::vector<TestedHypothesis> hypotheses;  ///< all hypotheses that apply to the scene, the best first
    double sound = 0;                          ///< decades without a fault, as in TestedHypothesis
    std::string rule;                          ///< the update that fits best, for users; empty if nothing was tested
};

/// Diagnoses a file by a few dozen of its steps. The result has no faults if the file is within 1e-4 of the scene's
/// motion or no known fault explains it. `all`: test all faults on a sound file too. Throws InputError for an invalid
/// scene.
FileDiagnosis diagnose(const Scene& scene, const TrajectoryFile& file, bool all = false);

}  // namespace polhode
