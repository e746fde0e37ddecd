// The update of D. Fleck's slides after C. Hecker, with angular momentum in world axes and the orientation as a
// matrix, and its variants. FleckStepper is the stepper; its template arguments select the attitude representation and
// the inertia update.
//
// A step of length h, in the slides' order:
//   forces and torque at the old state,
//   1. x += h v
//   2. A += h skew(w) A, the old w
//   3. v += h F / m,  L += h tau
//   4. A re-orthogonalised by its columns
//   5. I_W^-1 = A I^-1 A^T,  w = I_W^-1 L
// The slides do not treat held bodies: with a pivot, L, tau and I are about the pivot, and x, v follow from A, w.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "body/orientation.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"
#include "integrators/run/march.h"
#include "motion/world_loads.h"

namespace polhode {
namespace {

Quaternion<double> nan_quaternion() {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan};
}

/// A += h skew(w) A, with the slide's re-orthogonalisation or without.
template <bool repaired, class S>
class IncrementalMatrix {
  public:
    void start(const Quaternion<S>& q) { A_ = rotation_matrix(q); }
    void rotate_by(const Vector3<S>& w, S h) { A_ = A_ + skew(h * w) * A_; }
    void repair() {
        if constexpr (repaired) A_ = reorthogonalise(A_);
    }
    const Matrix3<S>& matrix() const { return A_; }
    Quaternion<double> quaternion() const {
        const Matrix3<double> A = cast<double>(A_);
        if constexpr (repaired) return quaternion_from_rotation(A);
        const double det = determinant(A);
        return std::isfinite(det) && det > 0 ? quaternion_from_rotation(nearest_rotation(A)) : nan_quaternion();
    }
    double orthogonality_defect() const { return polhode::orthogonality_defect(cast<double>(A_)); }

  private:
    Matrix3<S> A_;
};

/// q += (h/2) (0, w) q, then normalised.
template <class S>
class IncrementalQuaternion {
  public:
    void start(const Quaternion<S>& q) {
        q_ = q;
        A_ = rotation_matrix(q_);
    }
    void rotate_by(const Vector3<S>& w, S h) {
        const Vector3<S> half = (h / 2) * w;
        const Quaternion<S> change = Quaternion<S>{0, half[0], half[1], half[2]} * q_;
        q_ = {q_.w + change.w, q_.x + change.x, q_.y + change.y, q_.z + change.z};
    }
    void repair() {
        q_ = normalized(q_);
        A_ = rotation_matrix(q_);
    }
    const Matrix3<S>& matrix() const { return A_; }
    Quaternion<double> quaternion() const { return cast<double>(q_); }

  private:
    Quaternion<S> q_;
    Matrix3<S> A_;
};

/// Three vertices at unit distance along the body axes, each rotated incrementally: V = R(h w) V. A is computed from
/// them and re-orthogonalised; the vertices are not corrected.
template <class S>
class AccumulatedVertices {
  public:
    void start(const Quaternion<S>& q) { A_ = vertices_ = rotation_matrix(q); }
    void rotate_by(const Vector3<S>& w, S h) {
        vertices_ = rotation_matrix(quaternion_from_rotation_vector(h * w)) * vertices_;
    }
    void repair() { A_ = reorthogonalise(vertices_); }
    const Matrix3<S>& matrix() const { return A_; }
    Quaternion<double> quaternion() const { return quaternion_from_rotation(cast<double>(A_)); }
    double orthogonality_defect() const { return polhode::orthogonality_defect(cast<double>(vertices_)); }

  private:
    Matrix3<S> vertices_, A_;  ///< one vertex per column
};

/// w = A I^-1 A^T L, with the inverse in body axes computed once.
template <class S>
class TransformedInertia {
  public:
    explicit TransformedInertia(const Problem& problem) : inverse_B_(cast<S>(problem.body.full_inertia.inverse)) {}
    Vector3<S> angular_velocity(const Matrix3<S>& A, const Vector3<S>& L) const {
        return A * (inverse_B_ * (transposed(A) * L));
    }

