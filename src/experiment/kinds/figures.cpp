#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/kinds/curves.h"
#include "figure/curve_style.h"
#include "integrators/sundials/build.h"

namespace polhode {
namespace {

template <class X, class Y>
Curve make_curve(const std::vector<Result>& results, const PlannedScene& scene, const PlannedCurve& planned, const X& x,
                 const Y& y) {
    Curve curve;
    curve.label = curve_label(planned);
    style_curve(curve, planned);
    curve.dash = planned.method->control == Control::fixed_step_or_tolerance && planned.kind == SettingKind::step;
    for (const Result* row : select_rows(results, scene, planned)) {
        curve.cut = curve.cut || row->cut;
        const std::optional<double> at = x(*row), value = y(*row);
        if (row->status != Status::ok || !at || !value) continue;
        curve.x.push_back(*at), curve.y.push_back(*value);
    }
    return curve;
}

// Splits a figure with more panels than a page has into several: NAME_1, NAME_2, ..
std::vector<NamedFigure> split_into_pages(const std::string& name, const Plan& plan, const Figure& whole) {
    constexpr std::size_t page = 12;
    std::vector<NamedFigure> pages;
    for (std::size_t begin = 0; begin < whole.panels.size(); begin += page) {
        const std::size_t end = std::min(begin + page, whole.panels.size());
        Figure figure = whole;
        figure.panels.assign(whole.panels.begin() + static_cast<long>(begin),
                             whole.panels.begin() + static_cast<long>(end));
        add_figure_notes(figure, plan);
        const bool single = whole.panels.size() <= page;
        pages.push_back({single ? name : fmt::format("{}_{}", name, begin / page + 1), std::move(figure)});
    }
    return pages;
}

Figure error_against_setting(const Plan& plan, const std::vector<Result>& results, SettingKind kind, bool at_end) {
    const bool step = kind == SettingKind::step;
    std::optional<double> ErrorOfRun::*const error = at_end ? &ErrorOfRun::final : &ErrorOfRun::max;
    Figure figure;
    figure.title = fmt::format("{}: attitude error against {}", plan.experiment.name, step ? "step" : "tolerance");
    // at equal tolerance the more accurate method is the better one
    figure.best = step ? Best::greatest_x : Best::lowest_end;
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel;
        panel.title = scene.label;
        panel.x_label = step ? "step (s)" : "relative tolerance";
        panel.y_label = at_end ? "attitude error at the end (rad)" : "largest attitude error (rad)";
        panel.guides = at_end ? floor_guides(results, scene, &Floors::float64_final, &Floors::float32_final)
                              : floor_guides(results, scene, &Floors::float64, &Floors::float32);
        for (const PlannedCurve& planned : plan.curves)
            if (planned.kind == kind)
                panel.curves.push_back(make_curve(
                    results, scene, planned,
                    [&](const Result& r) { return step ? r.step_taken : std::optional(r.setting); },
                    [&](const Result& r) { return r.errors["attitude"].*error; }));
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

}  // namespace

std::vector<const Result*> select_rows(const std::vector<Result>& results, const PlannedScene& scene,
                                       const PlannedCurve& curve) {
    std::vector<const Result*> rows;
    for (const Result& r : results)
        if (r.scene == scene.label && r.method == curve.method->name && r.setting_kind == curve.kind &&
            r.formulation == curve.formulation)
            rows.push_back(&r);
    return rows;
}

std::string curve_label(const PlannedCurve& curve) {
    // a method that takes steps and tolerances has two curves
    if (curve.method->control != Control::fixed_step_or_tolerance) return std::string(curve.method->name);
    return fmt::format("{} ({})", curve.method->name, curve.kind == SettingKind::step ? "fixed step" : "controlled");
}

Curve& find_or_add_curve(std::vector<Curve>& curves, const std::string& label) {
    const auto same = std::find_if(curves.begin(), curves.end(), [&](const Curve& c) { return c.label == label; });
    if (same != curves.end()) return *same;
    Curve curve;
    curve.label = label;
    set_style(curve, plain_style(static_cast<int>(curves.size())));
    return curves.emplace_back(std::move(curve));
}

std::vector<Guide> floor_guides(const std::vector<Result>& results, const PlannedScene& scene,
                                std::optional<double> Floors::*float64, std::optional<double> Floors::*float32) {
    for (const Result& r : results)
        if (r.scene == scene.label && r.floors.*float64 && r.floors.*float32)
            return {{float64_floor_label, {}, {*(r.floors.*float64)}},
                    {float32_floor_label, {}, {*(r.floors.*float32)}}};
    return {};
}

void style_curve(Curve& curve, const PlannedCurve& planned) {
    set_style(curve, planned.style);
    curve.group = name_of(planned.method->family);
}

void add_figure_notes(Figure& figure, const Plan& plan) {
    figure.truncation_note =
        fmt::format("Arrow: the curve was cut because a run took more than {} s{}.", plan.experiment.seconds_per_run,
                    plan.experiment.max_evaluations < std::numeric_limits<long>::max()
                        ? fmt::format(" or {:g} evaluations", static_cast<double>(plan.experiment.max_evaluations))
                        : "");
    const bool sundials = std::any_of(plan.curves.begin(), plan.curves.end(),
                                      [](const PlannedCurve& c) { return c.method->library == sundials_library; });
    if (sundials && sundials_unoptimised()) figure.note += " SUNDIALS unoptimised.";
}

std::vector<NamedFigure> work_precision_figures(const Plan& plan, const std::vector<Result>& results) {
    Figure figure;
    figure.title = plan.experiment.name + ": attitude error against run time";
    figure.best = Best::least_x;
    figure.columns = 2;
    for (const PlannedScene& scene : plan.scenes) {
        Panel panel;
        panel.title = scene.label;
        panel.x_label = "run time, median (s)";
        panel.y_label = "largest attitude error (rad)";
        panel.guides = floor_guides(results, scene, &Floors::float64, &Floors::float32);
        for (const PlannedCurve& planned : plan.curves)
            panel.curves.push_back(make_curve(
                results, scene, planned, [](const Result& r) { return r.seconds_median; },
                [](const Result& r) { return r.errors["attitude"].max; }));
        figure.panels.push_back(std::move(panel));
    }
    return split_into_pages(plan.experiment.name, plan, figure);
}

std::vector<NamedFigure> convergence_figures(const Plan& plan, const std::vector<Result>& results) {
    const auto has = [&](SettingKind kind) {
        return std::any_of(plan.curves.begin(), plan.curves.end(),
                           [&](const PlannedCurve& c) { return c.kind == kind; });
    };
    std::vector<NamedFigure> figures;
    for (const SettingKind kind : {SettingKind::step, SettingKind::tolerance})
        if (has(kind)) {
            const Figure whole = error_against_setting(plan, results, kind, true);
            for (NamedFigure& page :
                 split_into_pages(fmt::format("{}_{}", plan.experiment.name, name_of(kind)), plan, whole))
                figures.push_back(std::move(page));
        }
    return figures;
}

std::vector<NamedFigure> tolerance_figures(const Plan& plan, const std::vector<Result>& results) {
    return split_into_pages(plan.experiment.name, plan,
                            error_against_setting(plan, results, SettingKind::tolerance, false));
}

}  // namespace polhode
