// Ensembles of mechanisms: solves one mechanism from many initial states, one run per row of a table.
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

/// The result for one row.
struct MechanismRow {
    Status status = Status::ok;  ///< how its run ended
    std::string message;         ///< the reason if status is not ok
    /// The motion of every body at k T/N, k = 1..N, up to the end of the run: by time and then by body.
    std::vector<Sample> samples;
};

/// A prepared mechanism that solves rows of initial states in several calls.
class MechanismEnsembleSolver {
  public:
    /// Copies the scene and the settings. `only_starts`: the tables set only initial states. `samples` is N. Throws
    /// InputError if the scene cannot be posed, std::invalid_argument for settings out of range or N < 1.
    MechanismEnsembleSolver(const Scene& scene, bool only_starts, long samples, const EnsembleSettings& settings);

    /// The number of rows that one thread solves per block.
    std::size_t block() const { return common_problem_ ? 256 : 1; }
    /// Writes the motion of each row's mechanism at k T/N, k = 1..N, T the scene's duration, to `rows`. Thread-safe. If
    /// the table sets only initial states, and there are no loops and no stiff damping, all rows share one right-hand
    /// side and are extrapolated sixteen at a time with individual steps. Errors are then relative to the larger of the
    /// sizes of the row and of the scene's start. Otherwise each row is posed and solved separately by the method
    /// `auto`. A row that fails, or whose loops do not close, gets the reason; the others are not affected. The bits
    /// are the same for any number of threads and any division into tables. Throws std::invalid_argument if the numbers
    /// of `rows` and of the table's rows differ.
    void solve(const MechanismTable& table, std::span<MechanismRow> rows) const;

  private:
    Scene scene_;
    EnsembleSettings settings_;
    long samples_;
    std::optional<Problem> common_problem_;  // the common right-hand side of all rows, if there is one
};

/// Why the rows of all ensembles of a scene of several bodies are solved one by one; empty if they are not.
std::string why_mechanisms_one_by_one(const Problem& problem);

/// Solves all rows of a table with a MechanismEnsembleSolver.
std::vector<MechanismRow> solve_mechanism_ensemble(const Scene& scene, const MechanismTable& table, long samples,
                                                   const EnsembleSettings& settings = {});

}  // namespace polhode
