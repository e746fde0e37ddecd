// Requirements on every reader for arbitrary bytes: it refuses them with a one-line error, or what it reads survives
// writing and reading again. Each oracle throws std::logic_error on a violation. The fuzz targets run them on
// millions of inputs, findings_test.cpp on seeds and earlier findings.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "body/mesh.h"
#include "check/check_files.h"
#include "check/convention.h"
#include "check/foreign_table.h"
#include "check/sample_clock.h"
#include "experiment/plan/pattern.h"
#include "experiment/run/result.h"
#include "experiment/write_experiment.h"
#include "integrators/engines/engine_mechanism.h"
#include "integrators/engines/engine_methods.h"
#include "integrators/own/ensemble.h"
#include "integrators/truth/cache.h"
#include "motion/ensemble_npy.h"
#include "motion/ensemble_table.h"
#include "motion/problem.h"
#include "motion/trajectory_csv.h"
#include "motion/written_tables.h"
#include "scene/body_source.h"
#include "scene/builtin.h"
#include "scene/mesh_file.h"
#include "scene/robot_file.h"
#include "scene/robot_tree.h"
#include "scene/scene_file.h"
#include "table/table.h"
#include "tests/integrators/tape/tape_oracle.h"
#include "text/content_hash.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/npy.h"

namespace polhode::oracles {

inline void require(bool holds, const char* what) {
    if (!holds) throw std::logic_error(what);
}

/// True for one input in `n`, always the same ones; for checks that are too slow for every input.
inline bool one_in(std::uint32_t n, std::string_view input) {
    std::uint32_t hash = 2166136261u;
    for (const char c : input) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    return hash % n == 0;
}

inline void require_one_line(std::string_view message) {
    for (const char c : message)
        require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f, "the message is not one line of text");
    require(message.size() < 1300, "the message is too long");
}

/// Returns parse(), or nothing if it throws InputError. The message must be "fuzz: PLACE: FAULT; REMEDY".
template <class Parse>
auto parsed(Parse&& parse) -> std::optional<decltype(parse())> {
    try {
        return parse();
    } catch (const InputError& error) {
        const std::string_view message = error.what();
        require_one_line(message);
        require(message.starts_with("fuzz: "), "the message does not name the file");
        require(message.find("; ") != message.npos, "the message has no remedy");
        return {};
    }
}

inline void scene(std::string_view text) {
    // read as if among the built-in scenes, so that robot files can be imported
    static const std::string directory = std::string(builtin_directory) + "mechanisms";
    const std::optional<Scene> scene = parsed([&] { return parse_scene(text, "fuzz", directory); });
    if (!scene) return;
    const std::string written = write_scene(*scene);
    require(write_scene(parse_scene(written, "written", directory)) == written, "a scene does not read back");
    if (!is_mechanism(*scene) && one_in(256, text)) pose(*scene);
}

/// A whole robot is refused by one line, or its bodies and joints form a valid scene.
inline void robot(std::string_view text, RobotBase base) {
    const std::optional<Scene> scene = parsed([&] {
        Scene made;
        made.name = "robot", made.duration = 1;
        RobotOptions options;
        options.base = base, options.balance_inertia = one_in(4, text);
        add_robot(parse_robot(text, "fuzz", options), options, "fuzz", made);
        validate(made, "fuzz");
        return made;
    });
    if (!scene) return;
    const std::string written = write_scene(*scene);
    require(write_scene(parse_scene(written, "written")) == written, "a robot does not read back");
    for (const std::vector<std::string>* phrases : {&scene->omitted, &scene->assumed})
        for (const std::string& phrase : *phrases) require_one_line(phrase);
}

/// Meshes and robot files are refused by one line, or give bodies with valid mass properties.
inline void body(std::string_view bytes) {
    for (const char* path : {"fuzz.obj", "fuzz.stl"}) {
        try {
            const Mesh mesh = parse_mesh(bytes, path);
            require(mesh_fault(mesh).empty() && enclosed_volume(mesh) > 0,
                    "an accepted surface does not enclose a volume");
        } catch (const InputError& error) {
            require_one_line(error.what());
            require(std::string_view(error.what()).starts_with("fuzz."), "the message does not name the file");
        }
    }
    parsed([&] {
        const Body body = body_of(body_source(parse_robot_body(bytes, "fuzz", "base")));
        require(body.mass > 0 && tensor_fault(body.inertia_B).empty(), "a link has no mass or an impossible tensor");
        return body;
    });
    for (const RobotBase base : {RobotBase::format_default, RobotBase::free, RobotBase::fixed}) robot(bytes, base);
}

