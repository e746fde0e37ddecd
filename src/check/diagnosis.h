// Why a trajectory is wrong: known faults of engines, each tried as a hypothesis.
//
// A fault predicts a motion. It is named only where its prediction lies at least ten times nearer to the file than the
// scene's own motion does: what a low order or a coarse step does to a sound method is no such fault, since none of
// these describes it to a tenth.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// What an engine may do to Euler's equations: I dw/dt = tau - gyroscopic w x I w - damping I w, |w| <= speed_limit,
/// dv/dt = .. - linear_damping v.
struct Alteration {
    double gyroscopic = 1;                                         ///< 0: the term is missing; -1: its sign is reversed
    double damping = 0;                                            ///< 1/s
    double linear_damping = 0;                                     ///< 1/s
    double speed_limit = std::numeric_limits<double>::infinity();  ///< rad/s
};

/// Solves an altered scene at times (s, increasing from 0 or later) to about six digits. Fewer samples than times where
/// that takes too long.
using AlteredMotion =
    std::function<std::vector<Sample>(const Scene&, const Alteration&, const std::vector<double>& times)>;

struct Diagnosis {
    std::string fault;       ///< a word for programs: "gyroscopic_term_missing", ..
    std::string message;     ///< one line for people: what, on which evidence, what to do
    std::string convention;  ///< the --convention that would mend the file; empty where none does
    double error = 0;        ///< the file's own, rad or relative: root mean square over the rows compared
    double explained = 0;    ///< what is left of it under the hypothesis
};

/// The faults that explain a file, the best first; none where the file is within 1e-4 of the scene's motion, or nothing
/// known explains it. Looks at some hundreds of rows at most, from the first on, until the error has become plain.
std::vector<Diagnosis> diagnose(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion);

}  // namespace polhode
