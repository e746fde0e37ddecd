// One case of a sweep: a scene by a method at a setting.
#pragma once

#include <optional>
#include <string>

#include "experiment/plan/experiment.h"
#include "experiment/run/result.h"
#include "integrators/analysis/conditioning.h"
#include "motion/problem.h"

namespace polhode {

/// Where it stands in the plan, its key, and its result once there is one.
struct Case {
    const PlannedScene* scene;
    const PlannedCurve* curve;
    std::size_t rank;  ///< of the setting on its curve
    std::string key;
    std::optional<Result> result{};
    Settings settings{};  ///< what it was run with
    double spent = 0;     ///< s, on errors and timings

    double setting() const { return curve->settings[rank]; }
};

/// What a reader knows the case by, whatever program ran it: experiment, scene, method, setting.
std::string words_of(const Plan& plan, const Case& c);

/// Nothing where the conditioning is not known.
Floors floors_of(const Conditioning& conditioning);

/// The untimed run, which takes the steps of the timed one and looks at every sample. Sets all of the result but its
/// timings; `seconds_min` is the time of this run. `kappa`: of the attitude at T (integrators/conditioning.h), which
/// says what errors to expect, for the message of a run that ends far off. Returns the run.
Trajectory measure_errors(const Experiment& experiment, const Problem& problem, const Reference& reference, Case& c,
                          std::optional<double> kappa = {});

/// The row of a case beyond the setting at which its curve was cut.
void cut_curve(const Case& at, Case& beyond);

}  // namespace polhode
