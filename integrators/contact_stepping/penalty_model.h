// Contact of one body with planes as a force: the equations of motion of a stiff ODE.
//
// The tolerance R of a run sets the stiffness. With the size L of the hull (m), the weight m g for g = 9.81 m/s^2, and
// for each pair of a plane and a piece of the hull the depth s = -gap (m), the normal velocity u_n and the slip u_t:
//   spring and damper    N = max(0, k s - c u_n),              k = m g / (R L),  c = 2 zeta (k / K_nn)^(1/2) min(1, s /
//   s_r) Hunt and Crossley    N = max(0, k s^(3/2) (1 - a u_n)),    k = m g / (R L^(3/2)),  a = d / u_0 friction F =
//   -mu N u_t / (|u_t|^2 + v_s^2)^(1/2),  v_s = R (g L)^(1/2)
// K_nn is the change of u_n by a unit impulse. The damper starts over the depth s_r = R L / 1000, so that the force is
// continuous. zeta and d follow from the restitution e (at least R^(1/3)) by the closed
// forms of an impact without other forces:
//   ln(1/e) = zeta / w ln((zeta + w) / (zeta - w)),  w = (zeta^2 - 1)^(1/2)    (Schwager and Poeschel 2007)
//   d (1 + e) = ln((1 + d) / (1 - e d))                                        (Marhefka and Orin 1999)
// u_0 is the approach speed at first touch. It is a component of the state: in flight it follows the approach speed,
// du_0/dt = (max(-u_n, v_min) - u_0) / tau, and in contact it is constant. v_min is the speed of a fall through the
// depth under the weight.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "motion/contact.h"
#include "motion/systems.h"
#include "motion/user_system.h"

namespace polhode::contact_stepping {

enum class PenaltyLaw { spring_damper, hunt_crossley };

/// The ratio of the speeds after and before an impact of a spring with the damping ratio zeta > 0 that does not pull.
inline double spring_restitution(double zeta) {
    if (zeta == 1) return std::exp(-2.0);
    if (zeta > 1) {
        const double w = std::sqrt((zeta - 1) * (zeta + 1));
        return std::exp(-2 * zeta / w * std::log(zeta + w));
    }
    const double w = std::sqrt((1 - zeta) * (1 + zeta));
    return std::exp(-zeta / w * std::atan2(2 * zeta * w, 2 * zeta * zeta - 1));
}

/// The root of a function that falls from a positive value at `low` to a negative one at `high`.
template <class Function>
double bisect(double low, double high, const Function& function) {
    for (int i = 0; i < 200; ++i) {
        const double middle = low + (high - low) / 2;
        if (!(middle > low && middle < high)) break;
        (function(middle) > 0 ? low : high) = middle;
    }
    return low;
}

/// The damping ratio zeta of the spring and damper with the restitution e > 0.
inline double damping_ratio(double e) {
    if (!(e < 1)) return 0;
    return bisect(0, 1 / e, [&](double zeta) { return spring_restitution(zeta) - e; });
}

/// The damping d = a u_0 of Hunt and Crossley's law with the restitution e > 0.
inline double hunt_crossley_damping(double e) {
    if (!(e < 1)) return 0;
    // the difference of both sides is zero at 0, positive up to d and then falls to -infinity at 1 / e
    const auto excess = [&](double d) { return d * (1 + e) - std::log1p(d) + std::log1p(-e * d); };
    return bisect((1 - e) / 2, 1 / e, excess);
}

/// One body and its planes as a system with 13 components, and one for each contact in Hunt and Crossley's law.
class PenaltyModel : public ErasedModel {
  public:
    /// `problem` must outlive the model, and be posed in the full formulation.
    PenaltyModel(const Problem& problem, PenaltyLaw law, double tolerance)
        : problem_(&problem), geometry_(problem.body.geometry.get()), law_(law), tolerance_(tolerance), body_(problem) {
        if (!geometry_->any()) return;
        const double mass = problem.body.mass, size = geometry_->reach;
        const bool linear = law == PenaltyLaw::spring_damper;
        stiffness_ = mass * gravity / (tolerance * (linear ? size : size * std::sqrt(size)));
        slip_speed_ = tolerance * std::sqrt(gravity * size);
        least_impact_ = std::sqrt(gravity * size * (linear ? tolerance : std::cbrt(tolerance * tolerance)));
        delay_ = 0.1 * std::sqrt(tolerance * size / gravity);
        for (const ContactPlane<double>& plane : geometry_->planes) {
            const double e = std::max(plane.restitution, std::cbrt(tolerance));
            damping_.push_back(linear ? damping_ratio(e) : hunt_crossley_damping(e));
        }
    }

