// The page of the kind `engine_contact`, and the published figures beside polhode's measurements.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "experiment/kinds/cells.h"
#include "experiment/kinds/engine_contact.h"
#include "table/markup.h"

namespace polhode {
namespace {

/// A published figure on an engine.
struct PublishedContact {
    const char *engine, *quantity, *published, *source;
    Cell (*ours)(const ContactPlace&);
};

Cell motion_of_push(const ContactPlace& place) {
    if (!place.fine.pushed) return {};
    return *place.fine.pushed < 0.01 ? std::string("no motion")
                                     : fmt::format("moves, {:.3g} of the exact speed", *place.fine.pushed);
}
Cell rolling_of(const ContactPlace& place) {
    if (!place.fine.rolling || !place.fine.slow_path) return {};
    return fmt::format("acceleration on an incline {:.4g}; path on the level with 0.05 m/s {:.3g}", *place.fine.rolling,
                       *place.fine.slow_path);
}
constexpr const char* pushed_block = "35 kg pushed diagonally by 150 N, mu = 0.4";
constexpr const char* sim_benchmark = "SimBenchmark (ETH Zurich, 2019), rolling test";
constexpr PublishedContact published_contacts[] = {
    {"ode", pushed_block, "no motion (friction pyramid)", sim_benchmark, motion_of_push},
    {"bullet", pushed_block, "moves, accurate", sim_benchmark, motion_of_push},
    {"bullet_f32", pushed_block, "moves, accurate", sim_benchmark, motion_of_push},
    {"mujoco", pushed_block, "moves, jitter", sim_benchmark, motion_of_push},
    {"mujoco_wasm", pushed_block, "moves, jitter", sim_benchmark, motion_of_push},
    {"jolt", "rolling ball / exact", "1.5 % too fast", "Jolt issue 2121", rolling_of}};

// The shape of the friction cone, and the size of friction.
std::string describe_friction(const ContactPlace& place) {
    const std::string cone = describe_cone(place.fine);
    if (cone.empty()) return fmt::format(" The sliding ball was not completed: {}.", place.usual.fault);
    if (cone == "cone")
        return fmt::format(" Friction acts in a circular cone; at {} it is {:.3f} times mu m g.",
                           step_name(default_engine_step),
                           place.usual.friction.empty() ? place.fine.friction.front() : place.usual.friction.front());
    if (cone.starts_with("pyramid"))
        return fmt::format(
            " Friction acts in a pyramid: at 45 degrees to its axes it is {:.2f} times that along them, and a sliding "
            "ball deviates by up to {:.1f} degrees.",
            place.fine.friction[3] / place.fine.friction[0], place.fine.deviation.value_or(0));
    return std::string(" Friction has no effective limit: a sliding ball rolls at once.") +
           (place.engine->engine == "cannon_es"
                ? " The engine limits the friction impulse of a step by mu m g, a force, instead of by mu times the "
                  "normal impulse."
                : "");
}

std::string describe_slope(const ContactPlace& place) {
    const std::string hold = describe_hold(place.usual), fine = describe_hold(place.fine);
    if (hold.empty()) return "";
    std::string text =
        fmt::format(" At {} a block {} at 0.99 of the critical slope and {} at 1.01", step_name(default_engine_step),
                    hold.substr(0, hold.find(',')), hold.substr(hold.find(' ') + 1));
    if (!fine.empty() && fine != hold) text += fmt::format(" (at {}: {})", step_name(fine_step), fine);
    return text + ".";
}

std::string describe_motions(const ContactPlace& place) {
    const ContactProbe &usual = place.usual, &fine = place.fine;
    std::string text;
    if (usual.rolling)
        text += fmt::format(" A ball on an incline rolls with {:.4g} of 5/7 g sin a (at {}: {}).", *usual.rolling,
                            step_name(fine_step), fine.rolling ? fmt::format("{:.4g}", *fine.rolling) : "not measured");
    if (usual.first_bounce && usual.fifth_bounce)
        text += fmt::format(
            " A ball with e = 0.8 rises to {:.2f} of its height after one impact and to {:.2f} after "
            "five (exact: {:.2f} and {:.2f}).",
            *usual.first_bounce, *usual.fifth_bounce, exact_bounce(1), exact_bounce(5));
    if (usual.drift && usual.depth)
        text +=
            fmt::format(" A block at rest on half the critical slope drifts by {:.1g} m in 5 s and sinks by {:.1g} m.",
                        *usual.drift, std::max(*usual.depth, 0.0));
    if (usual.slow_path && *usual.slow_path < 0.9)
        text +=
            fmt::format(" A ball that rolls with 0.05 m/s covers {:.2g} of its path in 4 s: it sleeps or is damped.",
                        *usual.slow_path);
    if (usual.slow_path && *usual.slow_path > 1.1)
        text += fmt::format(
            " A ball that rolls with 0.05 m/s covers {:.2g} times its path in 4 s: it gains speed while it sinks into "
            "the "
            "plane.",
            *usual.slow_path);
    return text;
}

std::string describe_spins(const ContactPlace& place) {
    const ContactProbe& fine = place.fine;
    std::string text;
    if (fine.disc_height)
        text += fmt::format(" Euler's disc is after 1 s at {:.2g} of its height (at {}).", *fine.disc_height,
                            step_name(fine_step));
    if (fine.reversal)
        text += fmt::format(" The rattleback reverses its spin at {:.2f} s (exact: {:.2f} s).", *fine.reversal,
                            exact_reversal().value_or(0));
    if (fine.keeps_spin) text += " The rattleback does not reverse its spin.";
    if (fine.throw_error)
        text += fmt::format(" A billiard ball leaves in a direction that is off by {:.2g} degrees.", *fine.throw_error);
    return text;
}

std::string describe_errors(const ContactPlace& place) {
    if (place.scenes == 0) return " No scene was completed.";
    return fmt::format(
        " At {} the median errors of {} scene{} are {} in attitude and {} in position; at {} they are {} and {}.",
        step_name(default_engine_step), place.scenes, place.scenes == 1 ? "" : "s",
        place.attitude && *place.attitude >= attitude_error_cap ? "1 rad or more"
                                                                : format_amount(place.attitude, " rad"),
        format_amount(place.position, " m"), step_name(fine_step), format_amount(place.fine_attitude, " rad"),
        format_amount(place.fine_position, " m"));
}

std::string describe_engine_contact(const std::vector<const ContactPlace*>& own) {
    const ContactPlace& first = *own.front();
    std::string text = engine_heading(first);
    if (!first.is_available()) return text;
    const std::vector<std::string>& shapes = first.report.hello.shapes;
    if (!shapes.empty()) text += fmt::format("Supported shapes on planes: {}.\n\n", listed_words(shapes));
    for (const ContactPlace* place : own)
        text += setting_heading(*place) + describe_errors(*place) + describe_friction(*place) + describe_slope(*place) +
                describe_motions(*place) + describe_spins(*place) + describe_incomplete(*place) + "\n";
    return text;
}

}  // namespace

NamedTable published_contact_table(const std::vector<ContactPlace>& places) {
    NamedTable named = make_named_table("published", "Published figures",
                                        {{"method", "method"},
                                         {"quantity", "quantity"},
                                         {"published", "published"},
                                         {"measured", "here, 1/1000 s"},
                                         {"source", "source"}});
    for (const PublishedContact& one : published_contacts)
        for (const ContactPlace& place : places)
            if (place.engine && place.engine->engine == one.engine && place.is_available())
                named.table.rows.push_back(
                    {std::string(place.curve->method->name), one.quantity, one.published, one.ours(place), one.source});
    return named;
}

std::string engine_contact_page(const Plan& plan, const std::vector<ContactPlace>& places, const Findings& findings) {
    std::string text = "# Contact in physics engines against the truth\n\n" + markdown_text(plan.experiment.about) +
                       ".\n\n[Engines](engines.md) is the corresponding page for one body without contact, and "
                       "[joints](engine_joints.md) the one for mechanisms.\n\n";
    text += fmt::format("Ranking. {}\n\n", contact_ranking_rule);
    text +=
        "The truth follows the rigid laws of contact: unilateral contact, Coulomb's friction in a circular cone, and "
        "Stronge's restitution. Engines approximate these laws; their errors include this difference. All errors are "
        "the largest of a run, penetration, slip and energy gain the largest over the scenes at 1/60 s. *Slip* is the "
        "speed of the contact point where the truth rolls. MuJoCo has no coefficient of restitution: scenes with "
        "impacts are unsupported. SimBenchmark pushes a box that carries 25 balls; here one block has the same push "
        "per "
        "mass. Planes with different coefficients, and torsional and rolling friction, are not "
        "compared.\n\n";
    for (const NamedTable& named : findings.tables)
        if (named.name != "scenes" && !named.table.rows.empty())
            text += fmt::format("## {}\n\n{}\n", named.title, markdown(page_of(named)));
    for (const NamedFigure& named : findings.figures)
        text += fmt::format("![{}]({}.svg)\n\n", named.figure.title, named.name);
    text += "## Details for each engine\n\n";
    for (const auto& own : group_by_engine(places)) text += describe_engine_contact(own) + "\n";
    text += fmt::format("## Errors for each scene\n\n[This table]({}_scenes.md) lists all errors on all scenes.\n\n",
                        plan.experiment.name);
    return text;
}

}  // namespace polhode
