// The page of the kind `stability`. Each sentence is generated from the runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/stability.h"
#include "table/markup.h"

namespace polhode {
namespace {

using Members = std::vector<const StabilityFinding*>;

std::string number(double value) { return fmt::format("{:.3g}", value); }
std::string join_words(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ", ")); }

double tenth_percentile(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 10];
}

// Whether a family has at least three members with positive parameters, all with the same duration, and its fastest
// rate increases by a factor of 1000 from the smallest to the largest parameter.
bool is_stiff(const StabilityFindings& found, const std::string& family) {
    std::vector<const StabilityScene*> members;
    for (const StabilityScene& scene : found.scenes)
        if (scene.family == family && scene.parameter.value_or(0) > 0) members.push_back(&scene);
    if (members.size() < 3) return false;
    const auto [first, last] = std::minmax_element(
        members.begin(), members.end(),
        [](const StabilityScene* a, const StabilityScene* b) { return *a->parameter < *b->parameter; });
    return (*last)->fastest_rate >= 1e3 * (*first)->fastest_rate &&
           std::all_of(members.begin(), members.end(),
                       [&](const StabilityScene* scene) { return scene->duration == members.front()->duration; });
}

/// The cost of stiffness to one method at one tolerance.
struct StiffnessCost {
    std::optional<double> exponent;  ///< p of evaluations ~ parameter^p, least squares over the stiffer half
    std::optional<double> lost_at;   ///< the smallest parameter from which no run is `ok`
};

// `members` must be sorted by parameter
StiffnessCost stiffness_cost(const Members& members, double tolerance) {
    StiffnessCost cost;
    std::vector<std::pair<double, double>> points;
    for (const StabilityFinding* f : members) {
        const auto run = std::find_if(f->runs.begin(), f->runs.end(),
                                      [&](const StabilityRun& r) { return r.result.setting == tolerance; });
        if (run == f->runs.end()) continue;
        const bool ok = run->result.status == Status::ok;
        if (ok)
            cost.lost_at.reset();
        else if (!cost.lost_at)
            cost.lost_at = f->scene->parameter;
        if (const long evaluations = run->result.rhs_evaluations.value_or(0); ok && evaluations > 0)
            points.emplace_back(std::log(*f->scene->parameter), std::log(static_cast<double>(evaluations)));
    }
    // at small stiffness the motion itself determines the step
    points.erase(points.begin(), points.begin() + static_cast<long>(points.size() / 2));
    if (points.size() >= 2) cost.exponent = least_squares_line(points).slope;
    return cost;
}

/// The text for one method with one kind of setting.
class MethodPage {
  public:
    MethodPage(const Plan& plan, const PlannedCurve& curve, const StabilityFindings& found)
        : plan_(plan),
          curve_(curve),
          found_(found),
          findings_(findings_of(found, *curve.method, curve.kind)),
          families_(group_by(findings_, [](const StabilityFinding* f) { return f->scene->family; })) {}
    bool empty() const { return findings_.empty(); }

    std::string text() const {
        std::string page = fmt::format("Supports {} of {} scenes.", findings_.size(), found_.scenes.size());
        return page + (curve_.kind == SettingKind::step ? step_text() : run_text() + stiffness_text());
    }

  private:
    // the families in which all members, or no member, satisfy a condition
    std::vector<std::string> families_where(bool all,
                                            const std::function<bool(const StabilityFinding*)>& satisfies) const {
        std::vector<std::string> names;
        for (const auto& [family, members] : families_)
            if (all ? std::all_of(members.begin(), members.end(), satisfies)
                    : std::none_of(members.begin(), members.end(), satisfies))
                names.push_back(family);
        return names;
    }

