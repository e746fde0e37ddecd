// polhode check: compares trajectories from any program with the truth. Parses the options, computes or reads the
// reference through check_files(), and prints the verdicts as text, JSON or JUnit.
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
    std::map<std::string, std::string> limits;  // by block, as given
    bool report_only = false, explain = false;
};

// Returns the files; directories are replaced by their CSV files, sorted by name.
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
        if (found.empty()) throw InputError(path, "", "is a directory without .csv files", "give trajectory files");
        std::ranges::sort(found);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

// Adds the words of --length-unit and --angle-unit to the convention.
Convention convention_of(const CheckOptions& options) {
    std::string words = options.convention;
    const auto add = [&](std::string_view word) { words += (words.empty() ? "" : ",") + std::string(word); };
    if (!options.length_unit.empty()) add(length_units().at(options.length_unit));
    if (!options.angle_unit.empty()) add(options.angle_unit == "deg" ? "degrees" : "radians");
    return parse_convention_option(words);
}

// Prints a text to stderr unless it is destroyed within two seconds.
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
            // without a thread the notice is not printed
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
    std::thread thread_;  // last member: the thread uses the others
};

int check_command(const CheckOptions& options) {
    const Convention convention = convention_of(options);
    ColumnNames columns;
    if (!options.columns.empty()) columns = as_usage([&] { return parse_columns(options.columns); }, "--columns: ");
    columns.degrees = convention.degrees;
    std::string drawn = options.picture;
    if (!drawn.empty()) {
        if (!drawn.ends_with(".svg")) throw UsageError("--picture must end in .svg; give NAME.svg");
        drawn.resize(drawn.size() - 4);
        require_output(options.picture);
    }
    const Scene scene = read_scene_with_notes(options.scene);
    ErrorLimits limits(scene);
    limits.report_only = options.report_only;
    for (const auto& [block, text] : options.limits)
        if (!text.empty() && !has_quantity(scene, block))
            throw UsageError(fmt::format("--max-{} applies to joints, and the scene has one body; remove the option",
                                         block == "joint_gap" ? "joint-gap" : "joint-turn"));
        else if (!text.empty())
            as_usage([&, name = block, value = text] { limits.set(name, value); });
    const std::vector<std::string> files = files_of(options.trajectories);
    if (!drawn.empty() && files.size() > 1) throw UsageError("--picture draws one trajectory; give one file");
    std::vector<CheckedFile> all;
    try {
        const Notice notice("polhode: computing the reference; it is cached, and the next check is faster\n");
        all = check_files(scene, files, convention, columns, limits, options.explain, !drawn.empty());
    } catch (const TruthUnavailable& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    if (!drawn.empty())
        if (const std::string fault = draw(*all.front().picture, drawn); !fault.empty())
            throw std::runtime_error("cannot draw the picture: " + fault);
    if (options.format == "json")
        write_output("", check_json(scene, limits, all));
    else if (options.format == "junit")
        write_output("", check_junit(scene, limits, all));
    else
        write_output("", check_text(limits, all) + (options.explain ? explanation_text(all) : ""));
    return std::ranges::any_of(all, [&](const CheckedFile& c) { return limits.refuses(c.file_errors); }) ? 1 : 0;
}

void describe_check(CLI::App& command) {
    describe_columns(
        command,
        "Blocks of --columns (BLOCK=COLUMN or BLOCK=COLUMN:COLUMN:..):\n"
        "  time=T  body=NAME  angular_velocity=X:Y:Z  position=X:Y:Z  origin=X:Y:Z  velocity=X:Y:Z\n"
        "  rotation=X:Y:Z:W   quaternion, or a rotation matrix by nine columns, row by row\n"
        "  matrix_by_columns= rotation matrix by nine columns, column by column\n"
        "  euler_zyx=A:B:C    Euler angles of any sequence, intrinsic rotations in this order\n"
        "\n"
        "Words of --convention (default: z-up, right-handed, radians, world-rates, metres, columns by name):\n"
        "  y-up               the scene's (x, y, z) is (x, z, -y) in the file; z-up: no change\n"
        "  left-handed        the scene's (x, y, z) is (x, z, y) with y-up, (x, -y, z) with z-up\n"
        "  right-handed       axes are right-handed\n"
        "  degrees, radians   Euler angles in deg or rad, w in deg/s or rad/s\n"
        "  body-rates         w in body axes\n"
        "  world-rates        w in world axes\n"
        "  scalar-first       the quaternion's columns are w,x,y,z in file order, whatever their names\n"
        "  scalar-last        the quaternion's columns are x,y,z,w in file order, whatever their names\n"
        "  metres, centimetres, millimetres, inches, feet   unit of positions and velocities\n"
        "  unity              y-up,left-handed\n"
        "  unreal             z-up,left-handed,centimetres\n"
        "  godot, three, bullet   y-up,right-handed\n"
        "\n"
        "Examples:\n"
        "  polhode check lagrange_top mine.csv --max-attitude 1e-6\n"
        "  polhode check t_handle engine.csv --convention unity,degrees --explain\n"
        "  polhode check t_handle log.csv --columns time=Time,rotation=a:b:c:d --format junit\n");
}

void add_limit_options(CLI::App& command, CheckOptions& options) {
    for (const ErrorBlock& block : error_blocks()) {
        std::string name = "--max-" + std::string(block.name);
        std::ranges::replace(name, '_', '-');
        command.add_option(
            name, options.limits[std::string(block.name)],
            fmt::format("Largest allowed error of the {}{}{} (default: the scene's \"tolerated\", otherwise {})",
                        block.title, block.unit.empty() ? "" : fmt::format(", in {}", block.unit),
                        block.unit.empty()   ? ", relative to its size, such as 0.02 or 2%"
                        : block.relative > 0 ? " or relative to the motion's size such as 2%"
                                             : "",
                        block.relative > 0 ? fmt::format("{:g} %", 100 * block.relative)
                                           : fmt::format("{:g} {}", block.absolute, block.unit)));
    }
}

void add_column_options(CLI::App& command, CheckOptions& options) {
    command.add_option("--columns", options.columns,
                       "Map of blocks to column names, such as time=T,rotation=X:Y:Z:W,position=A:B:C (blocks: below). "
                       "Other columns are ignored. Common names are recognised without this option");
    std::vector<std::string> lengths;
    for (const auto& [name, word] : length_units()) lengths.push_back(name);
    command
        .add_option("--length-unit", options.length_unit, "Unit of positions and velocities in the files (default m)")
        ->check(CLI::IsMember(lengths));
    command.add_option("--angle-unit", options.angle_unit, "Unit of w and Euler angles in the files (default rad)")
        ->check(CLI::IsMember({"rad", "deg"}));
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("check",
                                               "Compares trajectory files with the truth and diagnoses known faults. "
                                               "The exit code is 1 if the error of any block exceeds its limit.");
    describe_check(*command);
    const auto options = std::make_shared<CheckOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("TRAJECTORY", options->trajectories,
                     "CSV files, or directories of .csv files. Required columns: t,qw,qx,qy,qz. Optional columns: "
                     "wx,wy,wz, px,py,pz (or the body's origin ox,oy,oz), vx,vy,vz")
        ->required();
    add_limit_options(*command, *options);
    add_column_options(*command, *options);
    command->add_option("--picture", options->picture,
                        "Draw to F.svg and F.pdf: each block's error over time, its limit, the floors and the nearest "
                        "update of the catalogue");
    command->add_flag("--report-only", options->report_only, "Report errors of any size with exit code 0");
    command->add_flag("--explain", options->explain, "List the faults that were tried and the error that each leaves");
    command->add_option(
        "--convention", options->convention,
        "Convention of the files: words joined by commas, such as y-up,left-handed,degrees, or a program: unity, "
        "unreal, godot, three, bullet (words and default: below). The body is assumed to use the same axes");
    command->add_option("--format", options->format, "Output format: text, json or junit")
        ->check(CLI::IsMember({"text", "json", "junit"}))
        ->capture_default_str();
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = check_command(*options); });
}

}  // namespace polhode
