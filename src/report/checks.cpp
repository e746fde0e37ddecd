#include "report/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "body/mass_properties.h"
#include "check/check_files.h"
#include "check/limits.h"
#include "check/report.h"
#include "motion/trajectory_csv.h"

namespace polhode {
namespace {

// Mean angular velocity (rad/s, body axes) of the rotation between two attitudes that are `duration` seconds apart.
Vector3<double> mean_rate(const Quaternion<double>& from, const Quaternion<double>& to, double duration) {
    Quaternion<double> d = conjugate(normalized(from)) * normalized(to);
    if (d.w < 0) d = {-d.w, -d.x, -d.y, -d.z};
    const double sine = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double scale = sine > 0 ? 2 * std::atan2(sine, d.w) / sine / duration : 0;
    return {d.x * scale, d.y * scale, d.z * scale};
}

// The samples of a file, with missing columns estimated for drawing: w from differences of attitudes, v from
// differences of positions, the centre of mass of a body with a pivot from the attitude. Without positions and pivot,
// the centre of mass of each body stays at its initial position.
std::vector<Sample> drawn_samples(const Scene& scene, const TrajectoryFile& file) {
    std::vector<Vector3<double>> centers;
    const std::vector<std::size_t> places = bodies_of_file(scene, file);
    for (const std::size_t b : places) centers.push_back(scene_body(scene, b).body.center_of_mass);
    std::vector<Sample> samples = samples_of(file, centers);
    const std::size_t bodies = file.bodies_at_once();
    // the previous and the next sample of the same body
    const auto before = [&](std::size_t i) -> const Sample& { return samples[i >= bodies ? i - bodies : i]; };
    const auto after = [&](std::size_t i) -> const Sample& {
        return samples[i + bodies < samples.size() ? i + bodies : i];
    };
    const bool has_position = file.has_position || file.has_origin;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Sample &from = before(i), &to = after(i);
        const double h = to.t - from.t;
        if (!(h > 0)) continue;
        if (!file.has_angular_velocity) samples[i].angular_velocity_B = mean_rate(from.q, to.q, h);
        if (has_position && !file.has_velocity) samples[i].velocity_W = (1 / h) * (to.position_W - from.position_W);
    }
    if (has_position) return samples;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        Sample& sample = samples[i];
        if (scene.pivot) {
            const Vector3<double> arm = scene.body.center_of_mass - *scene.pivot;
            const Quaternion<double> q = normalized(sample.q);
            sample.position_W = rotate(q, arm);
            sample.velocity_W = rotate(q, cross(sample.angular_velocity_B, arm));
        } else {
            sample.position_W = scene_body(scene, places[i % places.size()]).initial.position_W;
            sample.velocity_W = {};
        }
    }
    return samples;
}

Json check_json(const CheckedFile& checked, const ErrorLimits& limits, int scene) {
    const bool failed = limits.refuses(checked.file_errors);
    Json json{{"file", std::filesystem::path(checked.path).filename().string()},
              {"scene", scene},
              {"verdict", failed ? "failed" : "passed"},
              {"passed", !failed},
              {"blocks", Json::array()},
              {"lines", Json::array()},
              {"diagnoses", Json::array()},
              {"remarks", checked.remarks},
              {"t", Json::array()},
              {"errors", Json::array()},
              {"motion_method", nullptr}};
    for (const BlockVerdict& verdict : limits.verdicts(checked.file_errors)) {
        const auto& summary = checked.file_errors[verdict.block->measure];
        const bool relative = verdict.limit.relative;
        const auto value = relative ? verdict.relative : verdict.error;
        json["blocks"].push_back({{"name", verdict.block->title},
                                  {"error", number_json(value.value_or(absent), 6)},
                                  {"unit", relative ? "relative" : std::string(verdict.block->unit)},
                                  {"limit", number_json(verdict.limit.value, 6)},
                                  {"passed", verdict.error ? Json(!verdict.failed) : Json()},
                                  {"at", summary ? number_json(summary->max_time, 6) : Json()}});
    }
    CheckedFile checked_copy = checked;
    checked_copy.path = json["file"].get<std::string>();
    std::istringstream lines(check_text(limits, {checked_copy}));
    for (std::string line; std::getline(lines, line);) json["lines"].push_back(line);
    for (const Diagnosis& fault : checked.diagnosis.faults) json["diagnoses"].push_back(fault.message);
    if (checked.diagnosis.update) json["diagnoses"].push_back(checked.diagnosis.update->message);
    if (!checked.picture) return json;
    for (const Panel& panel : checked.picture->panels) {
        if (panel.curves.empty()) continue;
        const Curve& own = panel.curves.front();
        if (json["t"].empty()) json["t"] = numbers_json(own.x, 6);
        std::string unit = panel.y_label;
        if (const std::size_t open = unit.find('('); open != std::string::npos)
            unit = unit.substr(open + 1, unit.size() - open - 2);
        json["errors"].push_back({{"name", panel.title}, {"unit", unit}, {"values", numbers_json(own.y, 4)}});
    }
    return json;
}

}  // namespace

CheckedTrajectories check_trajectories(const Scene& scene, int place, const std::vector<std::string>& files,
                                       const Convention& convention) {
    ErrorLimits limits(scene);
    ColumnNames columns;
    columns.degrees = convention.degrees;
    const std::vector<CheckedFile> all = check_files(scene, files, convention, columns, limits, false, true);
    CheckedTrajectories checked;
    for (const CheckedFile& one : all) {
        checked.list.push_back(check_json(one, limits, place));
        DrawnFile drawn{std::filesystem::path(one.path).filename().string(), place, {}, 1};
        // files that lack bodies are not drawn
        if (one.file && missing_bodies(scene, *one.file).empty()) {
            drawn.samples = drawn_samples(scene, *one.file);
            drawn.bodies = static_cast<int>(one.file->bodies_at_once());
        }
        checked.drawn.push_back(std::move(drawn));
    }
    return checked;
}

}  // namespace polhode