inline void experiment(std::string_view text) {
    const std::optional<Experiment> experiment = parsed([&] { return parse_experiment(text, "fuzz"); });
    if (!experiment) return;
    const std::string written = write_experiment(*experiment);
    require(write_experiment(parse_experiment(written, "written")) == written, "an experiment does not read back");
    // plans the experiment if it is small and needs no files
    std::size_t variants = 1;
    for (const Variation& variation : experiment->vary)
        variants = std::min<std::size_t>(variants * variation.values.size(), 100);
    if (variants > 20 || !one_in(64, text)) return;
    for (const std::string& name : experiment->scenes)
        if (builtin_scene_text(name).empty()) return;
    parsed([&] { return make_plan(*experiment, "fuzz", false); });
}

inline void trajectory(std::string_view text) {
    std::optional<TrajectoryFile> file = parsed([&] { return parse_trajectory(text, "fuzz"); });
    if (!file) return;
    // this remark concerns the original text; the written file has none
    file->skipped_content.clear();
    require(parse_trajectory(write_trajectory(*file), "written") == *file, "a trajectory does not read back");
    require(samples_of(*file, Vector3<double>(1, 2, 3)).size() == file->rows.size(), "samples are lost");
    // another quaternion order keeps all rows; converting axes twice restores the file; the clock stays monotonic
    const QuaternionColumns order = one_in(2, text) ? QuaternionColumns::scalar_last : QuaternionColumns::scalar_first;
    TrajectoryFile other = parse_trajectory(text, "fuzz", order);
    require(other.rows.size() == file->rows.size(), "rows are lost with another quaternion order");
    convert(other, {Axes::y_up_left, order, false});
    convert(other, {Axes::y_up_left, order, false});
    require(other == parse_trajectory(text, "fuzz", order), "converting axes twice does not restore the file");
    const std::vector<TrajectoryRow> before = other.rows;
    if (restore_clock(other, 1)) {
        for (std::size_t k = 0; k < before.size(); ++k) {
            const std::size_t at_once = other.bodies_at_once();
            require(k < at_once || other.rows[k].t > other.rows[k - at_once].t, "restored times do not increase");
            require(std::abs(other.rows[k].t - before[k].t) <= 1e-6 * before[k].t, "restored times differ too much");
        }
    }
}

/// Ensemble tables, in flight and about a pivot: accepted ones can be solved, and every row ends with a status.
inline void ensemble(std::string_view text) {
    Scene scene;
    scene.name = "fuzz", scene.duration = 1;
    if (one_in(2, text)) scene.pivot = Vector3<double>(0, 0, 0);
    const std::optional<EnsembleTable> table = parsed([&] { return parse_ensemble(text, "fuzz", scene); });
    if (!table) return;
    const bool pivoted = scene.pivot.has_value();
    const EnsembleTable again = parse_ensemble(write_ensemble(*table, pivoted), "written", scene);
    require(again.bodies == table->bodies && again.ids == table->ids, "an ensemble does not read back");
    require(table->ids.empty() || table->ids.size() == table->bodies.size(), "ids are lost");
    for (const EnsembleBody& body : table->bodies) require(!fault_of(body, pivoted), "an accepted body is not valid");
    if (table->bodies.size() > 20) return;
    for (const EnsembleRow& row : solve_ensemble(scene, table->bodies)) {
        require((row.status == Status::ok) == row.message.empty(), "a status does not match its message");
        require(row.status != Status::ok || squared_norm(row.end.q) * 0 == 0, "a row with status ok is not finite");
    }
}

