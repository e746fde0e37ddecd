// Requirements on any command line; see oracles.h. The program is called as a function in a private directory with a
// few small files, and its output is captured.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/laboratory.h"
#include "fuzz/folder_oracle.h"

namespace polhode::oracles {

/// Captures what is written to a C stream during its lifetime.
class KeptStream {
  public:
    explicit KeptStream(FILE*& stream) : stream_(stream), before_(stream), memory_(::open_memstream(&text_, &size_)) {
        require(memory_ != nullptr, "cannot open a stream in memory");
        stream_ = memory_;
    }
    ~KeptStream() {
        stream_ = before_;
        std::fclose(memory_);
        std::free(text_);  // NOLINT
    }
    KeptStream(const KeptStream&) = delete;
    KeptStream& operator=(const KeptStream&) = delete;

    std::string text() {
        std::fflush(memory_);
        return {text_, size_};
    }

  private:
    FILE*& stream_;
    FILE* before_;
    char* text_ = nullptr;
    std::size_t size_ = 0;
    FILE* memory_;
};

/// A directory with a scene of each kind, a trajectory, an ensemble table, a small experiment and a results folder,
/// and a separate directory with the truth cache. PATH is empty, so that no other program can be started.
class Bench {
  public:
    Bench() : work_("command"), beside_("beside") {
        ::setenv("PATH", "/nonexistent", 1);
        ::setenv("POLHODE_CACHE", (beside_.path() / "cache").c_str(), 1);
        ::setenv("POLHODE_REPORT_PAGE", (beside_.path() / "page.html").c_str(), 1);
        beside_.write("page.html", "<!--polhode:title--><!--polhode:data-->");
        fill();
    }

    const std::filesystem::path& path() const { return work_.path(); }

    /// The names and sizes of all files except the cache.
    std::map<std::string, std::uintmax_t> files() const {
        std::map<std::string, std::uintmax_t> found;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(work_.path()))
            found[entry.path().string()] = entry.is_regular_file() ? entry.file_size() : 0;
        return found;
    }
    const std::map<std::string, std::uintmax_t>& files_before() const { return before_; }

    void fill() {
        work_.clear();
        work_.write("one.json", R"({"name": "one", "duration": 0.01, "body": {"mass": 1, "inertia": [1, 2, 3]},
                        "initial": {"angular_velocity": [1, 2, 3]},
                        "loads": [{"type": "torque", "vector": [0.1, 0, 0], "frame": "body"}]})");
        work_.write("two.json", R"({"name": "two", "duration": 0.01,
                        "bodies": [{"name": "a", "body": {"mass": 1, "inertia": [1, 2, 2], "center_of_mass": [0, 0, -1]}}],
                        "joints": [{"name": "j", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 1, 0],
                                    "initial": {"angle": 0.5}}],
                        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}]})");
        work_.write("bad.json", R"({"name": "bad", "duration": 1, "body": {"mass": -1, "inertia": [1, 2, 3]}})");
        work_.write("study.json", R"({"name": "study", "scenes": ["one.json"], "methods": ["dop853"],
                        "settings": {"steps": [0.005]}, "samples": 2, "repeats": 1})");
        work_.write("motion.csv", "t,qw,qx,qy,qz,wx,wy,wz\n0,1,0,0,0,1,2,3\n0.01,1,0.005,0.01,0.015,1,2,3\n");
        work_.write("starts.csv", "Ixx,Iyy,Izz,qw,qx,qy,qz,wx,wy,wz\n1,2,3,1,0,0,0,1,2,3\n1,1,1,1,0,0,0,0,0,1\n");
        work_.write("angles.csv", "j.angle,j.rate\n0.5,0\n-0.5,1\n");
        std::filesystem::create_directory(work_.path() / "results");
        work_.write("results/t.csv", "name,count\na,1\n");
        before_ = files();
    }

  private:
    OwnDirectory work_, beside_;
    std::map<std::string, std::uintmax_t> before_;
};

