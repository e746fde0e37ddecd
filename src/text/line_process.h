// A program that is asked line by line: it answers a line with a line, and is kept for the next one.
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// What came of a question.
struct LineAnswer {
    std::string line;              ///< without its end
    std::string fault;             ///< why there is none, in one line; else empty
    bool was_not_found = false;    ///< there is no such program
    bool was_out_of_time = false;  ///< none came within the time
};

/// A child process in a process group of its own. What it reads comes on its standard input, what it answers goes to
/// its file descriptor 3; its standard output and error are its own, and only their last line is ever quoted. After a
/// fault it is dead, with all of its group, and every further question is answered by that fault.
class LineProcess {
  public:
    /// Starts the program `arguments[0]`, looked up on the PATH where its name has no slash. Throws nothing: what went
    /// wrong is told by the first answer.
    explicit LineProcess(const std::vector<std::string>& arguments);
    ~LineProcess();
    LineProcess(const LineProcess&) = delete;
    LineProcess& operator=(const LineProcess&) = delete;

    /// The next line that it writes, without a question before.
    LineAnswer next(std::chrono::duration<double> time);
    /// Writes the question, which holds no line's end, and waits for the answer.
    LineAnswer ask(std::string_view question, std::chrono::duration<double> time);
    /// Whether it can be asked.
    bool alive() const { return fault_.fault.empty(); }

  private:
    LineAnswer read_line(std::chrono::steady_clock::time_point until, std::chrono::duration<double> time);
    LineAnswer die(std::string what, bool out_of_time = false);
    bool write_all(std::string_view text, std::chrono::steady_clock::time_point until);

    struct CloseFile {
        void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }  // read from: nothing is lost
    };

    std::string name_;
    int process_ = 0, input_ = -1, output_ = -1;
    std::unique_ptr<std::FILE, CloseFile> chatter_;  ///< its standard output and error
    std::string unread_;
    LineAnswer fault_;
};

}  // namespace polhode
