// Events and modes of contacts and joints.
#include <fmt/format.h>

#include "app/commands.h"
#include "app/lookup.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/contact/solve_joints.h"
#include "integrators/truth/reference.h"
#include "python/bindings.h"
#include "scene/plane_file.h"
#include "scene/sphere_contacts.h"

namespace polhode::python {
namespace {

// Events are (t, what, event, normal impulse, tangential impulse), intervals (from, to, what, mode, ratio). Times and
// impulses are numbers for a method and decimals for a truth.
using Lists = std::pair<py::list, py::list>;

// The method of the run. Throws UsageError unless it records events.
const Method& recording_method(const SolvedScene& solved) {
    if (!contact::has_events(solved.scene->scene()))
        throw UsageError("the scene has no planes or contacts, and no joint has friction or limits");
    const Method* method = find_method(solved.method);
    const bool has_joints = contact::has_joint_events(solved.scene->scene());
    if (!solved.settings || !method || !(has_joints ? follows_events(*method) : follows_contacts(*method)))
        throw UsageError(fmt::format("{} does not record events; use taylor or polhode.truth()", solved.method));
    return *method;
}

// "PLANE" for one body, "BODY and OTHER" for several.
std::string name_of_contact(const Scene& scene, std::size_t plane) {
    if (!has_sphere_contacts(scene)) return plane_name(scene, plane);
    const ContactNames names = contact_names(scene, plane);
    return fmt::format("{} and {}", names.body, names.other);
}

// In flight: the body, if there are several.
std::string name_in_mode(const Scene& scene, std::size_t plane, bool is_flight) {
    if (!is_flight) return name_of_contact(scene, plane);
    return has_sphere_contacts(scene) ? contact_names(scene, plane).body : "";
}

Lists joint_events(const SolvedScene& solved) {
    const Method& method = recording_method(solved);
    const auto run = call([&] {
        return contact::follow_joints_in_binary64(*solved.scene->problem(solved.formulation, false), *solved.settings,
                                                  method.steps);
    });
    Lists lists;
    for (const auto& e : run.events)
        lists.first.append(py::make_tuple(e.t, solved.scene->scene().joints[e.joint].name,
                                          contact::joint_event_names[static_cast<std::size_t>(e.kind)], e.impulse,
                                          py::make_tuple(0.0, 0.0, 0.0)));
    return lists;
}

Lists events_of_run(const SolvedScene& solved) {
    const Method& method = recording_method(solved);
    const Scene& scene = solved.scene->scene();
    if (contact::has_joint_events(scene)) return joint_events(solved);
    const contact::Record<double> record = call([&] {
        return contact::record_contacts(*solved.scene->problem(solved.formulation, false), *solved.settings,
                                        method.steps);
    });
    Lists lists;
    for (const auto& e : record.events) {
        const Vector3<double>& J = e.tangential_impulse_W;
        lists.first.append(py::make_tuple(e.t, name_of_contact(scene, e.plane),
                                          contact::event_names[static_cast<std::size_t>(e.kind)], e.normal_impulse,
                                          py::make_tuple(J[0], J[1], J[2])));
    }
    for (const auto& in : record.intervals)
        lists.second.append(py::make_tuple(in.from, in.to,
                                           name_in_mode(scene, in.plane, in.mode == contact::Mode::flight),
                                           contact::mode_names[static_cast<std::size_t>(in.mode)], in.largest_ratio));
    return lists;
}

Lists events_of_truth(const DecimalReference& truth, const ReadScene& read) {
    const Scene& scene = read.scene();
    const bool joints = contact::has_joint_events(scene);
    Lists lists;
    for (const DecimalContactEvent& e : truth.contact_events) {
        const auto& J = e.tangential_impulse;
        lists.first.append(py::make_tuple(e.t, joints ? scene.joints[e.plane].name : name_of_contact(scene, e.plane),
                                          e.event, e.normal_impulse, py::make_tuple(J[0], J[1], J[2])));
    }
    for (const DecimalContactInterval& in : truth.contact_intervals)
        lists.second.append(py::make_tuple(in.from, in.to, name_in_mode(scene, in.plane, in.mode == "flight"), in.mode,
                                           in.largest_ratio));
    return lists;
}

}  // namespace

void bind_contacts(py::module_& module) {
    module.def("events_of_run", &events_of_run);
    module.def("events_of_truth", &events_of_truth);
}

}  // namespace polhode::python
