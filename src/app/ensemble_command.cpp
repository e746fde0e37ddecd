// polhode ensemble: one scene, a body a row.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "app/commands.h"
#include "app/ensemble_parts.h"
#include "app/ensemble_rows.h"
#include "app/lookup.h"
#include "experiment/run/case_store.h"
#include "integrators/own/mechanism_ensemble.h"
#include "motion/ensemble_stream.h"
#include "scene/scene_file.h"
#include "text/atomic_file.h"
#include "text/atomic_stream.h"
#include "text/content_hash.h"
#include "text/message.h"
#include "text/work_in_order.h"

namespace polhode {
namespace {

constexpr long most_threads = 4096, most_steps = 1'000'000'000, most_samples = 10'000, most_rows_at_once = 10'000'000;

struct EnsembleOptions {
    std::string scene, initial, output;
    std::optional<double> tolerance, duration;
    std::optional<long> threads;
    long max_steps = EnsembleSettings{}.max_steps;
    double max_seconds = EnsembleSettings{}.seconds_limit;
    long samples = 1, rows_at_once = 4096;
    std::string shard;
};

constexpr std::size_t most_told = 100;
// of rows for stdout, bytes
constexpr std::size_t most_held = std::size_t{8} << 20;

// The first row that did not end well, a line.
template <class Row>
void append_failure(std::string& text, const std::vector<Row>& rows, const std::vector<std::size_t>& numbers) {
    const auto failed = std::ranges::find_if(rows, [](const Row& row) { return row.status != Status::ok; });
    if (failed == rows.end()) return;
    text += fmt::format("first    row {}: {}: {}\n", numbers[static_cast<std::size_t>(failed - rows.begin())],
                        name_of(failed->status), one_line(failed->message, 500));
}

// Those that were refused, a line each: the first of so many.
void append_refused(std::string& text, const std::vector<RefusedRow>& refused, std::size_t all) {
    const std::size_t told = std::min(most_told, refused.size());
    for (std::size_t i = 0; i < told; ++i)
        text += fmt::format("refused  row {}: {}\n", refused[i].row, one_line(refused[i].fault, 500));
    if (all > told) text += fmt::format("refused  {} rows more; all stand in the table\n", all - told);
}

// Where rows go: a file that is there whole or not at all, or stdout, which begins once all rows are there or more of
// them than are held.
class RowSink {
  public:
    explicit RowSink(const std::string& path) {
        if (!path.empty()) file_.emplace(path);
    }

    AtomicStream* file() { return file_ ? &*file_ : nullptr; }
    // What stands in front of the first piece.
    void begin(std::string header) {
        if (file_)
            file_->write(header);
        else
            held_.push_back(std::move(header));
    }
    void write(std::string piece) {
        if (file_) {
            file_->write(piece);
            return;
        }
        held_bytes_ += piece.size();
        held_.push_back(std::move(piece));
        if (held_bytes_ > most_held) write_held();
    }
    void commit() {
        write_held();
        if (file_) file_->commit();
    }

  private:
    void write_held() {
        for (const std::string& text : held_) write_output("", text);
        held_.clear();
        held_bytes_ = 0;
    }

    std::optional<AtomicStream> file_;
    std::vector<std::string> held_;
    std::size_t held_bytes_ = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// One table, piece by piece.
class EnsembleRun {
  public:
    EnsembleRun(const Scene& scene, const EnsembleSettings& settings, const EnsembleOptions& options)
        : scene_(scene),
          settings_(settings),
          options_(options),
          table_(open_ensemble(options.initial, scene)),
          format_(format_of(options.output, *table_, options.initial)) {
        // each piece by one thread, and all pieces side by side
        EnsembleSettings alone = settings;
        alone.threads = 1;
        for (long k = 1; k <= options.samples; ++k) {
            Scene until = scene;
            until.duration = sample_time(scene.duration, k, options.samples);
            solvers_.emplace_back(until, alone);
        }
        largest_piece_ = static_cast<std::size_t>(std::max(64L, options.rows_at_once / options.samples));
        piece_rows_ = std::min(solvers_.front().block(), largest_piece_);
    }

    int whole() {
        solve(options_.output, std::numeric_limits<std::size_t>::max(), nullptr);
        std::fputs(summary().c_str(), stderr);
        return all_ok() ? 0 : 1;
    }

