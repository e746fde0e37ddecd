// Why a trajectory is wrong: known faults of engines and their files, each tried as a hypothesis, and which known
// update its engine steps by.
//
// A fault is named only where with it the file is predicted about ten times better than without, summed over the
// questions of check/evidence.h, whatever the engine's update may be: what a low order or a coarse step does to a sound
// method is no such fault, and is told as that.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// One fault that explains a file.
struct Diagnosis {
    std::string fault;       ///< a word for programs: "gyroscopic_term_missing", ..
    std::string message;     ///< one line for people: what, on which evidence, what to do
    std::string convention;  ///< the --convention that would mend the file; empty where none does
    double error = 0;        ///< how far the file is from what is predicted without it, relative to what moves
    double explained = 0;    ///< the same with it
};

/// A method of the catalogue that a file follows.
struct FollowedUpdate {
    std::string method;             ///< its name
    std::string message;            ///< one line for people
    double step = 0;                ///< s
    double distance = 0;            ///< rad, the largest from the file to the method's motion
    double error = 0;               ///< rad, the largest from the file to the scene's motion, over the same rows
    bool matches = false;           ///< to rounding; else it resembles it
    std::optional<double> left_at;  ///< s, the first row that no longer matches
};

/// What was tried, and how far the file is from what it predicts.
struct Tried {
    std::string fault, what;
    double decades = 0;  ///< summed over the questions; lower is nearer
};

/// What is known of a file's errors.
struct Diagnosed {
    std::vector<Diagnosis> faults;         ///< what explains it; several that cannot be told apart say so
    std::optional<FollowedUpdate> update;  ///< where no fault was found and one is followed
    std::vector<Tried> tried;              ///< all hypotheses that mean anything in the scene, the best first
    double sound = 0;                      ///< decades without any fault
    std::string rule;                      ///< the kind of update that fits best, for people; empty: nothing was tried
};

/// The faults that explain a file; none where it is within 1e-4 of the scene's motion, or nothing known explains it.
/// Looks at a few dozen steps of the file. `all` tries them on a sound file too. Throws InputError on an invalid scene.
Diagnosed diagnose(const Scene& scene, const TrajectoryFile& file, bool all = false);

}  // namespace polhode
