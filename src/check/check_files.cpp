#include "check/check_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <thread>
#include <utility>

#include "body/orientation.h"
#include "check/error_picture.h"
#include "check/foreign_table.h"
#include "check/joint_event_faults.h"
#include "check/sample_clock.h"
#include "check/system_search.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/contact/joint_events.h"
#include "integrators/truth/dense.h"
#include "integrators/truth/reference.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"
#include "text/interruption.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/parallel.h"

namespace polhode {
namespace {

bool has_armature(const Scene& scene) {
    return std::ranges::any_of(scene.joints, [](const Joint& joint) { return joint.armature != std::array{0.0, 0.0}; });
}

// Lists the columns and blocks that a file of this scene could have but lacks.
std::string list_missing_blocks(const Scene& scene, const TrajectoryFile& file) {
    const bool several = body_count(scene) > 1, has_place = file.has_position || file.has_origin;
    const bool has_joints = !scene.joints.empty() || !scene.loops.empty();
    std::vector<std::string> all;
    if (!file.has_angular_velocity) all.emplace_back("angular velocity (therefore also energy and angular momentum)");
    if (const std::vector<std::string> missing = missing_bodies(scene, file); !missing.empty())
        all.push_back(fmt::format("bod{} {} (therefore also energy, momentum and joints)",
                                  missing.size() > 1 ? "ies" : "y", one_line(join_with_commas(missing), 200)));
    if (!scene.pivot && !has_place) all.emplace_back(has_joints ? "position (therefore also joint gaps)" : "position");
    if (!scene.pivot && !file.has_velocity) all.emplace_back("velocity");
    if (!scene.pivot && file.has_angular_velocity && !(file.has_velocity && has_place))
        all.emplace_back(several                          ? "energy and momentum (they need position and velocity)"
                         : rotation_is_independent(scene) ? "translational energy (the rotational energy is compared)"
                                                          : "energy");
    return fmt::format("{}", fmt::join(all, "; "));
}

// Compares a file of many samples with a polynomial reference, in binary64. A million samples take about a second.
void compare_in_binary64(const Scene& scene, const TrajectoryFile& file, const DenseTruth& truth,
                         CheckedFile& checked) {
    constexpr std::size_t pieces = 16, at_once = 1024;
    const std::size_t rows = file.rows.size();
    std::vector<FileErrorAccumulator> accumulators;
    for (std::size_t i = 0; i < pieces; ++i) accumulators.emplace_back(scene, file, ErrorArithmetic::binary64);
    parallel_for(pieces, static_cast<int>(std::thread::hardware_concurrency()), [&](std::size_t i) {
        std::vector<ReferenceSample> samples;
        const std::size_t end = rows * (i + 1) / pieces;
        for (std::size_t first = rows * i / pieces; first < end; first += samples.size()) {
            if (Interruption::is_requested()) throw TruthUnavailable(checked.path + ": interrupted");
            samples.clear();
            for (std::size_t k = first; k < std::min(first + at_once, end); ++k)
                samples.push_back(truth.at(file.rows[k].t));
            accumulators[i].add(first, samples);
        }
    });
    for (std::size_t i = 1; i < pieces; ++i) accumulators[0].append(accumulators[i]);
    checked.file_errors = accumulators[0].result();
    checked.truth_bound = truth.bound, checked.truth = truth.message;
    checked.remarks.emplace_back("evaluated in binary64: errors below 1e-15 are not resolved");
}

// Compares a file with the truth. Returns why there is no truth, or an empty string.
std::string compare_with_truth(const Scene& scene, TrajectoryFile& file, CheckedFile& checked) {
    constexpr std::size_t many = 2000;
    if (file.rows.size() > many && file.rows.back().t > 0)
        if (const DenseTruth truth = dense_reference(scene, file.rows.back().t); truth.available) {
            compare_in_binary64(scene, file, truth, checked);
            return "";
        }
    std::vector<double> times;
    for (std::size_t k = 0; k < file.rows.size(); k += file.bodies_at_once()) times.push_back(file.rows[k].t);
    Reference truth = reference(scene, times);
    if (!truth.available && !scene.planes.empty() && truth.message.find("impact") != std::string::npos) {
        // the truth ends where impacts accumulate: find the last row before that by bisection
        const std::string why = truth.message;
        std::size_t known = 1, unknown = times.size();
        while (unknown - known > 1) {
            const std::size_t middle = known + (unknown - known) / 2;
            Reference part = reference(scene, {times.begin(), times.begin() + static_cast<std::ptrdiff_t>(middle)});
            if (part.available)
                known = middle, truth = std::move(part);
            else
                unknown = middle;
        }
        if (truth.available) {
            file.rows.resize(known);
            checked.samples = known, checked.until = file.rows.back().t;
            checked.remarks.push_back(fmt::format("compared up to t = {:.6g} s: {}", checked.until, why));
        }
    }
    if (!truth.available) return truth.message;
    checked.truth_bound = truth.bound, checked.truth = truth.message;
    checked.file_errors = compute_file_errors(scene, file, truth);
    return "";
}

// Computes the floors at the ends of the file's spans and in between, and adds remarks on the file's error.
void compare_with_floors(const Scene& scene, const ErrorLimits& limits, CheckedFile& checked) {
    if (!(checked.until > 0)) return;
    constexpr int between = 20;
    std::vector<double> times;
    double begin = 0;
    for (const ErrorSpan& span : checked.file_errors.over_time) {
        for (int i = 1; i < between; ++i) times.push_back(begin + (span.until - begin) * i / between);
        times.push_back(begin = span.until);
    }
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    const Conditioning kappa = conditioning(scene, times, settings);
    if (!kappa.available)
        checked.remarks.push_back(kappa.times.empty() ? "floors not available: " + kappa.message
                                                      : fmt::format("floors available only until t = {:.4g} s: {}",
                                                                    kappa.times.back(), kappa.message));
    if (kappa.times.empty()) return;
    RoundingFloor so_far;
    const double allowed = limits["attitude"].value;
    for (std::size_t k = 0; k < kappa.times.size(); ++k) {
        so_far.float64 = std::max(so_far.float64, kappa.floor(k, float64_roundoff));
        so_far.float32 = std::max(so_far.float32, kappa.floor(k, float32_roundoff));
        if (so_far.float32 > allowed && !checked.float32_valid_until)
            checked.float32_valid_until = k > 0 ? times[k - 1] : 0;
        if ((k + 1) % between == 0) checked.floor_over_time.push_back(so_far);
    }
    checked.floor = so_far;
    const double error = checked.file_errors["attitude"]->max;
    // the floor contains the rounding of the start only; rounding in each step raises the error to a few times the
    // floor
    constexpr double a_few = 4;
    // the remark is about the attitude, but is made only if the other blocks are equally accurate
    const auto others_within = [&](double floor) {
        const std::vector<BlockVerdict> all = limits.verdicts(checked.file_errors);
        return std::all_of(all.begin(), all.end(), [&](const BlockVerdict& v) {
            return v.block->name == "attitude" || !v.relative || *v.relative <= 1e3 * std::max(floor, 1e-14);
        });
    };
    // an error far below the binary32 floor is not caused by binary32
    if (kappa.available && error <= a_few * so_far.float64 && others_within(so_far.float64))
        checked.remarks.emplace_back(
            "at the float64 floor: the attitude is as accurate as binary64 allows on this scene");
    else if (kappa.available && error <= a_few * so_far.float32 && error >= so_far.float32 / 10 &&
             others_within(so_far.float32))
        checked.remarks.emplace_back(
            "at the float32 floor: the attitude is as accurate as binary32 allows on this scene");
    if (checked.float32_valid_until)
        checked.remarks.push_back(fmt::format(
            "beyond t = {:.4g} s a binary32 engine cannot be evaluated: rounding the initial data to binary32 alone "
            "causes an attitude error above {} rad",
            *checked.float32_valid_until, shortest_decimal(allowed)));
}

// Returns what to record if no cause was found.
std::string explain_missing_diagnosis(const TrajectoryFile& file) {
    double turn = 0, interval = 0;
    for (std::size_t k = 1; k < file.rows.size(); ++k) {
        turn = std::max(turn, rotation_angle_between(file.rows[k - 1].q, file.rows[k].q));
        interval = std::max(interval, file.rows[k].t - file.rows[k - 1].t);
    }
    const bool complete = file.has_angular_velocity && file.has_velocity && (file.has_position || file.has_origin);
    return fmt::format(
        "no diagnosis: no known fault and no known update, in 1 to 16 or 20 steps per row, predicts a row from the "
        "previous one; rows are up to {:.4g} s apart, and the body rotates by up to {:.2g} rad between them; {}; the "
        "first 200 steps suffice",
        interval, turn,
        complete ? "if the engine takes more steps than that per row, record a row after every step"
                 : "record a row after every step of the engine, with w, p and v");
}

// Returns why a file of several bodies has no diagnosis, and what to record.
std::string explain_missing_system_diagnosis(const Scene& scene, const TrajectoryFile& file) {
    if (!missing_bodies(scene, file).empty()) return "no diagnosis: bodies are missing in the file; record all bodies";
    if (!file.has_angular_velocity || !file.has_velocity || !(file.has_position || file.has_origin))
        return "no diagnosis: no known fault predicts a row from the previous one; record w, p and v of all bodies "
               "after every step of the engine";
    return "no diagnosis: no known fault of loads, joints or bodies predicts a row from the previous one";
}

// The blocks of a file whose errors exceed their limits.
struct FailedBlocks {
    std::vector<std::string_view> names;

