#include "text/line_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "text/child_process.h"
#include "text/message.h"

namespace polhode {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_answer = std::size_t(1) << 30;
constexpr int answers_descriptor = 3;

// poll() takes ms; the upper limit of 1e8 ms is about a day
int milliseconds_until(Clock::time_point until) {
    const double left = std::chrono::duration<double>(until - Clock::now()).count();
    return static_cast<int>(std::clamp(left * 1e3 + 1, 0.0, 1e8));
}

Clock::time_point after(std::chrono::duration<double> time) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(
                              std::min(time, std::chrono::duration<double>(std::chrono::hours(24))));
}

// A pair of connected sockets that are not inherited by other children; -1 if the system has none left.
void connect(int (&ends)[2]) {
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) ends[0] = ends[1] = -1;
}

}  // namespace

LineProcess::LineProcess(const std::vector<std::string>& arguments)
    : name_(arguments.empty() ? "" : one_line(arguments.front(), 200)), captured_output_(std::tmpfile()) {
    int input[2], output[2];
    connect(input), connect(output);
    if (name_.empty() || !captured_output_ || input[0] < 0 || output[0] < 0) {
        fault_.fault = name_.empty() ? "no program is given"
                                     : fmt::format("{} could not be started: {}", name_, std::strerror(errno));
    } else {
        std::vector<char*> pointers;
        // posix_spawnp() takes pointers to non-const but does not modify the strings
        for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
        pointers.push_back(nullptr);
        // a copy numbered above the descriptors that the dup2 actions overwrite
        const int answers = fcntl(output[1], F_DUPFD_CLOEXEC, answers_descriptor + 1);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, input[1], STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, fileno(captured_output_.get()), STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&actions, fileno(captured_output_.get()), STDERR_FILENO);
        posix_spawn_file_actions_adddup2(&actions, answers, answers_descriptor);
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
        posix_spawnattr_setpgroup(&attributes, 0);
        const int refused = posix_spawnp(&process_, pointers.front(), &actions, &attributes, pointers.data(), environ);
        posix_spawnattr_destroy(&attributes);
        posix_spawn_file_actions_destroy(&actions);
        close(answers);
        if (refused != 0) {
            process_ = 0;
            fault_.not_found = refused == ENOENT;
            fault_.fault = fault_.not_found ? name_ + " was not found"
                                            : fmt::format("{} could not be started: {}", name_, std::strerror(refused));
        }
    }
    for (const int end : {input[1], output[1]})
        if (end >= 0) close(end);
    input_ = input[0], output_ = output[0];
    if (output_ >= 0) fcntl(output_, F_SETFL, O_NONBLOCK);
    if (input_ >= 0) fcntl(input_, F_SETFL, O_NONBLOCK);
}

LineProcess::~LineProcess() {
    if (process_ > 0) terminate("was stopped: it is no longer needed");
    for (const int end : {input_, output_})
        if (end >= 0) close(end);
}

LineAnswer LineProcess::next(std::chrono::duration<double> time) {
    if (!is_alive()) return fault_;
    return read_line(after(time), time);
}

LineAnswer LineProcess::ask(std::string_view question, std::chrono::duration<double> time) {
    if (!is_alive()) return fault_;
    const Clock::time_point until = after(time);
    if (!write_all(std::string(question) + '\n', until)) return fault_;
    return read_line(until, time);
}

bool LineProcess::write_all(std::string_view text, Clock::time_point until) {
    while (!text.empty()) {
        const ssize_t written = send(input_, text.data(), text.size(), MSG_NOSIGNAL);
        if (written > 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
            continue;
        }
        if (errno == EAGAIN || errno == EINTR) {
            pollfd waiting{input_, POLLOUT, 0};
            if (Clock::now() < until) {
                poll(&waiting, 1, milliseconds_until(until));
                continue;
            }
            terminate("was stopped: it did not read its input within the time limit", true);
            return false;
        }
        terminate("");
        return false;
    }
    return true;
}

LineAnswer LineProcess::read_line(Clock::time_point until, std::chrono::duration<double> time) {
    std::size_t searched_size = 0;
    for (;;) {
        if (const std::size_t end = unread_.find('\n', searched_size); end != std::string::npos) {
            LineAnswer answer;
            answer.line = unread_.substr(0, end);
            unread_.erase(0, end + 1);
            return answer;
        }
        searched_size = unread_.size();
        if (searched_size > longest_answer)
            return terminate(fmt::format("was stopped: it wrote more than {} bytes", searched_size));
        char buffer[65536];
        const ssize_t got = read(output_, buffer, sizeof buffer);
        if (got > 0) {
            unread_.append(buffer, static_cast<std::size_t>(got));
            continue;
        }
        if (got == 0 || (errno != EAGAIN && errno != EINTR)) return terminate("");
        if (Clock::now() >= until)
            return terminate(fmt::format("was stopped: it did not answer within {:.3g} s", time.count()), true);
        pollfd waiting{output_, POLLIN, 0};
        poll(&waiting, 1, milliseconds_until(until));
    }
}

// Kills the process group. If `what` is empty, the process ended by itself, and the fault reports how.
LineAnswer LineProcess::terminate(std::string what, bool out_of_time) {
    int status = 0;
    if (what.empty()) {
        // it has closed its end of the socket; wait up to 1 s for it to exit
        for (int i = 0; i < 200 && waitpid(process_, &status, WNOHANG) == 0; ++i) usleep(5000);
    }
    siginfo_t information{};
    const bool is_left = waitid(P_PID, static_cast<id_t>(process_), &information, WEXITED | WNOHANG | WNOWAIT) == 0;
    kill(-process_, SIGKILL);
    if (is_left)
        while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
    process_ = 0;
    if (what.empty())
        what = WIFSIGNALED(status)        ? fmt::format("was terminated by signal {}", WTERMSIG(status))
               : WEXITSTATUS(status) != 0 ? fmt::format("exited with code {}", WEXITSTATUS(status))
                                          : "exited without an answer";
    fault_.fault = fmt::format("{} {}", program_name(name_), what), fault_.timed_out = out_of_time;
    if (const std::string last_line = last_line_of(captured_output_.get()); !last_line.empty())
        fault_.fault += ": " + last_line;
    return fault_;
}

}  // namespace polhode
