// Figures of errors against time.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "experiment/kinds/curves.h"
#include "integrators/analysis/conditioning.h"
#include "measure/growth.h"

namespace polhode {
namespace {

// EXPERIMENT_SCENE, with a number for further variations of the same scene
std::string figure_name(const Plan& plan, const PlannedScene& scene) {
    const auto same = std::count_if(plan.scenes.data(), &scene,
                                    [&](const PlannedScene& other) { return other.scene.name == scene.scene.name; });
    std::string name = plan.experiment.name;
    if (plan.scenes.size() > 1) name += "_" + scene.scene.name;
    if (same > 0) name += fmt::format("_{}", same + 1);
    return name;
}

struct Quantity {
    const char *measure, *label;

    std::string title() const { return std::string(measures()[measure_index(measure)].title); }
    const std::vector<double>& of(const ErrorSeries& series) const { return series[measure]; }
    bool is_attitude() const { return std::string_view(measure) == "attitude"; }
};
const Quantity attitude_quantity{"attitude", "attitude error (rad)"};
const Quantity momentum_quantity{"momentum", "|L - L_ref| / max |L_ref|"};
const Quantity energy_quantity{"energy", "|E - E_ref| / max E"};
const Quantity norm_quantity{"norm", "||q| - 1|"};

// The floors over time for a panel of the attitude error; `shaped` makes a guide from a label, times and values.
template <class Shaped>
std::vector<Guide> floors_over_time(const std::vector<Result>& results, const PlannedScene& scene, Shaped shaped) {
    for (const Result& r : results) {
        const ErrorSeries& s = r.series;
        if (r.scene != scene.label || s.float64_floor.empty() || s.float64_floor.size() != s.t.size()) continue;
        if (s.t.back() < scene.scene.duration) continue;  // a run that ended early
        std::vector<double> float32;
        for (const double floor : s.float64_floor)
            float32.push_back(std::min(floor / float64_roundoff * float32_roundoff, std::numbers::pi));
        return {shaped(float64_floor_label, s.t, s.float64_floor), shaped(float32_floor_label, s.t, float32)};
    }
    return {};
}

}  // namespace

std::vector<NamedFigure> drift_figures(const Plan& plan, const std::vector<Result>& results) {
    std::vector<NamedFigure> figures;
    for (const PlannedScene& scene : plan.scenes) {
        Figure figure;
        figure.title = fmt::format("{}: {}", plan.experiment.name, scene.label);
        figure.columns = 3;
        for (const Quantity& quantity : {attitude_quantity, momentum_quantity, energy_quantity}) {
            Panel panel;
            panel.title = quantity.title(), panel.x_label = "time (s)", panel.y_label = quantity.label;
            panel.log_x = false;
            if (quantity.is_attitude())
                panel.guides = floors_over_time(
                    results, scene, [](const char* label, const std::vector<double>& t, const std::vector<double>& y) {
                        return Guide{label, t, y};
                    });
            std::map<const Method*, int> dashes;  // number of settings so far; each setting has its own dash
            for (const PlannedCurve& planned : plan.curves) {
                for (const Result* row : select_rows(results, scene, planned)) {
                    Curve curve;
                    curve.label = planned.kind == SettingKind::none
                                      ? std::string(planned.method->name)
                                      : fmt::format("{}, {} {:.3g}{}", planned.method->name,
                                                    planned.kind == SettingKind::step ? "h" : "tolerance",
                                                    row->step_taken.value_or(row->setting),
                                                    planned.kind == SettingKind::step ? " s" : "");
                    style_curve(curve, planned);
                    curve.dash = dashes[planned.method]++;
                    // curves cross often, so marks are drawn only if another method has the same colour
                    curve.points = std::ranges::any_of(plan.curves, [&](const PlannedCurve& other) {
                        return other.method != planned.method && other.style.color == planned.style.color;
                    });
                    const std::vector<double>& y = quantity.of(row->series);
                    curve.x.assign(row->series.t.begin(),
                                   row->series.t.begin() + static_cast<long>(std::min(y.size(), row->series.t.size())));
                    curve.y = y;
                    panel.curves.push_back(std::move(curve));
                }
            }
            figure.panels.push_back(std::move(panel));
        }
        add_figure_notes(figure, plan);
        figures.push_back({figure_name(plan, scene), std::move(figure)});
    }
    return figures;
}

std::vector<NamedFigure> conservation_figures(const Plan& plan, const std::vector<Result>& results) {
    std::vector<NamedFigure> figures;
    for (const PlannedScene& scene : plan.scenes)
        for (const double cost : plan.experiment.evaluations_per_revolution) {
            Figure figure;
            figure.title = fmt::format("{}: {}, {:g} evaluations per revolution, largest error so far",
                                       plan.experiment.name, scene.label, cost);
            figure.columns = 2;
            for (const Quantity& quantity : {energy_quantity, momentum_quantity, attitude_quantity, norm_quantity}) {
                Panel panel;
                panel.title = quantity.title(), panel.x_label = "time (s)", panel.y_label = quantity.label;
                if (quantity.is_attitude())
                    panel.guides = floors_over_time(
                        results, scene,
                        [](const char* label, const std::vector<double>& t, const std::vector<double>& y) {
                            const Envelope envelope = error_envelope(t, y);
                            return Guide{label, envelope.t, envelope.error};
                        });
                for (const PlannedCurve& planned : plan.curves)
                    for (const Result* row : select_rows(results, scene, planned)) {
                        if (row->evaluations_per_revolution != cost) continue;
                        Envelope envelope = error_envelope(row->series.t, quantity.of(row->series));
                        Curve curve;
                        curve.label = curve_label(planned);
                        style_curve(curve, planned);
                        curve.dash = planned.kind == SettingKind::step;
                        curve.x = std::move(envelope.t), curve.y = std::move(envelope.error);
                        panel.curves.push_back(std::move(curve));
                    }
                figure.panels.push_back(std::move(panel));
            }
            add_figure_notes(figure, plan);
            figures.push_back({fmt::format("{}_{:g}", figure_name(plan, scene), cost), std::move(figure)});
        }
    return figures;
}

}  // namespace polhode