  private:
    Matrix3<S> inverse_B_;
};

/// w = I_W^-1 L with I_W = sum m_i (r_i^2 1 - r_i r_i^T) over the world points r_i = A r_i(0), recomputed at every
/// step.
///
/// The points are eight masses m/8 at (+-a, +-b, +-c) in principal axes: I_1 = m (b^2 + c^2) and cyclic, so that a^2
/// = (I_2 + I_3 - I_1) / (2 m) and cyclic gives the body's tensor.
template <class S>
class ResummedInertia {
  public:
    explicit ResummedInertia(const Problem& problem) : mass_(S(problem.body.mass / 8)) {
        const Vector3<double>& I = problem.body.principal.moments;
        Vector3<double> half_extents;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            // For a flat body this difference is zero up to rounding.
            half_extents[i] = std::sqrt(std::max(I[j] + I[k] - I[i], 0.0) / (2 * problem.body.mass));
        }
        for (std::size_t n = 0; n < points_B_.size(); ++n)
            points_B_[n] = cast<S>(
                rotate(problem.body.principal.q_BP, Vector3<double>((n & 1U) ? half_extents[0] : -half_extents[0],
                                                                    (n & 2U) ? half_extents[1] : -half_extents[1],
                                                                    (n & 4U) ? half_extents[2] : -half_extents[2])));
    }
    Vector3<S> angular_velocity(const Matrix3<S>& A, const Vector3<S>& L) const {
        Matrix3<S> I_W;
        for (const Vector3<S>& point : points_B_) I_W = I_W + parallel_axis(mass_, A * point);
        return inverse(I_W) * L;
    }

  private:
    S mass_;  ///< mass of one point
    std::array<Vector3<S>, 8> points_B_;
};

template <class S, class Attitude, class Inertia>
class FleckStepper {
  public:
    explicit FleckStepper(const Problem& problem)
        : problem_(&problem), loads_(problem), inertia_(problem), pivoted_(problem.body.pivoted) {
        restart();
    }
    void restart() {
        const ExactBody<double>& body = problem_->body;
        attitude_.start(cast<S>(body.q));
        L_ = cast<S>(rotate(body.q, body.inertia_B * body.angular_velocity_B));
        x_ = cast<S>(body.position_W), v_ = cast<S>(body.velocity_W);
        update_angular_velocity();
        steps_ = 0;
    }
    void enter(const Segment& segment) {
        loads_.enter(segment);
        if (segment.impulses.empty()) return;
        WorldLoads<S>::apply_impulses(*problem_, segment, attitude_.matrix(), x_, L_, v_);
        update_angular_velocity();
    }
    [[gnu::flatten]] void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S>& A = attitude_.matrix();
        const Vector3<S> torque = loads_.torque_W(
            t, A, [&] { return cast<S>(attitude_.quaternion()); }, w_, x_, v_);
        const Vector3<S> acceleration = pivoted_ ? Vector3<S>() : loads_.acceleration_W(A, v_);
        x_ = x_ + h * v_;
        attitude_.rotate_by(w_, h);
        v_ = v_ + h * acceleration;
        L_ = L_ + h * torque;
        attitude_.repair();
        update_angular_velocity();
        ++steps_;
    }
    Sample sample(double t) const { return sample_in_world(*problem_, t, attitude_.quaternion(), w_, x_, v_); }
    bool finite() const { return all_finite(L_, w_, x_, v_) && all_finite(attitude_.matrix()); }
    long rhs_evaluations() const { return steps_; }
    double orthogonality_defect() const requires requires(const Attitude& a) { a.orthogonality_defect(); }
    { return attitude_.orthogonality_defect(); }

  private:
    void update_angular_velocity() {
        w_ = inertia_.angular_velocity(attitude_.matrix(), L_);
        if (pivoted_) {
            x_ = attitude_.matrix() * loads_.forcing().arm;
            v_ = cross(w_, x_);
        }
    }

    const Problem* problem_;
    WorldLoads<S> loads_;
    Inertia inertia_;
    bool pivoted_;
    Attitude attitude_;
    Vector3<S> L_, w_;  ///< world axes
    Vector3<S> x_, v_;  ///< centre of mass
    long steps_ = 0;
};

template <class S>
using RepairedMatrix = IncrementalMatrix<true, S>;
template <class S>
using DriftingMatrix = IncrementalMatrix<false, S>;

