#include "integrators/engines/engine_session.h"

#include <stdexcept>
#include <utility>

#include "text/child_process.h"

namespace polhode {
namespace {

/// Time limit for starting an interpreter and an engine in WebAssembly on a busy machine.
constexpr std::chrono::seconds time_to_start(60);
/// Number of consecutive timeouts after which no more requests are sent.
constexpr int silences = 2;

}  // namespace

LineAnswer EngineSession::take(Running& running) {
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_.empty()) {
            running = std::move(idle_.back());
            idle_.pop_back();
            return {};
        }
        // an engine that was not available at first is not searched again
        if (absent_) {
            running.hello = absent_->hello;
            return absent_->answer;
        }
    }
    running.process = std::make_unique<LineProcess>(command_);
    LineAnswer first = running.process->next(time_to_start);
    try {
        if (first.fault.empty()) running.hello = read_hello(first.line);
    } catch (const std::invalid_argument& error) {
        first.fault = program_name(command_.front()) + " " + error.what();
    }
    if (first.not_found || !running.hello.missing.empty()) {
        const std::scoped_lock lock(mutex_);
        absent_ = {first, running.hello};
    }
    return first;
}

void EngineSession::give_back(Running running) {
    const std::scoped_lock lock(mutex_);
    if (running.process && running.process->is_alive()) idle_.push_back(std::move(running));
}

LineAnswer EngineSession::greet(EngineHello& hello) {
    Running running;
    LineAnswer answer = take(running);
    hello = running.hello;
    if (answer.fault.empty()) give_back(std::move(running));
    return answer;
}

LineAnswer EngineSession::ask(const std::string& request, double seconds, EngineHello& hello) {
    if (unanswered_ >= silences) {
        LineAnswer none;
        none.fault = program_name(command_.front()) + " received no request: its last requests timed out";
        none.timed_out = true;
        return none;
    }
    Running running;
    LineAnswer answer = take(running);
    hello = running.hello;
    if (!answer.fault.empty() || !hello.missing.empty()) return answer;
    answer = running.process->ask(request, std::chrono::duration<double>(seconds));
    if (answer.timed_out)
        ++unanswered_;
    else
        unanswered_ = 0;
    give_back(std::move(running));
    return answer;
}

}  // namespace polhode
