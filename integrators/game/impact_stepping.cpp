// Impacts in fixed steps, as in game engines: a body that penetrates a plane after a step is reflected.
#include <fmt/format.h>

#include <array>

#include "integrators/run/amplification.h"
#include "integrators/run/march.h"
#include "motion/contact.h"

namespace polhode {
namespace {

enum class Detection { after_the_step, by_halving };

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
        times_.clear();
    }
    void enter(const Segment& segment) { system_.enter(segment, y_.data()); }
    void step(double t, double h) {
        if (!problem_->body.geometry->any()) return advance(t, h);
        if constexpr (detection == Detection::after_the_step) {
            advance(t, h);
            strike(t + h, 0);
        } else {
            halve(t, h);
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
        trajectory.impact_times = times_;
        if (trajectory.status == Status::ok && !times_.empty())
            trajectory.message = fmt::format("{} impact{}, the last at t = {:.10g} s", times_.size(),
                                             times_.size() == 1 ? "" : "s", times_.back());
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
    void strike(double t, double tolerance) {
        if (resolve_plane_impacts(*problem_, tolerance, y_.data()).has_impact) times_.push_back(t);
    }
    double distance() const { return problem_->body.geometry->distance(placement_of(y_.data())); }

    // A part of the step that ends too deep is repeated with half its length. The number of parts per step is
    // limited: after that (as for a body at rest), the remainder is taken in one part.
    void halve(double t, double h) {
        constexpr int most_parts = 1000;
        const double deep = -allowed_depth * problem_->body.geometry->reach, shortest = std::ldexp(h, -48);
        double left = h, part = h;
        for (int parts = 0; left > 0; ++parts) {
            const State before = y_;
            const double begun = distance();
            advance(t, part);
            const double reached = distance();
            if (reached < deep && reached < begun && part > shortest && parts < most_parts) {
                y_ = before;
                part /= 2;
                continue;
            }
            t += part, left -= part;
            if (reached <= 0) strike(t, 0);
            part = left;
        }
    }

    const Problem* problem_;
    SystemType system_;
    State y_{};
    long evaluations_ = 0;
    std::vector<double> times_;
};

template <Detection detection>
Trajectory solve_steps(const Problem& problem, const Settings& settings) {
    if (problem.formulation == Formulation::full) return march<ImpactStepper<FullMotion, detection>>(problem, settings);
    return march<ImpactStepper<LoadedMotion, detection>>(problem, settings);
}

constexpr Method each[] = {
    {.name = "impact_stepping",
     .documentation =
         "Semi-implicit Euler as in game engines, with impacts detected after the step: if a step ends with the body "
         "inside a plane and approaching it, the impulse is applied at the end of the step, to the deep contacts. The "
         "body is not pushed out. An impact is up to one step late, and a thin dip within a step is missed.",
     .source =
         "E. Catto 2005-2015, GDC talks on sequential impulses; C. Hecker 1997, Game Developer, \"Physics, Part 4\" "
         "(the impulse)",
     .solve = solve_steps<Detection::after_the_step>},
    {.name = "impact_halving",
     .documentation =
         "`impact_stepping` with the rule of game-physics lectures: a step that ends too deep in a plane is repeated "
         "at half its length until the body is no deeper than 10^-6 of its size. Then the impulse is applied and the "
         "remainder of the step is taken. The impact time is therefore that of the step's own motion.",
     .source =
         "C. Hecker 1997, Game Developer, \"Physics, Part 3: Collision Response\"; lecture slides on game physics "
         "after it",
     .solve = solve_steps<Detection::by_halving>},
};

constexpr auto list = apply_defaults({.conserves = "|q|; at an impact, the invariants of the impulse",
                                      .control = Control::fixed_step,
                                      .planes = true,
                                      .order = 1,
                                      .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                                      .family = Family::published_update},
                                     each);

}  // namespace

extern const std::span<const Method> impact_stepping_methods{list};

}  // namespace polhode
