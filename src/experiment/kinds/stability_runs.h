// The runs of the kind `stability`: each method on each extreme scene, its step sought out.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "experiment/run/result.h"
#include "experiment/run/sweep.h"
#include "measure/stability.h"

namespace polhode {

/// A row of the table of stability.
struct StabilityRun {
    Result result;
    Outcome outcome = Outcome::unsupported;
};

/// What a scene is: the same for all methods.
struct StabilityScene {
    std::string label;
    std::string family;               ///< scene/scene_family.h
    std::optional<double> parameter;  ///< of a family that has one
    double duration = 0;              ///< s
    double fastest_rate = 0;  ///< 1/s: the largest of |w|, of the true motion, and of its Jacobian's |eigenvalues|
    std::vector<std::complex<double>> eigenvalues;  ///< at t = 0, 1/s
    /// Rotation about one principal axis under a torque, its largest eigenvalue the same over the run within a
    /// thousandth: linear theory applies as it stands.
    bool is_linear = false;
    Floors floors;
    std::optional<double> kappa;  ///< of the attitude at T, where it was needed and is known
    bool has_truth = false;
};

/// Of one method on one scene, with one kind of setting. Steps in s; empty where there is none.
struct StabilityFinding {
    const StabilityScene* scene = nullptr;
    const Method* method = nullptr;
    SettingKind kind = SettingKind::none;
    std::vector<StabilityRun> runs;  ///< from coarse to fine

    // of fixed steps: the largest step such that it and every smaller one that was tried is stable, close, accurate
    const StabilityRun* stable = nullptr;
    const StabilityRun* close = nullptr;
    const StabilityRun* accurate = nullptr;
    const StabilityRun* beyond = nullptr;  ///< the next larger step that is not stable
};

/// False where the method does not solve the scene, or nothing is known of it yet.
inline bool was_run(const StabilityFinding& finding) {
    return !finding.runs.empty() && finding.runs.front().outcome != Outcome::unsupported;
}

struct StabilityFindings {
    std::vector<StabilityScene> scenes;  ///< in the plan's order
    std::vector<StabilityFinding> findings;
    long missing = 0;  ///< not run: filtered, other shards', interrupted
};

/// Runs what is not in the directory yet. Every run is kept there, so that an interrupted experiment goes on.
StabilityFindings run_stability_cases(const Plan& plan, const RunOptions& options);

/// The kind's table: the sweep's columns, then family, parameter, fastest_rate and outcome.
Table stability_table(const Plan& plan, const StabilityFindings& found);

}  // namespace polhode
