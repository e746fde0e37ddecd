// Proven bound on the rate at which two neighbouring motions separate: the logarithmic norm of the Jacobian in a
// weighted norm (G. Dahlquist 1959; Hairer, Norsett and Wanner, Solving ODEs I, theorem I.10.6).
//
//   |z| = |S y|_2,  B = S J(y) S^-1,  mu = largest eigenvalue of (B + B^T)/2
//   y' = f(y),  p' = f(p) + d(t),  |d| <= D    =>    |y - p|(t) <= e^(mu t) |y - p|(0) + t e^(max(mu, 0) t) D
//
// where mu bounds the logarithmic norm on a convex set that contains both. For a rotation dq/dt = 1/2 q (0, w) the
// block of q is skew and adds nothing. Damping is negative. The coupling remains; the weights S distribute it.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"
#include "motion/traced.h"

namespace polhode::truth {

/// Computes value and gradient of a quotient or square root from those of its operands.
template <class T>
void differentiate_quotient(const TapeNode<T>& node, std::vector<T>& value, std::vector<T>& slope, std::size_t i,
                            std::size_t n) {
    const bool is_root = node.kind == TapeNode<T>::Kind::root;
    const std::size_t above = static_cast<std::size_t>(node.a), below = static_cast<std::size_t>(node.b);
    value[i] = is_root ? square_root(value[above]) : (node.a >= 0 ? value[above] : T(1)) / value[below];
    const T factor = T(1) / (is_root ? T(value[i] + value[i]) : value[below]);
    for (std::size_t j = 0; j < n; ++j) {
        T change(0);
        if (node.a >= 0) change = slope[above * n + j];
        if (!is_root && !(slope[below * n + j] == 0)) change -= value[i] * slope[below * n + j];
        if (!(change == 0)) slope[i * n + j] = change * factor;
    }
}

/// J = df/dy of a recorded system, stored by rows, by forward propagation of gradients along the tape. T is double or
/// Ball; balls that enclose a set of states give a J that encloses all Jacobians of the set.
template <class T>
std::vector<T> jacobian_of(const Recording<T>& recording, const T* y) {
    using Kind = typename TapeNode<T>::Kind;
    const std::vector<TapeNode<T>>& nodes = recording.tape.nodes;
    const std::size_t n = recording.rates.size();
    std::vector<T> value(nodes.size(), T(0)), slope(nodes.size() * n, T(0)), J(n * n, T(0));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const TapeNode<T>& node = nodes[i];
        T* row_slope = &slope[i * n];
        if (node.kind == Kind::state) {
            value[i] = y[i], row_slope[i] = T(1);
            continue;
        }
        if (node.kind == Kind::quotient || node.kind == Kind::root) {
            differentiate_quotient(node, value, slope, i, n);
            continue;
        }
        const T* a = &slope[static_cast<std::size_t>(node.a) * n];
        if (node.kind == Kind::sine) {
            // the cosine is the next node
            sine_cosine(value[node.a], value[i], value[i + 1]);
            for (std::size_t j = 0; j < n; ++j)
                if (!(a[j] == 0)) row_slope[j] = value[i + 1] * a[j], row_slope[n + j] = -(value[i] * a[j]);
        } else if (node.kind == Kind::cosine) {
            continue;
        } else if (node.kind == Kind::combination) {
            value[i] = node.factor_a * value[node.a];
            for (std::size_t j = 0; j < n; ++j)
                if (!(a[j] == 0)) row_slope[j] = node.factor_a * a[j];
            if (node.b < 0) {
                value[i] += node.factor_b;
                continue;
            }
            const T* b = &slope[static_cast<std::size_t>(node.b) * n];
            value[i] += node.factor_b * value[node.b];
            for (std::size_t j = 0; j < n; ++j)
                if (!(b[j] == 0)) row_slope[j] += node.factor_b * b[j];
        } else {
            const T* b = &slope[static_cast<std::size_t>(node.b) * n];
            value[i] = value[node.a] * value[node.b];
            for (std::size_t j = 0; j < n; ++j) {
                if (!(a[j] == 0)) row_slope[j] = value[node.b] * a[j];
                if (!(b[j] == 0)) row_slope[j] += value[node.a] * b[j];
            }
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Traced<T>& rate = recording.rates[i];
        if (rate.node < 0) continue;
        for (std::size_t j = 0; j < n; ++j)
            J[i * n + j] = rate.factor * slope[static_cast<std::size_t>(rate.node) * n + j];
    }
    return J;
}

/// Plan for a piece between two events, in doubles. The proof does not depend on its accuracy.
struct PiecePlan {
    int dimension = 0;
    std::vector<double> weights;  ///< S, stored by rows
    std::vector<double> scales;   ///< size of each variable over the run
    std::vector<Block> blocks;    ///< blocks of variables that control the step, with their sizes
    double growth_bits = 0;       ///< log2 of the error growth over the piece that the logarithmic norm allows
    double spread_bits = 0;       ///< log2 of the ratio of the largest to the smallest weight, in units of the scales
    double spare_bits = 0;        ///< bits of the working precision reserved for the growth of rounding errors
    double damping_number = 0;    ///< fastest decay rate times the length of the piece
};

/// One plan per piece. The weights minimise the error growth along an approximate motion.
std::vector<PiecePlan> plan_pieces(const Problem& problem);

/// The norm |S y|_2. S consists of the plan's doubles, taken exactly.
class WeightedNorm {
  public:
    explicit WeightedNorm(const PiecePlan& plan);

    int dimension() const { return n_; }
    /// A length within which every variable changes by at most 2^-20 of its scale. The motion must stay within this
    /// length of a point for the logarithmic norm at that point to apply.
    const Bound& allowed() const { return allowed_; }
    /// Upper bound of |S y| if |y_i| <= component[i].
    Bound length(const std::vector<Bound>& component) const;
    /// Upper bounds of |y_i| if |S y| <= length.
    std::vector<Bound> components(const Bound& length) const;
    /// Upper bound of the logarithmic norm over the box of states; infinite if no bound is found.
    Ball logarithmic_norm(const Recording<Ball>& recording, const std::vector<Ball>& box) const;

  private:
    int n_;
    std::vector<Ball> S_, inverse_;
    Bound allowed_;
};

/// The recording with its factors rounded to the working precision (wider balls).
Recording<Ball> rounded(const Recording<Ball>& recording);

}  // namespace polhode::truth
