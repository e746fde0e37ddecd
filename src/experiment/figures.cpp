#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiment/report.h"
#include "integrators/versions.h"

namespace polhode {
namespace {

std::string curve_label(const PlannedCurve& curve) {
    // a method with both kinds of setting has two curves
    if (curve.method->control != Control::fixed_step_or_tolerance) return std::string(curve.method->name);
    return fmt::format("{} ({})", curve.method->name, curve.kind == SettingKind::step ? "fixed step" : "controlled");
}

bool any_cvode(const Plan& plan) {
    return std::any_of(plan.curves.begin(), plan.curves.end(),
                       [](const PlannedCurve& c) { return c.method->name.starts_with("cvode"); });
}

std::string note_of(const Plan& plan, bool cut) {
    std::string note;
    if (cut)
        note = fmt::format("Arrow: the curve was cut, a run takes more than {} s.", plan.experiment.seconds_per_run);
    if (any_cvode(plan) && sundials_unoptimised()) note += " SUNDIALS unoptimised.";
    return note;
}

template <class X, class Y>
Curve curve_of(const std::vector<Result>& results, const PlannedScene& scene, const PlannedCurve& planned, const X& x,
               const Y& y) {
    Curve curve;
    curve.label = curve_label(planned);
    curve.color = planned.color;
    curve.dash = planned.method->control == Control::fixed_step_or_tolerance && planned.kind == SettingKind::step;
    for (const Result* row : rows_of(results, scene, planned)) {
        curve.cut = curve.cut || row->cut;
        const std::optional<double> at = x(*row), value = y(*row);
        if (row->status != Status::ok || !at || !value) continue;
        curve.x.push_back(*at), curve.y.push_back(*value);
    }
    return curve;
}

bool any_cut(const Figure& figure) {
    for (const Panel& panel : figure.panels)
        for (const Curve& curve : panel.curves)
            if (curve.cut) return true;
    return false;
}

Figure convergence_figure(const Plan& plan, const std::vector<Result>& results, SettingKind kind) {
    const bool step = kind == SettingKind::step;
    Figure figure;
    figure.title = fmt::format("{}: attitude error against {}", plan.experiment.name, step ? "step" : "tolerance");
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel;
        panel.title = scene.label;
        panel.x_label = step ? "step (s)" : "relative tolerance";
        panel.y_label = "attitude error at the end (rad)";
        for (const PlannedCurve& planned : plan.curves)
            if (planned.kind == kind)
                panel.curves.push_back(curve_of(
                    results, scene, planned,
                    [&](const Result& r) { return step ? r.step_taken : std::optional(r.setting); },
                    [](const Result& r) { return r.errors.attitude_final; }));
        figure.panels.push_back(std::move(panel));
    }
    figure.note = note_of(plan, any_cut(figure));
    return figure;
}

}  // namespace

std::vector<NamedFigure> work_precision_figures(const Plan& plan, const std::vector<Result>& results) {
    Figure figure;
    figure.title = plan.experiment.name + ": attitude error against run time";
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel;
        panel.title = scene.label;
        panel.x_label = "run time, median (s)";
        panel.y_label = "largest attitude error (rad)";
        for (const PlannedCurve& planned : plan.curves)
            panel.curves.push_back(curve_of(
                results, scene, planned, [](const Result& r) { return r.seconds_median; },
                [](const Result& r) { return r.errors.attitude_max; }));
        figure.panels.push_back(std::move(panel));
    }
    figure.note = note_of(plan, any_cut(figure));
    return {{plan.experiment.name, std::move(figure)}};
}

std::vector<NamedFigure> convergence_figures(const Plan& plan, const std::vector<Result>& results) {
    const auto has = [&](SettingKind kind) {
        return std::any_of(plan.curves.begin(), plan.curves.end(),
                           [&](const PlannedCurve& c) { return c.kind == kind; });
    };
    std::vector<NamedFigure> figures;
    if (has(SettingKind::step))
        figures.push_back({plan.experiment.name + "_step", convergence_figure(plan, results, SettingKind::step)});
    if (has(SettingKind::tolerance))
        figures.push_back(
            {plan.experiment.name + "_tolerance", convergence_figure(plan, results, SettingKind::tolerance)});
    return figures;
}

std::vector<NamedFigure> drift_figures(const Plan& plan, const std::vector<Result>& results) {
    struct Quantity {
        const char *title, *label;
        std::vector<double> ErrorSeries::*values;
    };
    const Quantity quantities[] = {{"attitude", "attitude error (rad)", &ErrorSeries::attitude},
                                   {"angular momentum", "|L - L_ref| / max |L_ref|", &ErrorSeries::momentum},
                                   {"energy", "|E - E_ref| / max E", &ErrorSeries::energy}};
    std::vector<NamedFigure> figures;
    for (const PlannedScene& scene : plan.scenes) {
        Figure figure;
        figure.title = fmt::format("{}: {}", plan.experiment.name, scene.label);
        figure.columns = 3;
        for (const Quantity& quantity : quantities) {
            Panel panel;
            panel.title = quantity.title, panel.x_label = "time (s)", panel.y_label = quantity.label;
            panel.log_x = false;
            for (const PlannedCurve& planned : plan.curves) {
                int dash = 0;
                for (const Result* row : rows_of(results, scene, planned)) {
                    Curve curve;
                    curve.label = planned.kind == SettingKind::none
                                      ? std::string(planned.method->name)
                                      : fmt::format("{}, {} {:.3g}{}", planned.method->name,
                                                    planned.kind == SettingKind::step ? "h" : "tolerance",
                                                    row->step_taken.value_or(row->setting),
                                                    planned.kind == SettingKind::step ? " s" : "");
                    curve.color = planned.color, curve.dash = dash++, curve.points = false;
                    const std::vector<double>& y = row->series.*quantity.values;
                    curve.x.assign(row->series.t.begin(),
                                   row->series.t.begin() + static_cast<long>(std::min(y.size(), row->series.t.size())));
                    curve.y = y;
                    panel.curves.push_back(std::move(curve));
                }
            }
            figure.panels.push_back(std::move(panel));
        }
        figure.note = note_of(plan, false);
        // variations of one scene share its name: they are numbered
        const auto same = std::count_if(plan.scenes.data(), &scene, [&](const PlannedScene& other) {
            return other.scene.name == scene.scene.name;
        });
        std::string name = plan.experiment.name;
        if (plan.scenes.size() > 1) name += "_" + scene.scene.name;
        if (same > 0) name += fmt::format("_{}", same + 1);
        figures.push_back({name, std::move(figure)});
    }
    return figures;
}

}  // namespace polhode