template <template <class> class Attitude, template <class> class Inertia = TransformedInertia, class S = double>
Trajectory solve_fleck(const Problem& problem, const Settings& settings) {
    return march<FleckStepper<S, Attitude<S>, Inertia<S>>>(problem, settings);
}

constexpr std::string_view fleck_source =
    "D. Fleck, Game Physics, part IV: Moving to 3D (slides), after C. Hecker, Physics, part 4: The Third Dimension, "
    "Game Developer, June 1997";
constexpr std::string_view fleck_invariants = "L in world axes exactly if no torque acts";

constexpr Method fleck_variants[] = {
    {.name = "fleck_matrix",
     .documentation =
         "The slides' update: x += h v, A += h skew(w) A with the old w, L += h tau, A re-orthogonalised by its "
         "columns (X normalised, Z = X x Y, Y = Z x X), then w = A I^-1 A^T L. The error of a step depends on the "
         "axis, since only the first column keeps its direction. Order 1.",
     .origin = "slides: \"Putting it all together\" with \"Re-orthogonalizing a matrix\"",
     .solve = solve_fleck<RepairedMatrix>},
    {.name = "fleck_matrix_drifting",
     .documentation =
         "The slides' update without re-orthogonalisation. Each step stretches A perpendicular to w by sqrt(1 + "
         "h^2 w^2), so that A^T A - 1 grows like h w^2 t. Points and inertia are transformed by A itself, A r and "
         "A I^-1 A^T. The reported attitude is the rotation nearest to A. Order 1.",
     .origin = "slides: the update without re-orthogonalizing, A drifts",
     .conserves = "nothing",
     .solve = solve_fleck<DriftingMatrix>},
    {.name = "fleck_quaternion",
     .documentation =
         "The slides' update with a quaternion instead of the matrix: q += (h/2) (0, w) q, normalised, then w = A I^-1 "
         "A^T L with A = A(q). Vertices would be computed from the originals, V = A V0. Order 1.",
     .origin = "slides: the update with the orientation as a quaternion",
     .conserves = "L in world axes exactly if no torque acts; |q| to round-off",
     .solve = solve_fleck<IncrementalQuaternion>},
    {.name = "accumulated_vertices",
     .documentation =
         "The update that the slides warn against: vertices are rotated from their last positions, V = R(h w) V, "
         "instead of from the originals. The orientation for w = A I^-1 A^T L is computed from three of them, "
         "re-orthogonalised. The vertices accumulate rounding errors, and their A^T A - 1 is the reported defect. "
         "Order 1.",
     .origin = "slides: \"always start with the original\" ignored, vertices rotated from their last positions",
     .conserves = fleck_invariants,
     .solve = solve_fleck<AccumulatedVertices>},
    {.name = "fleck_resummed_inertia",
     .documentation =
         "`fleck_matrix` with the inertia tensor as the slides introduce it: summed over world points at every step, "
         "I_W = sum m (r^2 1 - r r^T), and inverted there. The points are eight masses with exactly the body's tensor. "
         "The motion equals that of `fleck_matrix` except for rounding, at higher cost. Order 1.",
     .origin = "slides: the inertia tensor from world space vectors, summed again in each frame",
     .solve = solve_fleck<RepairedMatrix, ResummedInertia>},
};

constexpr auto fleck_binary64_family =
    apply_defaults({.source = fleck_source,
                    .conserves = "L in world axes exactly if no torque acts; A^T A = 1 to round-off",
                    .control = Control::fixed_step,
                    .order = 1,
                    .amplification = explicit_euler_amplification,
                    .family = Family::published_update,
                    .formulation = Formulation::full},
                   fleck_variants);

constexpr auto fleck_family =
    with_binary32<fleck_binary64_family, binary32_refusal, solve_fleck<RepairedMatrix, TransformedInertia, float>,
                  solve_fleck<DriftingMatrix, TransformedInertia, float>,
                  solve_fleck<IncrementalQuaternion, TransformedInertia, float>,
                  solve_fleck<AccumulatedVertices, TransformedInertia, float>,
                  solve_fleck<RepairedMatrix, ResummedInertia, float>>();

}  // namespace

extern const std::span<const Method> fleck_methods{fleck_family};

}  // namespace polhode
