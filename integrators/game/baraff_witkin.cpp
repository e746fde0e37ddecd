// The rigid body of A. Witkin & D. Baraff's course: state x, q, P, L in world axes,
//   dx/dt = P / m,  dq/dt = 1/2 (0, w) q,  dP/dt = F,  dL/dt = tau,  w = I_W^-1 L,  I_W^-1 = R I^-1 R^T.
//
// As in the course's listing, R is computed from the normalised q, but the q of the state is not normalised. With a
// pivot, L, tau and I are about the pivot, and x, v follow from q, w.
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "body/orientation.h"
#include "integrators/game/explicit_step.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"
#include "integrators/run/march.h"
#include "motion/world_loads.h"

namespace polhode {
namespace {

template <class Scheme, class S>
class BaraffWitkin {
  public:
    explicit BaraffWitkin(const Problem& problem)
        : problem_(&problem),
          loads_(problem),
          pivoted_(problem.body.pivoted),
          mass_(S(problem.body.mass)),
          inverse_inertia_B_(cast<S>(problem.body.full_inertia.inverse)) {
        restart();
    }
    void restart() {
        const ExactBody<double>& body = problem_->body;
        put(y_.data(), 0, cast<S>(body.position_W));
        put(y_.data(), 3, cast<S>(body.q));
        put(y_.data(), 7, cast<S>(body.mass * body.velocity_W));
        put(y_.data(), 10, cast<S>(rotate(body.q, body.inertia_B * body.angular_velocity_B)));
        steps_ = 0;
    }
    void enter(const Segment& segment) {
        loads_.enter(segment);
        const Auxiliary now = auxiliary(y_);
        Vector3<S> L = vector_at(y_.data(), 10), v = now.v;
        WorldLoads<S>::apply_impulses(*problem_, segment, now.R, now.x, L, v);
        if (segment.impulses.empty()) return;
        put(y_.data(), 7, mass_ * v);
        put(y_.data(), 10, L);
    }
    [[gnu::flatten]] void step(double t, double h) {
        Scheme::step([this](double at, const State& y) { return rate(at, y); }, t, y_, S(h));
        ++steps_;
    }
    Sample sample(double t) const {
        const Auxiliary now = auxiliary(y_);
        Sample s;
        s.t = t, s.q = cast<double>(quaternion_at(y_.data(), 3));
        s.angular_velocity_B = cast<double>(transposed(now.R) * now.w);
        s.position_W = cast<double>(now.x), s.velocity_W = cast<double>(now.v);
        // Beyond the scalar's range q / |q| is zero, which is not an attitude.
        if (!has_length()) s.q.w = std::numeric_limits<double>::infinity();
        return s;
    }
    bool finite() const { return all_finite(y_) && has_length(); }
    long rhs_evaluations() const { return steps_ * Scheme::evaluations; }

  private:
    using State = std::array<S, 13>;  ///< x, q, P, L

    bool has_length() const { return std::isfinite(squared_norm(quaternion_at(y_.data(), 3))); }

    /// The course's auxiliary variables.
    struct Auxiliary {
        Matrix3<S> R;
        Quaternion<S> q;  ///< unit
        Vector3<S> w, x, v;
    };
    Auxiliary auxiliary(const State& y) const {
        Auxiliary now;
        now.q = normalized(quaternion_at(y.data(), 3));
        now.R = rotation_matrix(now.q);
        now.w = now.R * (inverse_inertia_B_ * (transposed(now.R) * vector_at(y.data(), 10)));
        if (pivoted_) {
            now.x = now.R * loads_.forcing().arm;
            now.v = cross(now.w, now.x);
        } else {
            now.x = vector_at(y.data(), 0);
            now.v = (1 / mass_) * vector_at(y.data(), 7);
        }
        return now;
    }
    State rate(double t, const State& y) const {
        const Auxiliary now = auxiliary(y);
        const Quaternion<S> spin{0, now.w[0] / 2, now.w[1] / 2, now.w[2] / 2};
        State dy{};
        put(dy.data(), 3, spin * quaternion_at(y.data(), 3));
        put(dy.data(), 10,
            loads_.torque_W(
                t, now.R, [&] { return now.q; }, now.w, now.x, now.v));
        if (!pivoted_) {
            put(dy.data(), 0, now.v);
            put(dy.data(), 7, mass_ * loads_.acceleration_W(now.R, now.v));
        }
        return dy;
    }

    const Problem* problem_;
    WorldLoads<S> loads_;
    bool pivoted_;
    S mass_;
    Matrix3<S> inverse_inertia_B_;
    State y_{};
    long steps_ = 0;
};

template <class Scheme, class S = double>
Trajectory solve_baraff_witkin(const Problem& problem, const Settings& settings) {
    return march<BaraffWitkin<Scheme, S>>(problem, settings);
}

constexpr std::string_view baraff_witkin_source =
    "D. Baraff, An Introduction to Physically Based Modeling: Rigid Body Simulation I, SIGGRAPH course notes 1997 (the "
    "Pixar course of A. Witkin & D. Baraff)";
constexpr std::string_view baraff_witkin_invariants = "L in world axes exactly if no torque acts";

constexpr Method baraff_witkin_variants[] = {
    {.name = "baraff_witkin_rk4",
     .documentation =
         "The Pixar course's state x, q, P, L by the classical Runge-Kutta method of order 4. w = R I^-1 R^T L, so no "
         "term w x Iw appears. R is computed from the normalised q. The length of q itself drifts.",
     .origin = "the Pixar course that the article recommends",
     .order = 4,
     .solve = solve_baraff_witkin<ClassicalRungeKutta>,
     .amplification = classical_amplification},
    {.name = "baraff_witkin_euler",
     .documentation =
         "The Pixar course's state x, q, P, L by explicit Euler steps. Each step lengthens q by the factor sqrt(1 "
         "+ h^2 w^2 / 4), which does not affect R(q/|q|). Order 1.",
     .origin = "the Pixar course's Euler step",
     .order = 1,
     .solve = solve_baraff_witkin<ExplicitEuler>,
     .amplification = explicit_euler_amplification},
};

constexpr auto baraff_witkin_binary64_family = apply_defaults({.source = baraff_witkin_source,
                                                               .conserves = baraff_witkin_invariants,
                                                               .control = Control::fixed_step,
                                                               .family = Family::published_update,
                                                               .formulation = Formulation::full},
                                                              baraff_witkin_variants);

constexpr auto baraff_witkin_family =
    with_binary32<baraff_witkin_binary64_family, binary32_refusal, solve_baraff_witkin<ClassicalRungeKutta, float>,
                  solve_baraff_witkin<ExplicitEuler, float>>();

}  // namespace

extern const std::span<const Method> baraff_witkin_methods{baraff_witkin_family};

}  // namespace polhode
