// The block on contacts in the description of a scene of one body.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/description.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/contact/solve_spheres.h"
#include "motion/contact.h"
#include "scene/plane_file.h"
#include "text/message.h"

namespace polhode::description {
namespace {

constexpr std::size_t most_contact_lines = 40;

std::string describe_interval(const Scene& scene, const contact::Interval<double>& in) {
    if (in.mode == contact::Mode::flight) return "flight";
    std::string text = fmt::format("{} on {}", contact::mode_names[static_cast<std::size_t>(in.mode)],
                                   one_line(plane_name(scene, in.plane), 60));
    if (in.largest_ratio > 0) text += fmt::format(", largest |F|/(mu N) {:.6g}", in.largest_ratio);
    return text;
}

// Whether the body is a ball about its centre of mass with three equal moments.
bool is_ball(const Problem& problem) {
    const auto& pieces = problem.body.geometry->pieces;
    return pieces.size() == 1 && !pieces[0].extended && hypotenuse(pieces[0].center) == 0 &&
           problem.needs.symmetry == Symmetry::spherical;
}

// Modes and events of several spheres, in the order of time.
void contacts_of_spheres(Report& report, const Problem& problem) {
    const Scene& scene = problem.scene;
    report.title("Contacts");
    report.line("laws", "Coulomb friction; impacts of spheres in closed form");
    report.line("simultaneous impacts",
                "one after the other, in the order of the pairs; not determined in a row of touching spheres");
    report.line("colliding pairs", fmt::format("{}", sphere_pairs(scene).size()));
    Settings settings;
    settings.samples = 1, settings.seconds_limit = 2, settings.tolerance = default_tolerance;
    const contact::SphereRun<double> run = contact::follow_spheres_in_binary64(problem, settings);
    const contact::Record<double> record = contact::merge_records(run.records);
    std::size_t lines = 0;
    for (const contact::Interval<double>& in : record.intervals) {
        if (++lines > most_contact_lines) break;
        const ContactNames names = contact_names(scene, in.plane);
        const bool flies = in.mode == contact::Mode::flight;
        report.line(
            fmt::format("{:.10g} s to {:.10g} s", in.from, in.to),
            fmt::format("{}: {}{}", one_line(names.body, 60), contact::mode_names[static_cast<std::size_t>(in.mode)],
                        flies ? "" : " on " + one_line(names.other, 60)));
    }
    if (record.intervals.size() > most_contact_lines)
        report.line("..", "further intervals; polhode truth --modes prints all of them");
    lines = 0;
    for (const contact::Event<double>& event : record.events) {
        if (event.kind != contact::EventKind::impact || ++lines > most_contact_lines) continue;
        const ContactNames names = contact_names(scene, event.plane);
        report.line(fmt::format("impact at {:.10g} s", event.t),
                    fmt::format("{} and {}, normal impulse {:.6g} N s", one_line(names.body, 60),
                                one_line(names.other, 60), event.normal_impulse));
    }
    if (!run.fault.empty()) report.line("ends early", one_line(run.fault, 300));
}

}  // namespace

void contacts(Report& report, const Problem& problem) {
    if (has_sphere_contacts(problem.scene)) return contacts_of_spheres(report, problem);
    if (problem.scene.planes.empty()) return;
    report.title("Contacts");
    if (problem.needs.user_torque) return report.line("user-defined torques are not supported together with planes");
    report.line("laws", "Coulomb friction; impacts by the shock equations of Darboux and Keller");
    const bool rough = std::ranges::any_of(problem.scene.planes, [](const Plane& plane) { return plane.friction > 0; });
    report.line("simultaneous impacts", rough ? "one after the other, in the order of planes and points of the hull"
                                              : "all points of a plane together, by Moreau's law");
    Settings settings;
    settings.samples = 1, settings.seconds_limit = 2, settings.tolerance = default_tolerance;
    const contact::Run<double> run = contact::follow_in_binary64(problem, settings);
    const auto& intervals = run.record.intervals;
    for (std::size_t i = 0; i < std::min(intervals.size(), most_contact_lines); ++i)
        report.line(fmt::format("{:.10g} s to {:.10g} s", intervals[i].from, intervals[i].to),
                    describe_interval(problem.scene, intervals[i]));
    if (intervals.size() > most_contact_lines)
        report.line("..", fmt::format("{} further intervals; polhode truth --modes prints all of them",
                                      intervals.size() - most_contact_lines));
    std::array<long, contact::event_names.size()> counts{};
    for (const contact::Event<double>& event : run.record.events) ++counts[static_cast<std::size_t>(event.kind)];
    std::vector<std::string> events;
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0) events.push_back(fmt::format("{} {}", counts[i], contact::event_names[i]));
    report.line("events", events.empty() ? "none" : join_with_commas(events));
    if (!run.fault.empty()) report.line("ends early", one_line(run.fault, 300));
    const bool rolls = std::ranges::any_of(intervals, [](const auto& in) { return in.mode == contact::Mode::rolling; });
    const bool has_torques = std::ranges::any_of(problem.scene.planes, [](const Plane& plane) {
        return plane.torsional_friction > 0 || plane.rolling_friction > 0;
    });
    if (rolls && !has_torques) report.line("kept while rolling", "energy, unless drag or a torque acts");
    if (has_torques) report.line("friction torques", "torsional and rolling friction; none acts in impacts");
    const bool has_twist =
        std::ranges::any_of(problem.scene.planes, [](const Plane& plane) { return plane.torsional_friction > 0; });
    if (is_ball(problem) && !has_twist && problem.scene.planes.size() == 1)
        report.line("kept by a ball", "spin about the normal of the plane, unless a torque acts");
}

}  // namespace polhode::description
