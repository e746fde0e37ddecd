// The page of the kind `engines`.
#include <fmt/format.h>

#include <algorithm>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/engines.h"
#include "experiment/kinds/kinds.h"
#include "figure/curve_style.h"
#include "table/markup.h"

namespace polhode {
namespace {

std::string name_number(const std::optional<double>& value, const char* unit = "") {
    return value ? fmt::format("{:.2g}{}", *value, unit) : "not measured";
}
// Does not distinguish errors above 1 rad.
std::string format_attitude(const std::optional<double>& angle) {
    return angle && *angle >= 1 ? "1 rad or more" : name_number(angle, " rad");
}
std::string add_brackets(const std::string& about) { return about.empty() ? "" : " (" + about + ")"; }

std::string describe_accuracy(const EnginePlace& place) {
    std::string text;
    for (int i = 0; i < 3; ++i) {
        if (!place.within[i]) continue;
        text += fmt::format("{}{:g} rad at steps up to {}", text.empty() ? "" : ", ", accuracies[i],
                            step_name(*place.within[i]));
    }
    if (text.empty()) return "No step tested keeps the attitude error below 0.1 rad on at least half of the scenes.";
    text = "The attitude error on at least half of the scenes is within " + text;
    if (!place.within[2]) text += fmt::format("; no step tested reaches {:g} rad", place.within[1] ? 0.001 : 0.01);
    return text + ".";
}

std::string describe_gyroscopic_term(const EngineFacts& facts) {
    if (!facts.gyroscopic_fraction) return "";
    std::string text;
    if (*facts.gyroscopic_fraction > 0.5)
        text = " The gyroscopic term acts";
    else if (*facts.gyroscopic_fraction < -0.5)
        text = " The gyroscopic term acts with the wrong sign";
    else
        text =
            " The gyroscopic term does not act: at any step, a free body with unequal moments keeps rotating about an "
            "axis that it should leave";
    if (facts.matching_update == no_update)
        text += ". The motion matches no update of polhode";
    else if (!facts.matching_update.empty())
        text += fmt::format(". The motion matches `{}` to {:.1g} rad", facts.matching_update, facts.update_difference);
    return text + ".";
}

// Recommends the engine's most accurate setting if it is better than the default.
std::string describe_remedy(const std::vector<const EnginePlace*>& own) {
    const EnginePlace *first = own.front(), *best = own.front();
    for (const EnginePlace* place : own)
        if (place->facts->engine->setting == "default") first = place;
    for (const EnginePlace* place : own)
        if (place->attitude && (!best->attitude || *place->attitude < *best->attitude)) best = place;
    if (best == first || !first->attitude || !best->attitude || *best->attitude > 0.9 * *first->attitude) return "";
    return fmt::format("Use the setting `{}`{}: at {} the median error decreases from {:.2g} to {:.2g} rad.",
                       best->facts->engine->setting, add_brackets(best->facts->setting_description),
                       step_name(default_engine_step), *first->attitude, *best->attitude);
}

std::string describe_engine(const std::string& engine, const std::vector<const EnginePlace*>& own) {
    const EngineFacts& first = *own.front()->facts;
    std::string text = fmt::format("### {}{}{}\n\n", engine, first.report.hello.version.empty() ? "" : " ",
                                   first.report.hello.version);
    if (!first.is_available()) return text + fmt::format("Not compared: {}.\n", first.report.fault);
    for (const EnginePlace* place : own) {
        const EngineFacts& facts = *place->facts;
        text += fmt::format("- `{}`{}: place {}.", facts.engine->setting, add_brackets(facts.setting_description),
                            place->place);
        if (place->scenes == 0) {
            text += " No scene was completed.\n";
            continue;
        }
        text += fmt::format(
            " At {} the median errors of {} scene{} are {} (attitude), {} (angular momentum) and {} (energy). {} {}{}",
            step_name(default_engine_step), place->scenes, place->scenes == 1 ? "" : "s",
            format_attitude(place->attitude), name_number(place->momentum), name_number(place->energy),
            place->order ? fmt::format("The observed order of the attitude error is {:.1f}.", *place->order)
                         : "The attitude error shows no order.",
            describe_accuracy(*place), describe_gyroscopic_term(facts));
        if (!facts.repeats) text += " A second run gives different numbers.";
        text += "\n";
    }
    if (const std::string remedy = describe_remedy(own); !remedy.empty()) text += "\n" + remedy + "\n";
    return text;
}

// Keeps one curve per engine, so that figures are legible: the given setting, or "default" if the engine lacks it.
Plan with_one_setting(const Plan& plan, const char* setting) {
    Plan part = plan;
    std::erase_if(part.curves, [&](const PlannedCurve& curve) {
        const EngineMethod* engine = engine_of(*curve.method);
        if (!engine) return false;
        for (const PlannedCurve& other : plan.curves)
            if (const EngineMethod* one = engine_of(*other.method); one && one->engine == engine->engine)
                if (one->setting == setting) return engine->setting != setting;
        return engine->setting != "default";
    });
    // All engines belong to one family, so here each one has its own colour. Other methods, whose curves are far below,
    // keep theirs.
    int place = -1;
    const Method* before = nullptr;
    for (PlannedCurve& curve : part.curves) {
        if (!engine_of(*curve.method)) continue;
        if (curve.method != before) ++place;
        const PlainStyle plain = plain_style(place);
        curve.style = {plain.color, plain.mark}, before = curve.method;
    }
    return part;
}

}  // namespace

std::string engines_page(const Plan& plan, const std::vector<EnginePlace>& places,
                         const std::vector<EngineFacts>& facts, const Findings& findings) {
    const std::vector<NamedTable>& tables = findings.tables;
    std::string text = "# Physics engines against the truth\n\n";
    if (!plan.experiment.about.empty()) text += markdown_text(plan.experiment.about) + ".\n\n";
    text += "[Joints](engine_joints.md) is the corresponding page for mechanisms.\n\n";
    text += fmt::format("Ranking. {}\n\n", leaderboard_rule);
    text +=
        "Errors are the largest over a run. *Attitude* is the rotation angle to the truth. *Momentum* and *energy* are "
        "relative to those of the motion. The time per step covers the stepping alone, without the process and its "
        "start. For engines compiled to WebAssembly it includes the overhead of WebAssembly.\n\n";
    for (const NamedTable& named : tables)
        if (named.name == "leaderboard" || named.name == "identity")
            text += fmt::format("## {}\n\n{}\n", named.title, markdown(page_of(named)));
    if (!findings.figures.empty()) text += "## Error against run time\n\n";
    for (const NamedFigure& named : findings.figures)
        text += fmt::format("![{}]({}.svg)\n\n", named.figure.title, named.name);
    text += "## Details for each engine\n\n";
    std::vector<std::string> printed_engines;
    for (const EngineFacts& one : facts) {
        const std::string& engine = one.engine->engine;
        if (std::ranges::find(printed_engines, engine) != printed_engines.end()) continue;
        printed_engines.push_back(engine);
        std::vector<const EnginePlace*> own;
        for (const EngineFacts& other : facts)
            for (const EnginePlace& place : places)
                if (place.facts == &other && other.engine->engine == engine) own.push_back(&place);
        text += describe_engine(engine, own) + "\n";
    }
    for (const NamedTable& named : tables)
        if (named.name == "gazebo_boxes")
            text += fmt::format(
                "## {}\n\nThe angular momentum of a free box is constant. The published numbers (S. Peters and J. Hsu "
                "2014) are the largest errors over all steps, for the engine versions and settings that Gazebo used "
                "then. They do not include the attitude. polhode's numbers are the largest over the samples and "
                "therefore slightly smaller. ODE's 1.31 % match `gyroscopic_explicit`; the ODE compared here uses "
                "`gyroscopic_linearly_implicit`. Bullet's 1.25 % match `gyroscopic_implicit`, which it still uses. "
                "Simbody's 0.64 % match its second semi-explicit Euler integrator, which takes two half steps. Gazebo "
                "selects this integrator; here it is the setting `gazebo`. Simbody's default integrator conserves the "
                "momentum. DART's error was large in 2014; it now matches `gyroscopic_explicit`.\n\n{}\n",
                named.title, markdown(page_of(named)));
    for (const NamedTable& named : tables)
        if (named.name == "scenes")
            text += fmt::format("## {}\n\n[This table]({}) lists all errors of all engines on all scenes.\n",
                                named.title, plan.experiment.name + "_scenes.md");
    return text;
}

Findings conclude_engines(const Plan& plan, const std::vector<Result>& rows) {
    const std::vector<EngineFacts> facts = engine_facts(plan, rows);
    const std::vector<EnginePlace> places = engine_places(plan, rows, facts);
    Findings findings{{leaderboard_table(places), identity_table(facts), engine_scenes_table(plan, rows)}};
    if (NamedTable gazebo = gazebo_table(plan, rows); !gazebo.table.rows.empty())
        findings.tables.push_back(std::move(gazebo));
    for (const char* setting : {"default", "best"})
        for (NamedFigure& named : work_precision_figures(with_one_setting(plan, setting), rows)) {
            named.name += std::string("_") + setting;
            named.figure.title += fmt::format(", engines with the setting \"{}\"", setting);
            findings.figures.push_back(std::move(named));
        }
    findings.page = engines_page(plan, places, facts, findings);
    return findings;
}

}  // namespace polhode
