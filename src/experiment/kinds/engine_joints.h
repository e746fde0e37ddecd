// The kind `engine_joints`: the joints of physics engines compared with the truth.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "experiment/kinds/engine_standing.h"

namespace polhode {

/// Summary of a method's joint errors over the scenes of a plan, and its place in the ranking.
struct JointPlace : EngineStanding {
    /// Medians over the scenes completed at the usual step of the largest errors of a run.
    std::optional<double> attitude, gap, turn, energy;
    std::optional<double> fine_attitude, fine_gap;  ///< medians of the largest errors at the fine step
    std::optional<double> order;                    ///< median of the observed orders of the attitude error
    std::optional<double> gap_order;                ///< median of the observed orders of the gap
    std::optional<double> step_seconds;             ///< median over all runs
    std::optional<double> worst_gap;                ///< m, at the usual step
    std::string worst_gap_scene;                    ///< the scene with the largest gap
    /// Whether all gaps are round-off, as with joint coordinates.
    bool closes() const { return gap && *gap < 1e-9 && worst_gap && *worst_gap < 1e-9; }
};

/// The methods that have rows: engines by place, best first, then other methods in the plan's order.
std::vector<JointPlace> joint_places(const Plan& plan, const std::vector<Result>& rows);

/// The page: ranking rule, tables, and a paragraph for each engine.
std::string engine_joints_page(const Plan& plan, const std::vector<JointPlace>& places, const Findings& findings);

/// `conclude` of the kind `engine_joint_laws`: limits, friction and gears of joints.
Findings conclude_engine_joint_laws(const Plan& plan, const std::vector<Result>& rows);

/// Errors of a method on bodies with proportional and derivative control: a spacecraft, the same with sampled control,
/// a flywheel with a motor, and the same with sampled control.
struct ControlErrors {
    const Method* method = nullptr;
    std::array<std::optional<double>, 4> usual, fine;  ///< largest attitude error, rad, at the usual and the fine step
    std::string fault;                                 ///< why a value is missing
};
/// Runs the methods on the controlled bodies.
std::vector<ControlErrors> measure_control(const std::vector<const Method*>& methods);
/// The table of these errors, and a sentence about it.
NamedTable control_table(const std::vector<ControlErrors>& errors);
std::string describe_control(const std::vector<ControlErrors>& errors);

/// The follow-up of `engine_joints` at one step: a rope with a ball of 1 to 1000 times a link's mass, and hanging
/// chains of 10 to 100 links.
Plan joint_sweeps(const Plan& plan);

}  // namespace polhode
