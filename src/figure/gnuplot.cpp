#include "figure/gnuplot.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <thread>

namespace polhode {

namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
/// An unlinked temporary file: as input and output of a program it needs no reader beside it, as a pipe would.
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string content(std::FILE* file) {
    std::string text;
    std::rewind(file);
    char buffer[65536];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) text.append(buffer, n);
    return text;
}

/// One line, for a message.
std::string one_line(const std::string& text) {
    std::string line;
    for (const char c : text) {
        const bool space = c == '\n' || c == '\t' || c == ' ' || c == '\r';
        if (!space) {
            line += c;
        } else if (!line.empty() && line.back() != ' ') {
            line += ' ';
        }
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

/// Waits for the process to end; kills it at the time limit and returns false.
bool ended_in_time(pid_t process, std::chrono::milliseconds time_limit, int& status) {
    const auto deadline = std::chrono::steady_clock::now() + time_limit;
    while (true) {
        const pid_t ended = waitpid(process, &status, WNOHANG);
        if (ended == process) return true;
        if (ended < 0 && errno != EINTR) return false;
        if (std::chrono::steady_clock::now() >= deadline) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    kill(process, SIGKILL);
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return false;
}

/// Cairo writes the time of day into a PDF's /CreationDate (D:yyyymmddhhmmssZ): the date
/// becomes the epoch.
void clear_creation_date(std::string& pdf) {
    const std::string_view key = "/CreationDate (D:";
    const std::size_t place = pdf.rfind(key);
    if (place == std::string::npos) return;
    const std::string_view epoch = "19700101000000";
    std::size_t i = place + key.size();
    for (const char digit : epoch) {
        if (i < pdf.size() && pdf[i] >= '0' && pdf[i] <= '9') pdf[i++] = digit;
    }
}

}  // namespace

GnuplotRun run_gnuplot(const std::string& script, std::chrono::milliseconds time_limit) {
    const File input(std::tmpfile()), output(std::tmpfile()), errors(std::tmpfile());
    if (!input || !output || !errors || std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() ||
        std::fflush(input.get()) != 0) {
        return {"", fmt::format("no temporary file for gnuplot: {}", std::strerror(errno))};
    }
    std::rewind(input.get());

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), 1);
    posix_spawn_file_actions_adddup2(&actions, fileno(errors.get()), 2);
    char program[] = "gnuplot", no_start_up_file[] = "-d";
    char* arguments[] = {program, no_start_up_file, nullptr};
    pid_t process = 0;
    const int refused = posix_spawnp(&process, program, &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (refused == ENOENT) return {"", "gnuplot was not found on the PATH"};
    if (refused != 0) return {"", fmt::format("gnuplot could not be started: {}", std::strerror(refused))};

    int status = 0;
    if (!ended_in_time(process, time_limit, status)) {
        return {"", fmt::format("gnuplot was stopped after {:g} s", std::chrono::duration<double>(time_limit).count())};
    }
    const std::string said = one_line(content(errors.get()));
    if (WIFSIGNALED(status)) return {"", fmt::format("gnuplot was ended by signal {}: {}", WTERMSIG(status), said)};
    if (WEXITSTATUS(status) != 0) return {"", fmt::format("gnuplot failed ({}): {}", WEXITSTATUS(status), said)};
    return {content(output.get()), ""};
}

GnuplotRun gnuplot_picture(const std::string& script, const std::string& terminal,
                           std::chrono::milliseconds time_limit) {
    GnuplotRun run = run_gnuplot(script, time_limit);
    if (!run.fault.empty()) return run;
    const bool svg = terminal == "svg";
    if (run.output.find(svg ? "</svg>" : "%%EOF") == std::string::npos)
        return {"", svg ? "gnuplot wrote no complete SVG" : "gnuplot wrote no complete PDF"};
    if (!svg) clear_creation_date(run.output);
    return run;
}

}  // namespace polhode
