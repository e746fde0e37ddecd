// Tables and summaries of runs with contact, shared by the kinds `contact` and `engine_contact`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/result.h"

namespace polhode {

/// Slope of log(position error) over log(step); empty if fewer than three steps have a usable error.
std::optional<double> contact_order(const std::vector<const Result*>& rows);

/// Replaces `most` by a larger value.
void keep_largest(std::optional<double>& most, const std::optional<double>& value);

/// The largest values over several runs.
struct ContactExtremes {
    std::optional<double> penetration, slip, energy_gain;  ///< m, m/s, J
};
ContactExtremes contact_extremes(const std::vector<const Result*>& rows);

/// For each scene and method: the errors of these measures ("attitude", "position") at each step, the order of the
/// position, and the largest of the other errors. Without "attitude", the largest attitude error is one of them.
NamedTable contact_scenes_table(const Plan& plan, const std::vector<Result>& rows,
                                const std::vector<std::string>& measures);

}  // namespace polhode
