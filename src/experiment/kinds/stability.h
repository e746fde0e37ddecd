// The kind `stability`: the largest stable step of each method on each stiff or extreme scene.
//
// For each scene and fixed-step method a search halves the step until the attitude is within 1e-3 rad, then bisects the
// limits of stability and accuracy (stability_runs.cpp). Tables and the page summarise these runs
// (stability_tables.cpp, stability_page.cpp). Three separate studies follow: linear theory compared with measured
// limits (stability_linear.cpp), maps of outcomes over step x stiffness and step x spin (stability_maps.cpp), and
// discontinuous torques (stability_events.cpp).
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "experiment/run/sweep.h"
#include "measure/stability.h"

namespace polhode {

/// A row of the table of runs.
struct StabilityRun {
    Result result;
    Outcome outcome = Outcome::unsupported;
};

/// The properties of a scene that all methods share.
struct StabilityScene {
    std::string label;
    std::string family;               ///< scene/scene_family.h
    std::optional<double> parameter;  ///< parameter of the family, if it has one
    double duration = 0;              ///< s
    double fastest_rate = 0;  ///< 1/s: the largest of |w|, of the true motion, and of its Jacobian's |eigenvalues|
    std::vector<std::complex<double>> eigenvalues;  ///< at t = 0, 1/s
    /// Rotation about one principal axis under a torque, its largest eigenvalue constant over the run to 0.1 %: linear
    /// theory applies.
    bool is_linear = false;
    Floors floors;
    std::optional<double> kappa;  ///< condition number of the attitude at T, if a run needed it
};

/// One method on one scene, with one kind of setting. Pointers are null if no run qualifies.
struct StabilityFinding {
    const StabilityScene* scene = nullptr;
    const Method* method = nullptr;
    SettingKind kind = SettingKind::none;
    std::vector<StabilityRun> runs;  ///< from coarse to fine

    // fixed steps: the largest step such that it and every smaller one is stable, close, accurate
    const StabilityRun* stable = nullptr;
    const StabilityRun* close = nullptr;
    const StabilityRun* accurate = nullptr;
    const StabilityRun* beyond = nullptr;  ///< the next larger step that is not stable
};

struct StabilityFindings {
    std::vector<StabilityScene> scenes;  ///< in the plan's order
    std::vector<StabilityFinding> findings;
    long missing = 0;  ///< searches not run: filtered, of other shards, or interrupted
};

/// False if the method does not support the scene or the search is missing.
inline bool was_run(const StabilityFinding& finding) {
    return !finding.runs.empty() && finding.runs.front().outcome != Outcome::unsupported;
}

/// The findings of a method with one kind of setting that were run, in the order of the scenes.
std::vector<const StabilityFinding*> findings_of(const StabilityFindings& found, const Method& method,
                                                 SettingKind kind);

/// Runs the searches whose runs are not in the directory yet, and stores the runs of each search there when it ends.
StabilityFindings run_stability_cases(const Plan& plan, const RunOptions& options);

/// The table of runs: the sweep's columns, then family, parameter, fastest_rate and outcome.
Table stability_table(const Plan& plan, const StabilityFindings& found);

/// For each fixed-step method and scene: the largest stable step, the largest within 0.1 and 1e-3 rad, their cost, and
/// the outcome of the next larger step. Steps also in units of the scene's fastest time (step_times_rate).
Table limits_table(const StabilityFindings& found);

/// For each method that has a binary32 version: the scenes that binary32 never solves within 0.1 rad though binary64
/// does, and the median over the other scenes of binary32's smallest error over binary64's.
Table binary32_table(const StabilityFindings& found);

/// For each tolerance-driven method on extreme/drag_torque_1e6: the fewest evaluations per second of motion that reach
/// 1e-10 rad, or the smallest error if no run does. Empty if the scene is not in the plan.
Table damping_table(const Plan& plan, const StabilityFindings& found);

/// For each method that has a linear theory, on a linear scene of each direction of the eigenvalue: the largest
/// h |lambda| without growth by theory, and as measured over 50,000 steps (`quick`: 5,000).
Table measure_linear_limits(const Plan& plan, const StabilityFindings& found, int jobs, bool quick);

/// Draws the regions of |growth| <= 1. One figure is in the plane of z = h lambda, with one panel per family of methods
/// and the eigenvalues of some scenes' Jacobians at t = 0, multiplied by the step (see the legend). The other is in the
/// plane of h gamma and h omega, for methods for second-order equations.
std::vector<NamedFigure> draw_stability_regions(std::span<const PlannedScene> scenes);

/// Runs each fixed-step method on a grid of step x stiffness and on one of step x spin. Tables: `maps` (one row per
/// interval of steps with one outcome) and `gyroscopic` (the updates of game engines: where they diverge, where they
/// damp, where only the attitude is wrong). Figures: one panel per method, sixteen per page. `quick`: every fourth
/// column and row.
Findings run_step_maps(std::span<const Method* const> methods, int jobs, bool quick);

/// Measures the observed order of methods if a torque or its derivative jumps, or if a torque acts for less than a
/// step. The jump is either an event of the scene, at which steps end, or in a torque function, so that steps cross it.
/// `quick`: coarser steps and tolerances only.
NamedTable measure_discontinuities(bool quick);

/// The page: tables, and for each method its limits on the families of scenes. `tables`: those that the page shows.
std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<NamedTable>& tables);

}  // namespace polhode
