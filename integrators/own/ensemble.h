// Bodies by the million: each with its own inertia and start, all under the loads of one scene.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrators/lanes/lanes.h"
#include "motion/ensemble_table.h"
#include "motion/trajectory.h"

namespace polhode {

/// How an ensemble is solved.
struct EnsembleSettings {
    /// Error per step, estimated by comparison with a result of lower order: relative to the size of the rates, and in
    /// rad for the attitude. Bodies with a closed form are accurate to round-off.
    double tolerance = 1e-10;
    int threads = 1;              ///< at least 1
    long max_steps = 1'000'000;   ///< a body that needs more between two events is `failed`
    double seconds_limit = 3600;  ///< s of the thread's time; a body solved by itself that needs more is `failed`
    InstructionSet instructions = instruction_set();  ///< not beyond what the processor has; same bits in each
};

/// Throws std::invalid_argument for settings out of range.
void require_in_range(const EnsembleSettings& settings);

/// What became of one body.
struct EnsembleRow {
    Status status = Status::ok;  ///< how its run ended
    bool moved = false;          ///< `end` holds a motion: false for a body that could not begin
    Sample end;                  ///< the motion at the scene's duration, or where the body's run ended
    std::string message;         ///< why, wherever status is not ok
};

/// The motion of each body at the scene's duration. A body that fails, or that cannot be (see fault_of), gets a row
/// that says so and stops no other. A row depends on its own body, the scene and the tolerance alone: the same bits for
/// any number of threads, any order of the bodies and any instruction set. Torque-free pieces go by the closed form,
/// eight bodies at once; the loads of a scene file by extrapolation, sixteen bodies at once. Other bodies are posed and
/// solved one by one, by the method `auto`: scenes with planes, a user's torque; stiff damping; principal moments
/// further apart than 10^8. Memory does not grow with the duration. Throws InputError where the scene is not valid,
/// std::invalid_argument for settings out of range.
std::vector<EnsembleRow> solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies,
                                        const EnsembleSettings& settings = {});

/// A prepared scene that solves bodies in several calls, for tables that are too large for one call.
class EnsembleSolver {
  public:
    /// Copies both. Throws as solve_ensemble().
    EnsembleSolver(const Scene& scene, const EnsembleSettings& settings);
    ~EnsembleSolver();
    /// Takes the other's scene; what is left of it can only be assigned to, or go.
    EnsembleSolver(EnsembleSolver&&) noexcept;
    /// Takes the other's scene in place of its own; what is left of the other can only be assigned to, or go.
    EnsembleSolver& operator=(EnsembleSolver&&) noexcept;

    /// How many bodies are solved together by one thread: fewer where each takes long.
    std::size_t block() const;
    /// The motion of each body at the scene's duration, into as many rows; several threads may call it at once. Throws
    /// std::invalid_argument where there are not as many rows as bodies.
    void solve(std::span<const EnsembleBody> bodies, std::span<EnsembleRow> rows) const;

  private:
    struct Prepared;
    std::unique_ptr<const Prepared> prepared_;
};

/// The motion of each body at the scene's duration, written into rows of the caller's. Throws std::invalid_argument
/// also where there are not as many rows as bodies. Everything else is as in the function that returns the rows.
void solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies, const EnsembleSettings& settings,
                    std::span<EnsembleRow> rows);

}  // namespace polhode
