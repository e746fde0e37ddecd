// The kinds of experiments. src/experiment/kinds/kinds.cpp defines the table of all kinds.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace polhode {

struct Findings;
struct Plan;
struct Result;
struct RunOptions;

/// A kind of experiment: the keys that it reads, the curves that it runs, and the evaluation of the rows. Exactly one
/// of `conclude` and `make` is set. A failure of a method is a row, not an exception.
struct ExperimentKind {
    std::string_view name;                ///< the value of the key `kind`
    std::vector<std::string_view> reads;  ///< keys of the experiment file besides name, about and kind
    /// Returns tables and figures from the finished rows. The sweep has run, timed and stored the cases (scenes by
    /// methods at settings); it also writes the table of the rows. Requires scenes and methods in the file.
    Findings (*conclude)(const Plan& plan, const std::vector<Result>& rows) = nullptr;
    /// With `conclude` only: returns a second plan, derived from the first. Its cases are run, timed and stored in the
    /// same way. The findings of its kind are appended to those of the first.
    Plan (*follow_up)(const Plan& plan) = nullptr;
    /// Computes rows, tables and figures itself, while no other run on this machine computes. `quick` of the options
    /// requests about a tenth of the work.
    Findings (*make)(const Plan& plan, const RunOptions& options) = nullptr;
    bool keeps_series = false;      ///< rows include their errors over time
    bool calibrated = false;        ///< settings are evaluations per revolution; see calibrate()
    bool all_formulations = false;  ///< every curve is run with all three Formulations
    bool chooses_steps = false;     ///< chooses the steps of fixed-step methods itself; their planned setting is NaN
    /// With `make` only: stores finished work in the directory, honours filter, shard and jobs, and stops when it is
    /// interrupted. If false, the kind ignores directory, filter and shard, and the first shard computes everything.
    bool resumable = false;
    bool one_body = false;  ///< supports scenes of one body only
};

/// All kinds. The first is the default of a file without the key `kind`.
std::span<const ExperimentKind> kinds();

/// Finds a kind by name. Returns nullptr if there is none.
const ExperimentKind* find_kind(std::string_view name);

}  // namespace polhode
