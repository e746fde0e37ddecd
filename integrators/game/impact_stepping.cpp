// Impacts in fixed steps, as in game engines: a body that penetrates a plane after a step is reflected.
#include <fmt/format.h>

#include <array>

#include "integrators/run/amplification.h"
#include "integrators/run/march.h"
#include "motion/contact.h"

namespace polhode {
namespace {

enum class Detection { step_end, halving };

/// Halving continues until the body's depth in a plane is below this fraction of its size.
constexpr double allowed_depth = 1e-6;

/// Semi-implicit Euler: w and v from the old state, then q and p from the new w and v.
///   w += h I^-1 (tau - w x I w),  v += h a,  q += h/2 q (0, w), normalised,  p += h v
template <class SystemType, Detection detection>
class ImpactStepper {
  public:
    explicit ImpactStepper(const Problem& problem) : problem_(&problem), system_(problem) { restart(); }
    void restart() {
        system_.initial(y_.data());
        evaluations_ = 0;
        impact_times_.clear();
    }
    void enter(const Segment& segment) { system_.enter(segment, y_.data()); }
    void step(double t, double h) {
        if (!problem_->body.geometry->any()) return advance(t, h);
        if constexpr (detection == Detection::step_end) {
            advance(t, h);
            apply_impacts(t + h, 0);
        } else {
            step_by_halving(t, h);
        }
    }
    Sample sample(double t) const {
        Sample s = system_.motion(t, y_.data());
        if (problem_->body.pivoted)
            pivoted_center(s.q, s.angular_velocity_B, problem_->body.arm, s.position_W, s.velocity_W);
        return s;
    }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }
    /// Reports the impacts since restart().
    void report(Trajectory& trajectory) const {
        trajectory.impact_times = impact_times_;
        if (trajectory.status == Status::ok && !impact_times_.empty())
            trajectory.message = fmt::format("{} impact{}, the last at t = {:.10g} s", impact_times_.size(),
                                             impact_times_.size() == 1 ? "" : "s", impact_times_.back());
    }

  private:
    using State = std::array<double, SystemType::dimension>;

    void advance(double t, double h) {
        State rate{};
        system_.derivative(t, y_.data(), rate.data());
        ++evaluations_;
        for (int i : {0, 1, 2, 10, 11, 12}) y_[i] += h * rate[i];
        const Vector3<double> w = SystemType::angular_velocity(y_.data());
        const Quaternion<double> q = SystemType::attitude(y_.data()), dq = attitude_rate(h / 2, q, w);
        SystemType::set_rotation(y_.data(), w,
                                 normalized(Quaternion<double>{q.w + dq.w, q.x + dq.x, q.y + dq.y, q.z + dq.z}));
        for (int i = 7; i < 10; ++i) y_[i] += h * y_[i + 3];
    }
    void apply_impacts(double t, double tolerance) {
        if (resolve_plane_impacts(*problem_, tolerance, y_.data()).has_impact) impact_times_.push_back(t);
    }
    double distance() const { return problem_->body.geometry->distance(placement_of(y_.data())); }

    // A part of the step that ends too deep is repeated with half its length. The number of parts per step is
    // limited: after that (as for a body at rest), the remainder is taken in one part.
    void step_by_halving(double t, double h) {
        constexpr int max_substeps = 1000;
        const double depth_limit = -allowed_depth * problem_->body.geometry->reach, shortest = std::ldexp(h, -48);
        double remaining = h, substep = h;
        for (int substeps = 0; remaining > 0; ++substeps) {
            const State before = y_;
            const double distance_before = distance();
            advance(t, substep);
            const double distance_after = distance();
            if (distance_after < depth_limit && distance_after < distance_before && substep > shortest &&
                substeps < max_substeps) {
                y_ = before;
                substep /= 2;
                continue;
            }
            t += substep, remaining -= substep;
            if (distance_after <= 0) apply_impacts(t, 0);
            substep = remaining;
        }
    }

    const Problem* problem_;
    SystemType system_;
    State y_{};
    long evaluations_ = 0;
    std::vector<double> impact_times_;
};

template <Detection detection>
Trajectory solve_impact_stepping(const Problem& problem, const Settings& settings) {
    if (problem.formulation == Formulation::full) return march<ImpactStepper<FullMotion, detection>>(problem, settings);
    return march<ImpactStepper<LoadedMotion, detection>>(problem, settings);
}

constexpr Method impact_stepping_variants[] = {
    {.name = "impact_stepping",
     .documentation =
         "Semi-implicit Euler as in game engines, with impacts detected after the step: if a step ends with the body "
         "inside a plane and approaching it, the impulse is applied at the end of the step, to the deep contacts. The "
         "body is not pushed out. An impact is up to one step late, and a thin dip within a step is missed.",
     .source =
         "E. Catto 2005-2015, GDC talks on sequential impulses; C. Hecker 1997, Game Developer, \"Physics, Part 4\" "
         "(the impulse)",
     .solve = solve_impact_stepping<Detection::step_end>},
    {.name = "impact_halving",
     .documentation =
         "`impact_stepping` with the rule of game-physics lectures: a step that ends too deep in a plane is repeated "
         "at half its length until the body is no deeper than 10^-6 of its size. Then the impulse is applied and the "
         "remainder of the step is taken. The impact time is therefore that of the step's own motion.",
     .source =
         "C. Hecker 1997, Game Developer, \"Physics, Part 3: Collision Response\"; lecture slides on game physics "
         "after it",
     .solve = solve_impact_stepping<Detection::halving>},
};

constexpr auto impact_stepping_family =
    apply_defaults({.conserves = "|q|; at an impact, the invariants of the impulse",
                    .control = Control::fixed_step,
                    .planes = true,
                    .order = 1,
                    .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                    .family = Family::published_update},
                   impact_stepping_variants);

}  // namespace

extern const std::span<const Method> impact_stepping_methods{impact_stepping_family};

}  // namespace polhode
