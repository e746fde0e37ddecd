// Events at contacts that a method records, compared with those of the reference.
#pragma once

#include <string>

#include "integrators/method.h"
#include "measure/contact_errors.h"

namespace polhode {

/// contact_errors() of a run of `method`. If the method follows contacts from event to event, `event_time` compares all
/// of its events, otherwise the times of impacts that it reports. A missing or additional event is appended to
/// `message`.
ContactErrors measure_contacts(const Method& method, const Problem& problem, const Settings& settings,
                               const Trajectory& trajectory, const Reference& reference, std::string& message);

}  // namespace polhode
