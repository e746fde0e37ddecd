#include "app/description.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "check/limits.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/method.h"
#include "integrators/own/mechanism_ensemble.h"
#include "integrators/run/stiffness.h"
#include "motion/conserved.h"
#include "scene/scene_formulas.h"

namespace polhode {
namespace {

using namespace description;

struct LoadText {
    std::string operator()(const Gravity& load) const { return "gravity " + text(load.acceleration_W) + " m/s^2"; }
    std::string operator()(const Torque& load) const {
        return fmt::format("torque {} N m, constant in {} axes", text(load.vector), text(load.frame));
    }
    std::string operator()(const Force& load) const {
        return fmt::format("force {} N, constant in {} axes, at {} m in the {}", text(load.vector), text(load.frame),
                           text(load.point), text(load.point_frame));
    }
    std::string operator()(const Impulse& load) const {
        return fmt::format("impulse {} N s, in {} axes, at {} m in the {}, at t = {} s", text(load.vector),
                           text(load.frame), text(load.point), text(load.point_frame), number(load.at));
    }
    std::string operator()(const Drag& load) const {
        return fmt::format("drag, rotational {} N m s, translational {} N s/m", text(load.rotational),
                           number(load.translational));
    }
    std::string operator()(const Spring& load) const {
        return fmt::format("torsional spring {} N m, at rest at {}", number(load.stiffness),
                           text(load.rest_orientation));
    }
    std::string operator()(const UserTorque& load) const { return "user-defined torque: " + load.name; }
    std::string operator()(const Motor& load) const {
        return fmt::format("motor of joint \"{}\", {} N m (or N) along its axis", load.joint, number(load.force));
    }
    std::string operator()(const FormulaLoad& load) const {
        const std::string axes = load.frame == Frame::body ? "body axes" : "world axes";
        const std::string at = !load.has_point ? "at the centre of mass"
                                               : fmt::format("at {} m in the {}", text(load.point),
                                                             load.point_frame == Frame::body ? "body" : "world");
        return load.kind == FormulaKind::torque  ? fmt::format("torque {} N m, {}", load.formula, axes)
               : load.kind == FormulaKind::force ? fmt::format("force {} N, {}, {}", load.formula, axes, at)
               : load.kind == FormulaKind::motor
                   ? fmt::format("motor of joint \"{}\", {} N m (or N) along its axis", load.joint, load.formula)
                   : fmt::format("potential {} J", load.formula);
    }
    std::string operator()(const PointSpring& load) const {
        return fmt::format("spring {} N/m from {} m in {} to {} m in {}, rest length {} m", number(load.stiffness),
                           text(load.first_point), load.first, text(load.second_point), load.second,
                           number(load.rest_length));
    }
};

// the body that a load acts on, in scenes of several bodies
std::string on_body(const Load& load) {
    const std::string name = load_body(load);
    return name.empty() ? "" : fmt::format(", on body \"{}\"", name);
}

}  // namespace

void description::loads(Report& report, const Scene& scene) {
    report.title("Loads");
    if (scene.loads.empty()) report.line("none");
    for (const Load& load : scene.loads) {
        const Window window = window_of(load);
        std::string when;
        if (std::isfinite(window.from)) when += fmt::format(", from {} s", number(window.from));
        if (std::isfinite(window.until)) when += fmt::format(", until {} s", number(window.until));
        report.line(std::visit(LoadText{}, load) + when + on_body(load));
    }
}

void description::choice(Report& report, const Problem& problem) {
    report.title("Method selected by auto");
    const Choice taken = choose_method(problem);
    report.line(std::string(taken.method->name), std::string(taken.why));
    const Stiffness found = stiffness(problem);
    if (found.decay_times > 0)
        report.line(found.stiff() ? "stiff" : "not stiff",
                    fmt::format("{:.3g} time constants of the fastest decay, {:.3g} rad of rotation", found.decay_times,
                                found.rotation));
    const std::string why = why_one_by_one(problem);
    report.line("ensembles", why.empty() ? "rows are solved side by side" : "rows are solved one by one: " + why);
}

// Names, values and switches of formulas.
void description::formulas(Report& report, const Problem& problem) {
    std::string names;
    for (const FormulaParameter& parameter : problem.scene.parameters)
        names += fmt::format("{}{} = {}", names.empty() ? "" : ", ", parameter.name, number(parameter.value));
    if (!names.empty()) report.line("parameters", names);
    for (const FormulaDefinition& definition : problem.scene.let)
        report.line("let " + definition.name, one_line(definition.formula, 2000));
    const std::shared_ptr<const FormulaSet> set = compile_formulas(problem.scene, problem.scene.name);
    std::string switches;
    for (const formula::Switch& one : set->expression.switches())
        if (switches.find(one.text) == std::string::npos) switches += (switches.empty() ? "" : "; ") + one.text;
    report.line("formulas", fmt::format("{} operations, {} auxiliary variables, {}", set->expression.nodes().size(),
                                        set->auxiliaries.size(), switches.empty() ? "analytic" : "piecewise analytic"));
    if (!set->periods.empty()) {
        std::vector<double> periods = set->periods;
        std::ranges::sort(periods);
        periods.erase(std::unique(periods.begin(), periods.end()), periods.end());
        std::vector<std::string> shown;
        for (const double period : periods) shown.push_back(number(period));
        report.line("sampled", fmt::format("{} value{} held, sampled every {} s", set->periods.size(),
                                           set->periods.size() == 1 ? "" : "s", join_with_commas(shown)));
    }
    if (!switches.empty()) report.line("switches", one_line(switches, 2000));
}

void description::invariants(Report& report, const Problem& problem, const char* without) {
    report.title("Invariants, with their values at t = 0");
    const std::vector<Conserved> all = conserved(problem);
    if (all.empty()) report.line(without);
    for (const Conserved& one : all) {
        const bool vector = one.value.size() == 3;
        std::string value =
            vector ? text(Vector3<double>(one.value[0], one.value[1], one.value[2])) : number(one.value[0]);
        report.line(one.name, value + "; " + one.formula);
        if (one.kind == ConservedKind::angular_momentum_component ||
            one.kind == ConservedKind::linear_momentum_component)
            report.line("", "u = " + text(one.direction) + ", world axes");
        if (one.kind == ConservedKind::spin)
            report.line("", "e = " + text(one.direction) + ", axes of the system posed");
    }
}

// Prints how small changes of the initial state grow, and until when an engine's error can be attributed to the engine.
void description::growth(Report& report, const Problem& problem, ConditioningBudget budget,
                         const std::vector<double>& times) {
    report.title("Conditioning");
    ConditioningSettings settings;
    if (budget == ConditioningBudget::brief) {
        settings.max_steps = prompt_conditioning_steps;
        settings.mechanism_work = brief_mechanism_work;
    }
    const Conditioning found = polhode::conditioning(problem, times, settings);
    const auto how_to_get_it = [&] {
        if (budget == ConditioningBudget::brief && found.limit_reached)
            report.line("", "`polhode describe --conditioning` computes it for the whole run");
    };
    // the initial time alone gives no information
    if (found.times.empty() || (!found.available && found.times.back() == 0)) {
        report.line("not available: " + found.message);
        how_to_get_it();
        return;
    }
    const std::size_t last = found.times.size() - 1;
    const std::string end = found.available ? "T" : fmt::format("t = {:.4g} s", found.times[last]);
    const Peak state = found.state_peak();
    if (!found.available) report.line("only until " + end, found.message), how_to_get_it();
    report.line(fmt::format("kappa({})", found.available ? "T" : fmt::format("{:.4g} s", found.times[last])),
                fmt::format("{:.4g} = ||d state / d state(0)||, each block in units of its scale", found.state[last]));
    report.line("largest kappa", fmt::format("{:.4g}, at t = {:.4g} s", state.value, state.time));
    report.line("attitude part of kappa",
                fmt::format("{:.4g} rad at {} per relative change of the initial state; at most "
                            "{:.4g} rad, at t = {:.4g} s",
                            found.attitude[last], end, found.attitude_peak().value, found.attitude_peak().time));
    for (const auto& [name, roundoff] :
         {std::pair("floor in binary64", float64_roundoff), std::pair("floor in binary32", float32_roundoff)})
        report.line(name,
                    fmt::format("{:.2g} rad at {}, at most {:.2g} rad: error caused by rounding the initial state",
                                found.floor(last, roundoff), end, found.floor_peak(roundoff).value));
    const ErrorLimit allowed = ErrorLimits(problem.scene)["attitude"];
    std::size_t k = 0;
    while (k <= last && !(found.floor(k, float32_roundoff) > allowed.value)) ++k;
    const std::string until = k <= last         ? fmt::format("until t = {:.4g} s", found.times[k])
                              : found.available ? "for the whole run"
                                                : "at least until " + end;
    report.line("binary32 engine", fmt::format("can be evaluated {}: its floor is within {} rad ({})", until,
                                               number(allowed.value), allowed.from));
    if (found.available) report.line("computed by", found.message);
}

}  // namespace polhode
