// What the kind `engines` is made of: physics engines beside the truth.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "integrators/engines/engine_methods.h"

namespace polhode {

/// The step (s) at which engines are compared where one has to be chosen: games' own, 60 a second.
inline constexpr double usual_step = 1.0 / 60;
/// And where they are at their best.
inline constexpr double fine_step = 1e-3;

/// rad: an attitude beyond it is as wrong as any.
inline constexpr double hopeless_attitude = 1;

/// In place of an update's name, where none of the catalogue is ten times nearer to the engine than the truth is.
inline constexpr const char* no_update = "no known update";

/// What is known of an engine in one setting beside its rows.
struct EngineFacts {
    const EngineMethod* engine = nullptr;
    EngineReport report;
    std::string about_setting;      ///< in the driver's own words
    bool repeats = false;           ///< a second process gave the same numbers
    std::optional<double> turning;  ///< how much of the gyroscopic term's change of w it has: 1 all, 0 none
    std::string follows;    ///< the update of the catalogue that its motion follows, or no_update; empty: unknown
    double follows_to = 0;  ///< rad, over the probe
    bool is_here() const { return report.fault.empty(); }
};

/// Asks every engine that has rows who it is, and has it move a body whose motion is known.
std::vector<EngineFacts> engine_facts(const Plan& plan, const std::vector<Result>& rows);

/// An engine in one setting among the others.
struct EnginePlace {
    const EngineFacts* facts = nullptr;
    double median_place = 0, mean_place = 0;           ///< over scenes and steps
    long place = 0;                                    ///< in the end; 0 where it is not here
    long scenes = 0;                                   ///< that it has run to the end at the usual step
    std::optional<double> attitude, momentum, energy;  ///< medians over those scenes, the largest errors of each
    std::optional<double> fine_attitude;               ///< the same at the fine step
    std::optional<double> order;                       ///< median of the observed orders
    std::optional<double> step_seconds;                ///< median over all runs
    /// The largest step from which on it stays within 0.1, 0.01 and 0.001 rad on half of the scenes.
    std::optional<double> within[3];
};
inline constexpr double accuracies[3] = {0.1, 0.01, 0.001};

/// All of them, the best first. The rule stands in leaderboard_rule.
std::vector<EnginePlace> engine_places(const Plan& plan, const std::vector<Result>& rows,
                                       const std::vector<EngineFacts>& facts);
extern const char* const leaderboard_rule;

/// NAME_leaderboard, a row an engine and setting.
NamedTable leaderboard_table(const std::vector<EnginePlace>& places);
/// NAME_scenes: of each scene and engine the largest attitude error at each step, the observed order, momentum and
/// energy at the usual step, time of a step, binary32's floor.
NamedTable engine_scenes_table(const Plan& plan, const std::vector<Result>& rows);
/// NAME_gazebo_boxes: the published benchmark of Gazebo's boxes, where its scene and the step 1/1000 s are in the plan.
NamedTable gazebo_table(const Plan& plan, const std::vector<Result>& rows);
/// NAME_identity: version, settings, what was read back, which update is followed, whether numbers repeat.
NamedTable identity_table(const std::vector<EngineFacts>& facts);

/// The page: the rule, the tables, the pictures, and a paragraph for each engine.
std::string engines_page(const Plan& plan, const std::vector<EnginePlace>& places,
                         const std::vector<EngineFacts>& facts, const Findings& findings);

/// What places go by: the largest attitude error (rad), one radian at the most; infinite of a run that did not come to
/// its end.
double standing_of(const Result& row);
/// Whether a row is one of that step (s), to what rounding and whole steps between samples make of it.
bool is_step(const Result& row, double step);
/// "1/60 s"
std::string step_name(double step);

}  // namespace polhode