/// Bodies joined by every type of joint with coordinates, and one free body.
inline const Scene& joined_bodies() {
    static const Scene scene = parse_scene(
        R"({"name": "joined", "duration": 0.01,
            "bodies": [{"name": "a", "body": {"mass": 1, "inertia": [1, 1, 1], "center_of_mass": [0, 0, -1]}},
                       {"name": "b", "body": {"mass": 2, "inertia": [1, 2, 2]}},
                       {"name": "c", "body": {"mass": 1, "inertia": [1, 1, 1], "center_of_mass": [0, 1, 0]}},
                       {"name": "d", "body": {"mass": 1, "inertia": [1, 1, 1]}},
                       {"name": "e", "body": {"mass": 3, "inertia": [2, 1, 2]}}],
            "joints": [{"name": "turn", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 1, 0]},
                       {"name": "slide", "type": "prismatic", "parent": "a", "child": "b", "axis": [1, 0, 0]},
                       {"name": "ball", "type": "spherical", "parent": "b", "child": "c"},
                       {"name": "cross", "type": "universal", "parent": "c", "child": "d",
                        "axes": [[1, 0, 0], [0, 1, 0]]}]})",
        "joined");
    return scene;
}

/// Each row of a table of mechanisms gives a scene that survives writing and reading.
inline void require_scenes(const MechanismTable& table, const Scene& scene) {
    require(table.numbers.size() == table.rows() * table.columns.size(),
            "a row has a different length than the header");
    for (std::size_t k = 0; k < std::min<std::size_t>(table.rows(), 4); ++k) {
        const std::string written = write_scene(table.scene_of(scene, k));
        require(write_scene(parse_scene(written, "written")) == written, "a row's scene does not read back");
    }
}

/// Reads a table in NumPy's format whose header states `rows` records. Pieces of any size give the same rows, also
/// after skipped rows. Returns the whole table.
inline EnsembleTable npy_rows(std::string_view content, const Scene& scene, std::uint64_t rows) {
    EnsembleTable whole, piece;
    npy_ensemble_of(content, "fuzz", scene)->next(whole, content.size() + 1);
    require(whole.rows() + whole.refused.size() == rows, "rows are lost");
    require(whole.ids.empty() || whole.ids.size() == whole.rows(), "ids are lost");
    for (const RefusedRow& row : whole.refused) require_one_line(row.fault);
    for (const EnsembleBody& body : whole.bodies)
        require(!fault_of(body, scene.pivot.has_value()), "an accepted body is not valid");
    require_scenes(whole.mechanisms, scene);
    const std::size_t left_out = npy_ensemble_of(content, "fuzz", scene)->skip(content.size() + 1);
    require(left_out == rows, "skipped rows are not counted");
    const auto pieces = npy_ensemble_of(content, "fuzz", scene);
    std::size_t passed = pieces->skip(1);
    std::vector<EnsembleBody> bodies;
    std::vector<double> numbers;
    while (pieces->next(piece, 3)) {
        bodies.insert(bodies.end(), piece.bodies.begin(), piece.bodies.end());
        numbers.insert(numbers.end(), piece.mechanisms.numbers.begin(), piece.mechanisms.numbers.end());
        passed += piece.rows() + piece.refused.size();
    }
    require(passed == rows, "pieces lose rows");
    require(std::equal(bodies.rbegin(), bodies.rend(), whole.bodies.rbegin()), "pieces differ from the whole");
    require(std::equal(numbers.rbegin(), numbers.rend(), whole.mechanisms.numbers.rbegin()),
            "pieces differ from the whole");
    return whole;
}

/// Ensemble tables in NumPy's format, of one body and of several: the header survives writing and reading, and the
/// table has the same bodies as CSV.
inline void npy(std::string_view content) {
    Scene scene;
    scene.name = "fuzz", scene.duration = 1;
    if (one_in(2, content)) scene.pivot = Vector3<double>(0, 0, 0);
    auto header = parsed([&] { return parse_npy_header(content, content.size(), "fuzz"); });
    if (header) {
        require(header->file_size() == content.size(), "the size of a file does not match its header");
        // written names are polhode's and need no escapes
        for (NpyField& field : header->fields) std::erase(field.name, '\'');
        const std::string again = write_npy_header(header->fields, header->rows);
        const NpyHeader read = parse_npy_header(again, again.size() + header->rows * header->record_size, "written");
        require(read.rows == header->rows && read.record_size == header->record_size, "a header does not read back");
    }
    const auto opens = [&](const Scene& of) { return parsed([&] { return npy_ensemble_of(content, "fuzz", of); }); };
    if (opens(joined_bodies())) npy_rows(content, joined_bodies(), header.value().rows);
    if (!opens(scene)) return;
    const EnsembleTable whole = npy_rows(content, scene, header.value().rows);
    const auto as_comment = [](const std::string& id) { return id.starts_with('#'); };
    if (whole.bodies.empty() || std::any_of(whole.ids.begin(), whole.ids.end(), as_comment)) return;
    const EnsembleTable csv = parse_ensemble(write_ensemble(whole, scene.pivot.has_value()), "written", scene);
    require(csv.bodies == whole.bodies && csv.ids == whole.ids, "an ensemble does not read back");
}

