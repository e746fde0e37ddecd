// Common base of the CVODE and ARKODE sessions for one posed problem: state, tolerances, right-hand side, Jacobian, and
// a handler of their messages.
#pragma once

#include <fmt/format.h>
#include <sundials/sundials_nvector.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/run/solver_run.h"
#include "integrators/sundials/serial_vector.h"
#include "integrators/sundials/sundials_handles.h"
#include "motion/finite.h"
#include "motion/jacobian.h"
#include "motion/numbers.h"
#include "motion/systems.h"

namespace polhode {

/// Vector: FixedVector<N>, or a type with the same make() and data(). The problem must outlive the session. Not
/// movable: the library holds pointers into it.
template <class SystemType, class Vector = typename VectorFor<SystemType::dimension>::type>
class SundialsSession {
  public:
    static constexpr int dimension = SystemType::dimension;

    SundialsSession(const SundialsSession&) = delete;
    SundialsSession& operator=(const SundialsSession&) = delete;

    double time() const { return t_; }
    std::size_t size() const { return static_cast<std::size_t>(system_.size()); }  ///< number of state variables
    double* y() { return Vector::data(state_.get()); }

    /// The motion at time(), from the solver's unmodified state.
    auto sample() { return sample_at(t_); }

    /// The motion at t, for callers that keep the time: t may differ from time() by rounding.
    auto sample_at(double t) { return system_.motion(t, y()); }

  protected:
    /// Relative tolerance R, absolute tolerance R times each component's scale. Throws std::bad_alloc if there is not
    /// enough memory.
    SundialsSession(const Problem& problem, double tolerance)
        : problem_(&problem),
          system_(problem),
          // smaller tolerances are rejected elsewhere; below this value the weights (reciprocals) would overflow
          tolerance_(std::max(tolerance, 1e-100)) {
        system_.initial(y());
        system_.scales(Vector::data(absolute_.get()));
        for (int i = 0; i < system_.size(); ++i) Vector::data(absolute_.get())[i] *= tolerance_;
    }
    ~SundialsSession() = default;

    // with valid arguments only allocation can fail; flags are zero on success
    static void check_flag(int flag) {
        if (flag != 0) throw std::bad_alloc();
    }

    // creates Newton's method, the matrix of its linear systems and their solver
    void make_newton() {
        nonlinear_ = make_owner(SUNNonlinSol_Newton(state_.get(), context_));
        matrix_ = make_owner(make_matrix<dimension>(state_.get(), context_));
        linear_ = make_owner(make_linear_solver<dimension>(state_.get(), matrix_.get(), context_));
    }
    void reset_state() {
        system_.initial(y());
        evaluations_ = 0;
        not_finite_at_.reset();
    }
    void apply_event(const Segment& segment) {
        system_.enter(segment, y());
        t_ = segment.begin, end_ = segment.end;
    }
    // `status` is the meaning of the flag; the flag's name is used if the library gave no message
    SolverFailure describe_failure(const char* library, Status status, char* flag_name) {
        const std::unique_ptr<char, decltype(&std::free)> name(flag_name, &std::free);
        const std::string reason = message_.empty() ? fmt::format("{} returned", name.get()) : message_;
        if (not_finite_at_)
            return {Status::diverged, fmt::format("the right-hand side is not finite at {}; {}: {}{}",
                                                  format_time(*not_finite_at_), library, reason, last_state(sample()))};
        return {status, fmt::format("{}: {}", library, reason)};
    }
    void rethrow() {
        if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
    }
    // A segment as short as a rounding error, on which no solver can start: one explicit Euler step is exact there.
    void take_euler_step() {
        Numbers<dimension> rate(system_.size());
        system_.derivative(t_, y(), rate.data());
        ++evaluations_;
        for (int i = 0; i < system_.size(); ++i) y()[i] += (end_ - t_) * rate[i];
        t_ = end_;
        message_.clear();
    }

    // A rate that is not finite ends the run; otherwise the solver would try ever smaller steps up to its limit. The
    // return value -1 requests this, but the nonlinear solvers of SUNDIALS 6.4 treat it as a convergence failure and
    // retry. Therefore all calls after the first -1 also return -1.
    [[gnu::flatten]] static int right_hand_side(double t, N_Vector y, N_Vector rate, void* session) {
        SundialsSession* self = static_cast<SundialsSession*>(session);
        if (self->not_finite_at_ || self->exception_) return -1;
        double* dy = Vector::data(rate);
        t += self->offset_;
        ++self->evaluations_;
        try {
            self->system_.derivative(t, Vector::data(y), dy);
        } catch (...) {  // must not propagate through C code
            self->exception_ = std::current_exception();
            return -1;
        }
        double zeros[2] = {0, 0};
        for (int i = 0; i < self->system_.size(); ++i) zeros[i & 1] += dy[i] * 0;
        if (zeros[0] + zeros[1] == 0) return 0;
        self->not_finite_at_ = t;
        return -1;
    }

    // fills the matrix type of this vector size
    static int fill_jacobian(double t, N_Vector y, N_Vector, SUNMatrix J, void* session, N_Vector, N_Vector, N_Vector) {
        SundialsSession* self = static_cast<SundialsSession*>(session);
        if constexpr (dimension == run_time) {
            const int n = self->system_.size();
            std::vector<double> rows(static_cast<std::size_t>(n) * n);
            jacobian(self->system_, t + self->offset_, Vector::data(y), rows.data());
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) SM_ELEMENT_D(J, i, j) = rows[i * n + j];
            if (all_finite(rows)) return 0;
        } else {
            auto& entries = FixedMatrix<dimension>::entries(J);
            jacobian(self->system_, t + self->offset_, Vector::data(y), entries.data());
            if (entries.allFinite()) return 0;
        }
        self->not_finite_at_ = t + self->offset_;
        return -1;
    }

    // positive codes are warnings
    static void store_message(int code, const char*, const char*, char* text, void* session) {
        if (code <= 0) static_cast<SundialsSession*>(session)->message_ = text;
    }

    const Problem* problem_;
    SystemType system_;
    double tolerance_;
    SundialsContext context_;  // declared before the members that use it
    SundialsOwner<N_Vector> state_ = make_owner(make_vector<Vector>(context_, system_.size()));
    SundialsOwner<N_Vector> absolute_ = make_owner(make_vector<Vector>(context_, system_.size()));
    SundialsOwner<SUNNonlinearSolver> nonlinear_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    double t_ = 0, end_ = 0;
    double offset_ = 0;  // s, from the solver's clock to the motion's
    long evaluations_ = 0;
    std::optional<double> not_finite_at_;
    std::string message_;
    std::exception_ptr exception_;
};

}  // namespace polhode
