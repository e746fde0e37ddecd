// Processes of one engine, used for many trajectories from several threads.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "integrators/engines/engine_request.h"
#include "text/line_process.h"

namespace polhode {

/// The processes of one engine, one per concurrent request. An idle process waits for the next request. A process that
/// crashes or hangs is replaced; after two consecutive timeouts no more requests are sent.
class EngineSession {
  public:
    /// Does not start a process.
    explicit EngineSession(std::vector<std::string> command) : command_(std::move(command)) {}

    /// Sends a request and returns the answer, with a limit of `seconds`. Sets `hello` if the process has started.
    LineAnswer send(const std::string& request, double seconds, EngineHello& hello);
    /// Returns the hello of a process, starting one if necessary.
    LineAnswer request_hello(EngineHello& hello);

  private:
    struct EngineProcess {
        std::unique_ptr<LineProcess> process;
        EngineHello hello;
    };
    struct MissingEngine {
        LineAnswer answer;
        EngineHello hello;
    };
    LineAnswer acquire(EngineProcess& engine);
    void release(EngineProcess engine);

    std::vector<std::string> command_;
    std::mutex mutex_;
    std::vector<EngineProcess> idle_;
    std::optional<MissingEngine> missing_engine_;  ///< result of a start that found no engine
    std::atomic<int> timeouts_ = 0;                ///< number of consecutive requests that timed out
};

}  // namespace polhode
