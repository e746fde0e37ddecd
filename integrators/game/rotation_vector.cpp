// Axis and angle as the integrated state: the rotation vector theta of q = q_c exp(theta/2), and w in body axes, with
//   dtheta/dt = w + 1/2 theta x w + (1 - (|theta|/2) cot(|theta|/2)) / |theta|^2 theta x (theta x w)
// which is the inverse of the differential of exp. The chart ends at |theta| = 2 pi; it is centred anew, q_c <- q and
// theta <- 0, as soon as |theta| > pi/2.
#include <cmath>
#include <numbers>
#include <span>

#include "body/orientation.h"
#include "integrators/game/charted_motion.h"
#include "integrators/game/explicit_step.h"
#include "integrators/kernels/linear_growth.h"
#include "integrators/march.h"

namespace polhode {
namespace {

struct RotationVectorChart {
    Quaternion<double> centre;

    Quaternion<double> quaternion(const Vector3<double>& theta) const {
        return centre * quaternion_from_rotation_vector(theta);
    }
    Vector3<double> rate(const Vector3<double>& theta, const Vector3<double>& w) const {
        const double square = dot(theta, theta);
        double factor = 0;
        if (square < 0.01) {  // x/2 cot x/2 = 1 - x^2/12 - x^4/720 - x^6/30240 - x^8/1209600 - ..
            factor = 1.0 / 12 + square * (1.0 / 720 + square * (1.0 / 30240 + square / 1209600));
        } else {
            const double half = std::sqrt(square) / 2;
            factor = (1 - half / std::tan(half)) / square;
        }
        const Vector3<double> across = cross(theta, w);
        return w + (0.5 * across + factor * cross(theta, across));
    }
};

class RotationVector {
  public:
    explicit RotationVector(const Problem& problem)
        : problem_(&problem), motion_{system_on<FullMotion<double>>(problem, problem.segments.front()), {}} {
        restart();
    }
    void restart() {
        const ExactBody<double>& body = problem_->body;
        motion_.chart.centre = body.q;
        put(y_.data(), 0, body.angular_velocity_B);
        put(y_.data(), 3, Vector3<double>());
        put(y_.data(), 6, body.position_W);
        put(y_.data(), 9, body.velocity_W);
        steps_ = 0;
    }
    void enter(const Segment& segment) {
        enter_charted(*problem_, segment, motion_.chart, y_.data());
        motion_.body = system_on<FullMotion<double>>(*problem_, segment);
    }
    void step(double t, double h) {
        const auto rate = [this](double at, const ChartedState& y) {
            ChartedState dy{};
            motion_.derivative(at, y.data(), dy.data());
            return dy;
        };
        ClassicalRungeKutta::step(rate, t, y_, h);
        const Vector3<double> theta = vector_at(y_.data(), 3);
        constexpr double quarter = std::numbers::pi / 2;
        if (dot(theta, theta) > quarter * quarter) {
            motion_.chart.centre = normalized(motion_.chart.quaternion(theta));
            put(y_.data(), 3, Vector3<double>());
        }
        ++steps_;
    }
    Sample sample(double t) const { return sample_charted(*problem_, t, motion_.chart, y_.data()); }
    bool finite() const { return all_finite(y_) && std::isfinite(squared_norm(motion_.chart.centre)); }
    long rhs_evaluations() const { return steps_ * ClassicalRungeKutta::evaluations; }

  private:
    const Problem* problem_;
    ChartedMotion<RotationVectorChart> motion_;
    ChartedState y_{};
    long steps_ = 0;
};

Trajectory solve(const Problem& problem, const Settings& settings) {
    return march<RotationVector>(pose(problem.scene, Formulation::full), settings);
}

const Method family[] = {
    {.name = "rotation_vector",
     .documentation =
         "Axis and angle in one vector theta as the integrated attitude, with w in body axes, by the classical "
         "Runge-Kutta method: dtheta/dt is the inverse differential of exp applied to w (Bortz's equation). Where "
         "|theta| exceeds pi/2 the vector starts again from zero at the attitude reached, so that its singularity at "
         "2 pi is never met. Order 4.",
     .source =
         "J. E. Bortz 1971, A new mathematical formulation for strapdown inertial navigation, IEEE Trans. Aerosp. "
         "Electron. Syst. AES-7, 61-66; H. Munthe-Kaas 1999, Appl. Numer. Math. 29, 115-127",
     .described_as = "slides: axis-angle representation, integrated",
     .conserves = "|q| to round-off",
     .control = Control::fixed_step,
     .order = 4,
     .solve = solve,
     .growth = classical_growth},
};

}  // namespace

extern const std::span<const Method> rotation_vector_methods;
const std::span<const Method> rotation_vector_methods = family;

}  // namespace polhode
