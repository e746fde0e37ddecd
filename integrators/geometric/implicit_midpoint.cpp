// The implicit midpoint rule on the first-order system: y+ = y + h k, k = f(t + h/2, y + h k/2).
//
// It conserves every quadratic form that f conserves, since (y+ - y) . Q (y+ + y) = 2 h k . Q (y + h k/2) = 0 (G. J.
// Cooper 1987, IMA J. Numer. Anal. 7, 1): |q|^2; |I w|^2 and the energy of a free body; the energy with gravity about
// a pivot or with springs, because the right-hand side uses |q|^2 R(q), which makes the energy quadratic in q.
#include <algorithm>
#include <cmath>
#include <span>

#include "integrators/closed_form/compensated_rotation.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"
#include "integrators/run/march.h"
#include "integrators/series/linear_algebra.h"
#include "motion/jacobian.h"
#include "motion/numbers.h"

namespace polhode {
namespace {

template <class SystemType>
class ImplicitMidpoint {
    static constexpr int N = SystemType::dimension;
    using S = typename SystemType::Scalar;
    using Column = Eigen::Matrix<S, N, 1>;
    using Square = Eigen::Matrix<S, N, N, Eigen::RowMajor>;

  public:
    explicit ImplicitMidpoint(const Problem& problem) : problem_(&problem), system_(problem) {
        system_.scales(scales_.data());
        restart();
    }
    void restart() {
        system_.initial(y_.data());
        clear_history();
        evaluations_ = 0, failed_ = false;
    }
    void enter(const Segment& segment) {
        system_.enter(segment, y_.data());
        clear_history();
    }
    void step(double t, double step) {
        const S h = S(step);
        Column k = predict_slope(t, h);
        if (stiff_ || !iterate_fixed_point(t, h, k)) {
            stiff_ = true;
            k = slope(t, current_state());
            if (!iterate_newton(t, h, k)) {
                failed_ = true, failed_at_ = t;
                return;
            }
        }
        before_last_ = last_, last_ = k, history_length_ = h == last_h_ ? history_length_ + 1 : 1, last_h_ = h;
        for (int i = 0; i < system_.size(); ++i) {
            CompensatedSumOf<S> sum{y_[i], rounding_errors_[i]};
            sum.add(h * k[i]);
            y_[i] = sum.value, rounding_errors_[i] = sum.lost;
        }
        if (project_step(system_, y_.data())) clear_history();
    }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const { report_unsolved_step(trajectory, sample(failed_at_)); }

  private:
    const Problem* problem_;
    SystemType system_;
    alignas(32) Numbers<N, S> y_{system_.size()};
    Numbers<N, S> rounding_errors_ = y_;
    Numbers<N> scales_{system_.size()};
    Column last_ = Column::Zero(system_.size()), before_last_ = last_;  ///< k of the previous steps
    S last_h_ = 0;
    int history_length_ = 0;
    bool stiff_ = false;  ///< fixed-point iteration does not contract
    long evaluations_ = 0;
    double failed_at_ = 0;
    bool failed_ = false;

    void clear_history() {
        for (S& lost : rounding_errors_) lost = 0;
        history_length_ = 0, last_h_ = 0, stiff_ = false;
    }
    Column current_state() const { return Eigen::Map<const Column>(y_.data(), system_.size()); }
    Column slope(double t, const Column& z) {
        alignas(32) Numbers<N, S> from(system_.size()), to = from;
        Eigen::Map<Column>(from.data(), system_.size()) = z;
        system_.derivative(t, from.data(), to.data());
        ++evaluations_;
        return Eigen::Map<const Column>(to.data(), system_.size());
    }
    // Predicts k from the previous one or two steps.
    Column predict_slope(double t, S h) {
        if (h == last_h_ && history_length_ > 1) return 2 * last_ - before_last_;
        return slope(t, current_state());
    }
    // Largest component of the change h dk, in units of the scales.
    double change_size(S h, const Column& change) const {
        double worst = 0;
        for (int i = 0; i < system_.size(); ++i) worst = std::max(worst, std::abs(double(h * change[i])) / scales_[i]);
        return worst;
    }
    static constexpr double rounding = std::numeric_limits<S>::epsilon() / 4, near = 256 * rounding;

    // Fixed-point iteration k <- f(y + h k/2) to rounding. Returns false if it does not contract well.
    bool iterate_fixed_point(double t, S h, Column& k) {
        constexpr int max_iterations = 30;
        const Column y = current_state();
        double before = INFINITY;
        for (int i = 0; i < max_iterations; ++i) {
            const Column next = slope(t + h / 2, y + (S(0.5) * h) * k);
            const double moved = change_size(h, next - k);
            k = next;
            if (moved <= rounding) return true;
            if (moved >= 0.25 * before) return moved <= near;
            before = moved;
        }
        return false;
    }
    // Newton's method for k - f(y + h k/2) = 0, with the Jacobian at the initial guess. The Jacobian is recomputed if
    // the iteration contracts slowly.
    bool iterate_newton(double t, S h, Column& k) {
        constexpr int max_iterations = 60;
        const Column y = current_state();
        Eigen::PartialPivLU<Square> factors;
        const auto factorise = [&] {
            const Eigen::Matrix<double, N, 1> middle = (y + (S(0.5) * h) * k).template cast<double>();
            const int n = system_.size();
            Eigen::Matrix<double, N, N, Eigen::RowMajor> J(n, n);
            jacobian(system_, t + h / 2, middle.data(), J.data());
            factors.compute(Square::Identity(n, n) - (S(0.5) * h) * J.template cast<S>());
        };
        factorise();
        double before = INFINITY;
        for (int i = 0; i < max_iterations; ++i) {
            const Column change = factors.solve(k - slope(t + h / 2, y + (S(0.5) * h) * k));
            k -= change;
            const double moved = change_size(h, change);
            if (!(moved < INFINITY)) return false;
            if (moved <= rounding || (moved >= 0.25 * before && moved <= near)) return true;
            if (moved > 0.1 * before) factorise();
            before = moved;
        }
        return false;
    }
};

template <class S>
Trajectory solve_implicit_midpoint(const Problem& problem, const Settings& settings) {
    return with_system_in<S>(
        problem, [&]<class SystemType>() { return march<ImplicitMidpoint<SystemType>>(problem, settings); });
}

constexpr Method implicit_midpoint_variants[] = {
    {.name = "implicit_midpoint",
     .documentation =
         "The implicit midpoint rule on the first-order system, solved to round-off: by fixed-point iteration, or by "
         "Newton's method where that does not contract (stiff loads). It conserves every quadratic form that the "
         "equations conserve. Supports all loads. Order 2.",
     .source = "E. Hairer, C. Lubich & G. Wanner 2006, Geometric Numerical Integration, IV.2; G. J. Cooper 1987, IMA "
               "J. Numer. Anal. 7, 1",
     .conserves = "|q|; energy of a free body, in uniform gravity about a pivot and under springs; |L|, but not L, of "
                  "a free body; all to round-off",
     .control = Control::fixed_step,
     .general_systems = true,
     .order = 2,
     .solve = solve_implicit_midpoint<double>,
     .amplification = midpoint_amplification},
};

constexpr auto implicit_midpoint_binary64_family =
    apply_defaults({.family = Family::runge_kutta}, implicit_midpoint_variants);

constexpr auto implicit_midpoint_family =
    with_binary32<implicit_midpoint_binary64_family, binary32_system_refusal, solve_implicit_midpoint<float>>();

}  // namespace

extern const std::span<const Method> implicit_midpoint_methods{implicit_midpoint_family};

}  // namespace polhode
