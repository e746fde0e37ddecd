// Engines as methods: those of polhode's list and user-defined ones.
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

/// Information that an engine provides in addition to trajectories.
struct EngineReport {
    std::string fault;                 ///< why there is no information; otherwise empty
    EngineHello hello;                 ///< version, settings and joint types of the engine
    std::optional<double> difference;  ///< readback_difference() of the problem's body, if requested
};

/// An engine in one of its settings: the method ENGINE:SETTING.
struct EngineMethod {
    std::string engine;                    ///< name of the engine
    std::string setting;                   ///< as in a new installation (default), most accurate (best), ..
    std::shared_ptr<const Method> method;  ///< solves by requests to the engine's process
    /// Requests the engine's hello and, if a problem is given, the readback of its body.
    std::function<EngineReport(const Problem*)> inspect;
};

/// Reads the engines of a file (JSON, see README.md), each in all its settings. In their commands {here} is replaced by
/// the directory of the file. No process is started before a trajectory is requested. Throws InputError.
std::vector<EngineMethod> read_engines(const std::string& path);
/// As read_engines(), from the text of a file.
std::vector<EngineMethod> parse_engines(std::string_view text, const std::string& path);

/// Registers the engines of a file for engines() and find_engine(), which read it on first use. Engines of later files
/// follow those of earlier ones. Not thread-safe.
void add_engines(const std::string& path);
/// All registered engines. Throws InputError if a file cannot be read or two engines have the same name.
const std::vector<EngineMethod>& engines();
/// The engine with the name ENGINE:SETTING, or with the name ENGINE in its first setting; nullptr if there is none.
const EngineMethod* find_engine(std::string_view name);
/// The engine behind a method; nullptr if the method is not an engine.
const EngineMethod* engine_of(const Method& method);

}  // namespace polhode
