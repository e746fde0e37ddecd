// Runge-Kutta methods of order 4 on the rotation group: q by exponentials of body rates, L_W (and p, v) as vectors.
#include <span>

#include "integrators/geometric/momentum_state.h"
#include "integrators/run/amplification.h"

namespace polhode {
namespace {

/// The vectors of the state, or their rates.
struct VectorState {
    Vector3<double> momentum_W, position_W, velocity_W;
};

template <class Scheme>
class LieGroupStepper : public MomentumState {
  public:
    explicit LieGroupStepper(const Problem& problem) : MomentumState(problem) {}

    void step(double t, double h) {
        const Quaternion<double> q = attitude_.value();
        const VectorState start{momentum_.value(), position_.value(), velocity_.value()};
        VectorState k[4];
        // Body rates at time t + c h, with the attitude q (1 + d) and the vectors advanced by c h times `before`. The
        // rates of the vectors are stored in `slope`.
        const auto rates_at = [&](double c, const RotationIncrement& d, const VectorState& before, VectorState& slope) {
            const Quaternion<double> turned = q * Quaternion<double>{1 + d.w, d.v[0], d.v[1], d.v[2]};
            const Matrix3<double> R = rotation_matrix(turned);
            Vector3<double> L = start.momentum_W;
            if (!has_loads()) return rates(transposed(R) * L);
            L = L + (c * h) * before.momentum_W;
            const Vector3<double> w = rates(transposed(R) * L);
            Vector3<double> p, v;
            if (translates_) {
                p = start.position_W + (c * h) * before.position_W;
                v = start.velocity_W + (c * h) * before.velocity_W;
                slope.position_W = v;
                slope.velocity_W = acceleration_W(R, v);
            }
            slope.momentum_W = torque_W(t + c * h, R, turned, w, p, v);
            return w;
        };
        Scheme::advance_attitude(h, rates_at, k, attitude_);
        evaluations_ += 4;
        if (!has_loads()) return;
        const auto sum = [&](Vector3<double> VectorState::*part) {
            return (h / 6) * ((k[0].*part + k[3].*part) + 2.0 * (k[1].*part + k[2].*part));
        };
        momentum_.add(sum(&VectorState::momentum_W));
        if (!translates_) return;
        position_.add(sum(&VectorState::position_W));
        velocity_.add(sum(&VectorState::velocity_W));
    }
};

/// Classical tableau for the rotation vector u of q exp(u), du/dt = w + u x w / 2 + u x (u x w) / 12 + O(u^4).
struct MuntheKaas {
    template <class RateFunction>
    static void advance_attitude(double h, const RateFunction& rates_at, VectorState* k,
                                 CompensatedAttitude& attitude) {
        const auto pulled_back = [](const Vector3<double>& u, const Vector3<double>& w) {
            const Vector3<double> across = cross(u, w);
            return w + (0.5 * across + (1.0 / 12) * cross(u, across));
        };
        const Vector3<double> k1 = rates_at(0, RotationIncrement{}, k[0], k[0]);
        const Vector3<double> u2 = (h / 2) * k1;
        const Vector3<double> k2 = pulled_back(u2, rates_at(0.5, rotation_increment(u2), k[0], k[1]));
        const Vector3<double> u3 = (h / 2) * k2;
        const Vector3<double> k3 = pulled_back(u3, rates_at(0.5, rotation_increment(u3), k[1], k[2]));
        const Vector3<double> u4 = h * k3;
        const Vector3<double> k4 = pulled_back(u4, rates_at(1, rotation_increment(u4), k[2], k[3]));
        attitude.rotate(rotation_increment((h / 6) * ((k1 + k4) + 2.0 * (k2 + k3))));
    }
};

/// Five exponentials, no commutators.
struct CommutatorFree {
    template <class RateFunction>
    static void advance_attitude(double h, const RateFunction& rates_at, VectorState* k,
                                 CompensatedAttitude& attitude) {
        const Vector3<double> k1 = rates_at(0, RotationIncrement{}, k[0], k[0]);
        const RotationIncrement half = rotation_increment((h / 2) * k1);
        const Vector3<double> k2 = rates_at(0.5, half, k[0], k[1]);
        const Vector3<double> k3 = rates_at(0.5, rotation_increment((h / 2) * k2), k[1], k[2]);
        const Vector3<double> k4 = rates_at(1, compose(half, rotation_increment(h * (k3 - 0.5 * k1))), k[2], k[3]);
        const Vector3<double> middle = 2.0 * (k2 + k3);
        attitude.rotate(compose(rotation_increment((h / 12) * (3.0 * k1 + middle - k4)),
                                rotation_increment((h / 12) * (3.0 * k4 + middle - k1))));
    }
};

template <class Scheme>
Trajectory solve_lie_group(const Problem& problem, const Settings& settings) {
    return march_momentum<LieGroupStepper<Scheme>>(problem, settings);
}

constexpr std::string_view lie_group_invariants = "|q|; L in world axes exactly if no torque acts; not energy";

constexpr Method lie_group_variants[] = {
    {.name = "munthe_kaas4",
     .documentation =
         "The classical Runge-Kutta method on the rotation group: the stages are rotation vectors from the start of "
         "the step, their rates pulled back by the inverse differential of exp. The state is the angular momentum in "
         "world axes, which is therefore constant without torque. Supports all loads. Order 4.",
     .source = "H. Munthe-Kaas 1998, BIT 38, 92; H. Munthe-Kaas & B. Owren 1999, Phil. Trans. R. Soc. A 357, 957",
     .solve = solve_lie_group<MuntheKaas>},
    {.name = "commutator_free4",
     .documentation =
         "A commutator-free Runge-Kutta method on the rotation group, by products of five exponentials per step. The "
         "state is the angular momentum in world axes, which is therefore constant without torque. Supports all "
         "loads. Order 4.",
     .source = "E. Celledoni, A. Marthinsen & B. Owren 2003, Future Gener. Comput. Syst. 19, 341",
     .solve = solve_lie_group<CommutatorFree>},
};

constexpr auto lie_group_family = apply_defaults({.conserves = lie_group_invariants,
                                                  .control = Control::fixed_step,
                                                  .order = 4,
                                                  .amplification = classical_amplification,
                                                  .family = Family::rotation_group},
                                                 lie_group_variants);

}  // namespace

extern const std::span<const Method> lie_group_methods{lie_group_family};

}  // namespace polhode
