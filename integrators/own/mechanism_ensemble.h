// One mechanism from many starts, each row of a table a run of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "integrators/own/ensemble.h"
#include "motion/mechanism_table.h"
#include "motion/trajectory.h"

namespace polhode {

/// What became of one row.
struct MechanismRow {
    Status status = Status::ok;  ///< how its run ended
    std::string message;         ///< why, wherever status is not ok
    /// The motion of every body at k T/N, k = 1..N, as far as it was reached: by time and then by body.
    std::vector<Sample> samples;
};

/// The motion of each row's mechanism at k T/N, k = 1..N, of the scene's duration T; `samples` is N. Where the table
/// sets starts alone, and there is no loop and no stiff damping, the rows share one right-hand side and are
/// extrapolated sixteen at once, each by steps of its own, measured by what the scene's own start comes to or the row,
/// if that is more. Else each row is posed and solved by itself, by the method `auto`. A row that fails, or whose loops
/// do not close, says so and stops no other. The same bits for any number of threads. Throws std::invalid_argument for
/// settings out of range or fewer than one sample.
std::vector<MechanismRow> solve_mechanism_ensemble(const Scene& scene, const MechanismTable& table, long samples,
                                                   const EnsembleSettings& settings = {});

}  // namespace polhode
