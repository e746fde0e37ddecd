// Projection of a state onto the manifold of the conserved quantities.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrators/run/march.h"
#include "motion/conserved.h"
#include "motion/dual.h"

namespace polhode {

/// Conserved quantities: |q| = 1 and, as found by motion/conserved.h, energy, angular and linear momentum (as
/// vectors, or the conserved components) and the spin about an axis of symmetry, each with its value at t = 0. (The
/// integrals of special tops are omitted: Kovalevskaya's has zero gradient at its zero, where the simplest of these
/// motions run, and that of Goryachev and Chaplygin is conserved only on one level of L_z.) At a pivot p and v are
/// not projected.
///
/// Computes the nearest point in the norm of |dy_i| / scale_i by Gauss-Newton iterations. With the constraints g,
/// their Jacobian J by forward differentiation and D = diag(scale^2),
///
///   y <- y - D J^T (J D J^T)^-1 g                    (Hairer, Lubich & Wanner 2006, IV.4)
///
/// If constraints depend on each other (energy and momentum of a steady rotation or of a sphere), the later ones are
/// omitted by a Cholesky factorisation with diagonal pivoting that stops at pivots below 10^-6.
template <class SystemType>
class Projection {
  public:
    static constexpr int N = SystemType::dimension;

    explicit Projection(const Problem& problem) : problem_(&problem), system_(problem) {
        std::array<double, N> scale{};
        system_.scales(scale.data());
        for (int i = 0; i < N; ++i) weight_[i] = scale[i] * scale[i];
        find_invariants();
        std::array<double, N> start{};
        system_.initial(start.data());
        system_.enter(problem.segments.front(), start.data());
        evaluate(start.data(), target_.data());
        target_[0] = 1;
    }

    /// Number of constraints.
    int count() const { return count_; }

    /// Moves y onto the manifold, to rounding. Returns false and leaves y unchanged if no such point was found.
    bool project(double* y) {
        constexpr int iterations = 8;
        constexpr double round_off = 4 * std::numeric_limits<double>::epsilon();
        std::array<double, N> moved{};
        std::copy(y, y + N, moved.begin());
        for (int k = 0; k < iterations; ++k) {
            std::array<Dual<N>, N> state;
            std::array<Dual<N>, max_constraints> values;
            for (int i = 0; i < N; ++i) state[i] = Dual<N>(moved[i]), state[i].slope[i] = 1;
            evaluate(state.data(), values.data());
            double worst = 0;
            factorise(values);
            std::array<double, max_constraints> g{};
            for (int r = 0; r < rank_; ++r) {
                const int c = order_[r];
                g[r] = (values[c].value - target_[c]) / length_[c];
                worst = std::max(worst, std::abs(g[r]));
            }
            if (!std::isfinite(worst) || !all_finite(moved)) return false;
            if (worst <= round_off) {
                std::copy(moved.begin(), moved.end(), y);
                return true;
            }
            solve(g);
            for (int r = 0; r < rank_; ++r)
                for (int i = 0; i < N; ++i) moved[i] -= g[r] * weight_[i] * slope_[order_[r]][i];
            // Convergence is quadratic: the remaining error is the square of this one.
            if (worst <= 1e-9) {
                std::copy(moved.begin(), moved.end(), y);
                return true;
            }
        }
        return false;
    }

  private:
    static constexpr int max_constraints = SystemType::about_axis ? 2 : 9;

    void find_invariants() {
        const bool full = problem_->formulation == Formulation::full;
        const Problem reduced = full ? pose(problem_->scene) : *problem_;
        for (const Conserved& invariant : conserved(reduced)) {
            switch (invariant.kind) {
                case ConservedKind::energy:
                    has_energy_ = true;
                    break;
                case ConservedKind::angular_momentum:
                    angular_ = {Vector3<double>(1, 0, 0), Vector3<double>(0, 1, 0), Vector3<double>(0, 0, 1)};
                    angular_count_ = 3;
                    break;
                case ConservedKind::angular_momentum_component:
                    angular_[angular_count_++] = invariant.direction;
                    break;
                case ConservedKind::linear_momentum:
                    linear_ = {Vector3<double>(1, 0, 0), Vector3<double>(0, 1, 0), Vector3<double>(0, 0, 1)};
                    linear_count_ = 3;
                    break;
                case ConservedKind::linear_momentum_component:
                    linear_[linear_count_++] = invariant.direction;
                    break;
                case ConservedKind::spin:
                    has_spin_ = true;
                    spin_axis_ = full ? rotate(reduced.body.q_BP, invariant.direction) : invariant.direction;
                    break;
                case ConservedKind::integral_of_a_special_top:
                    break;
            }
        }
        count_ = 1 + has_energy_;
        if constexpr (!SystemType::about_axis) count_ += angular_count_ + has_spin_;
        if constexpr (SystemType::has_translation) count_ += linear_count_;
    }

