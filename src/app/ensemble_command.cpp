// polhode ensemble: one scene, a body a row.
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "app/commands.h"
#include "app/lookup.h"
#include "integrators/own/ensemble.h"
#include "motion/ensemble_table.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_threads = 4096, most_steps = 1'000'000'000;

struct EnsembleOptions {
    std::string scene, initial, output;
    std::optional<double> tolerance, duration;
    std::optional<long> threads;
    long max_steps = EnsembleSettings{}.max_steps;
    double max_seconds = EnsembleSettings{}.seconds_limit;
};

// A number, or nothing where there is none.
void append(std::string& text, double value) {
    text += ',';
    if (!std::isfinite(value)) return;
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

void append(std::string& text, const Vector3<double>& v) {
    for (int i = 0; i < 3; ++i) append(text, v[i]);
}

void append_message(std::string& text, const std::string& message) {
    text += ',';
    if (message.empty()) return;
    text += '"';
    for (const char c : one_line(message, 500)) text.append(c == '"' ? 2 : 1, c);
    text += '"';
}

std::string csv_of(const std::vector<EnsembleRow>& rows, const std::vector<std::string>& ids) {
    std::string text = "row,";
    text += ids.empty() ? "" : "id,";
    text += "status,t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,message\n";
    text.reserve(rows.size() * 250 + text.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const EnsembleRow& row = rows[i];
        const Sample& s = row.end;
        text += std::to_string(i + 1);
        if (!ids.empty()) text.append(",").append(ids[i]);
        text.append(",").append(name_of(row.status));
        if (row.moved) {
            append(text, s.t);
            for (const double value : {s.q.w, s.q.x, s.q.y, s.q.z}) append(text, value);
            append(text, (1 / squared_norm(s.q)) * rotate(s.q, s.angular_velocity_B));
            append(text, s.position_W);
            append(text, s.velocity_W);
        } else {
            text.append(14, ',');
        }
        append_message(text, row.message);
        text += '\n';
    }
    return text;
}

// What the run did, for people: a line each.
std::string summary(const Scene& scene, const std::vector<EnsembleRow>& rows, const EnsembleSettings& settings,
                    double seconds) {
    std::map<Status, std::size_t> count;
    for (const EnsembleRow& row : rows) ++count[row.status];
    std::string text =
        fmt::format("scene    {}: {} bodies, {} s\n", one_line(scene.name, 100), rows.size(), scene.duration);
    text += fmt::format("cost     {:.3f} s on {} thread{} ({}), {:.4g} bodies a second\n", seconds, settings.threads,
                        settings.threads == 1 ? "" : "s", name_of(settings.instructions),
                        static_cast<double>(rows.size()) / seconds);
    text += "status  ";
    const char* separator = " ";
    for (const auto& [status, bodies] : count) {
        text += fmt::format("{}{} {}", separator, bodies, name_of(status));
        separator = ", ";
    }
    text += '\n';
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].status != Status::ok) {
            text += fmt::format("first    row {}: {}: {}\n", i + 1, name_of(rows[i].status),
                                one_line(rows[i].message, 500));
            break;
        }
    return text;
}

int ensemble_command(const EnsembleOptions& options) {
    if (options.tolerance) require_positive("--tolerance", *options.tolerance);
    if (options.duration) require_positive("--duration", *options.duration);
    if (options.threads) require_count("--threads", *options.threads, most_threads);
    require_count("--max-steps", options.max_steps, most_steps);
    require_positive("--max-seconds", options.max_seconds);
    require_output(options.output);
    Scene scene = find_scene(options.scene);
    if (options.duration) scene.duration = *options.duration;
    EnsembleSettings settings;
    settings.tolerance = options.tolerance.value_or(settings.tolerance);
    settings.threads = static_cast<int>(
        options.threads.value_or(std::max<long>(1, static_cast<long>(std::thread::hardware_concurrency()))));
    settings.max_steps = options.max_steps, settings.seconds_limit = options.max_seconds;
    const EnsembleTable table = read_ensemble(options.initial, scene);
    const auto start = std::chrono::steady_clock::now();
    const std::vector<EnsembleRow> rows = solve_ensemble(scene, table.bodies, settings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_output(options.output, csv_of(rows, table.ids));
    std::fputs(summary(scene, rows, settings, seconds).c_str(), stderr);
    for (const EnsembleRow& row : rows)
        if (row.status != Status::ok) return 1;
    return 0;
}

}  // namespace

void add_ensemble(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "ensemble", "Solves a scene for many bodies, each with its own inertia and start: a row (CSV) each.");
    const auto options = std::make_shared<EnsembleOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("--initial", options->initial,
                     "CSV file, a body a line; columns among qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,ixx,iyy,izz,ixy,"
                     "ixz,iyz,mass,id; the scene's values for those left out")
        ->required();
    command->add_option("--tolerance", options->tolerance, "Relative tolerance (default 1e-10)");
    command->add_option("--duration", options->duration, "T in s, in place of the scene's");
    command->add_option("--threads", options->threads, "Threads (default: as many as the machine runs at once)");
    command
        ->add_option("--max-steps", options->max_steps,
                     "A body that needs more steps between two events ends as failed")
        ->capture_default_str();
    command
        ->add_option("--max-seconds", options->max_seconds,
                     "Likewise, of its thread's time, for a body that is solved by itself")
        ->capture_default_str();
    command->add_option("--output", options->output, "File to write, in place of stdout");
    command->callback([options, &exit_code] { exit_code = ensemble_command(*options); });
}

}  // namespace polhode
