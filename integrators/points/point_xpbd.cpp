// Bodies made of points at fixed distances, by position-based dynamics as used in games.
//
// A step of length h: v += h a; r_old = r, r += h v; then, `iterations` times, each distance in turn (Gauss-Seidel)
//   dlambda = (l - |d| - alpha/h^2 lambda) / (2/m + alpha/h^2),   alpha = 0: hard,
//   r_i += dlambda/m d/|d|, and the opposite for r_j
// and v = (r - r_old) / h. The remainder of a step after an event may be as short as its rounding error, and cannot
// be divided by. Below 1/64 of a step, the points only drift.
#include <algorithm>
#include <cmath>

#include "integrators/points/point_runs.h"
#include "integrators/run/march.h"

namespace polhode {
namespace {

struct XpbdSetup {
    const PointBody* body;
    int iterations;
    double* largest_stretch;
    double min_step;  ///< s
};

class XpbdPoints {
  public:
    XpbdPoints(const Problem& problem, const XpbdSetup& setup)
        : setup_(setup),
          n_(3 * static_cast<std::size_t>(setup.body->count())),
          motion_(problem, *setup.body),
          y_(2 * n_),
          a_(n_) {
        double squares = 0;
        for (const double c : setup.body->pivot_weights) squares += c * c;
        pivot_gain_ = squares > 0 ? 1 / squares : 0;
    }

    void restart() {
        motion_.initial(y_.data());
        sweeps_ = 0;
    }
    void enter(const Segment& segment) { motion_.enter(segment, y_.data()); }

    void step(double t, double h) {
        double *r = y_.data(), *v = r + n_;
        std::fill(a_.begin(), a_.end(), 0.0);
        motion_.add_loads(t, r, a_.data());
        previous_positions_.assign(r, r + n_);
        for (std::size_t i = 0; i < n_; ++i) {
            v[i] += h * a_[i];
            r[i] += h * v[i];
        }
        if (h < setup_.min_step) return;
        for (int k = 0; k < setup_.iterations; ++k) sweep(r);
        for (std::size_t i = 0; i < n_; ++i) v[i] = (r[i] - previous_positions_[i]) / h;
    }

    Sample sample(double t) const {
        *setup_.largest_stretch = std::max(*setup_.largest_stretch, largest_stretch(*setup_.body, y_.data()));
        return motion_.sample(t, y_.data());
    }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return sweeps_; }

  private:
    // Masses are equal: each end moves half of the correction.
    void sweep(double* r) {
        ++sweeps_;
        for (const PointLink& link : setup_.body->links) {
            const Vector3<double> d = vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
            const double length = std::sqrt(dot(d, d));
            const Vector3<double> move = (0.5 * (link.length - length) / length) * d;
            put(r, 3 * link.i, vector_at(r, 3 * link.i) + move);
            put(r, 3 * link.j, vector_at(r, 3 * link.j) - move);
        }
        if (!setup_.body->pivoted) return;
        const std::vector<double>& c = setup_.body->pivot_weights;
        Vector3<double> pivot_point;
        for (std::size_t i = 0; i < c.size(); ++i)
            pivot_point = pivot_point + c[i] * vector_at(r, 3 * static_cast<int>(i));
        for (std::size_t i = 0; i < c.size(); ++i) {
            const int at = 3 * static_cast<int>(i);
            put(r, at, vector_at(r, at) - (pivot_gain_ * c[i]) * pivot_point);
        }
    }

    XpbdSetup setup_;
    std::size_t n_;
    PointMotion motion_;
    double pivot_gain_ = 0;
    std::vector<double> y_, a_, previous_positions_;
    long sweeps_ = 0;
};

constexpr Method point_xpbd_variants[] = {
    {.name = "point_xpbd",
     .documentation =
         "A body made of eight points at the corners of a box (three if it is flat) at fixed distances, by "
         "position-based dynamics with compliance 0: each step moves the points freely, then corrects the distances "
         "one after the other in ten passes (counted as evaluations), and computes the velocities from the "
         "displacements. Order 1.",
     .source = "M. Macklin, M. Mueller & N. Chentanez 2016, XPBD: position-based simulation of compliant constrained "
               "dynamics, Motion in Games",
     .origin = "article: point masses at fixed distances, as in games",
     .conserves = "momentum of a free body",
     .control = Control::fixed_step,
     .order = 1,
     .solve = [](const Problem& p, const Settings& s) { return point_xpbd(p, s, {}).trajectory; }},
};

constexpr auto point_xpbd_family =
    apply_defaults({.family = Family::points, .refusal = point_body_refusal}, point_xpbd_variants);

}  // namespace

PointRun point_xpbd(const Problem& problem, const Settings& settings, const PointOptions& options) {
    const PointBody body = point_body(problem, options.arrangement);
    if (!body.refusal.empty()) return {unsupported(body.refusal)};
    PointRun run;
    const double step = longest_step(problem, settings);
    run.trajectory =
        march<XpbdPoints>(problem, settings, XpbdSetup{&body, options.iterations, &run.largest_stretch, step / 64});
    return run;
}

extern const std::span<const Method> point_xpbd_methods{point_xpbd_family};

}  // namespace polhode
