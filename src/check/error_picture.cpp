#include "check/error_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiment/plan/method_style.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t most_points = 400;
// blue, which no engine update uses
constexpr int file_color = static_cast<int>(Family::series);

// The update drawn for comparison, with its errors at the file's times; empty if there is none.
struct Companion {
    const Method* method = nullptr;
    std::string label;
    ErrorSeries errors;
};
Companion companion(const Scene& scene, const TrajectoryFile& file, const std::vector<std::size_t>& rows,
                    const Reference& truth, const CheckedFile& checked) {
    const double last = file.rows.back().t, row = last / static_cast<double>(file.rows.size() - 1);
    for (std::size_t k = 0; k < file.rows.size(); ++k)
        if (!(std::abs(file.rows[k].t - static_cast<double>(k) * row) <= 1e-3 * row)) return {};
    const std::optional<UpdateMatch>& followed = checked.diagnosis.update;
    const Method* const method = find_method(followed ? followed->method : "gyroscopic_explicit");
    Scene timed = scene;
    timed.duration = last;
    Settings settings;
    settings.samples = static_cast<long>(file.rows.size()) - 1;
    settings.step = followed ? followed->step : row;
    settings.max_steps = 2'000'000;
    Trajectory run = solve(timed, *method, settings);
    if (run.status != Status::ok || run.samples.size() != file.rows.size()) return {};
    std::vector<Sample> picked;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        picked.push_back(run.samples[rows[i]]);
        picked.back().t = truth.samples[i].t;
    }
    run.samples = std::move(picked);
    return {method, fmt::format("{} at {:.4g} Hz", method->name, 1 / *settings.step), error_series(scene, run, truth)};
}

// Adds the attitude errors of one body caused by rounding the start.
void add_floors(const Scene& scene, const std::vector<double>& times, Panel& panel) {
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    if (const Conditioning kappa = conditioning(scene, times, settings); !kappa.times.empty()) {
        std::vector<double> float64, float32;
        for (std::size_t k = 0; k < kappa.times.size(); ++k)
            float64.push_back(kappa.floor(k, float64_roundoff)), float32.push_back(kappa.floor(k, float32_roundoff));
        for (const auto& [label, y, dash] : {std::tuple{"float32 floor", &float32, 1}, {"float64 floor", &float64, 2}})
            panel.curves.push_back(
                {.label = label, .color = 0, .dash = dash, .points = false, .x = kappa.times, .y = *y});
    }
}

// The value of a limit in the unit of the measure.
double limit_of(const BlockVerdict& verdict, const Measure& measure, double size) {
    const double of_size = measure.is_relative() || !verdict.limit.relative ? 1 : size;
    const double per_size = measure.is_relative() && !verdict.limit.relative && !verdict.block->unit.empty() ? size : 1;
    return verdict.limit.value * of_size / per_size;
}

// The errors of a block over time: of the file, and of the update drawn for comparison.
Panel block_panel(const BlockVerdict& verdict, const ErrorSeries& own, const Companion& beside, double size) {
    const Measure& measure = measures()[measure_index(verdict.block->measure)];
    Panel panel;
    panel.title = std::string(verdict.block->title);
    panel.x_label = "time (s)", panel.log_x = false;
    panel.y_label = fmt::format("error ({})", measure.unit);
    const auto add = [&](std::string label, const MethodStyle& style, int dash, const std::vector<double>& y) {
        panel.curves.push_back({.label = std::move(label),
                                .color = style.color,
                                .mark = style.mark,
                                .dash = dash,
                                .points = false,
                                .x = own.t,
                                .y = y});
    };
    add("the file", {file_color, 0}, 0, own[verdict.block->measure]);
    if (!beside.label.empty())
        add(beside.label, method_style(*beside.method), 1, beside.errors[verdict.block->measure]);
    if (const double allowed = limit_of(verdict, measure, size); std::isfinite(allowed) && allowed > 0)
        panel.guides.push_back({"limit", {}, {allowed}});
    return panel;
}

}  // namespace

Figure error_picture(const Scene& scene, const TrajectoryFile& file, const ErrorLimits& limits,
                     const CheckedFile& checked) {
    // evenly spread times, including the first and the last
    const std::size_t at_once = file.bodies_at_once(), moments = file.rows.size() / at_once;
    std::vector<std::size_t> rows;
    const std::size_t count = std::min(most_points, moments);
    for (std::size_t i = 0; i < count; ++i) rows.push_back(count > 1 ? i * (moments - 1) / (count - 1) : 0);
    TrajectoryFile picked = file;
    picked.rows.clear();
    std::vector<double> times;
    for (const std::size_t k : rows) {
        times.push_back(file.rows[k * at_once].t);
        for (std::size_t b = 0; b < at_once; ++b) picked.rows.push_back(file.rows[k * at_once + b]);
    }
    const Reference truth = reference(scene, times);
    if (!truth.available) throw std::invalid_argument(truth.message);

    const Trajectory of_file = complete_from_truth(truth, scene, picked);
    const ErrorSeries own = error_series(scene, of_file, truth);
    const Companion beside = file.rows.size() > 1 ? companion(scene, file, rows, truth, checked) : Companion();

    Figure figure;
    figure.title = fmt::format("{} on {}", one_line(checked.path, 80), scene.name);
    figure.columns = 2;
    for (const BlockVerdict& verdict : limits.verdicts(checked.file_errors)) {
        if (!verdict.error) continue;
        Panel panel =
            block_panel(verdict, own, beside, checked.file_errors.size[measure_index(verdict.block->measure)]);
        if (verdict.block->name == "attitude" && checked.until > 0 && body_count(scene) == 1)
            add_floors(scene, times, panel);
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace polhode
