// polhode check: trajectories of anyone's making against the truth.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "check/check_files.h"
#include "check/report.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

struct Options {
    std::string scene, format = "text", convention;
    std::vector<std::string> trajectories;
    std::optional<double> max_attitude;
};

int run(const Options& options) {
    if (options.max_attitude) require_positive("--max-attitude", *options.max_attitude);
    const Convention convention = convention_option(options.convention);
    const Scene scene = find_scene(options.scene);
    AttitudeLimit limit{options.max_attitude, "--max-attitude"};
    if (!limit.attitude) limit = {scene.tolerated_attitude, "tolerated by the scene"};
    std::vector<CheckedFile> all;
    try {
        all = check_files(scene, options.trajectories, convention, limit);
    } catch (const NoTruth& fault) {
        std::fputs(("polhode: " + one_line(fault.what(), 500) + "\n").c_str(), stderr);
        return 1;
    }
    write_output("", options.format == "json"    ? check_json(scene, limit, all)
                     : options.format == "junit" ? check_junit(scene, limit, all)
                                                 : check_text(limit, all));
    const auto exceeds = [&](const CheckedFile& checked) { return limit.exceeded_by(checked); };
    return std::any_of(all.begin(), all.end(), exceeds) ? 1 : 0;
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("check",
                                               "Judges trajectory files against the truth and says what is wrong where "
                                               "the fault is known; exit code 1 where an "
                                               "attitude error is too large.");
    const auto options = std::make_shared<Options>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("TRAJECTORY", options->trajectories,
                     "CSV files with the columns t,qw,qx,qy,qz and, where they are known, wx,wy,wz, px,py,pz (or the "
                     "body's origin ox,oy,oz) and vx,vy,vz")
        ->required();
    command->add_option("--max-attitude", options->max_attitude,
                        "The largest attitude error allowed, rad (default: what the scene tolerates, if it says so)");
    command->add_option(
        "--convention", options->convention,
        "What the files are written in, words joined by commas: y-up or z-up (y-up: the scene's (x, y, z) is (x, z, "
        "-y) "
        "there, and (x, z, y) where left-handed), left-handed or right-handed (z-up, left-handed: (x, -y, z)), degrees "
        "(w in degrees per second), scalar-first or scalar-last (the four columns of the quaternion hold w,x,y,z or "
        "x,y,z,w in the order in which they stand, whatever their names); or unity (y-up,left-handed), godot (y-up). "
        "The "
        "body is taken to be built in the same axes. Default: z-up, right-handed, radians, columns by name");
    command->add_option("--format", options->format, "text, json or junit")
        ->check(CLI::IsMember({"text", "json", "junit"}))
        ->capture_default_str();
    command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace polhode
