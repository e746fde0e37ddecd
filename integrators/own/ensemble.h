// Bodies by the million: each with its own inertia and start, all under the loads of one scene.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrators/lanes/lanes.h"
#include "motion/ensemble_table.h"
#include "motion/problem.h"
#include "motion/trajectory.h"

namespace polhode {

/// How an ensemble is solved.
struct EnsembleSettings {
    /// Error per step, estimated by comparison with a result of lower order: relative to the size of the rates, and in
    /// rad for the attitude. Bodies with a closed form are accurate to round-off.
    double tolerance = 1e-10;
    int threads = 1;              ///< at least 1
    long max_steps = 1'000'000;   ///< a body that needs more between two events is `failed`
    double seconds_limit = 3600;  ///< s of the thread's time; a body solved separately that needs more is `failed`
    InstructionSet instructions = instruction_set();  ///< must be available on the processor; all give the same bits
};

/// Throws std::invalid_argument for settings out of range.
void require_in_range(const EnsembleSettings& settings);

/// Why the rows of all ensembles of a scene are solved one by one; empty if they are not.
std::string why_one_by_one(const Problem& problem);

/// The result for one body.
struct EnsembleRow {
    Status status = Status::ok;  ///< how its run ended
    bool moved = false;          ///< whether `end` is valid; false for a body that could not be started
    Sample end;                  ///< the motion at the scene's duration, or at the end of a shorter run
    std::string message;         ///< the reason if status is not ok
};

/// Computes the motion of each body at the scene's duration. A body that is not valid (see fault_of) or whose run fails
/// gets a row with the reason; the others are not affected. A row depends only on its body, the scene and the
/// tolerance: the bits are the same for any number of threads, order of bodies and instruction set. Torque-free pieces
/// are solved in closed form, eight bodies at a time; loads of a scene file by extrapolation, sixteen bodies at a time.
/// The method `auto` solves bodies individually for planes, user-defined torques, stiff damping, principal moments with
/// a ratio above 10^8, and loads by formulas that switch or hold values, or for a mass or inertia that is not the
/// scene's. Memory does not grow with the duration. Throws InputError if the scene is not valid, std::invalid_argument
/// for settings out of range.
std::vector<EnsembleRow> solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies,
                                        const EnsembleSettings& settings = {});

/// A prepared scene that solves bodies in several calls, for tables that are too large for one call.
class EnsembleSolver {
  public:
    /// Copies scene and settings. Throws like solve_ensemble().
    EnsembleSolver(const Scene& scene, const EnsembleSettings& settings);
    ~EnsembleSolver();
    /// A moved-from solver can only be assigned to or destroyed.
    EnsembleSolver(EnsembleSolver&&) noexcept;
    /// A moved-from solver can only be assigned to or destroyed.
    EnsembleSolver& operator=(EnsembleSolver&&) noexcept;

    /// The number of bodies that one thread solves per block; smaller if each body takes long.
    std::size_t block() const;
    /// Writes the motion of each body at the scene's duration to `rows`. Thread-safe. Throws std::invalid_argument if
    /// the numbers of rows and bodies differ.
    void solve(std::span<const EnsembleBody> bodies, std::span<EnsembleRow> rows) const;

  private:
    struct Prepared;
    std::unique_ptr<const Prepared> prepared_;
};

/// Like the function that returns rows, but writes them to `rows`. Also throws std::invalid_argument if the numbers of
/// rows and bodies differ.
void solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies, const EnsembleSettings& settings,
                    std::span<EnsembleRow> rows);

}  // namespace polhode
