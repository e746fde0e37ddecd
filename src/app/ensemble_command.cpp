// polhode ensemble: solves one scene for many bodies or initial states of a mechanism, one per row of a table.
//
// The table is read in pieces of some thousand rows. Each piece is solved by one thread, pieces in parallel, and
// written in the order of the table (work_in_order()), so that memory does not depend on the length of the table. With
// --shard a run solves a contiguous part of the rows and writes a .json file that identifies it; see ensemble_parts.h.
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

constexpr std::size_t most_refusals = 100;  // listed in the summary
// bytes of rows buffered for stdout
constexpr std::size_t most_held = std::size_t{8} << 20;

// The destination of rows: a file, which is complete or does not appear, or stdout. Output to stdout starts when all
// rows are available or the buffer is full.
class RowSink {
  public:
    explicit RowSink(const std::string& path) {
        if (!path.empty()) file_.emplace(path);
    }

    AtomicStream* file() { return file_ ? &*file_ : nullptr; }
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

// Solves one table, piece by piece.
class EnsembleRun {
  public:
    EnsembleRun(const Scene& scene, const EnsembleSettings& settings, const EnsembleOptions& options)
        : scene_(scene),
          settings_(settings),
          options_(options),
          table_(open_ensemble(options.initial, scene)),
          format_(make_format(options.output, scene, *table_, options.initial)) {
        // one thread per piece; pieces run in parallel
        EnsembleSettings single_thread = settings;
        single_thread.threads = 1;
        if (is_mechanism(scene))
            mechanism_.emplace(scene, table_->empty_table().mechanisms.only_starts(), options.samples, single_thread);
        for (long k = 1; k <= options.samples && !mechanism_; ++k) {
            Scene until = scene;
            until.duration = sample_time(scene.duration, k, options.samples);
            solvers_.emplace_back(until, single_thread);
        }
        const long records = options.samples * static_cast<long>(body_count(scene));
        largest_piece_ = static_cast<std::size_t>(std::max(64L, options.rows_at_once / records));
        piece_rows_ = std::min(mechanism_ ? mechanism_->block() : solvers_.front().block(), largest_piece_);
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
        part.table = compute_identity(options_.initial, scene_);
        part.scene = content_hash(write_scene(scene_));
        part.program = running_program_key();
        part.options = fmt::format("tolerance {}, samples {}, max-steps {}, max-seconds {}", settings_.tolerance,
                                   options_.samples, settings_.max_steps, settings_.seconds_limit);
        const auto [first, last] = shard_rows(part.table.rows, shard);
        if (table_->skip(first) < first) throw std::runtime_error(options_.initial + ": changed while it was read");
        const std::string path = part_path(options_.output, shard);
        ContentHash hash;
        solve(path, last - first, &hash);
        if (table_->rows_passed() != last) throw std::runtime_error(options_.initial + ": changed while it was read");
        part.rows = last - first, part.refused = refused_, part.bytes = bytes_, part.hash = hash.text();
        for (const auto& [status, rows] : count_) part.ok += status == Status::ok ? rows : 0;
        write_atomically(path + ".json", write_part(part));
        std::fputs(fmt::format("part     {} of {}: rows {} to {} of {}\n", shard.part, shard.parts,
                               std::min(first + 1, last), last, part.table.rows)
                       .c_str(),
                   stderr);
        std::fputs(summary().c_str(), stderr);
        return all_ok() ? 0 : 1;
    }

  private:
    // Solves at most the next `rows` rows of the table into a file. Adds the bytes after the header to `hash` unless it
    // is null.
    void solve(const std::string& path, std::size_t rows, ContentHash* hash) {
        const auto start = std::chrono::steady_clock::now();
        RowSink sink(path);
        if (format_->counts_records() && sink.file() && !sink.file()->is_regular())
            throw UsageError(path + " is not a regular file; give a regular file for .npy output");
        sink.write(format_->header(0));
        std::size_t left = rows;
        const auto read_next = [&]() -> std::optional<SolvedPiece> {
            SolvedPiece piece = read(left);
            if (piece.is_empty()) return {};
            left -= piece.table.rows() + piece.table.refused.size();
            return piece;
        };
        work_in_order(
            settings_.threads, read_next, [&](SolvedPiece& piece) { solve(piece); },
            [&](SolvedPiece piece) {
                count(piece);
                write(sink, piece, hash);
            });
        if (!hash) table_->require_rows();
        const auto written_all = std::chrono::steady_clock::now();
        if (format_->counts_records()) sink.file()->write_over_beginning(format_->header(bytes_));
        sink.commit();
        writing_ += seconds_since(written_all);
        in_all_ += seconds_since(start);
    }