    int dimension() const override {
        return BodyState::motion + (law_ == PenaltyLaw::hunt_crossley ? static_cast<int>(contacts()) : 0);
    }
    void initial(double* y) const override {
        body_.initial(y);
        for (std::size_t k = 0; k < memories(); ++k) {
            const Contact<double> contact = contact_at(k, y);
            y[BodyState::motion + k] = std::max(-contact.normal_velocity, least_impact_);
        }
    }
    void derivative(const double* y, double* dy) const override { rates(y, dy); }
    void derivative(const Dual<jacobian_directions>* y, Dual<jacobian_directions>* dy) const override { rates(y, dy); }
    void derivative(const Traced<double>*, Traced<double>*) const override { refuse_series(); }
    void derivative(const Traced<long double>*, Traced<long double>*) const override { refuse_series(); }
    std::vector<double> scales() const override {
        std::vector<double> all(static_cast<std::size_t>(dimension()), problem_->scales.velocity);
        body_.scales(all.data());
        if (!geometry_->any()) return all;
        // Depths are resolved relative to the body, not to its path. A body that starts at rest is moved by its loads.
        const double size = geometry_->reach, spin = std::sqrt(gravity / size), speed = std::sqrt(gravity * size);
        std::fill_n(all.begin(), 3, std::max(all[0], spin));
        std::fill_n(all.begin() + 7, 3, size);
        std::fill(all.begin() + 10, all.end(), std::max(all[10], speed));
        return all;
    }
    std::vector<Sample> motion(const double* y) const override { return {body_.motion(0, y)}; }
    std::vector<Reaction<double>> reactions(const double*) const override { return {}; }
    std::vector<double> events() const override {
        std::vector<double> times;
        for (const Segment& segment : problem_->segments) times.push_back(segment.begin);
        return times;
    }
    bool projects() const override { return false; }
    void project(double*) const override {}
    double kinetic_energy(const Bodies&) const override { return 0; }
    double energy_bound() const override { return std::numeric_limits<double>::infinity(); }
    std::shared_ptr<const ErasedModel> enter_event(double t, double* y) const override {
        auto next = std::make_shared<PenaltyModel>(*this);
        next->body_.enter(problem_->segments[segment_at(*problem_, t)], y);
        return next;
    }

  private:
    static constexpr double gravity = 9.81;  // m/s^2

    template <class S>
    struct Contact {
        Vector3<S> normal_B, arm_B, velocity_B;
        S gap{}, normal_velocity{};
    };

    const Problem* problem_;
    const ContactGeometry<double>* geometry_;
    PenaltyLaw law_;
    double tolerance_;
    FullMotion body_;
    double stiffness_ = 0, slip_speed_ = 0, least_impact_ = 0, delay_ = 1;
    std::vector<double> damping_;  // zeta or d, by plane

    std::size_t contacts() const { return geometry_->any() ? geometry_->size() : 0; }
    // contacts with a component u_0
    std::size_t memories() const { return law_ == PenaltyLaw::hunt_crossley ? contacts() : 0; }

    [[noreturn]] static void refuse_series() { throw std::logic_error("penalty forces have no Taylor series"); }
    static double number(double x) { return x; }
    static double number(const Dual<jacobian_directions>& x) { return x.value; }

