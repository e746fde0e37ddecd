#include "text/child_process.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "text/message.h"

namespace polhode {
namespace {

using Clock = std::chrono::steady_clock;

struct CloseFile {
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }  // a temporary file
};
/// An unlinked temporary file. Unlike a pipe it needs no concurrent reader, and no other process can hold it open.
using File = std::unique_ptr<std::FILE, CloseFile>;

// In memory (memfd) if supported, so that full or read-only folders do not matter.
File temporary_file() {
    const int memory = ::memfd_create("polhode", MFD_CLOEXEC);
    if (memory < 0) return File(std::tmpfile());
    File file(::fdopen(memory, "w+"));
    if (!file) ::close(memory);
    return file;
}

std::string content(std::FILE* file) {
    std::string text;
    std::rewind(file);
    char buffer[65536];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) text.append(buffer, n);
    return text;
}

std::size_t size_of(std::FILE* file) {
    struct stat properties {};
    return fstat(fileno(file), &properties) == 0 ? static_cast<std::size_t>(properties.st_size) : 0;
}

// posix_spawnp() with the three files as standard streams and a new process group. Returns 0 or the error number.
int start(const std::vector<std::string>& arguments, const File (&streams)[3], pid_t& process) {
    std::vector<char*> pointers;
    // posix_spawnp() takes pointers to non-const but does not modify the strings
    for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (int i = 0; i < 3; ++i) posix_spawn_file_actions_adddup2(&actions, fileno(streams[i].get()), i);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int refused = posix_spawnp(&process, pointers.front(), &actions, &attributes, pointers.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return refused;
}

// Whether the process has ended. It is not reaped yet, so that its group number is not reused.
bool has_ended(pid_t process) {
    siginfo_t information{};
    if (waitid(P_PID, static_cast<id_t>(process), &information, WEXITED | WNOHANG | WNOWAIT) == 0)
        return information.si_pid == process;
    return errno != EINTR;
}

}  // namespace

std::string last_line_of(std::FILE* file) {
    const std::string written = content(file);
    std::string_view text = written;
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    if (end == std::string_view::npos) return "";
    text = text.substr(0, end + 1);
    const std::size_t before = text.find_last_of("\r\n");
    return one_line(before == std::string_view::npos ? text : text.substr(before + 1), 300);
}

std::string program_name(std::string_view command) {
    const std::string_view name = command.substr(command.rfind('/') + 1);
    return one_line(name.empty() ? command : name, 200);
}

ChildRun run_child(const std::vector<std::string>& arguments, std::string_view input, const ChildLimits& limits) {
    ChildRun run;
    const std::string name = arguments.empty() ? "" : one_line(arguments.front(), 200);
    if (name.empty()) {
        run.fault = "no program is given", run.not_found = true;
        return run;
    }
    const File streams[] = {temporary_file(), temporary_file(), temporary_file()};
    const auto& [in, out, errors] = streams;
    if (!in || !out || !errors || std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() ||
        std::fflush(in.get()) != 0) {
        run.fault = fmt::format("cannot create a temporary file for {}: {}", name, std::strerror(errno));
        return run;
    }
    std::rewind(in.get());
    const auto begin = Clock::now();
    pid_t process = 0;
    if (const int refused = start(arguments, streams, process); refused != 0) {
        run.not_found = refused == ENOENT;
        run.fault = !run.not_found ? fmt::format("{} could not be started: {}", name, std::strerror(refused))
                    : name.find('/') == std::string::npos ? name + " was not found on the PATH"
                                                          : name + " was not found";
        return run;
    }
    const std::string running = program_name(arguments.front());
    // poll short programs often and long ones rarely
    auto pause = std::chrono::microseconds(50);
    while (!has_ended(process)) {
        run.timed_out = Clock::now() - begin >= limits.time;
        if (run.timed_out) {
            run.fault = fmt::format("{} was stopped after {:g} s", running, limits.time.count());
        } else if (size_of(out.get()) > limits.output_bytes || size_of(errors.get()) > limits.output_bytes) {
            run.fault = fmt::format("{} was stopped: it wrote more than {} bytes", running, limits.output_bytes);
        } else {
            std::this_thread::sleep_for(pause);
            pause = std::min(2 * pause, std::chrono::microseconds(2000));
            continue;
        }
        break;
    }
    run.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    kill(-process, SIGKILL);
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    run.output = content(out.get());
    if (!run.fault.empty()) return run;
    if (run.output.size() > limits.output_bytes) {
        run.fault = fmt::format("{} wrote more than {} bytes", running, limits.output_bytes);
        return run;
    }
    if (WIFSIGNALED(status))
        run.fault = fmt::format("{} was terminated by signal {}", running, WTERMSIG(status));
    else if (WEXITSTATUS(status) != 0)
        run.fault = fmt::format("{} exited with code {}", running, WEXITSTATUS(status));
    if (const std::string last_line = last_line_of(errors.get()); !run.fault.empty() && !last_line.empty())
        run.fault += ": " + last_line;
    return run;
}

}  // namespace polhode
