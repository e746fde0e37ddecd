#include "integrators/engines/engine_session.h"

#include <stdexcept>
#include <utility>

#include "text/child_process.h"

namespace polhode {
namespace {

/// Time limit for starting an interpreter and an engine in WebAssembly on a busy machine.
constexpr std::chrono::seconds start_timeout(60);
/// Number of consecutive timeouts after which no more requests are sent.
constexpr int max_timeouts = 2;

}  // namespace

LineAnswer EngineSession::acquire(EngineProcess& engine) {
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_.empty()) {
            engine = std::move(idle_.back());
            idle_.pop_back();
            return {};
        }
        // an engine that was not available at first is not searched again
        if (missing_engine_) {
            engine.hello = missing_engine_->hello;
            return missing_engine_->answer;
        }
    }
    engine.process = std::make_unique<LineProcess>(command_);
    LineAnswer first = engine.process->next(start_timeout);
    try {
        if (first.fault.empty()) engine.hello = read_hello(first.line);
    } catch (const std::invalid_argument& error) {
        first.fault = program_name(command_.front()) + " " + error.what();
    }
    if (first.not_found || !engine.hello.missing.empty()) {
        const std::scoped_lock lock(mutex_);
        missing_engine_ = {first, engine.hello};
    }
    return first;
}

void EngineSession::release(EngineProcess engine) {
    const std::scoped_lock lock(mutex_);
    if (engine.process && engine.process->is_alive()) idle_.push_back(std::move(engine));
}

LineAnswer EngineSession::request_hello(EngineHello& hello) {
    EngineProcess engine;
    LineAnswer answer = acquire(engine);
    hello = engine.hello;
    if (answer.fault.empty()) release(std::move(engine));
    return answer;
}

LineAnswer EngineSession::send(const std::string& request, double seconds, EngineHello& hello) {
    if (timeouts_ >= max_timeouts) {
        LineAnswer refused;
        refused.fault = program_name(command_.front()) + " received no request: its last requests timed out";
        refused.timed_out = true;
        return refused;
    }
    EngineProcess engine;
    LineAnswer answer = acquire(engine);
    hello = engine.hello;
    if (!answer.fault.empty() || !hello.missing.empty()) return answer;
    answer = engine.process->ask(request, std::chrono::duration<double>(seconds));
    if (answer.timed_out)
        ++timeouts_;
    else
        timeouts_ = 0;
    release(std::move(engine));
    return answer;
}

}  // namespace polhode
