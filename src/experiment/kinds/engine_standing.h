// What the kinds `engine_joints` and `engine_contact` share: the standing of a method, and parts of their pages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/kinds/engines.h"

namespace polhode {

/// A method that has rows: an engine with one setting, or another method for comparison.
struct EngineStanding {
    const PlannedCurve* curve = nullptr;
    const EngineMethod* engine = nullptr;  ///< null for methods of polhode
    EngineReport report;                   ///< engines only
    std::string setting_description;       ///< engines only: the driver's description of the setting
    double median_place = 0, mean_place = 0;
    long place = 0;   ///< among the engines; 0 for other methods and for engines that are not available
    long scenes = 0;  ///< number of scenes completed at the usual step
    std::vector<std::string> refused;  ///< reasons for unsupported scenes, without repetitions
    std::vector<std::string> lost;     ///< scenes not completed at the usual step

    bool is_available() const { return report.fault.empty(); }
    /// 0: ranked engine; 1: engine that is not available; 2: another method. See sort_places().
    int group() const { return !engine ? 2 : is_available() ? 0 : 1; }
};

/// The standing of a curve without places: its engine's report and the description of its setting.
EngineStanding inspect_curve(const PlannedCurve& curve);
/// Whether a method has rows.
bool has_rows(const PlannedCurve& curve, const std::vector<Result>& rows);
/// Sets the median and mean of the places.
void set_places(EngineStanding& standing, const std::vector<double>& places);
/// Adds a run at the usual step that is not `ok` to the standing's lists.
void add_incomplete(EngineStanding& standing, const Result& row, const std::string& scene);

/// The largest error of a run; empty if the run is not `ok`.
std::optional<double> largest_error(const Result& row, const char* measure);
/// Appends the value if there is one.
void gather(std::vector<double>& values, const std::optional<double>& value);
/// Appends the word if the list lacks it.
void gather(std::vector<std::string>& words, const std::string& word);

/// "a, b, c".
std::string listed_words(const std::vector<std::string>& words);
/// "0.12 m", or "not measured".
std::string format_amount(const std::optional<double>& value, const char* unit);
/// Sentences on refused and lost scenes, each after a space; empty if there are none.
std::string describe_incomplete(const EngineStanding& standing);
/// "### engine version" and, if the engine is not available, why.
std::string engine_heading(const EngineStanding& first);
/// "- `setting` (what it is): place 3."
std::string setting_heading(const EngineStanding& standing);

/// The standings of each engine, in the order of the engines' best places.
template <class Place>
std::vector<std::vector<const Place*>> group_by_engine(const std::vector<Place>& places) {
    std::vector<std::vector<const Place*>> groups;
    for (const Place& place : places) {
        if (!place.engine) continue;
        const auto found = std::ranges::find_if(groups, [&](const std::vector<const Place*>& group) {
            return group.front()->engine->engine == place.engine->engine;
        });
        if (found == groups.end())
            groups.push_back({&place});
        else
            found->push_back(&place);
    }
    return groups;
}

}  // namespace polhode
