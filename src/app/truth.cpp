// polhode truth: writes the reference trajectory in decimals, as CSV or JSON. Numbers are strings, because binary64
// does not hold their digits. Without --certified all rows share one bound; with it each number has a proven radius.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/contact_output.h"
#include "app/lookup.h"
#include "integrators/analysis/joint_history.h"
#include "integrators/truth/balls/certified.h"
#include "integrators/truth/reference.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_true_samples = 1'000'000;
constexpr const char* names[] = {"qw", "qx", "qy", "qz", "wx", "wy", "wz", "px", "py", "pz", "vx", "vy", "vz"};

struct TruthOptions {
    std::string scene, format = "csv", output, reactions, joints;
    std::optional<double> duration;
    long samples = 100;
    int digits = 17;
    double max_seconds = truth_seconds;
    bool certified = false;
    ContactOptions contacts;
};

std::string csv(const Scene& scene, const DecimalReference& truth) {
    const std::vector<std::string> bodies = body_names(scene);
    std::string text =
        fmt::format("# {}: {}\nt{}", one_line(scene.name, 100), truth.message, bodies.empty() ? "" : ",body");
    for (const char* name : names) text.append(",").append(name);
    text += ",bound\n";
    for (std::size_t i = 0; i < truth.impact_times.size(); ++i)
        text += fmt::format("# impact {} at t = {} s\n", i + 1, truth.impact_times[i]);
    const std::string bound = fmt::format(",{:.2e}\n", truth.bound);
    const std::size_t at_once = static_cast<std::size_t>(truth.bodies);
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        text += shortest_decimal(truth.times[i / at_once]);
        if (!bodies.empty()) text.append(",").append(bodies[i % at_once]);
        for (const std::string& value : truth.columns[i]) text.append(",").append(value);
        text += bound;
    }
    return text;
}

std::string json(const Scene& scene, const TruthOptions& options, const DecimalReference& truth) {
    std::string text = fmt::format(
        "{{\"scene\": {}, \"scene_hash\": \"{}\", \"method\": {}, \"digits\": {}, \"bound\": {:.2e},\n \"columns\": "
        "[\"t\"",
        json_string(scene.name), truth.scene_hash, json_string(truth.message), options.digits, truth.bound);
    const std::vector<std::string> bodies = body_names(scene);
    if (!bodies.empty()) text += ", \"body\"";
    for (const char* name : names) text += fmt::format(", \"{}\"", name);
    text += "],\n";
    if (!truth.impact_times.empty()) {
        text += fmt::format(" \"impact_time_error\": {:.2e}, \"impact_times\": [", truth.impact_time_error);
        for (std::size_t i = 0; i < truth.impact_times.size(); ++i)
            text += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", truth.impact_times[i]);
        text += "],\n";
    }
    text += " \"samples\": [";
    const std::size_t at_once = static_cast<std::size_t>(truth.bodies);
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        text += fmt::format("{}\n  [\"{}\"", i == 0 ? "" : ",", shortest_decimal(truth.times[i / at_once]));
        if (!bodies.empty()) text += ", " + json_string(bodies[i % at_once]);
        for (const std::string& value : truth.columns[i]) text += fmt::format(", \"{}\"", value);
        text += ']';
    }
    return text + "\n]}\n";
}

constexpr const char* reaction_columns[] = {"fx", "fy", "fz", "tx", "ty", "tz"};

// Returns the reactions of joints, then of loops, or those of planes, at each time.
std::string reactions_csv_of(const Scene& scene, const DecimalReference& truth) {
    const std::vector<std::string> joints = reaction_names(scene);
    std::string text = scene.planes.empty() ? "t,joint" : "t,plane";
    for (const char* name : reaction_columns) text.append(",").append(name);
    text += '\n';
    for (std::size_t i = 0; i < truth.reactions.size(); ++i) {
        text += shortest_decimal(truth.times[i / joints.size()]);
        text.append(",").append(joints[i % joints.size()]);
        for (const std::string& value : truth.reactions[i]) text.append(",").append(value);
        text += '\n';
    }
    return text;
}

