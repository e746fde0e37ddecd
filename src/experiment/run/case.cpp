#include "experiment/run/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiment/run/calibration.h"
#include "experiment/run/contact_events.h"
#include "measure/errors.h"

namespace polhode {
namespace {

Result blank(const Case& c) {
    Result result;
    result.scene = c.scene->label;
    result.method = c.curve->method->name;
    result.setting_kind = c.curve->kind;
    result.formulation = c.curve->formulation;
    if (c.curve->calibrated) {
        result.evaluations_per_revolution = c.setting();
        result.setting = c.settings.step.value_or(c.settings.tolerance.value_or(0));
    } else {
        result.setting = c.curve->kind == SettingKind::none ? 0 : c.setting();
    }
    return result;
}

// Sets the settings of the run. Returns false if the calibration found no setting; the result then holds the reason.
bool choose_settings(const Experiment& experiment, Case& c) {
    Settings& settings = c.settings;
    settings.samples = experiment.samples;
    // a step needs at least one evaluation, so a run with too many fixed steps is refused at once
    settings.max_steps = std::min(experiment.max_steps, experiment.max_evaluations);
    settings.max_evaluations = experiment.max_evaluations;
    settings.seconds_limit = experiment.seconds_per_run;
    settings.formulation = c.curve->formulation;
    double setting = c.setting();
    if (c.curve->calibrated) {
        const Calibration found = calibrate(c.scene->scene, *c.curve->method, c.curve->kind, setting);
        if (!found.found) {
            c.result = blank(c);
            c.result->status = Status::unsupported, c.result->message = found.message;
            return false;
        }
        setting = found.setting;
    }
    if (c.curve->kind == SettingKind::step) settings.step = setting;
    if (c.curve->kind == SettingKind::tolerance) settings.tolerance = setting;
    return true;
}

// T times the mean |w| of the truth, in revolutions
std::optional<double> revolutions(const Reference& reference) {
    if (!reference.available || reference.samples.size() < 2) return {};
    double sum = 0;
    for (const ReferenceSample& s : reference.samples) {
        const auto& w = s.angular_velocity_B;
        sum += std::hypot(w[0].high, w[1].high, w[2].high);
    }
    const double mean = sum / static_cast<double>(reference.samples.size());
    return mean * reference.samples.back().t / (2 * std::numbers::pi);
}

}  // namespace

std::string describe_case(const Plan& plan, const Case& c) {
    std::string description = fmt::format("{} {} {}", plan.experiment.name, c.scene->label, c.curve->method->name);
    if (c.curve->kind != SettingKind::none) description += fmt::format(" {} {:g}", name_of(c.curve->kind), c.setting());
    if (c.curve->calibrated) description += " evaluations per revolution";
    if (c.curve->formulation != Formulation::reduced) description += fmt::format(" {}", name_of(c.curve->formulation));
    return description;
}

Floors compute_floors(const Conditioning& conditioning) {
    if (!conditioning.available) return {};
    const std::size_t last = conditioning.times.size() - 1;
    return {conditioning.floor_peak(float64_roundoff).value, conditioning.floor_peak(float32_roundoff).value,
            conditioning.floor(last, float64_roundoff), conditioning.floor(last, float32_roundoff)};
}

Trajectory measure_errors(const Experiment& experiment, const Problem& problem, const Reference& reference, Case& c,
                          std::optional<double> kappa) {
    if (!choose_settings(experiment, c)) return {};
    Result result = blank(c);
    Settings settings = c.settings;
    // this run also computes samples, which the limit does not include
    settings.seconds_limit *= 4;
    Trajectory trajectory = solve(problem, *c.curve->method, settings);
    result.status = trajectory.status, result.message = trajectory.message;
    result.cut = trajectory.limit_reached;
    if (trajectory.step > 0) result.step_taken = trajectory.step;
    if (trajectory.status != Status::unsupported) {
        // the timed run keeps no samples
        result.steps = trajectory.steps;
        result.rhs_evaluations = trajectory.rhs_evaluations - trajectory.sample_evaluations;
        result.counts = trajectory.counts;
        const ErrorSeries series = error_series(problem.scene, trajectory, reference);
        result.errors = errors(series, trajectory, reference);
        if (!problem.scene.planes.empty())
            result.contacts =
                measure_contacts(*c.curve->method, problem, settings, trajectory, reference, result.message);
        if (experiment.kind->keeps_series) result.series = series, result.revolutions = revolutions(reference);
    }
    if (result.status == Status::ok && !reference.available)
        result.message += (result.message.empty() ? "" : "; ") + ("no truth: " + reference.message);
    if (result.status == Status::ok && c.curve->kind == SettingKind::tolerance &&
        result.errors["attitude"].final.value_or(0) > 1) {
        result.status = Status::tolerance_not_met;
        result.message = fmt::format("attitude error at the end is {:.3g} rad; kappa(T) times the tolerance is {}",
                                     *result.errors["attitude"].final,
                                     kappa ? fmt::format("{:.2g}", *kappa * *settings.tolerance) : "unknown");
    }
    if (result.rhs_evaluations.value_or(0) > experiment.max_evaluations) {
        result.status = Status::failed, result.cut = true, result.errors = {};
        result.message = fmt::format("exceeded the limit of {} evaluations", experiment.max_evaluations);
    }
    // the counts of a run that was stopped by a limit depend on the machine
    if (result.cut) result.steps.reset(), result.rhs_evaluations.reset(), result.counts = {};
    result.seconds_min = trajectory.seconds;
    c.result = std::move(result);
    return trajectory;
}

void cut_curve(const Case& at, Case& beyond) {
    beyond.result = blank(beyond);
    beyond.result->status = Status::failed;
    beyond.result->cut = true;
    beyond.result->message =
        fmt::format("not run: the curve was cut at {} {:g}", name_of(at.curve->kind), at.setting());
}

}  // namespace polhode
