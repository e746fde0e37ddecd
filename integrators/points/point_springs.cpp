// Bodies made of points with stiff springs, integrated by explicit steps: Runge-Kutta of order 4 and velocity Verlet.
// SpringStepper holds the state; SpringRk4 and SpringVerlet are the steps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrators/points/point_runs.h"
#include "integrators/points/spring_network.h"
#include "integrators/points/stiffness.h"
#include "integrators/run/amplification.h"
#include "integrators/run/march.h"

namespace polhode {
namespace {

struct SpringSetup {
    const PointBody* body;
    double stiffness, damping;
    double* largest_stretch;
};

/// Holds y = (r, v) and computes its rate under springs and loads.
class SpringStepper {
  public:
    SpringStepper(const Problem& problem, const SpringSetup& setup)
        : body_(setup.body),
          largest_stretch_(setup.largest_stretch),
          n_(3 * static_cast<std::size_t>(setup.body->count())),
          motion_(problem, *setup.body),
          network_(*setup.body, setup.stiffness, setup.damping),
          y_(2 * n_) {}

    void restart() {
        network_.apply_rotation_stretch(motion_.initial(y_.data()), y_.data());
        evaluations_ = steps_ = 0;
        failure_time_.reset();
    }
    void enter(const Segment& segment) {
        if (const auto w = motion_.enter(segment, y_.data())) network_.apply_rotation_stretch(*w, y_.data());
    }
    Sample sample(double t) const {
        *largest_stretch_ = std::max(*largest_stretch_, polhode::largest_stretch(*body_, y_.data()));
        return motion_.sample(t, y_.data());
    }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return evaluations_; }
    bool failed() const { return failure_time_.has_value(); }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::diverged;
        trajectory.message = fmt::format("a spring's length is off by more than {:g} of its rest length at t = {:g} s",
                                         max_stretch, *failure_time_);
    }

  protected:
    using Numbers = std::vector<double>;

    // An unstable step may leave a finite state in which the points no longer form a body.
    void check_stretch(double t) {
        if ((++steps_ & 15) == 0 && polhode::largest_stretch(*body_, y_.data()) > max_stretch) failure_time_ = t;
    }
    void accelerate(double t, const double* y, double* a) {
        ++evaluations_;
        network_.accelerations(y, a);
        motion_.add_loads(t, y, a);
    }

    const PointBody* body_;
    double* largest_stretch_;
    std::size_t n_;  ///< 3N
    PointMotion motion_;
    SpringNetwork network_;
    Numbers y_;
    long evaluations_ = 0, steps_ = 0;
    static constexpr double max_stretch = 0.5;
    std::optional<double> failure_time_;
};

class SpringRk4 : public SpringStepper {
  public:
    static constexpr double stability = 2.8284271247461903;  ///< h w < 2 sqrt(2) on the imaginary axis

    SpringRk4(const Problem& problem, const SpringSetup& setup)
        : SpringStepper(problem, setup), k_(2 * n_), z_(2 * n_), sum_(2 * n_) {}

    void step(double t, double h) {
        rate(t, y_);
        sum_ = k_;
        advance(h / 2), rate(t + h / 2, z_), add(2);
        advance(h / 2), rate(t + h / 2, z_), add(2);
        advance(h), rate(t + h, z_), add(1);
        for (std::size_t i = 0; i < 2 * n_; ++i) y_[i] += h / 6 * sum_[i];
        check_stretch(t + h);
    }

  private:
    void rate(double t, const Numbers& y) {
        std::copy(y.begin() + static_cast<long>(n_), y.end(), k_.begin());
        accelerate(t, y.data(), k_.data() + n_);
    }
    void advance(double h) {
        for (std::size_t i = 0; i < 2 * n_; ++i) z_[i] = y_[i] + h * k_[i];
    }
    void add(double weight) {
        for (std::size_t i = 0; i < 2 * n_; ++i) sum_[i] += weight * k_[i];
    }
    Numbers k_, z_, sum_;
};

/// Kick, drift, kick. A load that depends on rates uses those predicted with the first kick's acceleration.
class SpringVerlet : public SpringStepper {
  public:
    static constexpr double stability = 2;

    SpringVerlet(const Problem& problem, const SpringSetup& setup) : SpringStepper(problem, setup), a_(n_) {}

    void enter(const Segment& segment) {
        SpringStepper::enter(segment);
        accelerate(segment.begin, y_.data(), a_.data());
    }
    void step(double t, double h) {
        for (std::size_t i = 0; i < n_; ++i) {
            y_[n_ + i] += h / 2 * a_[i];
            y_[i] += h * y_[n_ + i];
        }
        half_.assign(y_.begin() + static_cast<long>(n_), y_.end());
        for (std::size_t i = 0; i < n_; ++i) y_[n_ + i] += h / 2 * a_[i];
        accelerate(t + h, y_.data(), a_.data());
        for (std::size_t i = 0; i < n_; ++i) y_[n_ + i] = half_[i] + h / 2 * a_[i];
        check_stretch(t + h);
    }