    // Left sides of the constraints. Energy is last, because it is the one that may depend on others.
    template <class S>
    void evaluate(const S* y, S* values) const {
        int k = 0;
        values[k++] = system_.attitude_square(y);
        if constexpr (!SystemType::about_axis) {
            const Vector3<S> L = system_.angular_momentum(y);
            if (angular_count_ > 0) {
                const Vector3<S> L_W = rotate(system_.attitude(y), L);
                for (int i = 0; i < angular_count_; ++i) values[k++] = dot(angular_[i], L_W);
            }
            if constexpr (SystemType::has_translation)
                for (int i = 0; i < linear_count_; ++i) values[k++] = dot(linear_[i], system_.velocity(y));
            if (has_spin_) values[k++] = dot(spin_axis_, L);
        }
        if (has_energy_) values[k++] = system_.energy(y);
    }

    // J D J^T with each constraint divided by the length of its gradient; C = G G^T by rows, in pivot order.
    void factorise(const std::array<Dual<N>, max_constraints>& values) {
        constexpr double min_pivot = 1e-6;
        std::array<std::array<double, max_constraints>, max_constraints> C{};
        std::array<bool, max_constraints> used{};
        for (int c = 0; c < count_; ++c) {
            double square = 0;
            for (int i = 0; i < N; ++i) square += weight_[i] * values[c].slope[i] * values[c].slope[i];
            length_[c] = std::sqrt(square);
            used[c] = !(length_[c] > 0);
            for (int i = 0; i < N; ++i) slope_[c][i] = used[c] ? 0 : values[c].slope[i] / length_[c];
        }
        for (int a = 0; a < count_; ++a)
            for (int b = 0; b < count_; ++b)
                for (int i = 0; i < N; ++i) C[a][b] += weight_[i] * slope_[a][i] * slope_[b][i];
        for (rank_ = 0; rank_ < count_; ++rank_) {
            int pivot = -1;
            // Prefer a later constraint to an earlier one only if it is larger by more than rounding.
            for (int c = 0; c < count_; ++c)
                if (!used[c] && (pivot < 0 || C[c][c] > C[pivot][pivot] * (1 + 1e-9))) pivot = c;
            if (pivot < 0 || !(C[pivot][pivot] > min_pivot)) break;
            used[pivot] = true, order_[rank_] = pivot;
            const double root = std::sqrt(C[pivot][pivot]);
            for (int c = 0; c < count_; ++c) column_[rank_][c] = C[c][pivot] / root;
            for (int a = 0; a < count_; ++a)
                for (int b = 0; b < count_; ++b)
                    if (!used[a] && !used[b]) C[a][b] -= column_[rank_][a] * column_[rank_][b];
        }
    }

    // g <- C^-1 g, in pivot order.
    void solve(std::array<double, max_constraints>& g) const {
        for (int r = 0; r < rank_; ++r) {
            for (int k = 0; k < r; ++k) g[r] -= column_[k][order_[r]] * g[k];
            g[r] /= column_[r][order_[r]];
        }
        for (int r = rank_ - 1; r >= 0; --r) {
            for (int k = r + 1; k < rank_; ++k) g[r] -= column_[r][order_[k]] * g[k];
            g[r] /= column_[r][order_[r]];
        }
    }

    const Problem* problem_;
    SystemType system_;
    std::array<double, N> weight_{};
    bool has_energy_ = false, has_spin_ = false;
    int angular_count_ = 0, linear_count_ = 0, count_ = 0, rank_ = 0;
    std::array<Vector3<double>, 3> angular_, linear_;
    Vector3<double> spin_axis_;
    std::array<double, max_constraints> target_{}, length_{};
    std::array<std::array<double, N>, max_constraints> slope_{};                 // gradients of unit length
    std::array<std::array<double, max_constraints>, max_constraints> column_{};  // columns of the factor, one per pivot
    std::array<int, max_constraints> order_{};
};

}  // namespace polhode