/// Tables of initial states of mechanisms are refused by one line, or give scenes that survive writing and reading.
inline void mechanisms(std::string_view text) {
    const Scene& scene = joined_bodies();
    const auto table = parsed([&] { return parse_ensemble(text, "fuzz", scene, BadRows::pass_over); });
    if (!table) return;
    require(table->ids.empty() || table->ids.size() == table->rows(), "ids are lost");
    for (const RefusedRow& row : table->refused) require_one_line(row.fault);
    require_scenes(table->mechanisms, scene);
}

/// A line of column names, then a table of another program. They are refused by one line, or the table can be read, and
/// written and read again under polhode's names. `check` and `plot` read tables in this way.
inline void columns(std::string_view text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string table(text.substr(std::min(end + 1, text.size())));
    ColumnNames names;
    try {
        names = parse_columns(std::string_view(text).substr(0, end));
    } catch (const std::invalid_argument& error) {
        require_one_line(error.what());
    }
    for (const bool several : {false, true}) {
        const auto found = parsed([&] { return find_foreign_columns(table, "fuzz", names, several); });
        if (!found) continue;
        for (const std::string& remark : found->remarks) require_one_line(remark);
        auto file = parsed([&] { return parse_foreign_trajectory(table, "fuzz", found->columns); });
        if (!file) continue;
        file->skipped_content.clear();
        require(parse_trajectory(write_trajectory(*file), "written") == *file, "a foreign table does not read back");
    }
    parsed([&] {
        CheckedFile checked;
        checked.path = "fuzz";
        std::vector<std::size_t> gaps;
        const TrajectoryFile file = prepare_file(nullptr, {}, names, table, checked, &gaps);
        require(std::ranges::is_sorted(gaps), "gaps are not sorted");
        require(gaps.empty() || gaps.back() <= file.rows.size(), "a gap is beyond the end");
        for (const std::string& remark : checked.remarks) require_one_line(remark);
        return 0;
    });
}

inline void decimal(const std::string& text) {
    const std::optional<double> value = parse_decimal(text);
    if (value && std::isfinite(*value)) {
        const std::optional<double> again = parse_decimal(shortest_decimal(*value));
        require(again && std::bit_cast<std::uint64_t>(*again) == std::bit_cast<std::uint64_t>(*value),
                "a number does not read back");
    }
    // strtod, an independent parser, also accepts hexadecimal numbers and leading blanks
    if (text.find_first_of("xX \t\n\v\f\r") != text.npos || text.find('\0') != text.npos || text.empty()) return;
    char* end = nullptr;
    const double other = std::strtod(text.c_str(), &end);
    require(value.has_value() == (end == text.c_str() + text.size()),
            "parse_decimal and strtod disagree on whether a text is a number");
    if (value) require(*value == other || (*value != *value && other != other), "a number differs from strtod's");
}

inline void quoted(const std::string& text) {
    for (const std::size_t limit : {40u, 300u}) {
        const std::string line = one_line(text, limit);
        require(line.size() <= limit, "a line is too long");
        require_one_line(line);
        require(first_invalid_utf8(line) == line.npos, "a line is not UTF-8");
    }
    if (first_invalid_utf8(text) != text.npos) return;
    const JsonDocument document(json_string(text), "written");
    require(document.root().string() == text, "a text does not read back");
}

/// Short texts: as numbers, as text quoted in messages, and as a regular expression that is matched against the rest.
inline void words(std::string_view bytes) {
    const std::string text(bytes);
    decimal(text);
    quoted(text);
    require(near_misses(text, {"taylor", "dop853", "radau", "splitting4", ""}).size() <= 3, "too many near misses");
    const std::size_t end = std::min(text.find('\n'), text.size());
    try {
        const Pattern pattern(text.substr(0, end));
        const std::string subject = text.substr(std::min(end + 1, text.size()));
        require(pattern.matches(subject) == pattern.matches(subject),
                "an expression matches one time and not the other");
    } catch (const std::invalid_argument& error) {
        require_one_line(error.what());
    }
}

