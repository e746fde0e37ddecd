// The kind `engines`: physics engines compared with the truth.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"
#include "integrators/engines/engine_methods.h"

namespace polhode {

/// The step (s) of tables with a single step: 60 steps per second, as in games.
inline constexpr double default_engine_step = 1.0 / 60;
/// The step (s) at which engines are most accurate.
inline constexpr double fine_step = 1e-3;

/// rad; larger attitude errors are all ranked alike.
inline constexpr double attitude_error_cap = 1;

/// Errors within this factor share a place.
inline constexpr double tie_factor = 1.1;

/// Replaces the name of an update if identify_update() finds none that matches the engine.
inline constexpr const char* no_update = "no known update";

/// Properties of an engine with one setting, apart from its rows.
struct EngineFacts {
    const EngineMethod* engine = nullptr;
    EngineReport report;
    std::string setting_description;            ///< the driver's description of the setting
    bool repeats = false;                       ///< a second process gives the same numbers
    std::optional<double> gyroscopic_fraction;  ///< fraction of the gyroscopic term's change of w: 1 all, 0 none
    std::string matching_update;                ///< name of the matching update, or no_update; empty: unknown
    double update_difference = 0;               ///< rad, distance to the matching update over the probe motion
    bool is_available() const { return report.fault.empty(); }
};

/// Queries every engine that has rows, and runs it on a body whose motion is known.
std::vector<EngineFacts> engine_facts(const Plan& plan, const std::vector<Result>& rows);

/// The place of an engine with one setting in the ranking.
struct EnginePlace {
    const EngineFacts* facts = nullptr;
    double median_place = 0, mean_place = 0;           ///< over scenes and steps
    long place = 0;                                    ///< final place; 0 if the engine is not available
    long scenes = 0;                                   ///< number of scenes completed at the usual step
    std::optional<double> attitude, momentum, energy;  ///< medians over these scenes of the largest errors of a run
    std::optional<double> fine_attitude;               ///< median of the largest errors at the fine step
    std::optional<double> order;                       ///< median of the observed orders
    std::optional<double> step_seconds;                ///< median over all runs
    /// The largest step from which on the error is within 0.1, 0.01 and 0.001 rad on at least half of the scenes.
    std::optional<double> within[3];
    /// 0: ranked; 1: not available. See sort_places().
    int group() const { return facts->is_available() ? 0 : 1; }
};
inline constexpr double accuracies[3] = {0.1, 0.01, 0.001};

/// Ranks all engines, best first, by the rule that leaderboard_rule documents.
std::vector<EnginePlace> engine_places(const Plan& plan, const std::vector<Result>& rows,
                                       const std::vector<EngineFacts>& facts);
extern const char* const leaderboard_rule;

/// NAME_leaderboard: one row per engine and setting.
NamedTable leaderboard_table(const std::vector<EnginePlace>& places);
/// NAME_scenes: for each scene and engine the largest attitude error at each step, the observed order, momentum and
/// energy errors at the usual step, the time per step, and the floor of binary32.
NamedTable engine_scenes_table(const Plan& plan, const std::vector<Result>& rows);
/// NAME_gazebo_boxes: comparison with the published benchmark of Gazebo's boxes. Empty unless the plan has its scene
/// and the step 1/1000 s.
NamedTable gazebo_table(const Plan& plan, const std::vector<Result>& rows);
/// NAME_identity: version, settings, readback, matching update, reproducibility.
NamedTable identity_table(const std::vector<EngineFacts>& facts);

/// The page: ranking rule, tables, figures, and a paragraph for each engine.
std::string engines_page(const Plan& plan, const std::vector<EnginePlace>& places,
                         const std::vector<EngineFacts>& facts, const Findings& findings);

/// The error used for ranking: the largest attitude error, at most 1 rad; infinite if the run is not `ok`.
double capped_error(const Result& row);
/// 1 + the number of engines that have an error smaller by more than tie_factor on the row's scene at its step.
double place_of(const Result& row, const std::vector<Result>& rows, const std::function<double(const Result&)>& error);

/// Sorts by group, and the ranked ones, of group 0, by median and mean place. Sets their final places; equal medians
/// and means share one.
template <class Place>
void sort_places(std::vector<Place>& places) {
    std::ranges::stable_sort(places, [](const Place& a, const Place& b) {
        if (a.group() != b.group()) return a.group() < b.group();
        if (a.group() != 0) return false;
        if (a.median_place != b.median_place) return a.median_place < b.median_place;
        return a.mean_place < b.mean_place;
    });
    for (std::size_t i = 0; i < places.size() && places[i].group() == 0; ++i) {
        const bool as_before = i > 0 && places[i].median_place == places[i - 1].median_place &&
                               places[i].mean_place == places[i - 1].mean_place;
        places[i].place = as_before ? places[i - 1].place : static_cast<long>(i) + 1;
    }
}
/// Whether a row has this step (s), to 0.1 %.
bool is_step(const Result& row, double step);
/// Formats a step: "1/60 s".
std::string step_name(double step);

}  // namespace polhode
