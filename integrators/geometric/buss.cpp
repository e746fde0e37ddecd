// The augmented second-order method of S. R. Buss (2000): one rotation by
//
//   h (w + h/2 dw/dt + h^2/12 dw/dt x w)
//
// with the vectors in world axes. A rotation by a world vector equals a rotation by its components in the current
// body axes applied from the other side, so the formula is evaluated in body axes. There dw/dt = I^-1 (tau - w x y)
// is the derivative in either frame. (Only the sign of the rates' second derivative distinguishes the frames.)
#include <span>

#include "integrators/geometric/momentum_state.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <class S>
class BussStepper : public MomentumStateOf<S> {
    using Base = MomentumStateOf<S>;
    using Base::attitude_, Base::momentum_, Base::evaluations_, Base::has_loads, Base::rates, Base::torque_W;

  public:
    explicit BussStepper(const Problem& problem) : Base(problem) {}

    void step(double t, double step) {
        const S h = S(step);
        const Quaternion<S> q = attitude_.value();
        const Matrix3<S> R = rotation_matrix(q), back = transposed(R);
        const Vector3<S> L = momentum_.value(), y = back * L, w = rates(y);
        const bool torque_acts = has_loads();
        Vector3<S> torque, acceleration = rates(cross(y, w));
        if (torque_acts) {
            torque = torque_W(t, R, q, w, {}, {});
            acceleration = rates(cross(y, w) + back * torque);
        }
        ++evaluations_;
        attitude_.rotate(
            rotation_increment(h * (w + ((h / 2) * acceleration + (h * h / 12) * cross(acceleration, w)))));
        if (!torque_acts) return;
        // Mean of the torques at both ends. The final torque uses the rates of the predicted momentum.
        const Quaternion<S> q_later = attitude_.value();
        const Matrix3<S> R_later = rotation_matrix(q_later);
        const Vector3<S> w_later = rates(transposed(R_later) * (L + h * torque));
        momentum_.add((h / 2) * (torque + torque_W(t + h, R_later, q_later, w_later, {}, {})));
        ++evaluations_;
    }
};

// a = -c v - s theta, theta+ = theta + v + a/2, v+ = v + (a - c (v + a) - s theta+) / 2. The cross product is of
// second order in the angle.
double buss_pendulum_growth(double c, double s) {
    const double theta_of_theta = 1 - s / 2, theta_of_v = 1 - c / 2;
    return spectral_radius(theta_of_theta, theta_of_v, (-s + c * s - s * theta_of_theta) / 2,
                           1 + (-c - c * (1 - c) - s * theta_of_v) / 2);
}

constexpr Method buss_variants[] = {
    {.name = "buss",
     .documentation =
         "The augmented second-order method of Buss: one rotation per step, by a rate corrected with the angular "
         "acceleration and its cross product with the rate. The state is the angular momentum in world axes; torques "
         "change it by the mean of their values at both ends of the step. Explicit. Supports all loads on a body "
         "whose rotation does not depend on its translation. Order 2.",
     .source = "S. R. Buss 2000, J. Comput. Phys. 164, 377",
     .conserves = "|q|; L in world axes exactly if no torque acts; not energy",
     .control = Control::fixed_step,
     .order = 2,
     .solve = march_momentum<BussStepper<double>>,
     .pendulum_amplification = buss_pendulum_growth},
};

constexpr auto buss_binary64_family =
    apply_defaults({.family = Family::rotation_group, .refusal = translation_refusal}, buss_variants);

constexpr auto buss_family =
    with_binary32<buss_binary64_family, binary32_refusal, march_momentum<BussStepper<float>>>();

}  // namespace

extern const std::span<const Method> buss_methods{buss_family};

}  // namespace polhode
