// The findings in plain words, each sentence from the runs.
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
std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ", ")); }

double tenth_percentile(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 10];
}

// At least three members of one duration with positive parameters, with which the fastest rate rises a thousandfold.
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
    std::optional<double> lost_at;   ///< the smallest parameter from which on no run is `ok`
};

// `members` by rising parameter
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
    // where stiffness is small the motion itself sets the step
    points.erase(points.begin(), points.begin() + static_cast<long>(points.size() / 2));
    if (points.size() >= 2) cost.exponent = least_squares_line(points).slope;
    return cost;
}

/// The text about one method with one kind of setting.
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
        std::string page = fmt::format("Solves {} of {} scenes.", findings_.size(), found_.scenes.size());
        return page + (curve_.kind == SettingKind::step ? step_text() : run_text() + stiffness_text());
    }

  private:
    // the families of whose members all, or none, satisfy a condition
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
            page += fmt::format(" Safe for: {} (all members within 1e-3 rad at some step).", joined(names));
        if (!fine.empty())
            page += fmt::format(
                " 1e-3 rad takes a step of {} over the fastest rate and {} right-hand sides per unit of the fastest "
                "time (medians over {} scenes).",
                number(median(fine)), number(median(evaluations)), fine.size());
        if (const auto names = families_where(false, is_accurate); !names.empty())
            page += fmt::format(" Not within 1e-3 rad on any member, with {} right-hand sides: {}.",
                                plan_.experiment.max_evaluations, joined(names));
        if (!stable.empty())
            page += fmt::format(
                " Where a limit of stability showed, the step times the fastest rate was {} (median; {} on a tenth of "
                "the scenes).",
                number(median(stable)), number(tenth_percentile(stable)));
        if (never_stable > 0)
            page += fmt::format(" On {} scenes no step within the limit of evaluations was stable.", never_stable);
        std::vector<std::string> ends;
        for (const auto& [outcome, count] : beyond) ends.push_back(fmt::format("{} on {}", outcome, count));
        if (!ends.empty()) page += fmt::format(" Beyond its stable step: {} scenes.", joined(ends));
        const auto never_rests = [](const StabilityFinding* f) {
            return std::none_of(f->runs.begin(), f->runs.end(),
                                [](const StabilityRun& run) { return run.outcome == Outcome::damped_to_rest; });
        };
        std::vector<std::string> rests;
        for (const auto& [family, members] : families_)
            if (!std::all_of(members.begin(), members.end(), never_rests)) rests.push_back(family);
        std::sort(rests.begin(), rests.end());
        if (!rests.empty())
            page += fmt::format(" Comes to rest though the motion does not, at large steps: {}.", joined(rests));
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
            page += fmt::format(" Ends `ok` on all members of: {}.", joined(names));
        if (const auto names = families_where(false, all_ok); !names.empty())
            page += fmt::format(" On no member of: {}.", joined(names));
        for (const Status status : {Status::failed, Status::diverged, Status::tolerance_not_met})
            if (ended[status] > 0) page += fmt::format(" {} runs of `{}`.", ended[status], name_of(status));
        if (ratios.empty()) return page;
        const auto within = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 10; });
        return page +
               fmt::format(
                   " Achieved over requested error: median {}, within 10 on {:.0f} % of the runs that end `ok`, worst "
                   "{} ({}).",
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
            page += fmt::format(" Stiffness ({}):", family);
            if (!exponents.empty())
                page += fmt::format(" evaluations grow like its power {:.2f}{}", median(exponents),
                                    median(exponents) < 0.1 ? " (flat)" : "");
            if (!lost_at.empty())
                page += fmt::format("{} out of reach from {:g} on", exponents.empty() ? "" : ",",
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
            for (const Cell& cell : row_of("", run.result))
                if (const double* value = std::get_if<double>(&cell)) not_finite += !std::isfinite(*value);
            longest = std::max(longest, run.result.seconds_min.value_or(0));
        }
    return fmt::format(
        "{} runs on {} scenes: {} `ok`, {} `unsupported`, {} `diverged`, {} `tolerance_not_met`, {} `failed`. {} of "
        "those that are `ok` are more than 1 rad off, {} numbers are not finite; the longest run took {} s.\n",
        runs, found.scenes.size(), ended[Status::ok], ended[Status::unsupported], ended[Status::diverged],
        ended[Status::tolerance_not_met], ended[Status::failed], ok_beyond_one, not_finite, number(longest));
}

struct Section {
    const char *table, *title, *text;
};
constexpr Section sections[] = {
    {"damping", "Damping 10^6 with a constant torque",
     "What it costs to be within 1e-10 rad over 10 s of a steady spin whose transient lasts a microsecond: the "
     "cheapest "
     "run that is, or the nearest that a method comes. A cell is empty where the run was stopped by its limits."},
    {"linear", "Linear theory",
     "Rotation about one principal axis under drag (eigenvalue real) and on a spring (imaginary): the largest h "
     "|lambda| at which nothing grows to ten times its size, by theory and as measured over 50,000 steps; and what a "
     "step adds 5 % beyond the theory's limit, where that is too little to show, or a window too narrow."},
    {"gyroscopic", "Gyroscopic terms of game updates",
     "From the maps of step x spin: where the update blows up, where it damps, and where momentum is kept and only the "
     "attitude is wrong."},
    {"float32_lost", "Binary32",
     "How often a fixed-step method in binary32 is never within 0.1 rad, at any step, where the same in binary64 comes "
     "within it; elsewhere the smallest error of the one over that of the other."},
    {"discontinuities", "Discontinuities",
     "A torque that jumps, stepped onto as an event of the scene, and stepped over as a function of time that nobody "
     "knows to jump."},
};

}  // namespace

std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<NamedTable>& tables) {
    std::string page =
        fmt::format("# Numerical stability\n\n{}.\n\n{}", markdown_text(plan.experiment.about), summary(found));
    page += R"(
How to read it. A family is a set of scenes that differ in one number; the fastest rate of a scene is the largest of its
angular velocity and of the eigenvalues of its Jacobian. *Stable* means that over the whole run the error of the angular
velocity stayed within four times the motion's largest rate and that of the energy within eight times its largest
energy. A fixed step is halved until the attitude is within 1e-3 rad twice or the run would need more right-hand sides
than the limit; then the limits of stability and of accuracy are bisected. *Wrong but bounded* is what no number of the
run betrays: such a run is `failed` here if it is more than 1 rad off.
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