    bool any() const { return !names.empty(); }
    bool any_of_joints() const { return std::ranges::any_of(names, is_of_joints); }
    bool any_of_rotation() const {
        return std::ranges::any_of(
            names, [](std::string_view name) { return name == "attitude" || name == "angular_velocity"; });
    }
};

// Why faults of several bodies are not varied; empty if they are.
std::string system_diagnosis_refusal(const Scene& scene) {
    if (has_formula_loads(scene)) return "no diagnosis: formulas in scenes with several bodies are not varied";
    if (has_sphere_contacts(scene)) return "no diagnosis: contacts of several bodies are not varied";
    return "";
}

void diagnose_mechanism(const Scene& scene, const TrajectoryFile& file, bool explain, const FailedBlocks& failed,
                        CheckedFile& checked) {
    std::vector<Diagnosis>& faults = checked.diagnosis.faults;
    if (const std::string why = system_diagnosis_refusal(scene); !why.empty()) {
        if (failed.any()) checked.remarks.push_back(why);
        return;
    }
    if (contact::has_joint_events(scene) || !scene.couplings.empty()) {
        if (failed.any()) faults = joint_event_faults(scene, file);
        if (failed.any() && faults.empty())
            checked.remarks.push_back(
                "no diagnosis: no change of friction, limits, couplings and armatures of joints explains the "
                "file; other faults are not varied in such a scene");
        return;
    }
    checked.diagnosis = diagnose_system(scene, file, explain);
    // in a sound engine that steps bodies separately, joints drift within the limit
    if (!failed.any_of_joints()) std::erase_if(faults, [](const Diagnosis& d) { return d.fault == "joint_drifts"; });
    if (failed.any() && faults.empty() && has_armature(scene)) faults = joint_event_faults(scene, file);
    if (failed.any() && faults.empty()) checked.remarks.push_back(explain_missing_system_diagnosis(scene, file));
}

void diagnose_body(const Scene& scene, const TrajectoryFile& file, const ErrorLimits& limits, bool explain,
                   const FailedBlocks& failed, CheckedFile& checked) {
    if (!sampling_times(scene).empty()) {
        if (failed.any()) checked.remarks.push_back("no diagnosis: formulas that hold sampled values are not varied");
        return;
    }
    checked.diagnosis = diagnose(scene, file, explain);
    // a matched update explains errors of the rotation only
    if (failed.any() && !failed.any_of_rotation()) checked.diagnosis.update.reset();
    if (failed.any() && checked.diagnosis.faults.empty() && !checked.diagnosis.update)
        checked.remarks.push_back(explain_missing_diagnosis(file));
    compare_with_floors(scene, limits, checked);
}

// Compares the files that were read with the truth, one by one, and diagnoses them.
void evaluate_files(const Scene& scene, const ErrorLimits& limits, bool explain, bool picture,
                    std::vector<TrajectoryFile>& files, std::vector<CheckedFile>& all) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        CheckedFile& checked = all[i];
        if (const std::string fault = compare_with_truth(scene, files[i], checked); !fault.empty())
            throw TruthUnavailable(checked.path + ": " + fault);
        checked.missing_blocks = list_missing_blocks(scene, files[i]);
        const std::vector<BlockVerdict> verdicts = limits.verdicts(checked.file_errors);
        FailedBlocks failed;
        for (const BlockVerdict& verdict : verdicts)
            if (verdict.failed) failed.names.push_back(verdict.block->name);
        if (is_mechanism(scene))
            diagnose_mechanism(scene, files[i], explain, failed, checked);
        else
            diagnose_body(scene, files[i], limits, explain, failed, checked);
        if (picture) checked.picture = error_picture(scene, files[i], limits, checked);
        if (picture) checked.file = std::move(files[i]);
        files[i] = {};
    }
}

}  // namespace

