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

// Throws UsageError unless the run has a record of events.
void require_record(const SolvedScene& solved) {
    const Scene& scene = solved.scene->scene();
    if (has_sphere_contacts(scene))
        throw UsageError("events of several bodies are not available in Python; use polhode truth --events");
    if (scene.planes.empty() && !contact::has_joint_events(scene))
        throw UsageError("the scene has no planes, and no joint has friction or limits");
    if (!solved.settings || solved.method != "taylor")
        throw UsageError(fmt::format("{} does not record events; use taylor or polhode.truth()", solved.method));
}

Lists joint_events(const SolvedScene& solved) {
    const auto run = call([&] {
        return contact::follow_joints_in_binary64(*solved.scene->problem(solved.formulation, false), *solved.settings);
    });
    Lists lists;
    for (const auto& e : run.events)
        lists.first.append(py::make_tuple(e.t, solved.scene->scene().joints[e.joint].name,
                                          contact::joint_event_names[static_cast<std::size_t>(e.kind)], e.impulse,
                                          py::make_tuple(0.0, 0.0, 0.0)));
    return lists;
}

Lists events_of_run(const SolvedScene& solved) {
    require_record(solved);
    const Scene& scene = solved.scene->scene();
    if (contact::has_joint_events(scene)) return joint_events(solved);
    const auto run = call([&] {
        return contact::follow_in_binary64(*solved.scene->problem(solved.formulation, false), *solved.settings);
    });
    Lists lists;
    for (const auto& e : run.record.events) {
        const Vector3<double>& J = e.tangential_impulse_W;
        lists.first.append(py::make_tuple(e.t, plane_name(scene, e.plane),
                                          contact::event_names[static_cast<std::size_t>(e.kind)], e.normal_impulse,
                                          py::make_tuple(J[0], J[1], J[2])));
    }
    for (const auto& in : run.record.intervals)
        lists.second.append(py::make_tuple(in.from, in.to,
                                           in.mode == contact::Mode::flight ? "" : plane_name(scene, in.plane),
                                           contact::mode_names[static_cast<std::size_t>(in.mode)], in.largest_ratio));
    return lists;
}

Lists events_of_truth(const DecimalReference& truth, const ReadScene& read) {
    const Scene& scene = read.scene();
    if (has_sphere_contacts(scene))
        throw UsageError("events of several bodies are not available in Python; use polhode truth --events");
    const bool joints = contact::has_joint_events(scene);
    Lists lists;
    for (const DecimalContactEvent& e : truth.contact_events) {
        const auto& J = e.tangential_impulse;
        lists.first.append(py::make_tuple(e.t, joints ? scene.joints[e.plane].name : plane_name(scene, e.plane),
                                          e.event, e.normal_impulse, py::make_tuple(J[0], J[1], J[2])));
    }
    for (const DecimalContactInterval& in : truth.contact_intervals)
        lists.second.append(py::make_tuple(in.from, in.to, in.mode == "flight" ? "" : plane_name(scene, in.plane),
                                           in.mode, in.largest_ratio));
    return lists;
}

}  // namespace

void bind_contacts(py::module_& module) {
    module.def("events_of_run", &events_of_run);
    module.def("events_of_truth", &events_of_truth);
}

}  // namespace polhode::python
