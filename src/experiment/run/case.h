// One case of a sweep: a scene, a method and a setting.
#pragma once

#include <optional>
#include <string>

#include "experiment/plan/experiment.h"
#include "experiment/run/result.h"
#include "integrators/analysis/conditioning.h"
#include "motion/problem.h"

namespace polhode {

/// A case: its place in the plan, its key, and its result when it is finished.
struct Case {
    const PlannedScene* scene;
    const PlannedCurve* curve;
    std::size_t rank;  ///< index of the setting in curve->settings
    std::string key;
    std::optional<Result> result{};
    Settings settings{};  ///< settings of the run
    double spent = 0;     ///< s, for errors and timings

    double setting() const { return curve->settings[rank]; }
};

/// Describes a case as "EXPERIMENT SCENE METHOD KIND SETTING". Does not depend on the program that ran it.
std::string describe_case(const Plan& plan, const Case& c);

/// The floors of the attitude error; empty if the conditioning is not available.
Floors compute_floors(const Conditioning& conditioning);

/// Makes an untimed run that takes the steps of the timed run and records every sample. Sets the result except its
/// timings; `seconds_min` is the time of this run. `kappa` is the condition number of the attitude at T
/// (integrators/analysis/conditioning.h); the message of a run with a large error quotes it. Returns the run.
Trajectory measure_errors(const Experiment& experiment, const Problem& problem, const Reference& reference, Case& c,
                          std::optional<double> kappa = {});

/// Sets the result of the case `beyond`, which is not run because its curve was cut at the case `at`.
void cut_curve(const Case& at, Case& beyond);

}  // namespace polhode