    int part(const Shard& shard) {
        EnsemblePart part;
        part.shard = shard;
        part.output = std::filesystem::path(options_.output).filename().string();
        part.table = identity_of(options_.initial, scene_);
        part.scene = content_hash(write_scene(scene_));
        part.program = running_program_key();
        part.options = fmt::format("tolerance {}, samples {}, max-steps {}, max-seconds {}", settings_.tolerance,
                                   options_.samples, settings_.max_steps, settings_.seconds_limit);
        const auto [first, last] = rows_of_shard(part.table.rows, shard);
        if (table_->skip(first) < first) throw std::runtime_error(options_.initial + ": changes while it is read");
        const std::string path = part_path(options_.output, shard);
        ContentHash hash;
        solve(path, last - first, &hash);
        if (table_->rows_passed() != last) throw std::runtime_error(options_.initial + ": changes while it is read");
        part.rows = last - first, part.refused = refused_, part.bytes = bytes_, part.hash = hash.text();
        for (const auto& [status, bodies] : count_) part.ok += status == Status::ok ? bodies : 0;
        write_atomically(path + ".json", write_part(part));
        std::fputs(fmt::format("part     {} of {}: rows {} to {} of {}\n", shard.part, shard.parts,
                               std::min(first + 1, last), last, part.table.rows)
                       .c_str(),
                   stderr);
        std::fputs(summary().c_str(), stderr);
        return all_ok() ? 0 : 1;
    }

  private:
    // The next rows of the table, `rows` at most, into a file; `hash`, where there is one, of what stands behind its
    // header.
    void solve(const std::string& path, std::size_t rows, ContentHash* hash) {
        const auto start = std::chrono::steady_clock::now();
        RowSink sink(path);
        if (format_->counts_rows() && sink.file() && !sink.file()->is_regular())
            throw UsageError(path + ": is no regular file; an .npy file is written into one");
        sink.begin(format_->header(0));
        std::size_t left = rows;
        const auto read_next = [&]() -> std::optional<SolvedPiece> {
            SolvedPiece piece = read(left);
            if (piece.is_empty()) return {};
            left -= piece.table.bodies.size() + piece.table.refused.size();
            return piece;
        };
        work_in_order(
            settings_.threads, read_next, [&](SolvedPiece& piece) { solve(piece); },
            [&](SolvedPiece piece) {
                count(piece);
                write(sink, piece, hash);
            });
        if (!hash) table_->require_bodies();
        const auto written_all = std::chrono::steady_clock::now();
        if (format_->counts_rows())
            sink.file()->write_over_beginning(
                format_->header(bodies_ * static_cast<std::uint64_t>(options_.samples) + refused_));
        sink.commit();
        writing_ += seconds_since(written_all);
        in_all_ += seconds_since(start);
    }

    // The next rows, at most `left`.
    SolvedPiece read(std::size_t left) {
        const auto start = std::chrono::steady_clock::now();
        SolvedPiece piece;
        piece.first_row = table_->rows_passed() + 1;
        if (left > 0) table_->next(piece.table, std::min(piece_rows_.load(), left));
        reading_ += seconds_since(start);
        return piece;
    }

    void solve(SolvedPiece& piece) const {
        const auto start = std::chrono::steady_clock::now();
        for (const EnsembleSolver& solver : solvers_)
            solver.solve(piece.table.bodies, piece.at.emplace_back(piece.table.bodies.size()));
        piece.solving = seconds_since(start);
        piece.text = rows_of(piece, *format_);
        piece.formatting = seconds_since(start) - piece.solving;
    }

    void write(RowSink& sink, SolvedPiece& piece, ContentHash* hash) {
        const auto start = std::chrono::steady_clock::now();
        bytes_ += piece.text.size();
        if (hash) hash->add(piece.text);
        sink.write(std::move(piece.text));
        solving_ += piece.solving;
        writing_ += piece.formatting + seconds_since(start);
        // short ones cost their hand-over, long ones let the other threads wait at the end
        if (piece.solving < 0.002) piece_rows_ = std::min(2 * piece_rows_.load(), largest_piece_);
    }

    void count(const SolvedPiece& piece) {
        const std::vector<EnsembleRow>& ends = piece.at.back();
        for (const EnsembleRow& row : ends) ++count_[row.status];
        bodies_ += ends.size();
        if (first_failure_.empty()) append_failure(first_failure_, ends, piece.numbers());
        for (const RefusedRow& row : piece.table.refused)
            if (refused_++ < most_told) told_.push_back(row);
    }

