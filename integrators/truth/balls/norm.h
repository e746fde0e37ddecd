// How fast two neighbouring motions can part, for certain: the logarithmic norm of the Jacobian in a weighted norm
// (G. Dahlquist 1959; Hairer, Norsett and Wanner, Solving ODEs I, theorem I.10.6).
//
//   |z| = |S y|_2,  B = S J(y) S^-1,  mu = largest eigenvalue of (B + B^T)/2
//   y' = f(y),  p' = f(p) + d(t),  |d| <= D    =>    |y - p|(t) <= e^(mu t) |y - p|(0) + t e^(max(mu, 0) t) D
//
// where mu bounds the logarithmic norm on a convex set that holds both. For a rotation dq/dt = 1/2 q (0, w) the block
// of q is skew: it adds nothing; damping is negative; what is left is the coupling, which the weights of S share out.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"
#include "motion/traced.h"

namespace polhode::truth {

/// The value and the gradient of a quotient or a root from those of its operands.
template <class T>
void divided(const TapeNode<T>& node, std::vector<T>& value, std::vector<T>& slope, std::size_t i, std::size_t n) {
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

/// J = df/dy of a recorded system, row by row, by carrying gradients along the tape. T: double, or balls that hold a
/// set of states, whose Jacobians then all lie in J.
template <class T>
std::vector<T> jacobian_of(const Recording<T>& recording, const T* y) {
    using Kind = typename TapeNode<T>::Kind;
    const std::vector<TapeNode<T>>& nodes = recording.tape.nodes;
    const std::size_t n = recording.rates.size();
    std::vector<T> value(nodes.size(), T(0)), slope(nodes.size() * n, T(0)), J(n * n, T(0));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const TapeNode<T>& node = nodes[i];
        T* own = &slope[i * n];
        if (node.kind == Kind::state) {
            value[i] = y[i], own[i] = T(1);
            continue;
        }
        if (node.kind == Kind::quotient || node.kind == Kind::root) {
            divided(node, value, slope, i, n);
            continue;
        }
        const T* a = &slope[static_cast<std::size_t>(node.a) * n];
        if (node.kind == Kind::sine) {
            // its cosine comes next
            sine_cosine(value[node.a], value[i], value[i + 1]);
            for (std::size_t j = 0; j < n; ++j)
                if (!(a[j] == 0)) own[j] = value[i + 1] * a[j], own[n + j] = -(value[i] * a[j]);
        } else if (node.kind == Kind::cosine) {
            continue;
        } else if (node.kind == Kind::combination) {
            value[i] = node.factor_a * value[node.a];
            for (std::size_t j = 0; j < n; ++j)
                if (!(a[j] == 0)) own[j] = node.factor_a * a[j];
            if (node.b < 0) {
                value[i] += node.factor_b;
                continue;
            }
            const T* b = &slope[static_cast<std::size_t>(node.b) * n];
            value[i] += node.factor_b * value[node.b];
            for (std::size_t j = 0; j < n; ++j)
                if (!(b[j] == 0)) own[j] += node.factor_b * b[j];
        } else {
            const T* b = &slope[static_cast<std::size_t>(node.b) * n];
            value[i] = value[node.a] * value[node.b];
            for (std::size_t j = 0; j < n; ++j) {
                if (!(a[j] == 0)) own[j] = value[node.b] * a[j];
                if (!(b[j] == 0)) own[j] += value[node.a] * b[j];
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

/// What is planned for a piece between two events, in doubles: nothing here needs to be right for the proof.
struct PiecePlan {
    int dimension = 0;
    std::vector<double> weights;  ///< S, row by row
    std::vector<double> scales;   ///< the size of each variable over the run
    std::vector<Block> blocks;    ///< of variables whose coefficients the step goes by, with their sizes
    double growth_bits = 0;       ///< log2 of what the logarithmic norm lets an error grow by over the piece
    double spread_bits = 0;       ///< log2 of the largest over the least weight, variables measured by their scales
    double spare_bits = 0;      ///< of the working precision, which the steps do not go by: for what rounding grows to
    double damping_number = 0;  ///< the fastest decay times the length of the piece
};

/// A plan for each piece, with weights that let errors grow least along an approximate motion.
std::vector<PiecePlan> plan_pieces(const Problem& problem);

/// The norm |S y|_2, S exactly the plan's doubles.
class WeightedNorm {
  public:
    explicit WeightedNorm(const PiecePlan& plan);

    int dimension() const { return n_; }
    /// A length within which every variable moves by at most 2^-20 of its scale: as far as the motion may be from a
    /// point whose logarithmic norm is to hold for it.
    const Bound& allowed() const { return allowed_; }
    /// |S y| where |y_i| <= component[i].
    Bound length(const std::vector<Bound>& component) const;
    /// |y_i| where |S y| <= length.
    std::vector<Bound> components(const Bound& length) const;
    /// A number that the logarithmic norm does not exceed anywhere in the box of states.
    Ball logarithmic_norm(const Recording<Ball>& recording, const std::vector<Ball>& box) const;

  private:
    int n_;
    std::vector<Ball> S_, inverse_;
    Bound allowed_;
};

/// The recording with its factors at the working precision (wider balls).
Recording<Ball> rounded(const Recording<Ball>& recording);

}  // namespace polhode::truth