    template <class S>
    Contact<S> contact_at(std::size_t k, const S* y) const {
        const ContactPlane<double>& plane = geometry_->planes[k / geometry_->pieces.size()];
        const SupportPiece<double>& piece = geometry_->pieces[k % geometry_->pieces.size()];
        const Quaternion<S> q = BodyState::attitude(y);
        const S scale = S(1) / squared_norm(q);
        Contact<S> c;
        c.normal_B = scale * rotate_back(q, plane.normal_W);
        c.arm_B = cast<S>(piece.center) - piece.radius * c.normal_B;
        if (piece.extended) {
            const Vector3<S> a = transposed(piece.semi_axes) * c.normal_B;
            // a disc that lies flat has no lowest point: its centre
            const S size = square_root(dot(a, a) + S(1e-30 * geometry_->reach * geometry_->reach));
            c.arm_B = c.arm_B - (S(1) / size) * (piece.semi_axes * a);
        }
        c.gap = dot(plane.normal_W, BodyState::position(y)) + dot(c.normal_B, c.arm_B) - plane.offset;
        c.velocity_B = scale * rotate_back(q, BodyState::velocity(y)) + cross(BodyState::angular_velocity(y), c.arm_B);
        c.normal_velocity = dot(c.normal_B, c.velocity_B);
        return c;
    }

    // N of a contact with a negative gap, N; u_0: approach speed at first touch
    template <class S>
    S normal_force(const Contact<S>& c, double damping, const S* u_0) const {
        const S depth = -c.gap;
        if (law_ == PenaltyLaw::hunt_crossley)
            return stiffness_ * (depth * square_root(depth)) * (S(1) - (damping / *u_0) * c.normal_velocity);
        const Vector3<S> moment = cross(c.arm_B, c.normal_B);
        const S K = 1 / problem_->body.mass + dot(moment, body_.inertia.inverse * moment);
        const double full_depth = 1e-3 * tolerance_ * geometry_->reach;
        S c_n = (2 * damping * std::sqrt(stiffness_)) / square_root(K);
        if (number(depth) < full_depth) c_n = (1 / full_depth) * depth * c_n;
        return stiffness_ * depth - c_n * c.normal_velocity;
    }

    template <class S>
    void rates(const S* y, S* dy) const {
        body_.derivative(0, y, dy);
        Vector3<S> force, moment;  // body axes
        bool touches = false;
        for (std::size_t k = 0; k < contacts(); ++k) {
            const Contact<S> c = contact_at(k, y);
            const bool closed = number(c.gap) < 0;
            const S* u_0 = memories() > 0 ? y + BodyState::motion + k : nullptr;
            if (u_0) {
                const S approach = -number(c.normal_velocity) > least_impact_ ? -c.normal_velocity : S(least_impact_);
                dy[BodyState::motion + k] = closed ? S(0) : (1 / delay_) * (approach - *u_0);
            }
            if (!closed) continue;
            const std::size_t plane = k / geometry_->pieces.size();
            const S N = normal_force(c, damping_[plane], u_0);
            if (!(number(N) > 0)) continue;
            const Vector3<S> slip = c.velocity_B - c.normal_velocity * c.normal_B;
            const S size = square_root(dot(slip, slip) + S(slip_speed_ * slip_speed_));
            const Vector3<S> f = N * c.normal_B - (geometry_->planes[plane].friction / size * N) * slip;
            force = force + f, moment = moment + cross(c.arm_B, f);
            touches = true;
        }
        if (!touches) return;
        const Quaternion<S> q = BodyState::attitude(y);
        put(dy, 0, vector_at(dy, 0) + body_.inertia.inverse * moment);
        put(dy, 10, vector_at(dy, 10) + (1 / problem_->body.mass / squared_norm(q)) * rotate(q, force));
    }
};

}  // namespace polhode::contact_stepping
