#include "experiment/run/contact_events.h"

#include <vector>

#include "integrators/contact/solve_contacts.h"
#include "integrators/truth/reference.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"

namespace polhode {
namespace {

std::vector<ContactEvent> recorded_events(const contact::Record<double>& record) {
    std::vector<ContactEvent> events;
    for (const contact::Event<double>& e : record.events)
        events.push_back({e.t, contact::event_names[static_cast<std::size_t>(e.kind)], e.plane});
    return events;
}

// The events of the reference, which is in the cache.
std::vector<ContactEvent> reference_events(const Scene& scene, long samples) {
    std::vector<ContactEvent> events;
    for (const DecimalContactEvent& e : decimal_reference(scene, samples).contact_events)
        events.push_back({parse_decimal(e.t).value_or(0), e.event, e.plane});
    return events;
}

}  // namespace

ContactErrors measure_contacts(const Method& method, const Problem& problem, const Settings& settings,
                               const Trajectory& trajectory, const Reference& reference, std::string& message) {
    ContactErrors result = contact_errors(problem.scene, trajectory, reference);
    if (!reference.available || trajectory.status != Status::ok) return result;
    if (has_sphere_contacts(problem.scene)) return result;  // the error of their events is not measured
    EventComparison compared = compare_impacts(trajectory, reference);
    // a method of this program, not a user-defined one
    const bool records_events = follows_contacts(method) && find_method(method.name) == &method;
    if (records_events) {
        const std::vector<ContactEvent> events = reference_events(problem.scene, settings.samples);
        // without contact modes there is no record
        if (!events.empty())
            compared =
                compare_events(recorded_events(contact::record_contacts(problem, settings, method.steps)), events);
    }
    result.event_time = compared.time_error;
    if (!compared.message.empty()) message += (message.empty() ? "" : "; ") + compared.message;
    return result;
}

}  // namespace polhode
