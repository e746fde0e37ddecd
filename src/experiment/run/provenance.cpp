#include "experiment/run/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "experiment/run/build_info.h"
#include "experiment/run/case_store.h"
#include "experiment/run/versions.h"
#include "integrators/sundials/build.h"
#include "text/atomic_file.h"

namespace polhode {
namespace {

using nlohmann::ordered_json;

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

// returns an empty object if the file is missing or invalid
ordered_json read_object(const std::filesystem::path& path) {
    ordered_json all = ordered_json::parse(read(path), nullptr, false);
    return all.is_object() ? all : ordered_json::object();
}

// The commit, which the build writes to a file beside the program. A commit in the program would change program_key().
std::string commit() {
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) return "unknown";
    std::string text = read(program.parent_path() / "commit.txt");
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text.empty() ? "unknown" : text;
}

}  // namespace

void record_provenance(const std::string& directory, const Experiment& experiment,
                       const std::map<std::string, std::string>& titles, const std::vector<std::string>& files,
                       const std::vector<std::string>& machines, const std::string& command_line, bool quick) {
    const std::filesystem::path path = std::filesystem::path(directory) / "provenance.json";
    ordered_json all = read_object(path);
    ordered_json versions = ordered_json::object();
    for (const auto& [name, version] : library_versions()) versions[name] = version;
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    all[experiment.name] = {{"about", experiment.about},
                            {"kind", experiment.kind->name},
                            {"titles", titles},
                            {"files", files},
                            {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))},
                            {"command_line", command_line},
                            {"quick", quick},
                            {"commit", commit()},
                            {"program_key", program_key()},
                            {"compiler", POLHODE_COMPILER},
                            {"flags", POLHODE_FLAGS},
                            {"sundials", sundials_build()},
                            {"versions", versions},
                            {"cpu", processor_name()},
                            {"machines", machines},
                            {"cores", std::thread::hardware_concurrency()}};
    write_atomically(path.string(), all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

std::vector<std::string> recorded_files(const std::string& directory, const std::string& experiment) {
    const ordered_json all = read_object(std::filesystem::path(directory) / "provenance.json");
    std::vector<std::string> files;
    const auto entry = all.find(experiment);
    if (entry == all.end() || !entry->is_object() || !entry->contains("files")) return files;
    for (const ordered_json& file : entry->at("files")) {
        if (!file.is_string()) continue;
        const std::filesystem::path name(file.get<std::string>());
        // the directory is untrusted: accept plain file names only
        if (name.filename() == name && name != "." && name != "..") files.push_back(name.string());
    }
    return files;
}

void copy_provenance(const std::string& from, const std::string& directory, const std::string& experiment) {
    const std::filesystem::path path = std::filesystem::path(directory) / "provenance.json";
    ordered_json all = read_object(path);
    const ordered_json other = read_object(std::filesystem::path(from) / "provenance.json");
    if (const auto entry = other.find(experiment); entry != other.end()) all[experiment] = *entry;
    write_atomically(path.string(), all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

void record_scenes(const std::string& directory, const Plan& plan) {
    const std::filesystem::path path = std::filesystem::path(directory) / "scenes.json";
    // sorted by name, so that the file does not depend on the order of runs
    nlohmann::json all = nlohmann::json::parse(read(path), nullptr, false);
    if (!all.is_object()) all = nlohmann::json::object();
    for (const PlannedScene& scene : plan.scenes) {
        const nlohmann::json canonical = nlohmann::json::parse(scene.canonical, nullptr, false, true);
        if (!canonical.is_object()) continue;
        all[scene.label] = scene.canonical;
    }
    write_atomically(path.string(), all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace polhode
