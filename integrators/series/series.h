// Taylor coefficients of a recorded system's solution, order by order (Moore 1966; Griewank & Walther 2008,
// Evaluating Derivatives, table 13.2). (k + 1) y_{k+1} = f_k. The k-th coefficient of a product is the Cauchy sum of
// the factors' first k + 1 coefficients. The other operations follow from products:
//
//   q = a / b:              b_0 q_k = a_k - sum of b_j q_{k-j},  j = 1..k
//   r = sqrt a:           2 r_0 r_k = a_k - sum of r_j r_{k-j},  j = 1..k-1
//   s = sin a, c = cos a:     k s_k =   sum of j a_j c_{k-j},    j = 1..k
//                             k c_k = - sum of j a_j s_{k-j},    j = 1..k
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include "body/elementary.h"
#include "integrators/series/real.h"
#include "motion/traced.h"

namespace polhode {

/// result = sum of a[j] b[k - j] for j = 0..k.
template <class T>
void convolve(T& result, const T* a, const T* b, int k, T& scratch) {
    result = T(0);
    if (a != b) {
        for (int j = 0; j <= k; ++j) add_product(result, a[j], b[k - j], scratch);
        return;
    }
    // For a square, each pair once.
    for (int j = 0; 2 * j < k; ++j) add_product(result, a[j], a[k - j], scratch);
    result += result;
    if (k % 2 == 0) add_product(result, a[k / 2], a[k / 2], scratch);
}

/// The k-th coefficient of a product for built-in floating-point types, accumulated in a register.
template <std::floating_point T>
void convolve(T& result, const T* a, const T* b, int k, T&) {
    T sum = 0;
    if (a != b) {
        for (int j = 0; j <= k; ++j) sum += a[j] * b[k - j];
    } else {
        for (int j = 0; 2 * j < k; ++j) sum += a[j] * a[k - j];
        sum += sum;
        if (k % 2 == 0) sum += a[k / 2] * a[k / 2];
    }
    result = sum;
}

/// result = a b + c d.
template <class T>
void combine(T& result, const T& a, const T& b, const T& c, const T& d, T& scratch) {
    result = a * b;
    add_product(result, c, d, scratch);
}

/// The Taylor coefficients of one solution, in the scalar T.
template <class T>
class Series {
  public:
    Series(Recording<T> recording, int order)
        : recording_(std::move(recording)), order_(order), stride_(order + 1), slope_(recording_.tape.nodes.size(), 0) {
        std::size_t rows = recording_.tape.nodes.size();
        for (std::size_t i = 0; i < slope_.size(); ++i)
            if (recording_.tape.nodes[i].kind == Kind::sine) slope_[i] = slope_[i + 1] = static_cast<int>(rows++);
        coefficients_.resize(rows * stride_);
    }

    int order() const { return order_; }
    /// Sets the order of later expansions, at most that given to the constructor.
    void set_order(int order) { order_ = std::min(order, static_cast<int>(stride_) - 1); }
    int dimension() const { return static_cast<int>(recording_.rates.size()); }
    /// The k-th coefficient of state variable i.
    const T& coefficient(int i, int k) const { return row(i)[k]; }

    const Recording<T>& recording() const { return recording_; }
    /// The first order() coefficients of a tape node; order() + 1 for a state variable.
    const T* node_coefficients(int node) const { return row(node); }

    /// Expands the solution that starts at y, which may be of another scalar type.
    template <class P>
    void expand(const P* y) {
        const std::vector<TapeNode<T>>& nodes = recording_.tape.nodes;
        const int n = dimension();
        for (int i = 0; i < n; ++i) row(i)[0] = T(y[i]);
        for (int k = 0; k < order_; ++k) {
            for (std::size_t i = n; i < nodes.size(); ++i) expand_node(nodes[i], static_cast<int>(i), k);
            for (int i = 0; i < n; ++i) {
                const Traced<T>& rate = recording_.rates[i];
                T& next = row(i)[k + 1];
                if (rate.node >= 0)
                    next = rate.factor * row(rate.node)[k];
                else
                    next = k == 0 ? rate.factor : T(0);
                divide(next, static_cast<unsigned long>(k) + 1);
            }
        }
    }

    /// y(t + h) by Horner's rule.
    template <class P>
    void evaluate(const P& h, P* y) const {
        const auto at = [&](const T& step) {
            for (int i = 0; i < dimension(); ++i) {
                T sum = row(i)[order_];
                for (int k = order_ - 1; k >= 0; --k) sum *= step, sum += row(i)[k];
                y[i] = static_cast<P>(sum);
            }
        };
        if constexpr (std::same_as<T, P>)
            at(h);
        else
            at(T(h));
    }

  private:
    using Kind = typename TapeNode<T>::Kind;

    Recording<T> recording_;
    int order_;
    std::size_t stride_;
    std::vector<int> slope_;       // for a sine and its cosine: the row of a_1, 2 a_2, 3 a_3, ..
    std::vector<T> coefficients_;  // node by node, order + 1 each, with padding
    T scratch_{0};

    T* row(int node) { return coefficients_.data() + static_cast<std::size_t>(node) * stride_; }
    const T* row(int node) const { return coefficients_.data() + static_cast<std::size_t>(node) * stride_; }

    void expand_node(const TapeNode<T>& node, int index, int k) {
        T& result = row(index)[k];
        switch (node.kind) {
            case Kind::state:
                break;
            case Kind::combination:
                if (node.b >= 0) {
                    combine(result, node.factor_a, row(node.a)[k], node.factor_b, row(node.b)[k], scratch_);
                    break;
                }
                result = node.factor_a * row(node.a)[k];
                if (k == 0) result += node.factor_b;
                break;
            case Kind::product:
                convolve(result, row(node.a), row(node.b), k, scratch_);
                break;
            case Kind::quotient:
                expand_quotient(node, row(index), k);
                break;
            case Kind::sine:
                if (k == 0)
                    sine_cosine(row(node.a)[0], result, row(node.b)[0]);
                else
                    row(slope_[index])[k - 1] = T(k) * row(node.a)[k];
                [[fallthrough]];
            case Kind::cosine:
                if (k == 0) break;
                convolve(result, row(slope_[index]), row(node.b), k - 1, scratch_);
                divide(result, static_cast<unsigned long>(k));
                if (node.kind == Kind::cosine) result = -result;
                break;
            case Kind::root:
                expand_root(row(node.a), row(index), k);
                break;
        }
    }
    void expand_quotient(const TapeNode<T>& node, T* q, int k) {
        const T* b = row(node.b);
        T above = node.a >= 0 ? row(node.a)[k] : T(k == 0 ? 1 : 0);
        if (k > 0) {
            convolve(q[k], b + 1, q, k - 1, scratch_);
            above -= q[k];
        }
        q[k] = above / b[0];
    }
    void expand_root(const T* a, T* r, int k) {
        if (k == 0) {
            r[0] = square_root(a[0]);
            return;
        }
        T above = a[k];
        if (k > 1) {
            convolve(r[k], r + 1, r + 1, k - 2, scratch_);
            above -= r[k];
        }
        r[k] = above / (r[0] + r[0]);
    }
};

}  // namespace polhode
