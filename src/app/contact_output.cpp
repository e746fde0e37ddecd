#include "app/contact_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "app/commands.h"
#include "motion/mechanism_motion.h"
#include "scene/plane_file.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

std::string events_csv(const Scene& scene, const DecimalReference& truth) {
    std::string text =
        "t,body,other,event,normal_impulse,tangential_impulse_1,tangential_impulse_2,tangential_impulse_3\n";
    for (const DecimalContactEvent& e : truth.contact_events) {
        const ContactNames names = contact_names(scene, e.plane);
        text += fmt::format("{},{},{},{},{},{},{},{}\n", e.t, names.body, names.other, e.event, e.normal_impulse,
                            e.tangential_impulse[0], e.tangential_impulse[1], e.tangential_impulse[2]);
    }
    return text;
}

std::string joint_events_csv(const Scene& scene, const DecimalReference& truth) {
    std::string text = "t,joint,event,impulse\n";
    for (const DecimalContactEvent& e : truth.contact_events)
        text += fmt::format("{},{},{},{}\n", e.t, scene.joints[e.plane].name, e.event, e.normal_impulse);
    return text;
}

std::string modes_table(const Scene& scene, const DecimalReference& truth) {
    std::size_t time = 8, contact = 7, mode = 7;
    const auto other = [&](const DecimalContactInterval& in) {
        return in.mode == "flight" ? std::string("-") : contact_names(scene, in.plane).other;
    };
    std::size_t body = 4;
    for (const DecimalContactInterval& in : truth.contact_intervals)
        time = std::max({time, in.from.size(), in.to.size()}), contact = std::max(contact, other(in).size()),
        mode = std::max(mode, in.mode.size()), body = std::max(body, contact_names(scene, in.plane).body.size());
    std::string text = fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<{}}  {:<{}}  |F|/(mu N)\n", "from (s)", time, "to (s)",
                                   time, "body", body, "contact", contact, "mode", mode);
    for (const DecimalContactInterval& in : truth.contact_intervals)
        text += fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<{}}  {:<{}}  {}\n", in.from, time, in.to, time,
                            contact_names(scene, in.plane).body, body, other(in), contact, in.mode, mode,
                            in.largest_ratio > 0 ? fmt::format("{:.6g}", in.largest_ratio) : std::string("-"));
    return text;
}

}  // namespace

void add_contact_options(CLI::App& command, ContactOptions& options) {
    command.add_flag("--modes", options.modes,
                     "Print the contact modes over time: flight, sliding, rolling, and with torsional and rolling "
                     "friction spinning, resting and .._without_spin, with the largest |F|/(mu N). To stdout with "
                     "--output, else to stderr");
    command.add_option("--events", options.events,
                       "CSV file for events at contacts: t,body,other,event and the impulse, N s, world axes. Events: "
                       "impact, lands, rolls, slides, lifts_off, accumulates, stops, spin_stops, spin_starts, "
                       "rolling_stops, rolling_starts. Friction and limits of joints: t,joint,event,impulse, N m s or "
                       "N s. Events: impact, rests, leaves, sticks, slips");
}

void require_contacts(const Scene& scene, const ContactOptions& options, const std::string& output,
                      const std::string& reactions) {
    if (!options.any()) return;
    require_output(options.events);
    const char* name = options.modes ? "--modes" : "--events";
    const bool has_joints = contact::has_joint_events(scene);
    if (scene.planes.empty() && scene.contacts.empty() && !has_joints)
        throw UsageError(fmt::format(
            "{}: the scene has no planes or contacts, and no joint has friction or limits; remove the option", name));
    if (has_joints && options.modes) throw UsageError("--modes: not available for joints; use --events");
    if (options.events.empty()) return;
    if (options.events == output) throw UsageError("--events and --output name the same file; give two files");
    if (options.events == reactions) throw UsageError("--events and --reactions name the same file; give two files");
}

void write_contacts(const Scene& scene, const ContactOptions& options, const DecimalReference& truth, bool to_stdout) {
    if (!options.any()) return;
    if (contact::has_joint_events(scene)) {
        write_output(options.events, joint_events_csv(scene, truth));
        return;
    }
    if (!options.events.empty()) write_output(options.events, events_csv(scene, truth));
    if (!options.modes) return;
    if (to_stdout)
        write_output("", modes_table(scene, truth));
    else
        std::fputs(modes_table(scene, truth).c_str(), stderr);
}

void write_contacts(const Scene& scene, const ContactOptions& options, const contact::Record<double>& record,
                    bool to_stdout) {
    DecimalReference as_text;
    for (const contact::Event<double>& e : record.events) {
        const Vector3<double>& J = e.tangential_impulse_W;
        as_text.contact_events.push_back({shortest_decimal(e.t),
                                          e.plane,
                                          contact::event_names[static_cast<std::size_t>(e.kind)],
                                          shortest_decimal(e.normal_impulse),
                                          {shortest_decimal(J[0]), shortest_decimal(J[1]), shortest_decimal(J[2])}});
    }
    for (const contact::Interval<double>& in : record.intervals)
        as_text.contact_intervals.push_back({shortest_decimal(in.from), shortest_decimal(in.to), in.plane,
                                             contact::mode_names[static_cast<std::size_t>(in.mode)], in.largest_ratio});
    write_contacts(scene, options, as_text, to_stdout);
}

void write_joint_events(const Scene& scene, const ContactOptions& options,
                        const std::vector<contact::JointEvent<double>>& events) {
    DecimalReference as_text;
    for (const contact::JointEvent<double>& e : events)
        as_text.contact_events.push_back({shortest_decimal(e.t),
                                          e.joint,
                                          contact::joint_event_names[static_cast<std::size_t>(e.kind)],
                                          shortest_decimal(e.impulse),
                                          {}});
    write_contacts(scene, options, as_text, false);
}

std::vector<std::string> reaction_names(const Scene& scene) {
    if (scene.planes.empty()) return joint_names(scene);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < scene.planes.size(); ++i) names.push_back(plane_name(scene, i));
    return names;
}

}  // namespace polhode
