// The kind `engine_contact`: contact with friction in physics engines compared with the truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/kinds/contact_probes.h"
#include "experiment/kinds/engine_standing.h"

namespace polhode {

/// Summary of a method's errors over the scenes of a plan, its motions with known results, and its place in the
/// ranking.
struct ContactPlace : EngineStanding {
    /// Medians over the scenes completed at the usual step of the largest errors of a run, rad and m.
    std::optional<double> attitude, position;
    std::optional<double> fine_attitude, fine_position;    ///< medians of the largest errors at the fine step
    std::optional<double> penetration, slip, energy_gain;  ///< largest values at the usual step, m, m/s, J
    std::optional<double> step_seconds;                    ///< median over all runs
    ContactProbe usual, fine;                              ///< at the usual and at the fine step
};

/// The rule by which contact_places() ranks.
extern const char* const contact_ranking_rule;

/// The methods that have rows: engines by place, best first, then other methods in the plan's order.
std::vector<ContactPlace> contact_places(const Plan& plan, const std::vector<Result>& rows);

/// NAME_published: published figures, and polhode's measurements of the same quantity.
NamedTable published_contact_table(const std::vector<ContactPlace>& places);

/// The page: ranking rule, tables, and a paragraph for each engine.
std::string engine_contact_page(const Plan& plan, const std::vector<ContactPlace>& places, const Findings& findings);

}  // namespace polhode
