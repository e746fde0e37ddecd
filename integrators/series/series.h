// Taylor coefficients of a recorded system's solution, order by order (Moore 1966): a product's k-th coefficient is
// the Cauchy sum of its factors' first k + 1, and (k + 1) y_{k+1} = f_k.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include "integrators/series/real.h"
#include "motion/traced.h"

namespace polhode::truth {

/// result = the sum of a[j] b[k - j] for j = 0..k.
template <class T>
void convolve(T& result, const T* a, const T* b, int k, T& scratch) {
    result = T(0);
    if (a != b) {
        for (int j = 0; j <= k; ++j) add_product(result, a[j], b[k - j], scratch);
        return;
    }
    // a square: each pair once
    for (int j = 0; 2 * j < k; ++j) add_product(result, a[j], a[k - j], scratch);
    result += result;
    if (k % 2 == 0) add_product(result, a[k / 2], a[k / 2], scratch);
}

/// The k-th coefficient of a product for the machine's own numbers, whose sum stays in a register.
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

template <class T>
class Series {
  public:
    Series(Recording<T> recording, int order)
        : recording_(std::move(recording)),
          order_(order),
          stride_(order + 1),
          coefficients_(recording_.tape.nodes.size() * stride_) {}

    int order() const { return order_; }
    /// For the expansions to come: at most that of the constructor.
    void set_order(int order) { order_ = std::min(order, static_cast<int>(stride_) - 1); }
    int dimension() const { return static_cast<int>(recording_.rates.size()); }
    /// The k-th coefficient of the i-th state variable.
    const T& coefficient(int i, int k) const { return row(i)[k]; }

    const Recording<T>& recording() const { return recording_; }
    /// The first order() coefficients of a node of the tape; of a state variable order() + 1.
    const T* node_coefficients(int node) const { return row(node); }

    /// Expands the solution that starts at y.
    void expand(const T* y) {
        const std::vector<Node<T>>& nodes = recording_.tape.nodes;
        const int n = dimension();
        for (int i = 0; i < n; ++i) row(i)[0] = y[i];
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
    void evaluate(const T& h, T* y) const {
        for (int i = 0; i < dimension(); ++i) {
            T sum = row(i)[order_];
            for (int k = order_ - 1; k >= 0; --k) sum *= h, sum += row(i)[k];
            y[i] = sum;
        }
    }

  private:
    Recording<T> recording_;
    int order_;
    std::size_t stride_;
    std::vector<T> coefficients_;  // node by node, order + 1 each, and room for more
    T scratch_{0};

    T* row(int node) { return coefficients_.data() + static_cast<std::size_t>(node) * stride_; }
    const T* row(int node) const { return coefficients_.data() + static_cast<std::size_t>(node) * stride_; }

    void expand_node(const Node<T>& node, int index, int k) {
        T& result = row(index)[k];
        const T* a = row(node.a);
        if (node.kind == Node<T>::Kind::combination) {
            result = node.factor_a * a[k];
            if (node.b >= 0)
                add_product(result, node.factor_b, row(node.b)[k], scratch_);
            else if (k == 0)
                result += node.factor_b;
            return;
        }
        convolve(result, a, row(node.b), k, scratch_);
    }
};

}  // namespace polhode::truth
