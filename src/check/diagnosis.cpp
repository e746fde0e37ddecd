#include "check/diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "check/attitude_update.h"
#include "check/contact_faults.h"
#include "check/impact_faults.h"
#include "check/known_update.h"
#include "check/row_faults.h"
#include "check/search.h"
#include "scene/scene_formulas.h"

namespace polhode {
namespace {

// a fault cannot be recognised if the file is this close to the scene's motion
constexpr double wrong_threshold = 1e-4;

const char* name_of(Criterion criterion) {
    constexpr const char* names[criterion_count] = {"the initial attitude",
                                                    "the initial angular velocity",
                                                    "the initial position",
                                                    "the initial velocity",
                                                    "the first step",
                                                    "the attitude per step",
                                                    "w per step",
                                                    "the position per step",
                                                    "the velocity per step",
                                                    ""};
    return names[static_cast<std::size_t>(criterion)];
}

// Describes the scene's events: "the step in which the torque ends at t = 2 s".
std::string events_of(const Scene& scene) {
    std::vector<std::string> all;
    const auto note = [&](const char* what, const char* does, double t) {
        if (t > 0 && t < scene.duration) all.push_back(fmt::format("the {} {} at t = {:.6g} s", what, does, t));
    };
    const auto window = [&](const char* what, const Window& w) {
        note(what, "starts", w.from), note(what, "ends", w.until);
    };
    for (const Load& load : scene.loads) {
        if (const auto* one = std::get_if<Gravity>(&load)) window("gravity", one->window);
        if (const auto* one = std::get_if<Torque>(&load)) window("torque", one->window);
        if (const auto* one = std::get_if<Force>(&load)) window("force", one->window);
        if (const auto* one = std::get_if<Drag>(&load)) window("drag", one->window);
        if (const auto* one = std::get_if<Spring>(&load)) window("spring", one->window);
        if (const auto* one = std::get_if<FormulaLoad>(&load)) window("formula", one->window);
        if (const auto* one = std::get_if<Impulse>(&load)) note("impulse", "acts", one->at);
    }
    if (all.empty()) return "the step in which the loads change";
    constexpr std::size_t most = 3;
    const std::size_t more = all.size() > most ? all.size() - most : 0;
    all.resize(std::min(all.size(), most));
    return fmt::format("the step in which {}{}", fmt::join(all, " or "),
                       more > 0 ? fmt::format(", and {} more", more) : "");
}
std::string describe_criterion(Criterion criterion, const Scene& scene) {
    return criterion == Criterion::events ? events_of(scene) : name_of(criterion);
}

// Returns the question whose answer the fault improves most.
std::size_t most_improved_criterion(const Residual& without, const Residual& with) {
    std::size_t best = 0;
    double gain = -1;
    for (std::size_t i = 0; i < criterion_count; ++i)
        if (without.decades[i] && with.decades[i] && *without.decades[i] - *with.decades[i] > gain)
            best = i, gain = *without.decades[i] - *with.decades[i];
    return best;
}

std::string describe_fault(const FittedFault& fault) {
    std::string what = fault.hypothesis->what;
    if (const std::size_t place = what.find("{}"); place != what.npos)
        what.replace(place, 2, fmt::format("{:.4g}", fault.x));
    // a load scaled by 1/n has often acted in one of n substeps
    const Subject about = fault.hypothesis->subject;
    const double parts = std::round(1 / fault.x);
    if (fault.hypothesis->values && about >= Subject::gravity && about <= Subject::drag && parts >= 2 && parts <= 20 &&
        std::abs(fault.x * parts - 1) < 2e-3)
        what += fmt::format(", as if it acted in one of {:.0f} substeps", parts);
    return what;
}

std::string describe_faults(const Explanation& e) {
    std::string all;
    for (const FittedFault& s : e.faults) all += (all.empty() ? "" : ", and ") + describe_fault(s);
    return all;
}

// Adds the faults of an explanation, each with its prediction errors.
void add_diagnoses(const Scene& scene, const Explanation& e, const FaultSearch& search, const std::string& also,
                   std::vector<Diagnosis>& diagnoses) {
    const std::size_t criterion = most_improved_criterion(search.sound.residual, e.residual);
    const double before = std::pow(10.0, search.sound.residual.decades[criterion].value_or(0)),
                 after = std::pow(10.0, e.residual.decades[criterion].value_or(0));
    for (const FittedFault& s : e.faults) {
        const Hypothesis& h = *s.hypothesis;
        const auto same = [&](const Diagnosis& d) { return d.fault == h.fault; };
        if (std::any_of(diagnoses.begin(), diagnoses.end(), same)) continue;
        diagnoses.push_back({h.fault,
                             fmt::format("{}; {}{} (relative prediction error of {}: {:.2g} with {}, {:.2g} without)",
                                         describe_fault(s), h.remedy, also,
                                         describe_criterion(static_cast<Criterion>(criterion), scene), after,
                                         e.faults.size() > 1 ? "both faults" : "this fault", before),
                             h.convention, before, after});
    }
}

}  // namespace

FileDiagnosis diagnose(const Scene& scene, const TrajectoryFile& file, bool all) {
    FileDiagnosis result;
    const FileEvidence evidence(scene, file);
    if (const std::optional<double> still = evidence.rest_start())
        result.faults.push_back(
            {"motion_stopped",
             fmt::format("nothing moves from t = {:.6g} s on, although the scene's body does: the engine put it to "
                         "sleep or never woke it; disable sleeping",
                         *still),
             "", 1, 0});
    const auto add = [&](const std::vector<Diagnosis>& more) {
        result.faults.insert(result.faults.end(), more.begin(), more.end());
    };
    add(find_length_faults(file));
    add(impact_faults(scene, file));
    add(contact_faults(scene, file));
    if (const std::vector<Diagnosis> between = rows_between_steps(file); !between.empty()) {
        add(between);
        return result;
    }
    if (!evidence.has_enough_rows() || (!all && evidence.plain_error() < wrong_threshold)) return result;
    const FaultSearch search = search_faults(evidence, all);
    result.sound = search.sound.residual.total;
    const Explanation& best = search.best;
    if (best.rule) result.rule = best.rule->name;
    for (const Explanation& e : search.singles)
        result.hypotheses.push_back({e.faults.front().hypothesis->fault, describe_faults(e), e.residual.total});
    if (!best.faults.empty()) {
        std::string also;
        for (const Explanation& e : search.alike) also += (also.empty() ? "" : "; or ") + describe_faults(e);
        add_diagnoses(scene, best, search, also.empty() ? "" : "; in this file indistinguishable from: " + also,
                      result.faults);
        for (const Explanation& e : search.alike)
            add_diagnoses(scene, e, search, "; in this file indistinguishable from the previous diagnosis",
                          result.faults);
    }
    const std::optional<FirstOrderUpdate> first_order =
        file.has_angular_velocity ? first_order_update(file) : std::nullopt;
    if (first_order)
        result.faults.push_back(
            {"first_order_quaternion_update",
             fmt::format(
                 "first-order quaternion update: the attitude advances by q + (h/2) w q with h = {:.4g} s, a rotation "
                 "by 2 atan(|w| h/2) instead of |w| h; rotate by the exponential of w h, or take smaller steps (rms "
                 "prediction error per row from the file's w: {:.2g} rad with this update, {:.2g} rad without)",
                 first_order->step, first_order->explained, first_order->error),
             "", first_order->error, first_order->explained});
    // the updates of known engines do not support formulas
    if (best.faults.empty() && !has_formula_loads(scene) && !evidence.rest_start() &&
        evidence.plain_error() >= wrong_threshold)
        result.update = identify_update(scene, file, best.steps, evidence.noise());
    return result;
}

}  // namespace polhode
