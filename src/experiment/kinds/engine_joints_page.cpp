// What the rows of the kind `engine_joints` say, in words.
#include <fmt/format.h>

#include <algorithm>

#include "experiment/kinds/engine_joints.h"
#include "experiment/kinds/kinds.h"
#include "table/markup.h"

namespace polhode {
namespace {

std::string listed_words(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}
std::string amount_of(const std::optional<double>& value, const char* unit) {
    return value ? fmt::format("{:.2g}{}", *value, unit) : "not measured";
}

// What the joints of a setting do, in one sentence.
std::string sentence_of_joints(const JointPlace& place) {
    if (place.scenes == 0) return " No scene was run to its end.";
    std::string text;
    if (place.closes())
        text = fmt::format(" Its joints have no gap but round-off ({}): they are its coordinates",
                           amount_of(place.worst_gap, " m"));
    else if (place.gap && *place.gap < 1e-9)
        text = fmt::format(
            " Its joints are its coordinates and have no gap but round-off; at the closure of a loop "
            "they part by {} at worst (`{}` at {})",
            amount_of(place.worst_gap, " m"), place.worst_gap_scene, step_name(usual_step));
    else
        text = fmt::format(" At {} its joints part by {} in the median of {} scene{}, by {} at worst (`{}`)",
                           step_name(usual_step), amount_of(place.gap, " m"), place.scenes,
                           place.scenes == 1 ? "" : "s", amount_of(place.worst_gap, " m"), place.worst_gap_scene);
    if (place.gap && *place.gap >= 1e-9 && place.fine_gap)
        text += fmt::format(", by {} at {}", amount_of(place.fine_gap, " m"), step_name(fine_step));
    const bool is_lost = place.attitude && *place.attitude >= hopeless_attitude;
    text += fmt::format("; the attitude is {} off, the energy {}",
                        is_lost ? "1 rad or more" : amount_of(place.attitude, " rad"), amount_of(place.energy, ""));
    text += place.order ? fmt::format(", and smaller steps help with order {:.1f}.", *place.order)
                        : ", and smaller steps show no order.";
    return text;
}

std::string sentence_of_refusals(const JointPlace& place) {
    std::string text;
    if (!place.refused.empty()) text += " Left out: " + listed_words(place.refused) + ".";
    if (!place.lost.empty())
        text += " Not run to the end at " + step_name(usual_step) + ": " + listed_words(place.lost) + ".";
    return text;
}

std::string paragraph_of_joints(const std::vector<const JointPlace*>& own) {
    const JointPlace& first = *own.front();
    const EngineHello& hello = first.report.hello;
    std::string text =
        fmt::format("### {}{}{}\n\n", first.engine->engine, hello.version.empty() ? "" : " ", hello.version);
    if (!first.is_here()) return text + fmt::format("It takes no part: {}.\n", first.report.fault);
    text += fmt::format("Joints: {}. Loops closed by: {}.\n\n", listed_words(hello.joints),
                        hello.loops.empty() ? "none" : listed_words(hello.loops));
    for (const JointPlace* place : own)
        text += fmt::format("- `{}`{}: place {}.{}{}\n", place->engine->setting,
                            place->about_setting.empty() ? "" : " (" + place->about_setting + ")", place->place,
                            sentence_of_joints(*place), sentence_of_refusals(*place));
    return text;
}

}  // namespace

std::string engine_joints_page(const Plan& plan, const std::vector<JointPlace>& places, const Findings& findings) {
    std::string text =
        "# Joints of physics engines against the truth\n\n" + markdown_text(plan.experiment.about) + ".\n\n";
    text += "The second page of the leaderboard; the first, of one body, is [engines](engines.md).\n\n";
    text += fmt::format("How the order is made. {}\n\n", leaderboard_rule);
    text +=
        "Each body starts where the scene has it; engines that keep every body's six freedoms are given the joints' "
        "points and axes, those with joint coordinates the tree. Attitude is the worst body's, the gap how far the "
        "two points of a joint part, the turn how far its axes do, the energy relative to the motion's own; all are "
        "the largest of a run. Springs, dampers and motors of joints are not asked for. A step's time is that of the "
        "stepping alone; engines in WebAssembly pay for that.\n\n";
    for (const NamedTable& named : findings.tables)
        if (named.name == "leaderboard" || named.name == "solvers")
            text += fmt::format("## {}\n\n{}\n", named.title, markdown(page_of(named)));
    for (const NamedFigure& named : findings.figures)
        text += fmt::format("![{}]({}.svg)\n\n", named.figure.title, named.name);
    text += "## Engine by engine\n\n";
    std::vector<std::string> told;
    for (const JointPlace& one : places) {
        if (!one.engine || std::ranges::find(told, one.engine->engine) != told.end()) continue;
        told.push_back(one.engine->engine);
        std::vector<const JointPlace*> own;
        for (const JointPlace& other : places)
            if (other.engine && other.engine->engine == one.engine->engine) own.push_back(&other);
        text += paragraph_of_joints(own) + "\n";
    }
    text += fmt::format("## Scene by scene\n\nEvery error on every scene: [the table]({}_scenes.md).\n\n",
                        plan.experiment.name);
    return text;
}

}  // namespace polhode
