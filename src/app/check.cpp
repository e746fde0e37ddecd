// polhode check: trajectories of anyone's making against the truth.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/lookup.h"
#include "check/check_files.h"
#include "check/foreign_table.h"
#include "check/limits.h"
#include "check/report.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

struct CheckOptions {
    std::string scene, format = "text", convention, columns, length_unit, angle_unit, picture;
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

// Units are words of a convention.
Convention convention_of(const CheckOptions& options) {
    std::string words = options.convention;
    const auto add = [&](std::string_view word) { words += (words.empty() ? "" : ",") + std::string(word); };
    if (!options.length_unit.empty()) add(length_units().at(options.length_unit));
    if (!options.angle_unit.empty()) add(options.angle_unit == "deg" ? "degrees" : "radians");
    return convention_option(words);
}

// Says on stderr what takes so long, where it takes more than two seconds.
class Notice {
  public:
    explicit Notice(std::string text) {
        try {
            thread_ = std::thread([this, said = std::move(text)] {
                std::unique_lock lock(mutex_);
                if (!ended_.wait_for(lock, std::chrono::seconds(2), [this] { return has_ended_; }))
                    std::fputs(said.c_str(), stderr);
            });
        } catch (const std::system_error&) {
            // where the system gives no thread, nothing is said
        }
    }
    Notice(const Notice&) = delete;
    Notice& operator=(const Notice&) = delete;
    ~Notice() {
        {
            const std::lock_guard lock(mutex_);
            has_ended_ = true;
        }
        ended_.notify_one();
        if (thread_.joinable()) thread_.join();
    }

  private:
    std::mutex mutex_;
    std::condition_variable ended_;
    bool has_ended_ = false;
    std::thread thread_;  // the last: it uses the others
};

int check_command(const CheckOptions& options) {
    const Convention convention = convention_of(options);
    ColumnNames columns;
    if (!options.columns.empty()) columns = as_usage([&] { return parse_columns(options.columns); }, "--columns: ");
    columns.degrees = convention.degrees;
    std::string drawn = options.picture;
    if (!drawn.empty()) {
        if (!drawn.ends_with(".svg")) throw UsageError("--picture: is no name of an SVG file; give NAME.svg");
        drawn.resize(drawn.size() - 4);
        require_output(options.picture);
    }
    const Scene scene = read_scene_with_notes(options.scene);
    ErrorLimits limits(scene);
    limits.report_only = options.report_only;
    for (const auto& [block, text] : options.limits)
        if (!text.empty() && is_of_joints(block) && !is_mechanism(scene))
            throw UsageError(fmt::format("--max-{}: is of joints, and the scene is of one body; leave it out",
                                         block == "joint_gap" ? "joint-gap" : "joint-turn"));
        else if (!text.empty())
            as_usage([&, name = block, value = text] { limits.set(name, value); });
    const std::vector<std::string> files = files_of(options.trajectories);
    if (!drawn.empty() && files.size() > 1) throw UsageError("--picture: draws one trajectory; give one file");
    std::vector<CheckedFile> all;
    try {
        const Notice notice("polhode: computing the reference; it is kept, so that the next check takes less\n");
        all = check_files(scene, files, convention, columns, limits, options.explain, !drawn.empty());
    } catch (const NoTruth& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    if (!drawn.empty())
        if (const std::string fault = draw(*all.front().picture, drawn); !fault.empty())
            throw std::runtime_error("the picture was not drawn: " + fault);
    if (options.format == "json")
        write_output("", check_json(scene, limits, all));
    else if (options.format == "junit")
        write_output("", check_junit(scene, limits, all));
    else
        write_output("", check_text(limits, all) + (options.explain ? explanation_text(all) : ""));
    return std::ranges::any_of(all, [&](const CheckedFile& c) { return limits.refuses(c.judgement); }) ? 1 : 0;
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("check",
                                               "Judges trajectory files against the truth and says what is wrong where "
                                               "the fault is known; exit code 1 where an error is too large: of the "
                                               "attitude, or of any other block that the file has.");
    tell_columns(*command);
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
    command->add_option(
        "--columns", options->columns,
        "Which columns hold what, where names are not ours: time=T,rotation=X:Y:Z:W (or the nine of a "
        "matrix, row by row),body=NAME (of scenes of several "
        "bodies),angular_velocity=X:Y:Z,position=..,origin=..,velocity=..; others are "
        "ignored; in place of rotation also matrix_by_columns= and Euler angles, euler_zyx=yaw:pitch:roll "
        "(any sequence, each turn about the axes that those before have brought). "
        "Names in common use are known without it");
    std::vector<std::string> lengths;
    for (const auto& [name, word] : length_units()) lengths.push_back(name);
    command->add_option("--length-unit", options->length_unit, "Unit of positions and velocities in the files")
        ->check(CLI::IsMember(lengths));
    command->add_option("--angle-unit", options->angle_unit, "Unit of w and of Euler angles in the files")
        ->check(CLI::IsMember({"rad", "deg"}));
    command->add_option("--picture", options->picture,
                        "F.svg (and F.pdf): the error of each block over time, beside what is allowed, the floors and "
                        "the update of the catalogue that is nearest");
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
    outside_option(*command);
    command->callback([options, &exit_code] { exit_code = check_command(*options); });
}

}  // namespace polhode