    // Reads the next rows, at most `left`.
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
            solver.solve(piece.table.bodies, piece.at.emplace_back(piece.table.rows()));
        piece.mechanisms.resize(piece.table.mechanisms.rows());
        if (mechanism_) mechanism_->solve(piece.table.mechanisms, piece.mechanisms);
        piece.solving = seconds_since(start);
        piece.text = format_rows(piece, scene_, *format_);
        piece.formatting = seconds_since(start) - piece.solving;
    }

    void write(RowSink& sink, SolvedPiece& piece, ContentHash* hash) {
        const auto start = std::chrono::steady_clock::now();
        bytes_ += piece.text.size();
        if (hash) hash->add(piece.text);
        sink.write(std::move(piece.text));
        solving_ += piece.solving;
        writing_ += piece.formatting + seconds_since(start);
        // short pieces have overhead; long pieces let other threads idle at the end
        if (piece.solving < 0.002) piece_rows_ = std::min(2 * piece_rows_.load(), largest_piece_);
    }

    void count(const SolvedPiece& piece) {
        const auto count_rows = [&](const auto& ends) {
            for (const auto& row : ends) ++count_[row.status];
            rows_ += ends.size();
            const auto failed = std::ranges::find_if(ends, [](const auto& row) { return row.status != Status::ok; });
            if (!first_failure_.empty() || failed == ends.end()) return;
            const std::vector<std::size_t> numbers = piece.table.row_numbers(piece.first_row);
            first_failure_ =
                fmt::format("first    row {}: {}: {}\n", numbers[static_cast<std::size_t>(failed - ends.begin())],
                            name_of(failed->status), one_line(failed->message, 500));
        };
        if (mechanism_)
            count_rows(piece.mechanisms);
        else
            count_rows(piece.at.back());
        for (const RefusedRow& row : piece.table.refused)
            if (refused_++ < most_refusals) refusals_.push_back(row);
    }

    bool all_ok() const {
        return refused_ == 0 &&
               std::ranges::all_of(count_, [](const auto& status) { return status.first == Status::ok; });
    }

    // Returns the summary of the run, one topic per line.
    std::string summary() const {
        const double solving = solving_ / settings_.threads;
        std::string text = fmt::format(
            "scene    {}: {} {}, {} s\n", one_line(scene_.name, 100), rows_,
            mechanism_ ? fmt::format("initial states of {} bodies", scene_.bodies.size()) : "bodies", scene_.duration);
        text += fmt::format("cost     {:.3f} s on {} thread{} ({}), {:.4g} {} per second\n", solving, settings_.threads,
                            settings_.threads == 1 ? "" : "s", name_of(settings_.instructions),
                            static_cast<double>(rows_) / solving, mechanism_ ? "initial states" : "bodies");
        text += fmt::format("tables   {:.3f} s to read, {:.3f} s to write; {:.3f} s in total\n", reading_, writing_,
                            in_all_);
        std::vector<std::string> ends;
        for (const auto& [status, rows] : count_) ends.push_back(fmt::format("{} {}", rows, name_of(status)));
        text += fmt::format("status   {}\n{}", join_with_commas(ends), first_failure_);
        for (const RefusedRow& row : refusals_)
            text += fmt::format("refused  row {}: {}\n", row.row, one_line(row.fault, 500));
        if (refused_ > refusals_.size())
            text += fmt::format("refused  {} more rows; the output lists all\n", refused_ - refusals_.size());
        return text;
    }

