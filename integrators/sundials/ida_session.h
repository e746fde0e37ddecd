// Runs of IDA for a mechanism in maximal coordinates.
#pragma once

#include <optional>
#include <vector>

#include "integrators/maximal/constrained.h"
#include "integrators/run/solver_run.h"
#include "integrators/run/watch.h"
#include "integrators/sundials/ida_solver.h"
#include "motion/mechanism.h"

namespace polhode {

/// Not movable: the library holds pointers into it. Satisfies SolverSession (run/solver_run.h).
class IdaSession {
  public:
    /// Relative tolerance R, absolute tolerance R times each component's scale. The problem must be a mechanism and
    /// must outlive this object. Throws std::bad_alloc if there is not enough memory.
    IdaSession(const Problem& problem, maximal::Index index, double tolerance);
    IdaSession(const IdaSession&) = delete;
    IdaSession& operator=(const IdaSession&) = delete;

    /// Returns to t = 0 and resets all counts.
    void restart();
    /// Processes an event: impulses, then the loads of this segment. Discards the history of previous steps.
    int enter(const Segment& segment);
    /// One internal step, cut at the segment's end. Returns IDA's flag.
    int step() { return solver_.step(); }
    double time() const { return solver_.time(); }
    /// The motion at time(), with the reactions from the multipliers.
    Moment sample() { return moment_at(time(), solver_.unknowns()); }
    /// The motion at a time within the last step.
    std::optional<Moment> sample_inside(double t) { return moment_at(t, solver_.inside(t)); }
    int inside_flag() const { return IDA_SUCCESS; }
    SolverFailure failure(int flag);
    long steps() { return solver_.counts().steps; }
    long rhs_evaluations() const { return solver_.evaluations(); }
    SolverCounts counts() {
        const IdaCounts& counts = solver_.counts();
        return {counts.rejected_steps, counts.newton_failures, {}};
    }

  private:
    const Problem* problem_;
    std::vector<BodyMotion<double>> start_;
    maximal::System<double> system_;
    maximal::ConstrainedEquations<double> equations_;
    IdaSolver solver_;

    Moment moment_at(double t, const double* z) const;
};

}  // namespace polhode
