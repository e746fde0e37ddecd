// Base of the SUNDIALS sessions for bodies made of points: state, time and the library's error messages.
#pragma once

#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "integrators/points/point_motion.h"
#include "integrators/run/watch.h"
#include "integrators/sundials/sundials_handles.h"
#include "integrators/sundials/sundials_session.h"
#include "motion/finite.h"
#include "motion/systems.h"

namespace polhode {

/// Must not be moved: the library holds pointers into it.
class PointSession {
  public:
    PointSession(const PointSession&) = delete;
    PointSession& operator=(const PointSession&) = delete;

    double time() const { return t_; }
    /// The motion at time(). Its stretch is included in largest_stretch().
    Sample sample() { return sample_at(t_, y()); }
    /// The motion at time(), without recording its stretch.
    Sample current_motion() { return motion_.sample(t_, y()); }
    double largest_stretch() const { return largest_stretch_; }
    long rhs_evaluations() const { return evaluations_; }

  protected:
    /// State: r and v of every point, then `extra` numbers. Tolerances are absolute: R times the size of each
    /// component, which is the extent of the points for r, and that times the scene's largest rate for v. Distant
    /// flight therefore does not reduce the accuracy of the attitude.
    PointSession(const Problem& problem, const PointBody& body, double tolerance, int extra)
        : body_(&body),
          motion_(problem, body),
          n_(3 * body.count()),
          dimension_(2 * n_ + extra),
          // Values too small for binary64 were refused before. Below 1e-100 the weights, which are reciprocals, would
          // overflow.
          tolerance_(std::max(tolerance, 1e-100)),
          rate_(std::max(problem.scales.angular_velocity, 1 / problem.scene.duration)),
          state_(make_owner(N_VNew_Serial(dimension_, context_))),
          absolute_(make_owner(N_VNew_Serial(dimension_, context_))),
          interpolated_(make_owner(N_VNew_Serial(dimension_, context_))) {
        N_VConst(0, state_.get());
        N_VConst(tolerance_ * body.extent, absolute_.get());
        double* absolute = N_VGetArrayPointer(absolute_.get());
        std::fill(absolute + n_, absolute + 2 * n_, tolerance_ * body.extent * rate_);
    }
    ~PointSession() = default;

    static void check_flag(int flag) {
        if (flag != 0) throw std::bad_alloc();
    }
    double* y() { return N_VGetArrayPointer(state_.get()); }
    Sample sample_at(double t, const double* y) {
        largest_stretch_ = std::max(largest_stretch_, polhode::largest_stretch(*body_, y));
        return motion_.sample(t, y);
    }

    // Same as PointMotion::initial() and PointMotion::enter().
    Vector3<double> reset_state() {
        N_VConst(0, state_.get());
        evaluations_ = 0;
        not_finite_at_.reset();
        return motion_.initial(y());
    }
    std::optional<Vector3<double>> apply_event(const Segment& segment) {
        t_ = segment.begin, end_ = segment.end;
        return motion_.enter(segment, y());
    }
    // Covers a segment whose length is a rounding error, on which no solver can start.
    void take_euler_step() {
        for (int i = 0; i < n_; ++i) y()[i] += (end_ - t_) * y()[n_ + i];
        t_ = end_;
        message_.clear();
    }
    // Returns 0, or -1 (unrecoverable) if numbers are not finite: see SundialsSession::right_hand_side.
    int check_finite(double t, const double* numbers, int count) {
        if (all_finite({numbers, static_cast<std::size_t>(count)})) return 0;
        not_finite_at_ = t;
        return -1;
    }
    bool has_failed() const { return not_finite_at_ || exception_; }
    void rethrow() {
        if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
    }
    SolverFailure describe_failure(const char* library, Status status, char* flag_name) {
        const std::unique_ptr<char, decltype(&std::free)> name(flag_name, &std::free);
        const std::string reason = message_.empty() ? fmt::format("{} returned", name.get()) : message_;
        if (not_finite_at_)
            return {Status::diverged, fmt::format("the right-hand side is not finite at {}; {}: {}{}",
                                                  format_time(*not_finite_at_), library, reason, last_state(sample()))};
        return {status, fmt::format("{}: {}", library, reason)};
    }
    // Codes above zero are warnings.
    static void store_message(int code, const char*, const char*, char* text, void* session) {
        if (code <= 0) static_cast<PointSession*>(session)->message_ = text;
    }

    const PointBody* body_;
    PointMotion motion_;
    int n_, dimension_;  ///< 3N; 6N plus `extra`
    double tolerance_;
    double rate_;              ///< rad/s, largest rate of the scene
    SundialsContext context_;  // declared before everything that uses it
    SundialsOwner<N_Vector> state_, absolute_, interpolated_;
    double t_ = 0, end_ = 0;
    long evaluations_ = 0;
    std::optional<double> not_finite_at_;
    std::string message_;
    std::exception_ptr exception_;
    double largest_stretch_ = 0;
};

}  // namespace polhode