    bool all_ok() const {
        return refused_ == 0 &&
               std::ranges::all_of(count_, [](const auto& status) { return status.first == Status::ok; });
    }

    // What the run did, for people: a line each.
    std::string summary() const {
        const double solving = solving_ / settings_.threads;
        std::string text =
            fmt::format("scene    {}: {} bodies, {} s\n", one_line(scene_.name, 100), bodies_, scene_.duration);
        text += fmt::format("cost     {:.3f} s on {} thread{} ({}), {:.4g} bodies a second\n", solving,
                            settings_.threads, settings_.threads == 1 ? "" : "s", name_of(settings_.instructions),
                            static_cast<double>(bodies_) / solving);
        text +=
            fmt::format("tables   {:.3f} s to read, {:.3f} s to write; {:.3f} s in all\n", reading_, writing_, in_all_);
        text += "status  ";
        const char* separator = " ";
        for (const auto& [status, bodies] : count_) {
            text += fmt::format("{}{} {}", separator, bodies, name_of(status));
            separator = ", ";
        }
        text += '\n' + first_failure_;
        append_refused(text, told_, refused_);
        return text;
    }

    const Scene& scene_;
    const EnsembleSettings& settings_;
    const EnsembleOptions& options_;
    std::unique_ptr<EnsembleStream> table_;
    std::unique_ptr<EnsembleFormat> format_;
    std::vector<EnsembleSolver> solvers_;             // one for each time that is asked for
    std::size_t largest_piece_ = 0;                   // rows
    std::atomic<std::size_t> piece_rows_{0};          // of the next piece; at most the largest
    double reading_ = 0, solving_ = 0, writing_ = 0;  // s, of all threads together
    double in_all_ = 0;                               // s
    std::map<Status, std::size_t> count_;
    std::size_t bodies_ = 0, refused_ = 0;
    std::uint64_t bytes_ = 0;       // behind the header
    std::string first_failure_;     // a line, or empty
    std::vector<RefusedRow> told_;  // the first of those that were refused
};

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
            append_number(text, row.samples[i].t);
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
    append_failure(text, rows, table.row_numbers);
    append_refused(text, table.refused, table.refused.size());
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
    require_count("--rows-at-once", options.rows_at_once, most_rows_at_once);
    require_output(options.output);
    Scene scene = read_scene_with_notes(options.scene);
    if (options.duration) scene.duration = *options.duration;
    EnsembleSettings settings;
    settings.tolerance = options.tolerance.value_or(settings.tolerance);
    settings.threads = static_cast<int>(
        options.threads.value_or(std::max<long>(1, static_cast<long>(std::thread::hardware_concurrency()))));
    settings.max_steps = options.max_steps, settings.seconds_limit = options.max_seconds;
    const Shard shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
    if (!options.shard.empty() && options.output.empty()) throw UsageError("--shard: parts are files; give --output");
    if (is_mechanism(scene)) {
        if (!options.shard.empty()) throw UsageError("--shard: the scene is of several bodies; leave it out");
        for (const std::string& path : {options.initial, options.output})
            if (path.ends_with(".npy")) throw UsageError(path + ": the scene is of several bodies; give tables as CSV");
        return mechanism_ensemble(options, scene, settings);
    }
    EnsembleRun run(scene, settings, options);
    return options.shard.empty() ? run.whole() : run.part(shard);
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
                     "CSV file, a body a line, or NumPy's structured array (.npy); columns among "
                     "qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,ixx,iyy,izz,ixy,"
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
    command
        ->add_option("--rows-at-once", options->rows_at_once,
                     "Rows times samples that a thread takes at a time, at most; the table may be of any length")
        ->capture_default_str();
    command->add_option("--shard", options->shard,
                        "I/N: solves part I of N of the rows into OUTPUT.part-I-of-N, with a .json that says of what; "
                        "polhode merge puts the parts together");
    command->add_option("--output", options->output,
                        "File to write, in place of stdout; one that ends in .npy is written as NumPy's structured "
                        "array");
    outside_option(*command);
    command->callback([options, &exit_code] { exit_code = ensemble_command(*options); });
}

}  // namespace polhode