    const Scene& scene_;
    const EnsembleSettings& settings_;
    const EnsembleOptions& options_;
    std::unique_ptr<EnsembleStream> table_;
    std::unique_ptr<EnsembleFormat> format_;
    std::vector<EnsembleSolver> solvers_;               // one body: one solver per sample
    std::optional<MechanismEnsembleSolver> mechanism_;  // several bodies
    std::size_t largest_piece_ = 0;                     // rows
    std::atomic<std::size_t> piece_rows_{0};            // rows of the next piece, at most largest_piece_
    double reading_ = 0, solving_ = 0, writing_ = 0;    // s, sum over all threads
    double in_all_ = 0;                                 // s
    std::map<Status, std::size_t> count_;
    std::size_t rows_ = 0, refused_ = 0;
    std::uint64_t bytes_ = 0;           // after the header
    std::string first_failure_;         // one line, or empty
    std::vector<RefusedRow> refusals_;  // the first ones
};

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
    if (!options.shard.empty() && options.output.empty()) throw UsageError("--shard writes a file; give --output");
    EnsembleRun run(scene, settings, options);
    return options.shard.empty() ? run.whole() : run.part(shard);
}

}  // namespace

void add_ensemble(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand(
        "ensemble",
        "Solves a scene for many bodies, each with its own inertia and initial state, or a mechanism from many initial "
        "states, one per row of a table. Invalid and failed rows are reported; the other rows are solved, and the exit "
        "code is 1.");
    command->footer(
        "Columns of the table (missing columns take the scene's values):\n"
        "  one body        qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,ixx,iyy,izz,ixy,ixz,iyz,mass,id\n"
        "  several bodies  JOINT.angle, .rate, .displacement, .speed, .angle1, .angle2, .rate1, .rate2, .qw.., .wx..,\n"
        "                  .stiffness, .rest, .damping; BODY.mass; free base: BODY.qw.., .wx.., .px.., .vx..; id\n"
        "\n"
        "Fields of an .npy output: row and status (<i8), t, qw .. vz (<f8), body (several bodies), id (.npy table).\n"
        "\n"
        "Examples:\n"
        "  polhode ensemble free_asymmetric --initial bodies.csv --output ends.csv\n"
        "  polhode ensemble mechanisms/double_pendulum --initial states.npy --samples 10 --output motion.npy\n"
        "  polhode ensemble free_asymmetric --initial bodies.npy --shard 1/4 --output ends.npy\n");
    const auto options = std::make_shared<EnsembleOptions>();
    command->add_option("SCENE", options->scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    command
        ->add_option("--initial", options->initial,
                     "Table: CSV file with one row per line, or NumPy structured array (.npy) with one row per record "
                     "(columns: below)")
        ->required();
    command->add_option("--tolerance", options->tolerance, "Relative tolerance (default 1e-10)");
    command->add_option("--duration", options->duration, "Duration T in s (default: the scene's)");
    command->add_option("--threads", options->threads, "Number of threads (default: all cores)");
    command->add_option("--max-steps", options->max_steps, "A row fails after this many steps between two events")
        ->capture_default_str();
    command
        ->add_option("--max-seconds", options->max_seconds,
                     "A row that is solved separately fails after this CPU time of its thread, in s")
        ->capture_default_str();
    command
        ->add_option("--samples", options->samples,
                     "Number of samples N at k T/N, k = 1..N. Single bodies are solved from t = 0 for each sample")
        ->capture_default_str();
    command
        ->add_option("--rows-at-once", options->rows_at_once,
                     "Largest number of rows times samples times bodies per piece of work of a thread (at least 64 "
                     "rows). Does not limit the length of the table")
        ->capture_default_str();
    command->add_option("--shard", options->shard,
                        "Solve part I of N of the rows (I/N) into OUTPUT.part-I-of-N and a .json file that describes "
                        "it; polhode merge joins the parts");
    command->add_option("--output", options->output,
                        "Output file (default: stdout). A name that ends in .npy selects a NumPy structured array with "
                        "one record per row, time and body (fields: below)");
    add_outside_option(*command);
    command->callback([options, &exit_code] { exit_code = ensemble_command(*options); });
}

}  // namespace polhode
