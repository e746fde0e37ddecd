// An engine in a process of its own, asked by many trajectories, from several threads.
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

/// The processes of one engine: as many as are asked at the same time. One that is done waits for the next question;
/// one that has crashed or hung is replaced, and one that hangs twice in a row is asked no more.
class EngineSession {
  public:
    /// Starts nothing yet.
    explicit EngineSession(std::vector<std::string> command) : command_(std::move(command)) {}

    /// The engine's answer to a request, within `seconds` of its being asked. `hello` becomes what the process said
    /// when it was started, if it did.
    LineAnswer ask(const std::string& request, double seconds, EngineHello& hello);
    /// What it says of itself.
    LineAnswer greet(EngineHello& hello);

  private:
    struct Running {
        std::unique_ptr<LineProcess> process;
        EngineHello hello;
    };
    struct Absent {
        LineAnswer answer;
        EngineHello hello;
    };
    LineAnswer take(Running& running);
    void give_back(Running running);

    std::vector<std::string> command_;
    std::mutex mutex_;
    std::vector<Running> idle_;
    std::optional<Absent> absent_;     ///< what a start gave that found no engine
    std::atomic<int> unanswered_ = 0;  ///< the last questions in a row that ran out of time
};

}  // namespace polhode
