// Axis and angle as the integrated state: the rotation vector theta of q = q_c exp(theta/2), and w in body axes, with
//   dtheta/dt = w + 1/2 theta x w + (1 - (|theta|/2) cot(|theta|/2)) / |theta|^2 theta x (theta x w),
// the inverse of the differential of exp. The chart ends at |theta| = 2 pi. It is recentred, q_c <- q and theta <- 0,
// as soon as |theta| > pi/2.
#include <cmath>
#include <numbers>
#include <span>

#include "body/orientation.h"
#include "integrators/game/charted_motion.h"
#include "integrators/game/explicit_step.h"
#include "integrators/run/amplification.h"
#include "integrators/run/march.h"

namespace polhode {
namespace {

template <class S>
struct RotationVectorChart {
    Quaternion<S> centre;

    Vector3<S> start(const Quaternion<double>& q) {
        centre = cast<S>(q);
        return {};
    }
    Quaternion<S> quaternion(const Vector3<S>& theta) const { return centre * quaternion_from_rotation_vector(theta); }
    Vector3<S> rate(const Vector3<S>& theta, const Vector3<S>& w) const {
        const S square = dot(theta, theta);
        S factor = 0;
        if (square < S(0.01)) {  // x/2 cot x/2 = 1 - x^2/12 - x^4/720 - x^6/30240 - x^8/1209600 - ..
            factor = S(1.0 / 12) + square * (S(1.0 / 720) + square * (S(1.0 / 30240) + square / 1209600));
        } else {
            const S half = std::sqrt(square) / 2;
            factor = (1 - half / std::tan(half)) / square;
        }
        const Vector3<S> across = cross(theta, w);
        return w + (S(0.5) * across + factor * cross(theta, across));
    }
};

template <class S>
class RotationVectorStepper {
  public:
    explicit RotationVectorStepper(const Problem& problem) : motion_(problem) { restart(); }
    void restart() {
        motion_.initial(y_.data());
        steps_ = 0;
    }
    void enter(const Segment& segment) { motion_.enter(segment, y_.data()); }
    void step(double t, double h) {
        const auto rate = [this](double at, const State& y) {
            State dy{};
            motion_.derivative(at, y.data(), dy.data());
            return dy;
        };
        ClassicalRungeKutta::step(rate, t, y_, S(h));
        const Vector3<S> theta = Motion::coordinates(y_.data());
        constexpr S quarter = std::numbers::pi_v<S> / 2;
        if (dot(theta, theta) > quarter * quarter) {
            motion_.chart().centre = normalized(motion_.chart().quaternion(theta));
            Motion::set_coordinates(y_.data(), {});
        }
        ++steps_;
    }
    Sample sample(double t) const { return motion_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_) && all_finite(motion_.chart().centre); }
    long rhs_evaluations() const { return steps_ * ClassicalRungeKutta::evaluations; }

  private:
    using Motion = ChartedMotion<RotationVectorChart<S>, S>;
    using State = std::array<S, Motion::dimension>;

    Motion motion_;
    State y_{};
    long steps_ = 0;
};

template <class S>
Trajectory solve_rotation_vector(const Problem& problem, const Settings& settings) {
    return march<RotationVectorStepper<S>>(problem, settings);
}

constexpr Method rotation_vector_variants[] = {
    {.name = "rotation_vector",
     .documentation =
         "The attitude as a rotation vector theta (axis times angle), with w in body axes, by the classical "
         "Runge-Kutta method: dtheta/dt is the inverse differential of exp applied to w (Bortz's equation). If "
         "|theta| exceeds pi/2, the vector restarts from zero at the current attitude, so that it never reaches "
         "its singularity at 2 pi. Order 4.",
     .source =
         "J. E. Bortz 1971, A new mathematical formulation for strapdown inertial navigation, IEEE Trans. Aerosp. "
         "Electron. Syst. AES-7, 61-66; H. Munthe-Kaas 1999, Appl. Numer. Math. 29, 115-127",
     .origin = "slides: axis-angle representation, integrated",
     .conserves = "|q| to round-off",
     .control = Control::fixed_step,
     .order = 4,
     .solve = solve_rotation_vector<double>,
     .amplification = classical_amplification},
};

constexpr auto rotation_vector_binary64_family =
    apply_defaults({.family = Family::published_update, .formulation = Formulation::full}, rotation_vector_variants);

constexpr auto rotation_vector_family =
    with_binary32<rotation_vector_binary64_family, binary32_system_refusal, solve_rotation_vector<float>>();

}  // namespace

extern const std::span<const Method> rotation_vector_methods{rotation_vector_family};

}  // namespace polhode