std::string reactions_json(const Scene& scene, const DecimalReference& truth) {
    const std::vector<std::string> joints = reaction_names(scene);
    std::string text = fmt::format("{{\"scene\": {}, \"scene_hash\": \"{}\",\n \"columns\": [\"t\", \"{}\"",
                                   json_string(scene.name), truth.scene_hash, scene.planes.empty() ? "joint" : "plane");
    for (const char* name : reaction_columns) text += fmt::format(", \"{}\"", name);
    text += "],\n \"reactions\": [";
    for (std::size_t i = 0; i < truth.reactions.size(); ++i) {
        text += fmt::format("{}\n  [\"{}\", {}", i == 0 ? "" : ",", shortest_decimal(truth.times[i / joints.size()]),
                            json_string(joints[i % joints.size()]));
        for (const std::string& value : truth.reactions[i]) text += fmt::format(", \"{}\"", value);
        text += ']';
    }
    return text + "\n]}\n";
}

// The column `bound` is the largest radius of the numbers in the row.
std::string csv(const Scene& scene, const CertifiedReference& truth) {
    std::string text =
        fmt::format("# {}: {}; proven to {} digits\nt", one_line(scene.name, 100), truth.message, truth.digits);
    const std::vector<std::string> bodies = body_names(scene);
    if (!bodies.empty()) text += ",body";
    for (const char* name : names) text.append(",").append(name);
    text += ",bound\n";
    const std::size_t at_once = static_cast<std::size_t>(truth.bodies);
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        text += shortest_decimal(truth.times[i / at_once]);
        if (!bodies.empty()) text.append(",").append(bodies[i % at_once]);
        for (const CertifiedNumber& number : truth.columns[i]) text.append(",").append(number.value);
        text.append(",").append(truth.bounds[i]).append("\n");
    }
    return text;
}

std::string json(const Scene& scene, const CertifiedReference& truth) {
    std::string text = fmt::format(
        "{{\"scene\": {}, \"scene_hash\": \"{}\", \"certified\": true, \"method\": {}, \"requested_digits\": {}, "
        "\"digits\": {},\n \"working_bits\": {}, \"steps\": {}, \"radius\": \"{}\", \"seconds\": {:.3f},\n "
        "\"columns\": [\"t\"",
        json_string(scene.name), truth.scene_hash, json_string(truth.method), truth.requested_digits, truth.digits,
        truth.working_bits, truth.steps, truth.radius, truth.seconds);
    const std::vector<std::string> bodies = body_names(scene);
    if (!bodies.empty()) text += ", \"body\"";
    for (const char* name : names) text += fmt::format(", \"{}\"", name);
    text += "],\n \"samples\": [";
    const std::size_t at_once = static_cast<std::size_t>(truth.bodies);
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        text += fmt::format("{}\n  [\"{}\"", i == 0 ? "" : ",", shortest_decimal(truth.times[i / at_once]));
        if (!bodies.empty()) text += ", " + json_string(bodies[i % at_once]);
        for (const CertifiedNumber& number : truth.columns[i])
            text += fmt::format(",\n   {{\"value\": \"{}\", \"radius\": \"{}\", \"digits\": {}}}", number.value,
                                number.radius, number.digits);
        text += ']';
    }
    text += "\n]";
    if (!scene.planes.empty()) {
        text += ",\n \"events\": [";
        for (std::size_t i = 0; i < truth.events.size(); ++i) {
            const CertifiedEvent& event = truth.events[i];
            text += fmt::format("{}\n  {{\"event\": \"{}\", \"plane\": {}, \"t\": \"{}\", \"radius\": \"{}\"}}",
                                i == 0 ? "" : ",", event.kind, json_string(event.plane), event.t.value, event.t.radius);
        }
        text += "\n]";
    }
    return text + "}\n";
}

