// A method in another process: a command that reads a scene and prints a trajectory.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// How an engine is called. In every argument {samples}, {step}, {tolerance} and {directory} stand for the number of
/// sample intervals N, the step (s), the relative tolerance and the directory that the scene's files are relative to.
struct EngineCommand {
    std::vector<std::string> arguments;  ///< the program, looked up on the PATH if it has no slash, and what follows
    std::vector<std::string> by_step{};  ///< appended where the run is by a fixed step: {"--step", "{step}"}
    std::vector<std::string>
        by_tolerance{};  ///< appended where the run is by a tolerance: {"--tolerance", "{tolerance}"}
    std::size_t most_bytes = std::size_t(1) << 30;  ///< of what it may print
};

/// A method that runs `command` once a trajectory. The scene's JSON is its standard input; its standard output is to be
/// a trajectory file (CSV, columns by name: t, q, w in world axes, p or o, v) with the N + 1 samples t = k T / N, to
/// within 10^-12 T. `description` says what is known of the engine: name, documentation, source, whether it takes
/// planes; its control follows from which of `by_step` and `by_tolerance` are given. Columns of place and velocity may
/// be missing where the body has a pivot.
///
/// A run ends as `failed`, with a message that says why, where the command is missing, crashes, exits with another code
/// than 0, prints no trajectory, one at other times or more than `most_bytes`; and with `limit_reached` where it takes
/// longer than Settings::seconds_limit, by the wall clock: then it is killed with its process group. Steps and
/// evaluations are not known and stay 0. The time is that of the whole process, its start included. A torque of the
/// user's own is `unsupported`: it has no JSON.
std::shared_ptr<const Method> external_method(const Method& description, const EngineCommand& command);

}  // namespace polhode
