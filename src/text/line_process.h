// A persistent child process with a line protocol: it answers each request line with one line.
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// The result of a request.
struct LineAnswer {
    std::string line;        ///< without its line end
    std::string fault;       ///< why there is no line, in one line; else empty
    bool not_found = false;  ///< the program does not exist
    bool timed_out = false;  ///< no answer within the time limit
};

/// A child process in its own process group. It reads requests from its standard input and writes answers to its file
/// descriptor 3. Its standard output and error are captured; at most their last line is quoted in errors. After a
/// fault the whole group has been killed, and every further request returns that fault.
class LineProcess {
  public:
    /// Starts the program `arguments[0]`; a name without a slash is looked up on the PATH. Throws nothing: an error
    /// is returned by the first request.
    explicit LineProcess(const std::vector<std::string>& arguments);
    ~LineProcess();
    LineProcess(const LineProcess&) = delete;
    LineProcess& operator=(const LineProcess&) = delete;

    /// Waits for the next line that it writes, without a request. `time` is the limit.
    LineAnswer next(std::chrono::duration<double> time);
    /// Writes the request, which must not contain a line end, and waits for the answer. `time` is the limit.
    LineAnswer ask(std::string_view question, std::chrono::duration<double> time);
    /// Whether it can answer requests.
    bool is_alive() const { return fault_.fault.empty(); }

  private:
    LineAnswer read_line(std::chrono::steady_clock::time_point until, std::chrono::duration<double> time);
    LineAnswer terminate(std::string what, bool out_of_time = false);
    bool write_all(std::string_view text, std::chrono::steady_clock::time_point until);

    struct CloseFile {
        void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }  // only read from
    };

    std::string name_;
    int process_ = 0, input_ = -1, output_ = -1;
    std::unique_ptr<std::FILE, CloseFile> captured_output_;  ///< captured standard output and error
    std::string unread_;
    LineAnswer fault_;
};

}  // namespace polhode