/// The words of a text, one per line.
inline std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    while (!text.empty() && words.size() < 24) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        words.emplace_back(text.substr(0, std::min(end, text.find('\0'))));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return words;
}

/// An option whose number sets the amount of work. Values up to `most` are fast and values above `refused_beyond` are
/// refused; those between are too slow to try.
struct Amount {
    std::string_view option;
    double most, refused_beyond;
};
inline constexpr double never = std::numeric_limits<double>::infinity();
inline constexpr Amount amounts[] = {{"--duration", 0.05, never}, {"--samples", 20, 1e7}, {"--steps", 1000, 1e12},
                                     {"--digits", 30, 1e6},       {"--jobs", 2, 4096},    {"--threads", 2, 4096}};

/// Whether the option's value is fast to run or refused.
inline bool is_little(std::string_view option, std::string_view value) {
    std::string digits;
    for (const char c : value)
        if (c != '_' && c != '\'') digits += c;  // digit separators
    const double number = std::strtod(digits.c_str(), nullptr);
    if (option == "--step") return number <= 0 || number >= 1e-5;
    if (option == "--tolerance") return number <= 0 || number >= 1e-13;
    for (const Amount& amount : amounts)
        if (option == amount.option) return number <= amount.most || number > amount.refused_beyond;
    return true;
}

/// Whether a command line may be tried: it names nothing outside its directory and requests little work.
inline bool may_be_tried(const std::vector<std::string>& words) {
    if (words.empty()) return true;
    const bool solves = words[0] != "show" && words[0] != "list";
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string_view word = words[i];
        const std::size_t equals = std::min(word.find('='), word.size());
        const std::string_view value = equals < word.size() ? word.substr(equals + 1) : std::string_view();
        // --engines changes state of the process that later inputs would see
        if (word.find("..") != word.npos || word.starts_with("--engines")) return false;
        for (const std::string_view path : {word, value})
            if (path.starts_with('/') || path.starts_with('~')) return false;
        for (const std::string_view name : {word, value})
            if (solves && (!builtin_scene_text(std::string(name)).empty() || !builtin_experiment_text(name).empty()))
                return false;
        if (!is_little(word.substr(0, equals), equals < word.size()   ? value
                                               : i + 1 < words.size() ? std::string_view(words[i + 1])
                                                                      : std::string_view()))
            return false;
    }
    return true;
}

/// Runs a command line, one word per line: it succeeds, or is refused by one line on stderr without any output.
inline void command(std::string_view text) {
    std::vector<std::string> words = words_of(text);
    if (!may_be_tried(words)) return;
    // these take tens of milliseconds: only one input in eight
    if (!words.empty() && (words[0] == "run" || words[0] == "check" || words[0] == "report") && !one_in(8, text))
        return;
    static Bench bench;
    words.insert(words.begin(), "polhode");
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    argv.push_back(nullptr);
    const int here = ::open(".", O_RDONLY | O_DIRECTORY);
    require(::chdir(bench.path().c_str()) == 0, "cannot change to the work directory");
    int exit_code = 0;
    std::string out, err;
    {
        KeptStream kept_out(stdout), kept_err(stderr);
        exit_code = run_laboratory(static_cast<int>(words.size()), argv.data());
        out = kept_out.text(), err = kept_err.text();
    }
    require(::fchdir(here) == 0, "cannot change back to the previous directory");
    ::close(here);
    require(exit_code >= 0 && exit_code <= 2, "the exit code is not 0, 1 or 2");
    require(exit_code != 1 || !err.empty() || !out.empty(), "a failure without any output");
    const bool unchanged = bench.files() == bench.files_before();
    if (!unchanged) bench.fill();
    if (exit_code != 2) return;
    require(unchanged, "bad usage wrote a file");
    require(out.empty(), "bad usage printed to stdout");
    require(err.starts_with("polhode: ") && err.ends_with("\n"), "bad usage is not reported in a line 'polhode: ..'");
    err.pop_back();
    for (const char c : err)
        require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f, "the message is not one line of text");
}

}  // namespace polhode::oracles
