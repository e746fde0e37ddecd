// The findings in plain words, each sentence from the runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiment/kinds/stability_tables.h"
#include "measure/statistics.h"
#include "table/markup.h"

namespace polhode {
namespace {

std::string number(double value) { return fmt::format("{:.3g}", value); }

std::string joined(const std::vector<std::string>& words, std::size_t most = 12) {
    std::string list;
    for (std::size_t i = 0; i < std::min(words.size(), most); ++i)
        list += fmt::format("{}{}", i == 0 ? "" : ", ", words[i]);
    return words.size() > most ? fmt::format("{} and {} more", list, words.size() - most) : list;
}

// a tenth of the values lie below
double tenth(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 10];
}

/// A method's findings by one kind of setting, and its families in the order of the scenes.
class MethodPage {
  public:
    MethodPage(const Plan& plan, const PlannedCurve& curve, const StabilityFindings& found)
        : curve_(curve), most_evaluations_(plan.experiment.max_evaluations) {
        for (const StabilityFinding& f : found.findings) {
            if (f.method != curve.method || f.kind != curve.kind) continue;
            if (!was_run(f)) {
                ++refused_;
                continue;
            }
            findings_.push_back(&f);
            const std::string& family = f.scene->family;
            if (!members_.contains(family)) families_.push_back(family);
            members_[family].push_back(&f);
        }
    }
    bool empty() const { return findings_.empty(); }

    std::string text(const std::vector<StiffnessCost>& costs) const {
        std::string page = fmt::format("Solves {} of {} scenes.", findings_.size(), findings_.size() + refused_);
        page += curve_.kind == SettingKind::step ? fixed_step() : tolerance(costs);
        return page;
    }

  private:
    // families all of whose members satisfy, and those of which none does
    template <class Satisfies>
    void split(const Satisfies& satisfies, std::vector<std::string>& all, std::vector<std::string>& none) const {
        for (const std::string& family : families_) {
            const auto& members = members_.at(family);
            const auto count = std::count_if(members.begin(), members.end(), satisfies);
            if (count == static_cast<long>(members.size())) all.push_back(family);
            if (count == 0) none.push_back(family);
        }
    }

    std::string fixed_step() const {
        std::string page;
        std::vector<std::string> accurate, lost;
        split([](const StabilityFinding* f) { return f->accurate != nullptr; }, accurate, lost);
        std::vector<double> stable, fine, evaluations;
        std::map<std::string, long> beyond;
        long never_stable = 0;
        std::set<std::string> rests;
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
            for (const StabilityRun& run : f->runs)
                if (run.outcome == Outcome::damped_to_rest) rests.insert(f->scene->family);
        }
        if (!accurate.empty())
            page += fmt::format(" Safe for: {} (all members within 1e-3 rad at some step).", joined(accurate, 40));
        if (!fine.empty())
            page += fmt::format(
                " 1e-3 rad takes a step of {} over the fastest rate and {} right-hand sides per unit of the fastest "
                "time (medians over {} scenes).",
                number(median(fine)), number(median(evaluations)), fine.size());
        if (!lost.empty())
            page += fmt::format(" Not within 1e-3 rad on any member, with {} right-hand sides: {}.", most_evaluations_,
                                joined(lost, 40));
        if (!stable.empty())
            page += fmt::format(
                " Where a limit of stability showed, the step times the fastest rate was {} (median; {} on a tenth of "
                "the scenes).",
                number(median(stable)), number(tenth(stable)));
        if (never_stable > 0)
            page += fmt::format(" On {} scenes no step within the limit of evaluations was stable.", never_stable);
        std::vector<std::string> ends;
        for (const auto& [outcome, count] : beyond) ends.push_back(fmt::format("{} on {}", outcome, count));
        if (!ends.empty()) page += fmt::format(" Beyond its stable step: {} scenes.", joined(ends));
        if (!rests.empty())
            page += fmt::format(" Comes to rest though the motion does not, at large steps: {}.",
                                joined({rests.begin(), rests.end()}, 40));
        return page;
    }

