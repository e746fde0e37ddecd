// polhode ensemble: one scene, a body a row.
#include <fmt/format.h>

#include <algorithm>
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
#include "integrators/own/mechanism_ensemble.h"
#include "motion/ensemble_table.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr long most_threads = 4096, most_steps = 1'000'000'000, most_samples = 10'000;

struct EnsembleOptions {
    std::string scene, initial, output;
    std::optional<double> tolerance, duration;
    std::optional<long> threads;
    long max_steps = EnsembleSettings{}.max_steps;
    double max_seconds = EnsembleSettings{}.seconds_limit;
    long samples = 1;
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

// A body's numbers at one time.
void append_numbers(std::string& text, const Sample& s) {
    for (const double value : {s.q.w, s.q.x, s.q.y, s.q.z}) append(text, value);
    append(text, (1 / squared_norm(s.q)) * rotate(s.q, s.angular_velocity_B));
    append(text, s.position_W);
    append(text, s.velocity_W);
}

// A body's row at one time.
void append_row(std::string& text, std::size_t number, const std::string* id, const EnsembleRow& row) {
    const Sample& s = row.end;
    text += std::to_string(number);
    if (id) text.append(",").append(*id);
    text.append(",").append(name_of(row.status));
    if (row.moved) {
        append(text, s.t);
        append_numbers(text, s);
    } else {
        text.append(14, ',');
    }
    append_message(text, row.message);
    text += '\n';
}

// Where each body stands among the table's rows, counted from 1.
std::vector<std::size_t> numbers_of(const EnsembleTable& table) {
    std::vector<std::size_t> numbers;
    auto refused = table.refused.begin();
    for (std::size_t number = 1; numbers.size() < table.bodies.size(); ++number)
        if (refused != table.refused.end() && refused->row == number)
            ++refused;
        else
            numbers.push_back(number);
    return numbers;
}

// The table's rows in their order, each at all times; `solved[k]` holds the bodies at the k-th time.
std::string csv_of(const std::vector<std::vector<EnsembleRow>>& solved, const EnsembleTable& table,
                   const std::vector<std::size_t>& numbers) {
    std::string text = table.ids.empty() ? "row,status" : "row,id,status";
    text += ",t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,message\n";
    text.reserve(numbers.size() * solved.size() * 250 + text.size());
    const std::string no_id;
    auto refused = table.refused.begin();
    for (std::size_t i = 0; i <= numbers.size(); ++i) {
        for (; refused != table.refused.end() && (i == numbers.size() || refused->row < numbers[i]); ++refused)
            append_row(text, refused->row, table.ids.empty() ? nullptr : &no_id,
                       {Status::failed, false, {}, refused->fault});
        if (i == numbers.size()) break;
        for (const std::vector<EnsembleRow>& at : solved)
            append_row(text, numbers[i], table.ids.empty() ? nullptr : &table.ids[i], at[i]);
    }
    return text;
}

// The first row that did not end well, and those that were refused, a line each.
template <class Row>
void append_troubles(std::string& text, const std::vector<Row>& rows, const std::vector<std::size_t>& numbers,
                     const std::vector<RefusedRow>& refused) {
    const auto failed = std::ranges::find_if(rows, [](const Row& row) { return row.status != Status::ok; });
    if (failed != rows.end())
        text += fmt::format("first    row {}: {}: {}\n", numbers[static_cast<std::size_t>(failed - rows.begin())],
                            name_of(failed->status), one_line(failed->message, 500));
    constexpr std::size_t most_told = 100;
    for (std::size_t i = 0; i < std::min(most_told, refused.size()); ++i)
        text += fmt::format("refused  row {}: {}\n", refused[i].row, one_line(refused[i].fault, 500));
    if (refused.size() > most_told)
        text += fmt::format("refused  {} rows more; all stand in the table\n", refused.size() - most_told);
}

// What the run did, for people: a line each.
std::string summary(const Scene& scene, const std::vector<EnsembleRow>& rows, const EnsembleTable& table,
                    const std::vector<std::size_t>& numbers, const EnsembleSettings& settings, double seconds) {
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
    append_troubles(text, rows, numbers, table.refused);
    return text;
}

// The rows of a table of mechanisms in their order, each at all times, at each a line for each body. A run that ended
// early has one more line, which says why.
std::string csv_of(const std::vector<MechanismRow>& solved, const MechanismTable& table, const Scene& scene) {
    std::string text = table.ids.empty() ? "row,status" : "row,id,status";
    text += ",t,body,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,message\n";
    const auto begin = [&](std::size_t number, const std::string& id, Status status) {
        text += std::to_string(number);
        if (!table.ids.empty()) text.append(",").append(id);
        text.append(",").append(name_of(status));
    };
    const auto ended = [&](const std::string& message) {
        text.append(15, ',');
        append_message(text, message);
        text += '\n';
    };
    auto refused = table.refused.begin();
    for (std::size_t k = 0; k <= table.rows(); ++k) {
        for (; refused != table.refused.end() && (k == table.rows() || refused->row < table.row_numbers[k]);
             ++refused) {
            begin(refused->row, "", Status::failed);
            ended(refused->fault);
        }
        if (k == table.rows()) break;
        const MechanismRow& row = solved[k];
        const std::string id = table.ids.empty() ? "" : table.ids[k];
        for (std::size_t i = 0; i < row.samples.size(); ++i) {
            begin(table.row_numbers[k], id, Status::ok);
            append(text, row.samples[i].t);
            text.append(",").append(scene.bodies[i % scene.bodies.size()].name);
            append_numbers(text, row.samples[i]);
            append_message(text, "");
            text += '\n';
        }
        if (row.status == Status::ok) continue;
        begin(table.row_numbers[k], id, row.status);
        ended(row.message);
    }
    return text;
}

std::string summary(const Scene& scene, const std::vector<MechanismRow>& rows, const MechanismTable& table,
                    const EnsembleSettings& settings, double seconds) {
    std::map<Status, std::size_t> count;
    for (const MechanismRow& row : rows) ++count[row.status];
    std::vector<std::string> words;
    for (const auto& [status, number] : count) words.push_back(fmt::format("{} {}", number, name_of(status)));
    std::string text = fmt::format(
        "scene    {}: {} starts of {} bodies, {} s\ncost     {:.3f} s on {} thread{}, {:.4g} starts a second\n"
        "status   {}\n",
        one_line(scene.name, 100), rows.size(), scene.bodies.size(), scene.duration, seconds, settings.threads,
        settings.threads == 1 ? "" : "s", static_cast<double>(rows.size()) / seconds, fmt::join(words, ", "));
    append_troubles(text, rows, table.row_numbers, table.refused);
    return text;
}

int mechanism_ensemble(const EnsembleOptions& options, const Scene& scene, const EnsembleSettings& settings) {
    const MechanismTable table = read_mechanism_table(options.initial, scene);
    const auto start = std::chrono::steady_clock::now();
    const std::vector<MechanismRow> rows = solve_mechanism_ensemble(scene, table, options.samples, settings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_output(options.output, csv_of(rows, table, scene));
    std::fputs(summary(scene, rows, table, settings, seconds).c_str(), stderr);
    const bool all_ok = std::ranges::all_of(rows, [](const MechanismRow& row) { return row.status == Status::ok; });
    return all_ok && table.refused.empty() ? 0 : 1;
}

int ensemble_command(const EnsembleOptions& options) {
    if (options.tolerance) require_positive("--tolerance", *options.tolerance);
    if (options.duration) require_positive("--duration", *options.duration);
    if (options.threads) require_count("--threads", *options.threads, most_threads);
    require_count("--max-steps", options.max_steps, most_steps);
    require_positive("--max-seconds", options.max_seconds);
    require_count("--samples", options.samples, most_samples);
    require_output(options.output);
    Scene scene = find_scene(options.scene);
    if (options.duration) scene.duration = *options.duration;
    EnsembleSettings settings;
    settings.tolerance = options.tolerance.value_or(settings.tolerance);
    settings.threads = static_cast<int>(
        options.threads.value_or(std::max<long>(1, static_cast<long>(std::thread::hardware_concurrency()))));
    settings.max_steps = options.max_steps, settings.seconds_limit = options.max_seconds;
    if (is_mechanism(scene)) return mechanism_ensemble(options, scene, settings);
    const EnsembleTable table = read_ensemble(options.initial, scene, BadRows::pass_over);
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::vector<EnsembleRow>> solved;
    for (long k = 1; k <= options.samples; ++k) {
        Scene until = scene;
        until.duration = sample_time(scene.duration, k, options.samples);
        solved.push_back(solve_ensemble(until, table.bodies, settings));
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::vector<std::size_t> numbers = numbers_of(table);
    write_output(options.output, csv_of(solved, table, numbers));
    const std::vector<EnsembleRow>& ends = solved.back();
    std::fputs(summary(scene, ends, table, numbers, settings, seconds).c_str(), stderr);
    const bool all_ok = std::ranges::all_of(ends, [](const EnsembleRow& row) { return row.status == Status::ok; });
    return all_ok && table.refused.empty() ? 0 : 1;
}

}  // namespace

void add_ensemble(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "ensemble",
        "Solves a scene for many bodies, each with its own inertia and start, or a mechanism from many starts: a row "
        "(CSV) each. A row of the table "
        "that is no body is told with its line, and stops no other; the exit code is 1 then.");
    const auto options = std::make_shared<EnsembleOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("--initial", options->initial,
                     "CSV file, a body a line; columns among qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,ixx,iyy,izz,ixy,"
                     "ixz,iyz,mass,id; the scene's values for those left out. Of a scene of several bodies a start a "
                     "line; columns "
                     "JOINT.angle, .rate, .displacement, .speed, .angle1, .angle2, .rate1, .rate2, .qw.., .wx.., "
                     ".stiffness, .rest, .damping, BODY.mass, and of a free base BODY.qw.., .wx.., .px.., .vx..")
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
    command
        ->add_option("--samples", options->samples,
                     "N: rows of each body at k T/N, k = 1..N, each solved from the start; the table has the start")
        ->capture_default_str();
    command->add_option("--output", options->output, "File to write, in place of stdout");
    outside_option(*command);
    command->callback([options, &exit_code] { exit_code = ensemble_command(*options); });
}

}  // namespace polhode
