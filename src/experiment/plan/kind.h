// What an experiment can be. All kinds stand in one table, which src/experiment/kinds/kinds.cpp fills.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace polhode {

struct Findings;
struct Plan;
struct Result;
struct RunOptions;

/// A kind of experiment: what it reads, which curves it runs and what it makes of the rows. It has either `conclude` or
/// `make`. Failures of methods are rows in either case.
struct ExperimentKind {
    std::string_view name;                ///< the word of the experiment file
    std::vector<std::string_view> reads;  ///< keys of the experiment file that it uses beside name, about and kind
    /// Called with the finished rows of the cases, scenes by methods at settings, which the engine has run, timed and
    /// stored: the tables and pictures beside the table of the rows. The file names scenes and methods.
    Findings (*conclude)(const Plan& plan, const std::vector<Result>& rows) = nullptr;
    /// Of `conclude`: a second plan that follows from the first. Its cases are run, timed and stored likewise, and what
    /// its own kind concludes from their rows stands behind the first one's.
    Plan (*sequel)(const Plan& plan) = nullptr;
    /// Of a kind whose rows are no such cases: makes them all, and tables and pictures of them, alone on the machine.
    /// `quick` of the options asks for about a tenth of the work.
    Findings (*make)(const Plan& plan, const RunOptions& options) = nullptr;
    bool keeps_series = false;  ///< rows come with their errors over time
    bool calibrated = false;    ///< settings are evaluations a revolution, from which steps and tolerances are found
    bool all_formulations = false;  ///< every curve three times, by all Formulations
    bool chooses_steps = false;     ///< it finds the steps of fixed-step methods: the plan has one without a number
    /// Of `make`: it keeps what it has finished in the directory, obeys filter, shard and jobs and stops when it is
    /// interrupted. Of any other, folder, filter and shard mean nothing, and the first shard makes all.
    bool resumable = false;
    bool one_body = false;  ///< what it measures is one body's: scenes of several are refused
};

/// All kinds; the first is the one of a file that names none.
std::span<const ExperimentKind> kinds();

/// By name; nullptr if there is none.
const ExperimentKind* find_kind(std::string_view name);

}  // namespace polhode