    std::string step_text() const {
        std::string page;
        std::vector<double> stable, fine, evaluations;
        std::map<std::string, long> beyond;
        long never_stable = 0;
        for (const StabilityFinding* f : findings_) {
            const double rate = f->scene->fastest_rate;
            if (f->stable && f->beyond)
                stable.push_back(f->stable->result.setting * rate);
            else if (!f->stable)
                ++never_stable;
            if (f->accurate) {
                fine.push_back(f->accurate->result.setting * rate);
                evaluations.push_back(static_cast<double>(f->accurate->result.rhs_evaluations.value_or(0)) /
                                      (f->scene->duration * rate));
            }
            if (f->beyond) ++beyond[name_of(f->beyond->outcome)];
        }
        const auto is_accurate = [](const StabilityFinding* f) { return f->accurate != nullptr; };
        if (const auto names = families_where(true, is_accurate); !names.empty())
            page += fmt::format(" Families with all members within 1e-3 rad at some step: {}.", join_words(names));
        if (!fine.empty())
            page += fmt::format(
                " An attitude error of 1e-3 rad needs a step times fastest rate of {} and {} evaluations per unit of "
                "fastest time (medians over {} scenes).",
                number(median(fine)), number(median(evaluations)), fine.size());
        if (const auto names = families_where(false, is_accurate); !names.empty())
            page += fmt::format(" Families with no member within 1e-3 rad in {} evaluations: {}.",
                                plan_.experiment.max_evaluations, join_words(names));
        if (!stable.empty())
            page += fmt::format(
                " The largest stable step times the fastest rate, on the scenes that have such a limit, is {} in the "
                "median and {} at the tenth percentile.",
                number(median(stable)), number(tenth_percentile(stable)));
        if (never_stable > 0)
            page += fmt::format(" On {} scenes no step within the limit on evaluations is stable.", never_stable);
        std::vector<std::string> ends;
        for (const auto& [outcome, count] : beyond) ends.push_back(fmt::format("{} on {}", outcome, count));
        if (!ends.empty()) page += fmt::format(" Outcomes above the stable step: {} scenes.", join_words(ends));
        const auto never_rests = [](const StabilityFinding* f) {
            return std::none_of(f->runs.begin(), f->runs.end(),
                                [](const StabilityRun& run) { return run.outcome == Outcome::damped_to_rest; });
        };
        std::vector<std::string> rests;
        for (const auto& [family, members] : families_)
            if (!std::all_of(members.begin(), members.end(), never_rests)) rests.push_back(family);
        std::sort(rests.begin(), rests.end());
        if (!rests.empty())
            page += fmt::format(" At large steps the body comes to rest although the true motion does not: {}.",
                                join_words(rests));
        return page;
    }

    std::string run_text() const {
        std::string page;
        std::map<Status, long> ended;
        std::vector<double> ratios;
        double worst = 0;
        std::string worst_on;
        for (const StabilityFinding* f : findings_)
            for (const StabilityRun& run : f->runs) {
                ++ended[run.result.status];
                if (run.result.status != Status::ok) continue;
                if (curve_.kind != SettingKind::tolerance || !run.result.errors["attitude"].max) continue;
                ratios.push_back(*run.result.errors["attitude"].max / run.result.setting);
                if (ratios.back() > worst)
                    worst = ratios.back(), worst_on = fmt::format("{} at {:g}", f->scene->label, run.result.setting);
            }
        const auto all_ok = [](const StabilityFinding* f) {
            return std::all_of(f->runs.begin(), f->runs.end(),
                               [](const StabilityRun& r) { return r.result.status == Status::ok; });
        };
        if (const auto names = families_where(true, all_ok); !names.empty())
            page += fmt::format(" Families with status `ok` on all members: {}.", join_words(names));
        if (const auto names = families_where(false, all_ok); !names.empty())
            page += fmt::format(" Families with another status on every member: {}.", join_words(names));
        for (const Status status : {Status::failed, Status::diverged, Status::tolerance_not_met})
            if (ended[status] > 0) page += fmt::format(" Runs with status `{}`: {}.", name_of(status), ended[status]);
        if (ratios.empty()) return page;
        const auto within = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 10; });
        return page +
               fmt::format(
                   " Error over tolerance of the runs with status `ok`: median {}, at most 10 in {:.0f} %, largest {} "
                   "({}).",
                   number(median(ratios)), 100.0 * static_cast<double>(within) / static_cast<double>(ratios.size()),
                   number(worst), worst_on);
    }

    std::string stiffness_text() const {
        std::string page;
        if (curve_.kind != SettingKind::tolerance) return page;
        for (auto [family, members] : families_) {
            if (!is_stiff(found_, family)) continue;
            std::erase_if(members, [](const auto* f) { return f->scene->parameter.value_or(0) <= 0; });
            std::sort(members.begin(), members.end(),
                      [](const auto* a, const auto* b) { return *a->scene->parameter < *b->scene->parameter; });
            std::vector<double> exponents, lost_at;
            for (const double tolerance : curve_.settings) {
                const StiffnessCost cost = stiffness_cost(members, tolerance);
                if (cost.exponent) exponents.push_back(*cost.exponent);
                if (cost.lost_at) lost_at.push_back(*cost.lost_at);
            }
            if (exponents.empty() && lost_at.empty()) continue;
            page += fmt::format(" Stiffness (family {}, parameter s):", family);
            if (!exponents.empty())
                page += fmt::format(" evaluations grow as s^{:.2f}{}", median(exponents),
                                    median(exponents) < 0.1 ? " (independent of s)" : "");
            if (!lost_at.empty())
                page += fmt::format("{} no run succeeds from s = {:g}", exponents.empty() ? "" : ",",
                                    *std::min_element(lost_at.begin(), lost_at.end()));
            page += ".";
        }
        return page;
    }

    const Plan& plan_;
    const PlannedCurve& curve_;
    const StabilityFindings& found_;
    Members findings_;
    std::vector<std::pair<std::string, Members>> families_;
};

