// The page of the kind `engine_joints`.
#include <fmt/format.h>

#include <algorithm>

#include "experiment/kinds/engine_joints.h"
#include "experiment/kinds/kinds.h"
#include "table/markup.h"

namespace polhode {
namespace {

// Describes the joint, attitude and energy errors of one setting.
std::string describe_joints(const JointPlace& place) {
    if (place.scenes == 0) return " No scene was completed.";
    std::string text;
    if (place.closes())
        text = fmt::format(" It uses joint coordinates: joint gaps are round-off ({} at most).",
                           format_amount(place.worst_gap, " m"));
    else if (place.gap && *place.gap < 1e-9)
        text = fmt::format(
            " It uses joint coordinates: joint gaps are round-off, except where a loop is closed. The largest gap at "
            "{} is {} (`{}`).",
            step_name(default_engine_step), format_amount(place.worst_gap, " m"), place.worst_gap_scene);
    else
        text = fmt::format(" At {} the median joint gap is {} ({} scene{}) and the largest is {} (`{}`).",
                           step_name(default_engine_step), format_amount(place.gap, " m"), place.scenes,
                           place.scenes == 1 ? "" : "s", format_amount(place.worst_gap, " m"), place.worst_gap_scene);
    if (place.gap && *place.gap >= 1e-9 && place.fine_gap)
        text += fmt::format(" At {} the median gap is {}.", step_name(fine_step), format_amount(place.fine_gap, " m"));
    const bool is_lost = place.attitude && *place.attitude >= attitude_error_cap;
    text += fmt::format(
        " At {} the median attitude error is {} and the median energy error is {}.", step_name(default_engine_step),
        is_lost ? "1 rad or more" : format_amount(place.attitude, " rad"), format_amount(place.energy, ""));
    text += place.order ? fmt::format(" The observed order of the attitude error is {:.1f}.", *place.order)
                        : " The attitude error shows no order.";
    return text;
}

std::string describe_engine_joints(const std::vector<const JointPlace*>& own) {
    const JointPlace& first = *own.front();
    const EngineHello& hello = first.report.hello;
    std::string text = engine_heading(first);
    if (!first.is_available()) return text;
    text += fmt::format("Supported joints: {}. Supported loop closures: {}.\n\n", listed_words(hello.joints),
                        hello.loops.empty() ? "none" : listed_words(hello.loops));
    for (const JointPlace* place : own)
        text += setting_heading(*place) + describe_joints(*place) + describe_incomplete(*place) + "\n";
    return text;
}

}  // namespace

std::string engine_joints_page(const Plan& plan, const std::vector<JointPlace>& places, const Findings& findings) {
    std::string text =
        "# Joints of physics engines against the truth\n\n" + markdown_text(plan.experiment.about) + ".\n\n";
    text +=
        "[Engines](engines.md) is the corresponding page for one body, "
        "[limits, friction and gears](engine_joint_laws.md) that for further laws of joints.\n\n";
    text += fmt::format("Ranking. {}\n\n", leaderboard_rule);
    text +=
        "Each body starts in the state that the scene defines. Engines in maximal coordinates receive the points and "
        "axes of the joints; engines in joint coordinates receive the tree. All errors are the largest of a run. "
        "*Attitude* is the error of the worst body. *Gap* is the distance between the two points of a joint. *Turn* is "
        "the angle between its axes. *Energy* is relative to the energy of the motion. Springs, dampers and motors at "
        "joints are not compared. The time per step covers the stepping alone. For engines compiled to WebAssembly it "
        "includes the overhead of WebAssembly.\n\n";
    for (const NamedTable& named : findings.tables)
        if (named.name == "leaderboard" || named.name == "solvers")
            text += fmt::format("## {}\n\n{}\n", named.title, markdown(page_of(named)));
    for (const NamedFigure& named : findings.figures)
        text += fmt::format("![{}]({}.svg)\n\n", named.figure.title, named.name);
    text += "## Details for each engine\n\n";
    for (const auto& own : group_by_engine(places)) text += describe_engine_joints(own) + "\n";
    text += fmt::format("## Errors for each scene\n\n[This table]({}_scenes.md) lists all errors on all scenes.\n\n",
                        plan.experiment.name);
    return text;
}

}  // namespace polhode
