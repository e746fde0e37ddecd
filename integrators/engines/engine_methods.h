// Engines as methods: those of polhode's own list and those of a user's.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/engines/engine_request.h"
#include "integrators/method.h"

namespace polhode {

/// What an engine tells beside a trajectory.
struct EngineReport {
    std::string fault;                 ///< why it tells nothing; else empty
    EngineHello hello;                 ///< who it is
    std::optional<double> difference;  ///< readback_difference() of the problem's body, where it was asked
};

/// An engine in one of its settings: the method ENGINE:SETTING.
struct EngineMethod {
    std::string engine;                    ///< its name
    std::string setting;                   ///< as a new user gets it (default), as it does best (best), ..
    std::shared_ptr<const Method> method;  ///< solves by asking the engine, in a process of its own
    /// Asks the engine who it is, and, where a problem is given, what it makes of its body.
    std::function<EngineReport(const Problem*)> inspect;
};

/// The engines of a file (JSON, see README.md), each in all its settings. In their commands {here} stands for the
/// directory of the file. Nothing is started before a method is asked for a trajectory. Throws InputError.
std::vector<EngineMethod> read_engines(const std::string& path);
/// Those of a file's text.
std::vector<EngineMethod> parse_engines(std::string_view text, const std::string& path);

/// Makes the engines of a file known to engines() and find_engine(), which read it when they are first asked. Those of
/// a file added later stand behind those of earlier ones. Not for several threads.
void add_engines(const std::string& path);
/// All engines that are known. Throws InputError where a file cannot be read, or two engines have one name.
const std::vector<EngineMethod>& engines();
/// The engine of the name ENGINE:SETTING, or of ENGINE alone in its first setting; nullptr if none is known by it.
const EngineMethod* find_engine(std::string_view name);
/// The engine that a method asks, nullptr if it asks none.
const EngineMethod* engine_of(const Method& method);

}  // namespace polhode
