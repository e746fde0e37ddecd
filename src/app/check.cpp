// polhode check: trajectories of anyone's making against the truth.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "integrators/truth/reference.h"
#include "measure/judge.h"
#include "scene/json_document.h"
#include "scene/message.h"
#include "scene/scene_file.h"
#include "table/decimal.h"

namespace polhode {
namespace {

struct Options {
    std::string scene, format = "text";
    std::vector<std::string> trajectories;
    std::optional<double> max_attitude;
};

/// One file and what came of it.
struct Checked {
    std::string path;
    TrajectoryFile file;
    Judgement judgement;
    double truth_bound = 0;
};

/// What a file is held to.
struct Limit {
    std::optional<double> attitude;  ///< rad
    const char* from = "";           ///< who set it

    bool exceeded_by(const Checked& checked) const {
        return attitude && !(checked.judgement.attitude_max <= *attitude);
    }
    const char* verdict(const Checked& checked) const {
        return !attitude ? "reported" : exceeded_by(checked) ? "failed" : "passed";
    }
};

// The name of each number, and the number where there is one.
std::vector<std::pair<const char*, std::optional<double>>> numbers(const Judgement& j) {
    return {{"attitude_error_max", j.attitude_max}, {"attitude_error_final", j.attitude_final},
            {"omega_error_max", j.omega_max},       {"energy_error_max", j.energy_max},
            {"momentum_error_max", j.momentum_max}, {"position_error_max", j.position_max},
            {"velocity_error_max", j.velocity_max}, {"norm_error_max", j.norm_max}};
}

std::string sentence(const Limit& limit, const Checked& c) {
    std::string text = fmt::format("attitude error at most {:.3g} rad, at t = {} s", c.judgement.attitude_max,
                                   shortest_decimal(c.judgement.attitude_max_time));
    if (limit.attitude)
        text += fmt::format("; {}{} rad allowed ({})", limit.exceeded_by(c) ? "more than the " : "",
                            shortest_decimal(*limit.attitude), limit.from);
    return text;
}

std::string text(const Limit& limit, const std::vector<Checked>& all) {
    std::string report;
    for (const Checked& c : all) {
        report += fmt::format("{}: {}: {}\n", one_line(c.path, 300), limit.verdict(c), sentence(limit, c));
        report += fmt::format("  {:<22}{}, t = {} to {} s\n", "samples", c.file.rows.size(),
                              shortest_decimal(c.file.rows.front().t), shortest_decimal(c.file.rows.back().t));
        for (const auto& [name, value] : numbers(c.judgement))
            report += fmt::format("  {:<22}{}\n", name, value ? fmt::format("{:.3e}", *value) : "not in the file");
        report += fmt::format("  {:<22}{:.2e}\n", "bound of the truth", c.truth_bound);
    }
    return report;
}

std::string json(const Scene& scene, const Limit& limit, const std::vector<Checked>& all) {
    std::string report =
        fmt::format("{{\"scene\": {}, \"max_attitude\": {}, \"trajectories\": [", json_string(scene.name),
                    limit.attitude ? shortest_decimal(*limit.attitude) : "null");
    for (const Checked& c : all) {
        report += fmt::format("{}\n  {{\"file\": {}, \"verdict\": \"{}\", \"samples\": {}, \"from\": {}, \"until\": {}",
                              &c == &all.front() ? "" : ",", json_string(one_line(c.path, 4096)), limit.verdict(c),
                              c.file.rows.size(), shortest_decimal(c.file.rows.front().t),
                              shortest_decimal(c.file.rows.back().t));
        report += fmt::format(", \"attitude_error_max_time\": {}", shortest_decimal(c.judgement.attitude_max_time));
        for (const auto& [name, value] : numbers(c.judgement))
            report += fmt::format(", \"{}\": {}", name, value ? shortest_decimal(*value) : "null");
        report += fmt::format(", \"truth_bound\": {}}}", shortest_decimal(c.truth_bound));
    }
    return report + "\n]}\n";
}

std::string xml_attribute(const std::string& text) {
    std::string escaped;
    for (const char c : one_line(text, 4096)) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '"')
            escaped += "&quot;";
        else
            escaped += c;
    }
    return '"' + escaped + '"';
}

// A test case for each file, as continuous integration reads them.
std::string junit(const Scene& scene, const Limit& limit, const std::vector<Checked>& all) {
    std::string cases;
    int failures = 0;
    for (const Checked& c : all) {
        cases += fmt::format("    <testcase classname={} name={}", xml_attribute("polhode check " + scene.name),
                             xml_attribute(c.path));
        if (limit.exceeded_by(c)) {
            ++failures;
            cases +=
                fmt::format(">\n      <failure message={}/>\n    </testcase>\n", xml_attribute(sentence(limit, c)));
        } else {
            cases += "/>\n";
        }
    }
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuites tests=\"{0}\" failures=\"{1}\">\n"
        "  <testsuite name={2} tests=\"{0}\" failures=\"{1}\">\n{3}  </testsuite>\n</testsuites>\n",
        all.size(), failures, xml_attribute("polhode check " + scene.name), cases);
}

int run(const Options& options) {
    if (options.max_attitude) require_positive("--max-attitude", *options.max_attitude);
    const Scene scene = find_scene(options.scene);
    // all are read before any is judged: a slip in the last must not cost the time of the first
    std::vector<Checked> all;
    for (const std::string& path : options.trajectories) {
        Checked& checked = all.emplace_back();
        checked.path = path, checked.file = read_trajectory(path);
        // a clock that adds up steps ends beside the duration by rounding
        if (const double last = checked.file.rows.back().t; last > scene.duration * (1 + 1e-9))
            throw InputError(path, "column t",
                             fmt::format("goes on to {} s, and the scene lasts {} s", shortest_decimal(last),
                                         shortest_decimal(scene.duration)),
                             "give times in s within the scene's duration, or a scene that lasts longer");
    }
    for (Checked& checked : all) {
        std::vector<double> times;
        for (const TrajectoryRow& row : checked.file.rows) times.push_back(row.t);
        const Reference truth = reference(scene, times);
        if (!truth.available) {
            std::fputs(("polhode: " + one_line(checked.path + ": " + truth.message, 500) + "\n").c_str(), stderr);
            return 1;
        }
        checked.truth_bound = truth.bound;
        checked.judgement = judge(scene, checked.file, truth);
    }
    Limit limit{options.max_attitude, "--max-attitude"};
    if (!limit.attitude) limit = {scene.tolerated_attitude, "tolerated by the scene"};
    write_output("", options.format == "json"    ? json(scene, limit, all)
                     : options.format == "junit" ? junit(scene, limit, all)
                                                 : text(limit, all));
    for (const Checked& checked : all)
        if (limit.exceeded_by(checked)) return 1;
    return 0;
}

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "check", "Judges trajectory files against the truth; exit code 1 where an attitude error is too large.");
    const auto options = std::make_shared<Options>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("TRAJECTORY", options->trajectories,
                     "CSV files with the columns t,qw,qx,qy,qz and, where they are known, wx,wy,wz, px,py,pz (or the "
                     "body's origin ox,oy,oz) and vx,vy,vz")
        ->required();
    command->add_option("--max-attitude", options->max_attitude,
                        "The largest attitude error allowed, rad (default: what the scene tolerates, if it says so)");
    command->add_option("--format", options->format, "text, json or junit")
        ->check(CLI::IsMember({"text", "json", "junit"}))
        ->capture_default_str();
    command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace polhode