int run_certified(const TruthOptions& options, const Scene& scene) {
    const CertifiedReference truth = certified_reference(scene, options.samples, options.digits, options.max_seconds);
    if (!truth.available) {
        std::fputs(("polhode: " + one_line(truth.message, 500) + "\n").c_str(), stderr);
        return 1;
    }
    if (options.format == "json")
        write_output(options.output, json(scene, truth));
    else
        write_trajectory_output(options.output, csv(scene, truth));
    std::fputs(
        fmt::format("scene    {}\ntruth    {}\nproven   {} digits, largest radius {}\nsteps    {}\ntime     "
                    "{:.3g} s\n",
                    one_line(scene.name, 100), truth.message, truth.digits, truth.radius, truth.steps, truth.seconds)
            .c_str(),
        stderr);
    return 0;
}

// The joints' coordinates and rates as decimals: t,joint,coordinate,rate, one line per coordinate.
std::string joints_csv_of(const Scene& scene, const JointHistory<Wide>& history, int digits) {
    const std::vector<std::string> joints = joint_names(scene);
    std::string text = "t,joint,coordinate,rate\n";
    for (std::size_t i = 0; i < history.motions.size(); ++i) {
        const std::vector<Wide> x = history.motions[i].coordinates(), rate = history.motions[i].rates();
        for (std::size_t k = 0; k < x.size(); ++k)
            text +=
                fmt::format("{},{},{},{}\n", shortest_decimal(history.times[i / scene.joints.size()]),
                            joints[i % scene.joints.size()], wide_decimal(x[k], digits), wide_decimal(rate[k], digits));
    }
    return text;
}

std::string joints_json(const Scene& scene, const JointHistory<Wide>& history, int digits) {
    std::string text =
        fmt::format("{{\"scene\": {}, \"columns\": [\"t\", \"joint\", \"coordinate\", \"rate\"],\n \"joints\": [",
                    json_string(scene.name));
    bool first = true;
    for (std::size_t i = 0; i < history.motions.size(); ++i) {
        const std::vector<Wide> x = history.motions[i].coordinates(), rate = history.motions[i].rates();
        for (std::size_t k = 0; k < x.size(); ++k, first = false)
            text += fmt::format("{}\n  [\"{}\", {}, \"{}\", \"{}\"]", first ? "" : ",",
                                shortest_decimal(history.times[i / scene.joints.size()]),
                                json_string(scene.joints[i % scene.joints.size()].name), wide_decimal(x[k], digits),
                                wide_decimal(rate[k], digits));
    }
    return text + "\n]}\n";
}

// Writes the file of joint coordinates, if there is one. Returns whether that was possible.
bool write_joints(const TruthOptions& options, const Scene& scene) {
    if (options.joints.empty()) return true;
    // at least as many digits as the decimals of the trajectory are computed with
    const Reference truth = reference(scene, options.samples, std::max(options.digits, 25), options.max_seconds);
    const std::string name = one_line(options.joints, 200);
    std::string fault = truth.available ? "" : truth.message;
    if (fault.empty()) {
        const JointHistory<Wide> history = joint_history(scene, truth);
        const int written = options.digits + 2;
        fault = history.fault;
        if (fault.empty())
            write_output(options.joints, options.format == "json" ? joints_json(scene, history, written)
                                                                  : joints_csv_of(scene, history, written));
    }
    if (!fault.empty()) std::fputs(fmt::format("polhode: {} was not written: {}\n", name, fault).c_str(), stderr);
    return fault.empty();
}