    std::string tolerance(const std::vector<StiffnessCost>& costs) const {
        std::string page;
        const auto all_ok = [](const StabilityFinding* f) {
            return std::all_of(f->runs.begin(), f->runs.end(),
                               [](const StabilityRun& r) { return r.result.status == Status::ok; });
        };
        std::vector<std::string> safe, lost;
        split(all_ok, safe, lost);
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
        if (!safe.empty()) page += fmt::format(" Ends `ok` on all members of: {}.", joined(safe, 40));
        if (!lost.empty()) page += fmt::format(" On no member of: {}.", joined(lost, 40));
        for (const Status status : {Status::failed, Status::diverged, Status::tolerance_not_met})
            if (ended[status] > 0)
                page += fmt::format(" {} runs of {}.", ended[status], fmt::format("`{}`", name_of(status)));
        if (!ratios.empty()) {
            const auto within = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 10; });
            page += fmt::format(
                " Achieved over requested error: median {}, within 10 on {:.0f} % of the runs that end `ok`, worst {} "
                "({}).",
                number(median(ratios)), 100.0 * static_cast<double>(within) / static_cast<double>(ratios.size()),
                number(worst), worst_on);
        }
        for (const std::string& family : families_) {
            std::vector<double> exponents;
            std::optional<double> gone;
            for (const StiffnessCost& cost : costs) {
                if (cost.method != curve_.method || cost.family != family || curve_.kind != SettingKind::tolerance)
                    continue;
                if (cost.exponent) exponents.push_back(*cost.exponent);
                if (cost.lost_at && (!gone || *cost.lost_at < *gone)) gone = cost.lost_at;
            }
            if (exponents.empty() && !gone) continue;
            page += fmt::format(" Stiffness ({}):", family);
            if (!exponents.empty())
                page += fmt::format(" evaluations grow like its power {:.2f}{}", median(exponents),
                                    median(exponents) < 0.1 ? " (flat)" : "");
            if (gone) page += fmt::format("{} out of reach from {:g} on", exponents.empty() ? "" : ",", *gone);
            page += ".";
        }
        return page;
    }

    const PlannedCurve& curve_;
    long most_evaluations_;
    std::vector<const StabilityFinding*> findings_;
    std::size_t refused_ = 0;
    std::vector<std::string> families_;
    std::map<std::string, std::vector<const StabilityFinding*>> members_;
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

}  // namespace

std::string stability_page(const Plan& plan, const StabilityFindings& found, const std::vector<StiffnessCost>& costs,
                           const std::vector<NamedTable>& tables) {
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
    const auto section = [&](const std::string& name, const char* title, const char* text) {
        for (NamedTable named : tables) {
            if (named.name != name || named.table.rows.empty()) continue;
            // of linear theory binary32 says the same again
            if (name == "linear")
                std::erase_if(named.table.rows, [&](const std::vector<Cell>& row) {
                    const Method* method = find_method(text_of(row[column_index(named.table, "method")]));
                    return method && method->precision == Precision::binary32;
                });
            const Table page_table = page_of(named);
            page += fmt::format("\n## {}\n\n{}\n\n{}", title, text, markdown(page_table));
        }
    };
    section("damping", "Damping 10^6 with a constant torque",
            "What it costs to be within 1e-10 rad over 10 s of a steady spin whose transient lasts a microsecond: the "
            "cheapest run that is, or the nearest that a method comes. A cell is empty where the run was stopped by "
            "its limits.");
    section("linear", "Linear theory",
            "Rotation about one principal axis under drag (eigenvalue real) and on a spring (imaginary): the largest h "
            "|lambda| at which nothing grows to ten times its size, by theory and as measured over 50,000 steps; and "
            "what a step "
            "adds 5 % beyond the theory's limit, where that is too little to show, or a window too narrow.");
    section("gyroscopic", "Gyroscopic terms of game updates",
            "From the maps of step x spin: where the update blows up, where it damps, and where momentum is kept and "
            "only the attitude is wrong.");
    section(
        "float32_lost", "Binary32",
        "How often a fixed-step method in binary32 is never within 0.1 rad, at any step, where the same in binary64 "
        "comes within it; elsewhere the smallest error of the one over that of the other.");
    section("discontinuities", "Discontinuities",
            "A torque that jumps, stepped onto as an event of the scene, and stepped over as a function of time that "
            "nobody knows to jump.");
    page += "\n## Method by method\n";
    for (const PlannedCurve& curve : plan.curves) {
        const MethodPage method(plan, curve, found);
        if (method.empty()) continue;
        page += fmt::format("\n### {}{}\n\n{}\n", curve.method->name,
                            curve.kind == SettingKind::tolerance && takes_step(*curve.method)   ? ", by tolerance"
                            : curve.kind == SettingKind::step && takes_tolerance(*curve.method) ? ", by fixed steps"
                                                                                                : "",
                            method.text(costs));
    }
    return page;
}

}  // namespace polhode