  private:
    Numbers a_, half_;
};

template <class Stepper>
PointRun run_springs(const Problem& problem, const Settings& settings, const PointOptions& options) {
    const PointBody body = point_body(problem, options.arrangement);
    if (!body.refusal.empty()) return {unsupported(body.refusal)};
    PointRun run;
    const double stiffness = options.stiffness ? *options.stiffness : default_stiffness(problem, body);
    const SpringSetup setup{&body, stiffness, damping_from_ratio(body, stiffness, options.damping_ratio.value_or(0)),
                            &run.largest_stretch};
    run.trajectory = march<Stepper>(problem, settings, setup);
    if (run.trajectory.status == Status::diverged) {
        const double limit = Stepper::stability / spring_frequencies(body, setup.stiffness).fastest;
        if (run.trajectory.step > 0.9 * limit)
            run.trajectory.message +=
                fmt::format("; springs of {:.3g} N/m require steps below {:.2g} s", setup.stiffness, limit);
    }
    return run;
}

// (theta, v, a): theta+ = theta + v + a/2, a+ = -s theta+ - c (v + a), v+ = v + (a + a+) / 2. Computed from the
// coefficients of the characteristic polynomial det(x - M).
double verlet_pendulum_growth(double c, double s) {
    const double M[3][3] = {{1, 1, 0.5}, {-s / 2, 1 - (s + c) / 2, 0.5 - (s / 2 + c) / 2}, {-s, -s - c, -s / 2 - c}};
    const auto minor = [&](int i, int j) { return M[i][i] * M[j][j] - M[i][j] * M[j][i]; };
    const double determinant = M[0][0] * minor(1, 2) - M[0][1] * (M[1][0] * M[2][2] - M[1][2] * M[2][0]) +
                               M[0][2] * (M[1][0] * M[2][1] - M[1][1] * M[2][0]);
    const std::complex<double> powers[] = {M[0][0] + M[1][1] + M[2][2], -(minor(0, 1) + minor(0, 2) + minor(1, 2)),
                                           determinant};
    return largest_root(powers);
}

constexpr std::string_view springs_source =
    "an article on rotational dynamics for game programmers (a rigid body as points at hard distances, here springs)";

constexpr Method point_springs_variants[] = {
    {.name = "point_springs_rk4",
     .documentation =
         "A body made of eight points at the corners of a box (three if it is flat) with its mass, centre of mass and "
         "tensor, all connected by springs, by the classical Runge-Kutta scheme. The slowest vibration of the springs "
         "has 100 times the scene's largest rate. Order 4 for the motion on springs, which differs from the rigid "
         "motion by a stretch m w^2/k. Stable only if the step is shorter than 2.8 over the frequency of the fastest "
         "vibration. The attitude is the best-fit rotation of the points; w is computed from their angular momentum "
         "and tensor.",
     .source = springs_source,
     .origin = "article: point masses at fixed distances, by springs",
     .conserves = "momentum; angular momentum of a free body to the order of the scheme",
     .solve = [](const Problem& p, const Settings& s) { return point_springs_rk4(p, s, {}).trajectory; },
     .amplification = classical_amplification},
    {.name = "point_springs_verlet",
     .documentation =
         "The points and springs of `point_springs_rk4` by the velocity form of Verlet's scheme: one evaluation of "
         "the springs per step, stable if the step is shorter than 2 over the frequency of the fastest vibration. "
         "Order 2 for the motion on springs.",
     .source = "L. Verlet 1967, Phys. Rev. 159, 98-103; the body as in the article on rotational dynamics",
     .origin = "article: point masses at fixed distances, by springs",
     .conserves = "momentum and angular momentum of a free body to round-off; energy on average",
     .solve = [](const Problem& p, const Settings& s) { return point_springs_verlet(p, s, {}).trajectory; },
     .pendulum_amplification = verlet_pendulum_growth},
};

constexpr auto point_springs_family = apply_defaults(
    {.control = Control::fixed_step, .family = Family::points, .refusal = point_body_refusal}, point_springs_variants);

}  // namespace

PointRun point_springs_rk4(const Problem& problem, const Settings& settings, const PointOptions& options) {
    return run_springs<SpringRk4>(problem, settings, options);
}
PointRun point_springs_verlet(const Problem& problem, const Settings& settings, const PointOptions& options) {
    return run_springs<SpringVerlet>(problem, settings, options);
}

extern const std::span<const Method> point_springs_methods{point_springs_family};

}  // namespace polhode
