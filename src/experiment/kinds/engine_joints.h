// What the kind `engine_joints` is made of: the joints of physics engines beside the truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/kinds/engines.h"

namespace polhode {

/// What a method's joints come to over the scenes of a plan.
struct JointPlace {
    const PlannedCurve* curve = nullptr;
    const EngineMethod* engine = nullptr;  ///< nullptr of a method of this program
    EngineReport report;                   ///< of an engine
    std::string about_setting;             ///< of an engine, in its driver's words
    double median_place = 0, mean_place = 0;
    long place = 0;   ///< among engines; 0 of others, and where it is not here
    long scenes = 0;  ///< run to the end at the usual step
    /// Medians over those scenes, the largest errors of each.
    std::optional<double> attitude, gap, turn, energy;
    std::optional<double> fine_attitude, fine_gap;  ///< the same at the fine step
    std::optional<double> order;                    ///< median of the observed orders of the attitude
    std::optional<double> gap_order;                ///< and of the gaps
    std::optional<double> step_seconds;             ///< median over all runs
    std::optional<double> worst_gap;                ///< m, at the usual step
    std::string worst_gap_scene;                    ///< where that is
    std::vector<std::string> refused;               ///< why scenes are left out, each reason once
    std::vector<std::string> lost;                  ///< scenes not run to the end at the usual step
    bool is_here() const { return report.fault.empty(); }
    /// Without a gap but for round-off, as joint coordinates leave it.
    bool closes() const { return gap && *gap < 1e-9 && worst_gap && *worst_gap < 1e-9; }
};

/// All that have rows: engines by their places, the best first, then the others in the plan's order.
std::vector<JointPlace> joint_places(const Plan& plan, const std::vector<Result>& rows);

/// The page: rule, tables, and a paragraph for each engine.
std::string engine_joints_page(const Plan& plan, const std::vector<JointPlace>& places, const Findings& findings);

/// The sequel of `engine_joints`: a rope with a ball of 1 to 1000 times a link's mass, and hanging chains of 10 to 100
/// links, at one step.
Plan joint_sweeps(const Plan& plan);

}  // namespace polhode