int truth_command(const TruthOptions& options) {
    require_count("--samples", options.samples, most_true_samples);
    require_count("--digits", options.digits, 1'000'000);
    if (options.duration) require_positive("--duration", *options.duration);
    require_positive("--max-seconds", options.max_seconds);
    require_output(options.output);
    require_output(options.reactions);
    require_output(options.joints);
    Scene scene = read_scene_with_notes(options.scene);
    require_states(scene, options.samples);
    if (options.duration) scene.duration = *options.duration;
    require_joint_files(scene, options.reactions, options.joints, options.output);
    require_contacts(scene, options.contacts, options.output, options.reactions);
    if (options.certified && options.contacts.any())
        throw UsageError(
            "--modes and --events: with --certified the times of events are in the JSON only; remove --certified, or "
            "use --format json");
    if (options.certified && !options.reactions.empty())
        throw UsageError("--reactions: certified reactions are not available; remove --certified");
    if (options.certified && !options.joints.empty())
        throw UsageError("--joints: certified joint coordinates are not available; remove --certified");
    if (!options.joints.empty() && options.digits > most_joint_digits)
        throw UsageError(fmt::format("--joints: {} digits are not available for joint coordinates; give at most {}",
                                     options.digits, most_joint_digits));
    if (options.certified) return run_certified(options, scene);
    const DecimalReference truth = decimal_reference(scene, options.samples, options.digits, options.max_seconds);
    if (!truth.available) {
        std::fputs(("polhode: " + one_line(truth.message, 500) + "\n").c_str(), stderr);
        return 1;
    }
    if (options.format == "json")
        write_output(options.output, json(scene, options, truth));
    else
        write_trajectory_output(options.output, csv(scene, truth));
    if (!options.reactions.empty() && !truth.reactions.empty())
        write_output(options.reactions,
                     options.format == "json" ? reactions_json(scene, truth) : reactions_csv_of(scene, truth));
    std::fputs(fmt::format("scene    {}\ntruth    {}\nbound    {:.2e}\n", one_line(scene.name, 100), truth.message,
                           truth.bound)
                   .c_str(),
               stderr);
    const bool joints = write_joints(options, scene);
    write_contacts(scene, options.contacts, truth, !options.output.empty());
    if (options.reactions.empty() || !truth.reactions.empty()) return joints ? 0 : 1;
    std::fputs(fmt::format("polhode: {} was not written: the truth of this scene does not include reactions\n",
                           one_line(options.reactions, 200))
                   .c_str(),
               stderr);
    return 1;
}

}  // namespace

void add_truth(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "truth",
        "Computes the reference trajectory of a scene (the truth) in decimals. Prints its error bound and method.");
    describe_columns(*command,
                     "Examples:\n"
                     "  polhode truth lagrange_top --digits 30 --output top.csv\n"
                     "  polhode truth free_asymmetric --certified --digits 40 --samples 10 --format json\n");
    const auto options = std::make_shared<TruthOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command->add_option("--samples", options->samples, "Number of sample intervals N: samples at k T/N, k = 0..N")
        ->capture_default_str();
    command
        ->add_option(
            "--digits", options->digits,
            fmt::format(
                "Correct digits, relative to the largest length of each of q, w, p, v (at most {}; no fixed limit with "
                "--certified)",
                most_truth_digits))
        ->capture_default_str();
    command->add_flag("--certified", options->certified,
                      "Prove the digits by ball arithmetic: each number has a radius that encloses the exact value");
    command->add_option("--format", options->format, "Output format: csv or json")
        ->check(CLI::IsMember({"csv", "json"}))
        ->capture_default_str();
    command->add_option("--duration", options->duration, "Duration T in s (default: the scene's)");
    command
        ->add_option("--max-seconds", options->max_seconds,
                     "Fail (exit code 1) after this CPU time of the thread, in s. Cached truths need almost none")
        ->capture_default_str();
    command->add_option("--reactions", options->reactions,
                        "File for the reactions of joints and loops (several bodies): t,joint,fx,fy,fz,tx,ty,tz. "
                        "Force in N and torque in N m by the parent on the child, world axes, about the child's point. "
                        "With planes: t,plane,.., the force of each plane at the contact point");
    command->add_option("--joints", options->joints,
                        "File for the coordinates of joints (several bodies): t,joint,coordinate,rate, one line per "
                        "coordinate. Angles in rad with full revolutions, displacements in m; the quaternion w, x, y, "
                        "z of a spherical joint");
    command->add_option("--output", options->output, "Output file (default: stdout)");
    add_contact_options(*command, options->contacts);
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = truth_command(*options); });
}

}  // namespace polhode