/// Values of --convention are refused by one line or survive writing and reading.
inline void convention(std::string_view text) {
    try {
        const Convention read = parse_convention(text);
        if (read != Convention{}) require(parse_convention(name_of(read)) == read, "a convention does not read back");
    } catch (const std::invalid_argument& error) {
        require_one_line(error.what());
    }
}

/// The series and rates of a tape agree between machine code and the interpreters.
inline void tape(std::string_view text) {
    const testing::TapeOfBytes made(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    testing::compare_ways(made.recording, made.order, made.careful, made.start);
    testing::compare_ways_of_rates(made.recording, made.start);
}

/// Result tables, and the files of finished cases and their series.
inline void table(std::string_view text) {
    try {
        const Table table = parse_csv(text);
        require(csv(parse_csv(csv(table))) == csv(table), "a table does not read back");
        if (table.columns == result_columns()) {
            Table rows{result_columns(), {}};
            for (std::size_t i = 0; i < table.rows.size(); ++i)
                rows.rows.push_back(result_row("e", parse_result(table, i)));
            Table again{result_columns(), {}};
            const Table read = parse_csv(csv(rows));
            for (std::size_t i = 0; i < read.rows.size(); ++i)
                again.rows.push_back(result_row("e", parse_result(read, i)));
            require(csv(again) == csv(rows), "results do not read back");
        } else if (table.columns == series_table({}).columns) {
            const std::string series = csv(series_table(parse_series(table)));
            require(csv(series_table(parse_series(parse_csv(series)))) == series, "a series does not read back");
        }
    } catch (const std::invalid_argument& error) {
        require_one_line(error.what());
    }
}

/// Files of the truth cache with a valid checksum.
inline void cache(std::string_view text) {
    const std::string key = "key";
    std::string sealed(text);
    sealed.append("checksum ").append(content_hash(text)).append("\n");
    require(!truth::decode(key, text), "a text without a checksum is accepted");
    const std::optional<truth::Truth> truth = truth::decode(key, sealed);
    if (!truth) return;
    const std::string written = truth::encode(key, *truth);
    const std::optional<truth::Truth> back = truth::decode(key, written);
    require(back.has_value(), "a written truth cannot be read");
    require(truth::encode(key, *back) == written, "a truth does not read back");
}

/// Messages and answers of engines, and files that list engines.
inline void engine(std::string_view text) {
    try {
        const EngineHello hello = read_hello(text);
        require_one_line(hello.version), require_one_line(hello.missing);
        for (const auto& [name, what] : hello.settings) require_one_line(name), require_one_line(what);
    } catch (const std::invalid_argument& error) {
        require_one_line(error.what());
    }
    Scene scene;
    scene.name = "fuzz", scene.duration = 1, scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    static const Problem problem = pose(scene);
    static const EngineScene known = engine_scene(problem);
    Settings settings;
    settings.samples = 2;
    const EngineAnswer answer = read_answer(text, problem, known, settings, 5);
    const Trajectory& run = answer.trajectory;
    require_one_line(run.message);
    require((run.status == Status::ok) == (run.samples.size() == 3),
            "the status of an answer does not match its samples");
    for (const Sample& s : run.samples)
        require(squared_norm(s.q) * 0 == 0 && dot(s.position_W, s.position_W) * 0 == 0, "a sample is not finite");
    if (run.status == Status::ok) require(run.seconds >= 0 && run.steps >= 0, "the cost is negative");
    static const Problem joined = pose(joined_bodies());
    static const EngineMechanism mechanism = engine_mechanism(joined);
    const Trajectory several = read_mechanism_answer(text, joined, mechanism, settings, 5);
    require_one_line(several.message);
    require((several.status == Status::ok) == (several.samples.size() == 3 * mechanism.bodies.size()),
            "the status of an answer does not match its samples");
    const auto engines = parsed([&] { return parse_engines(text, "fuzz"); });
    if (!engines) return;
    for (const EngineMethod& one : *engines)
        require(!one.engine.empty() && !one.setting.empty(), "an engine has no name or no setting");
}

}  // namespace polhode::oracles