std::string summary(const StabilityFindings& found) {
    std::map<Status, long> ended;
    long runs = 0, ok_beyond_one = 0, not_finite = 0;
    double longest = 0;
    for (const StabilityFinding& f : found.findings)
        for (const StabilityRun& run : f.runs) {
            ++runs, ++ended[run.result.status];
            const double error = run.result.errors["attitude"].max.value_or(0);
            ok_beyond_one += run.result.status == Status::ok && error > 1;
            for (const Cell& cell : result_row("", run.result))
                if (const double* value = std::get_if<double>(&cell)) not_finite += !std::isfinite(*value);
            longest = std::max(longest, run.result.seconds_min.value_or(0));
        }
    return fmt::format(
        "{} runs on {} scenes: {} `ok`, {} `unsupported`, {} `diverged`, {} `tolerance_not_met`, {} `failed`. {} runs "
        "with status `ok` have an attitude error above 1 rad. {} numbers are not finite. The longest run took {} s.\n",
        runs, found.scenes.size(), ended[Status::ok], ended[Status::unsupported], ended[Status::diverged],
        ended[Status::tolerance_not_met], ended[Status::failed], ok_beyond_one, not_finite, number(longest));
}

struct Section {
    const char *table, *title, *text;
};
constexpr Section sections[] = {
    {"damping", "Damping 10^6 with a constant torque",
     "Fewest evaluations with an attitude error of at most 1e-10 rad over 10 s of a steady spin whose transient lasts "
     "a microsecond. For methods that do not reach 1e-10 rad, the run with the smallest error is listed. Cells of runs "
     "that were stopped by a limit are empty."},
    {"linear", "Linear theory",
     "Rotation about one principal axis under drag (real eigenvalue) or on a spring (imaginary eigenvalue). The table "
     "lists the largest h |lambda| without growth to ten times the initial size, by theory and as measured over 50,000 "
     "steps. `growth_beyond` is the growth per step at 1.05 times the theoretical limit. Where it is too small to be "
     "observed, or the unstable window is too narrow, the measured limit deviates from the theoretical one."},
    {"gyroscopic", "Gyroscopic terms of game updates",
     "Results of the maps of step x spin: where each update diverges, where it loses energy, and where |L| is "
     "conserved but the attitude is wrong."},
    {"float32_lost", "Binary32",
     "`lost` is the number of scenes on which a fixed-step method in binary32 is above 0.1 rad at every step although "
     "it reaches 0.1 rad in binary64. `error_ratio_median` is the median, over the other scenes, of the smallest error "
     "in binary32 divided by that in binary64."},
    {"discontinuities", "Discontinuities",
     "A torque jumps. Methods either step *onto* the jump, which is an event of the scene, or step *over* it, if the "
     "torque is a function of time whose jump is unknown to the method."},
};

}  // namespace

std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<NamedTable>& tables) {
    std::string page =
        fmt::format("# Numerical stability\n\n{}.\n\n{}", markdown_text(plan.experiment.about), summary(found));
    page += R"(
Definitions. A *family* is a set of scenes that differ in one parameter. The *fastest rate* of a scene is the largest of
its angular velocity and of the magnitudes of its Jacobian's eigenvalues; the *fastest time* is its inverse. A run is
*stable* if over the whole run the error of the angular velocity is at most four times the largest true rate and the
error of the energy at most eight times the largest true energy. The search halves a fixed step until the attitude error
is within 1e-3 rad twice in a row or the run would exceed the limit on evaluations, then bisects the limits of stability
and accuracy. A run is *wrong but bounded* if nothing in the run itself indicates its error; above 1 rad its status
is `failed` here.
)";
    for (const auto& [name, title, text] : sections) {
        const auto named = std::find_if(tables.begin(), tables.end(),
                                        [wanted = std::string_view(name)](const auto& t) { return t.name == wanted; });
        if (named == tables.end() || named->table.rows.empty()) continue;
        NamedTable shown = *named;
        // linear theory is the same for binary32
        if (shown.name == "linear")
            std::erase_if(shown.table.rows, [&](const std::vector<Cell>& row) {
                const Method* method = find_method(text_of(row[column_index(shown.table, "method")]));
                return method && method->precision == Precision::binary32;
            });
        page += fmt::format("\n## {}\n\n{}\n\n{}", title, text, markdown(page_of(shown)));
    }
    page += "\n## Method by method\n";
    for (const PlannedCurve& curve : plan.curves) {
        const MethodPage method(plan, curve, found);
        if (method.empty()) continue;
        page += fmt::format("\n### {}{}\n\n{}\n", curve.method->name,
                            curve.kind == SettingKind::tolerance && takes_step(*curve.method)   ? ", by tolerance"
                            : curve.kind == SettingKind::step && takes_tolerance(*curve.method) ? ", by fixed steps"
                                                                                                : "",
                            method.text());
    }
    return page;
}

}  // namespace polhode
