// The faults of engines that `check` knows, each a hypothesis that predicts a motion: a new one is one entry of the
// table in hypotheses.cpp.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "check/compared_rows.h"

namespace polhode {

/// What a diagnosis is about: only those of one kind compete.
enum class About { attitude, rate, position };

/// What a hypothesis says of a file.
struct Explanation {
    double error = 0;             ///< the file's own; rad, m or relative to the largest rate
    double explained = 0;         ///< what is left of it under the hypothesis
    std::string what;             ///< the fault, in words
    std::string remedy;           ///< what to do
    std::string convention = "";  ///< the --convention that would mend the file
    std::string compared = "";    ///< how the errors were formed; empty for the root mean square over the rows
    /// How far the file's w is from the one predicted (ComparedRows::rates_left). Asked only of what explains the file.
    std::function<std::optional<double>()> rates_left = {};
};

struct Hypothesis {
    const char* fault;    ///< a word for programs; two ways to one fault share it
    About about;          ///< those about the attitude are tried where the attitude is wrong
    double factor;        ///< so many times nearer than the scene's own motion must the prediction lie
    bool fitted = false;  ///< a number of it is fitted to the file
    std::function<std::optional<Explanation>(const ComparedRows&)> explain;
};

/// Of hypotheses that explain a file alike the one that stands first here is told first.
std::span<const Hypothesis> hypotheses();

/// How many times nearer a hypothesis must lie than the scene; more where a number is fitted to the file: a method's
/// own dissipation or slowness has been seen described to a thirtieth by a damping, to an eighteenth by another time
/// step.
inline constexpr double alike = 10, fitted_alike = 50;
/// Below this a file is as the scene has it (rad, or relative).
inline constexpr double plain_error = 1e-4;
/// What is explained to this part of the error is explained.
inline constexpr double explained_wholly = 1e-3;

}  // namespace polhode
