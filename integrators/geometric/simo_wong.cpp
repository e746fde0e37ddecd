// The energy- and momentum-conserving algorithm of J. C. Simo & K. K. Wong (1991), in its trapezoidal form (ALGO_C1):
//
//   L+ = L + h (tau + tau+)/2,   q+ = q exp(theta),   theta = h (w + w+)/2,   w+ = I^-1 R(q+)^T L+
//
// Without loads L is constant. Then theta . (y+ - y) = 0, since exp(theta) leaves theta unchanged, so energy is
// conserved.
#include <span>

#include "integrators/geometric/momentum_state.h"
#include "integrators/geometric/newton.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <class S>
class SimoWongStepper : public MomentumStateOf<S> {
    using Base = MomentumStateOf<S>;
    using Base::attitude_, Base::momentum_, Base::evaluations_, Base::has_loads, Base::rates, Base::torque_W,
        Base::failed_, Base::failed_at_, Base::forcing, Base::inverse_moments_;

  public:
    explicit SimoWongStepper(const Problem& problem) : Base(problem) {}

    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Quaternion<S> q = attitude_.value();
        const Matrix3<S> R = rotation_matrix(q);
        const Vector3<S> L = momentum_.value(), y = transposed(R) * L, w = rates(y);
        const bool torque_acts = has_loads();
        const Vector3<S> torque = torque_acts ? torque_W(t, R, q, w, {}, {}) : Vector3<S>();
        ++evaluations_;

        Vector3<S> torque_later, y_later;
        const auto residual = [&](const Vector3<S>& theta) {
            const RotationIncrementOf<S> d = rotation_increment(theta);
            const Quaternion<S> q_later = q * Quaternion<S>{1 + d.w, d.v[0], d.v[1], d.v[2]};
            const Matrix3<S> R_later = rotation_matrix(q_later);
            Vector3<S> L_later = L;
            if (torque_acts) {
                torque_later = torque_W(t + h, R_later, q_later, (2 / h) * theta - w, {}, {});
                L_later = L + (h / 2) * (torque + torque_later);
            }
            ++evaluations_;
            y_later = transposed(R_later) * L_later;
            return theta - (h / 2) * (w + rates(y_later));
        };
        // d y+ = y+ x dtheta to lowest order in theta, and drag through the rates.
        const auto slope = [&](const Vector3<S>&) {
            Matrix3<S> M = skew(y_later);
            if (forcing().has_damping)
                for (int i = 0; i < 3; ++i) M[i] = M[i] - forcing().damping[i];
            for (int i = 0; i < 3; ++i) {
                M[i] = (S(-0.5) * h * inverse_moments_[i]) * M[i];
                M[i][i] += 1;
            }
            return M;
        };
        // Includes the terms omitted above, for torques that change fast with the attitude.
        const auto measured_slope = [&](const Vector3<S>& theta) { return measure_slope(residual, theta); };
        const Vector3<S> guess = h * (w + (h / 2) * rates(cross(y, w) + transposed(R) * torque));
        y_later = y;
        Vector3<S> theta = guess;
        if (!solve_to_rounding(theta, residual, slope)) {
            theta = guess;
            if (!solve_to_rounding(theta, residual, measured_slope)) {
                failed_ = true, failed_at_ = t;
                return;
            }
        }
        attitude_.rotate(rotation_increment(theta));
        if (torque_acts) momentum_.add((h / 2) * (torque + torque_later));
    }

  private:
    // The derivative of the residual by central differences. The width is about the cube root of the rounding unit,
    // which balances rounding and truncation errors of the difference.
    template <class Residual>
    static Matrix3<S> measure_slope(const Residual& residual, const Vector3<S>& theta) {
        constexpr S width = S(std::is_same_v<S, double> ? 1e-6 : 4e-3);
        Matrix3<S> M;
        for (int j = 0; j < 3; ++j) {
            Vector3<S> up = theta, down = theta;
            up[j] += width, down[j] -= width;
            const Vector3<S> difference = residual(up) - residual(down);
            for (int i = 0; i < 3; ++i) M[i][j] = difference[i] / (2 * width);
        }
        return M;
    }
};

constexpr Method simo_wong_variants[] = {
    {.name = "simo_wong",
     .documentation =
         "The implicit algorithm of Simo & Wong in its trapezoidal form (their ALGO_C1): the momentum balance in world "
         "axes, the attitude by the exponential of the mean of the body rates at both ends of the step. Solved to "
         "round-off. Supports all loads on a body whose rotation does not depend on its translation. Order 2.",
     .source = "J. C. Simo & K. K. Wong 1991, Int. J. Numer. Methods Eng. 31, 19",
     .conserves = "|q|; L in world axes exactly and energy to round-off if no torque acts",
     .control = Control::fixed_step,
     .order = 2,
     .solve = march_momentum<SimoWongStepper<double>>,
     .amplification = midpoint_amplification},
};

constexpr auto simo_wong_binary64_family =
    apply_defaults({.family = Family::rotation_group, .refusal = translation_refusal}, simo_wong_variants);

constexpr auto simo_wong_family =
    with_binary32<simo_wong_binary64_family, binary32_refusal, march_momentum<SimoWongStepper<float>>>();

}  // namespace

extern const std::span<const Method> simo_wong_methods{simo_wong_family};

}  // namespace polhode
