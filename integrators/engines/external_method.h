// A method in another process: a command that reads a scene and prints a trajectory.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// Command line of an engine. In every argument {samples}, {step}, {tolerance} and {directory} are replaced by the
/// number of sample intervals N, the step (s), the relative tolerance and the directory of the scene's relative paths.
struct EngineCommand {
    std::vector<std::string> arguments;       ///< program, searched on the PATH if it has no slash, and its arguments
    std::vector<std::string> by_step{};       ///< appended for a fixed step, e.g. {"--step", "{step}"}
    std::vector<std::string> by_tolerance{};  ///< appended for a tolerance, e.g. {"--tolerance", "{tolerance}"}
    std::size_t most_bytes = std::size_t(1) << 30;  ///< limit of its output
};

/// A method that runs `command` once per trajectory. The scene's JSON is its standard input. Its standard output must
/// be a trajectory file (CSV, columns by name: t, q, w in world axes, p or o, v) with the N + 1 samples t = k T / N, to
/// within 1e-12 T. Columns of position and velocity may be missing if the body has a pivot. `description` gives name,
/// documentation, source and support of planes; its control follows from `by_step` and `by_tolerance`.
///
/// A run is `failed`, with the reason in the message, if the command is missing, crashes, exits with a code other than
/// 0, or prints no trajectory, a trajectory at other times or more than `most_bytes`. It is `failed` with
/// `limit_reached` if it exceeds Settings::seconds_limit of wall clock; its process group is then killed. Steps and
/// evaluations are unknown and stay 0. The time is that of the whole process, including its start. A user-defined
/// torque is `unsupported`, because it has no JSON form.
std::shared_ptr<const Method> external_method(const Method& description, const EngineCommand& command);

}  // namespace polhode
