// IDA for the differential-algebraic equations of a mechanism in maximal coordinates.
#pragma once

#include <ida/ida.h>
#include <ida/ida_ls.h>
#include <nvector/nvector_serial.h>

#include <cstdlib>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "integrators/maximal/constrained.h"
#include "integrators/sundials/ida_counts.h"
#include "integrators/sundials/sparse_solver.h"
#include "integrators/sundials/sundials_handles.h"
#include "motion/problem.h"

namespace polhode {

/// Not movable: the library holds pointers into it.
class IdaSolver {
  public:
    /// Relative tolerance R, absolute tolerance R times the component's scale; `scales` are those of the motion.
    /// `set_time`: called with the time before each evaluation, if the equations depend on it. `system` and `equations`
    /// must outlive this object. Throws std::bad_alloc if there is not enough memory.
    IdaSolver(const maximal::System<double>& system, const maximal::ConstrainedEquations<double>& equations,
              const Scales& scales, double tolerance, std::function<void(double)> set_time = {});
    IdaSolver(const IdaSolver&) = delete;
    IdaSolver& operator=(const IdaSolver&) = delete;

    /// The unknowns; the differential ones come first.
    double* unknowns() { return N_VGetArrayPointer(state_.get()); }
    const double* rates() { return N_VGetArrayPointer(state_rate_.get()); }
    double time() const { return t_; }

    /// Sets all unknowns to zero and resets all counts.
    void reset();
    /// Moves the clock and makes the other unknowns consistent with the differential ones.
    void set_state(double t);
    /// Discards the history of previous steps. Returns IDA's flag.
    int start();
    /// Like start(), for motions that start from rest at an event: with steps whose errors are as small as the
    /// tolerance allows. IDA's own first steps are so short that the motion over them is as small as the errors of
    /// Newton's method. Those errors are also limited to a thousandth of the tolerance.
    int start_from_event();
    /// Steps will not pass this time. Returns IDA's flag.
    int set_stop(double t) {
        end_ = t;
        return IDASetStopTime(memory_.get(), t);
    }
    /// One internal step, cut at the stop time. Returns IDA's flag.
    int step();
    /// The unknowns at a time within the last step. Valid until the next call.
    const double* inside(double t);
    int last_order() const;

    long evaluations() const { return evaluations_; }
    IdaCounts& counts() {
        collect_counts();
        return counts_;
    }
    /// The time at which a residual was not finite.
    const std::optional<double>& not_finite_at() const { return not_finite_at_; }
    /// The reason that a negative flag reports.
    std::string reason(int flag) const;

  private:
    struct FreeMemory {
        void operator()(void* memory) const { IDAFree(&memory); }
    };

    const maximal::ConstrainedEquations<double>* equations_;
    std::function<void(double)> set_time_;
    int n_;
    double tolerance_;
    SundialsContext context_;  // declared before the members that use it
    SundialsOwner<N_Vector> state_, state_rate_, absolute_, variable_ids_, interpolated_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    std::unique_ptr<void, FreeMemory> memory_;
    double t_ = 0, end_ = 0;
    long evaluations_ = 0;
    IdaCounts counts_;
    bool running_ = false, was_euler_step_ = false;
    std::optional<double> not_finite_at_;
    std::string message_;

    void set_tolerances(const maximal::System<double>& system, const Scales& scales);
    void collect_counts();
    int check_finite(double t, const double* numbers, std::size_t count);
    static void check_flag(int flag) {
        if (flag != 0) throw std::bad_alloc();
    }
    static int residual(double t, N_Vector state, N_Vector rate, N_Vector result, void* solver);
    static int fill_jacobian(double t, double c, N_Vector state, N_Vector, N_Vector, SUNMatrix J, void* solver,
                             N_Vector, N_Vector, N_Vector);
    static void store_message(int code, const char*, const char*, char* text, void* solver);
};

}  // namespace polhode
