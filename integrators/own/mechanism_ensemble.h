// One mechanism from many starts, each row of a table a run of its own.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "integrators/own/ensemble.h"
#include "motion/mechanism_table.h"
#include "motion/problem.h"
#include "motion/trajectory.h"

namespace polhode {

/// What became of one row.
struct MechanismRow {
    Status status = Status::ok;  ///< how its run ended
    std::string message;         ///< why, wherever status is not ok
    /// The motion of every body at k T/N, k = 1..N, as far as it was reached: by time and then by body.
    std::vector<Sample> samples;
};

/// A mechanism prepared for many starts, some of which are solved at a time.
class MechanismEnsembleSolver {
  public:
    /// Copies the scene and the settings. `only_starts` says that the tables set starts alone, `samples` is N. Throws
    /// InputError where the scene cannot be posed, std::invalid_argument for settings out of range or N < 1.
    MechanismEnsembleSolver(const Scene& scene, bool only_starts, long samples, const EnsembleSettings& settings);

    /// How many rows are solved together by one thread.
    std::size_t block() const { return shared_ ? 256 : 1; }
    /// The motion of each row's mechanism at k T/N, k = 1..N, of the scene's duration T, into as many rows; several
    /// threads may call it at once. Where the table sets starts alone, and there is no loop and no stiff damping, the
    /// rows share one right-hand side and are extrapolated sixteen at once, each by steps of its own, with errors
    /// relative to the larger of the row's sizes and those of the scene's own start. Otherwise each row is posed and
    /// solved by itself, by the method `auto`. A row that fails, or whose loops do not close, reports why and stops no
    /// other. The same bits for any number of threads and any division into tables. Throws std::invalid_argument where
    /// there are not as many rows as in the table.
    void solve(const MechanismTable& table, std::span<MechanismRow> rows) const;

  private:
    Scene scene_;
    EnsembleSettings settings_;
    long samples_;
    std::optional<Problem> shared_;  // the right-hand side of all rows, where they have one
};

/// All rows of a table, solved by a MechanismEnsembleSolver.
std::vector<MechanismRow> solve_mechanism_ensemble(const Scene& scene, const MechanismTable& table, long samples,
                                                   const EnsembleSettings& settings = {});

}  // namespace polhode