TrajectoryFile prepare_file(const Scene* scene, const Convention& convention, const ColumnNames& columns,
                            std::string_view text, CheckedFile& checked, std::vector<std::size_t>* gaps) {
    const std::vector<std::string> bodies = scene != nullptr ? body_names(*scene) : std::vector<std::string>();
    ForeignTable table = find_foreign_columns(text, checked.path, columns, scene == nullptr || !bodies.empty());
    TrajectoryFile file =
        parse_foreign_trajectory(text, checked.path, table.columns, convention.quaternion, bodies, gaps);
    checked.remarks = std::move(table.remarks);
    if (!file.skipped_content.empty()) checked.remarks.push_back("ignored: " + file.skipped_content);
    if (scene == nullptr) {
        convert(file, convention);
        return file;
    }
    if (bodies.empty() && !file.bodies.empty())
        throw InputError(checked.path, "column body", "is not allowed for a scene of one body",
                         "remove it, or give a scene of several bodies");
    convert(file, convention);
    if (const std::optional<double> dt = restore_clock(file, scene->duration))
        checked.remarks.push_back(
            fmt::format("times are rounded to binary32: replaced by the multiples of {} s that they were rounded from",
                        shortest_decimal(*dt)));
    const double last = file.rows.back().t;
    // a clock that accumulates steps ends near the duration, up to rounding
    if (last > scene->duration * (1 + 1e-9))
        throw InputError(checked.path, "column t",
                         fmt::format("ends at {} s, but the scene lasts {} s", shortest_decimal(last),
                                     shortest_decimal(scene->duration)),
                         "give times in s within the scene's duration, or a longer scene");
    checked.samples = file.rows.size() / file.bodies_at_once(), checked.from = file.rows.front().t,
    checked.until = last;
    return file;
}

std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<std::string>& paths,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture) {
    std::vector<CheckedFile> all;
    std::vector<TrajectoryFile> files;
    for (const std::string& path : paths) {
        all.emplace_back().path = path;
        files.push_back(prepare_file(&scene, convention, columns, read_text(path, largest_file, "a readable CSV file"),
                                     all.back()));
    }
    evaluate_files(scene, limits, explain, picture, files, all);
    return all;
}

std::vector<CheckedFile> check_files(const Scene& scene, const std::vector<NamedText>& texts,
                                     const Convention& convention, const ColumnNames& columns,
                                     const ErrorLimits& limits, bool explain, bool picture) {
    std::vector<CheckedFile> all;
    std::vector<TrajectoryFile> files;
    for (const NamedText& one : texts) {
        all.emplace_back().path = one.name;
        files.push_back(prepare_file(&scene, convention, columns, one.text, all.back()));
    }
    evaluate_files(scene, limits, explain, picture, files, all);
    return all;
}

}  // namespace polhode
