// polhode check: trajectories of anyone's making against the truth.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/commands.h"
#include "check/check_files.h"
#include "check/foreign_table.h"
#include "check/limits.h"
#include "check/report.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

struct CheckOptions {
    std::string scene, format = "text", convention, columns;
    std::vector<std::string> trajectories;
    std::map<std::string, std::string> limits;  // by block, as they were given
    bool report_only = false, explain = false;
};

// The files, and of each folder its CSV files by name.
std::vector<std::string> files_of(const std::vector<std::string>& paths) {
    namespace fs = std::filesystem;
    std::vector<std::string> files;
    for (const std::string& path : paths) {
        std::error_code none;
        if (!fs::is_directory(path, none)) {
            files.push_back(path);
            continue;
        }
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(path))
            if (entry.path().extension() == ".csv") found.push_back(entry.path().string());
        if (found.empty()) throw InputError(path, "", "is a folder without a .csv file", "give trajectory files");
        std::ranges::sort(found);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

int check_command(const CheckOptions& options) {
    const Convention convention = convention_option(options.convention);
    ColumnNames columns;
    if (!options.columns.empty()) try {
            columns = parse_columns(options.columns);
        } catch (const std::invalid_argument& error) {
            throw UsageError(fmt::format("--columns: {}", error.what()));
        }
    const Scene scene = find_scene(options.scene);
    ErrorLimits limits(scene);
    limits.report_only = options.report_only;
    for (const auto& [block, text] : options.limits)
        if (!text.empty()) try {
                limits.set(block, text);
            } catch (const std::invalid_argument& error) {
                throw UsageError(error.what());
            }
    std::vector<CheckedFile> all;
    try {
        all = check_files(scene, files_of(options.trajectories), convention, columns, limits, options.explain);
    } catch (const NoTruth& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    const std::string text = check_text(limits, all) + (options.explain ? explanation_text(all) : "");
    write_output("", options.format == "json"    ? check_json(scene, limits, all)
                     : options.format == "junit" ? check_junit(scene, limits, all)
                                                 : text);
    const auto exceeds = [&](const CheckedFile& checked) { return limits.exceeded_by(checked.judgement); };
    return !options.report_only && std::any_of(all.begin(), all.end(), exceeds) ? 1 : 0;
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("check",
                                               "Judges trajectory files against the truth and says what is wrong where "
                                               "the fault is known; exit code 1 where an error is too large: of the "
                                               "attitude, or of any other block that the file has.");
    const auto options = std::make_shared<CheckOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("TRAJECTORY", options->trajectories,
                     "CSV files with the columns t,qw,qx,qy,qz and, where they are known, wx,wy,wz, px,py,pz (or the "
                     "body's origin ox,oy,oz) and vx,vy,vz; of a folder all that end in .csv")
        ->required();
    for (const JudgedBlock& block : judged_blocks()) {
        std::string name = "--max-" + std::string(block.name);
        std::ranges::replace(name, '_', '-');
        command->add_option(
            name, options->limits[std::string(block.name)],
            fmt::format("The largest error of the {} allowed{}{} (default: what the scene tolerates, or else {})",
                        block.title, block.unit.empty() ? "" : fmt::format(", {}", block.unit),
                        block.relative > 0 ? ", or a part of the motion's size such as 2%" : "",
                        block.relative > 0 ? fmt::format("{:g} %", 100 * block.relative)
                                           : fmt::format("{:g} {}", block.absolute, block.unit)));
    }
    command->add_option("--columns", options->columns,
                        "Which columns hold what, where names are not ours: time=T,rotation=X:Y:Z:W (or the nine of a "
                        "matrix, row by row),angular_velocity=X:Y:Z,position=..,origin=..,velocity=..; others are "
                        "ignored. Names in common use are known without it");
    command->add_flag("--report-only", options->report_only,
                      "Tell the errors; the exit code is 0 however large they are");
    command->add_flag("--explain", options->explain, "List the faults that were tried and what each leaves");
    command->add_option(
        "--convention", options->convention,
        "What the files are written in, words joined by commas: y-up or z-up (y-up: the scene's (x, y, z) is (x, z, "
        "-y) "
        "there, and (x, z, y) where left-handed), left-handed or right-handed (z-up, left-handed: (x, -y, z)), degrees "
        "(w in degrees per second), body-rates (w in body axes), centimetres, millimetres, inches or feet, "
        "scalar-first or scalar-last (the four columns of the quaternion hold w,x,y,z or "
        "x,y,z,w in the order in which they stand, whatever their names); or unity (y-up,left-handed), unreal "
        "(left-handed,centimetres), godot, three or bullet (y-up). "
        "The "
        "body is taken to be built in the same axes. Default: z-up, right-handed, radians, columns by name");
    command->add_option("--format", options->format, "text, json or junit")
        ->check(CLI::IsMember({"text", "json", "junit"}))
        ->capture_default_str();
    command->callback([options, &exit_code] { exit_code = check_command(*options); });
}

}  // namespace polhode
