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
#include <cstdint>
#include <limits>
#include <stdexcept>
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

/// The nodes of a tape whose coefficients a series keeps for all orders. For other nodes it keeps only the coefficient
/// of the present order, which takes a quarter of the memory for mechanisms: the memory's speed limits large series.
enum class SeriesRows {
    all,
    operands,  ///< operands of products, quotients, functions and roots, and the state variables
};

/// The Taylor coefficients of one solution, in the scalar T.
template <class T>
class Series {
  public:
    Series(Recording<T> recording, int order, SeriesRows rows = SeriesRows::all) {
        assign(std::move(recording), order, rows);
    }
    /// Replaces the system and the order. Reuses the memory.
    void assign(Recording<T> recording, int order, SeriesRows rows = SeriesRows::all) {
        recording_ = std::move(recording);
        order_ = order, stride_ = static_cast<std::size_t>(order) + 1;
        place_nodes(rows);
    }

    int order() const { return order_; }
    /// Sets the order of later expansions, at most that given to the constructor.
    void set_order(int order) { order_ = std::min(order, static_cast<int>(stride_) - 1); }
    int dimension() const { return static_cast<int>(recording_.rates.size()); }
    /// The k-th coefficient of state variable i.
    const T& coefficient(int i, int k) const { return row(i)[k]; }

    const Recording<T>& recording() const { return recording_; }
    /// The first order() coefficients of a tape node; order() + 1 for a state variable. Requires SeriesRows::all.
    const T* node_coefficients(int node) const {
        return coefficients_.data() + (places_[static_cast<std::size_t>(node)] >> 1);
    }

    /// Expands the solution that starts at y, which may be of another scalar type.
    template <class P>
    void expand(const P* y) {
        const int n = dimension();
        for (int i = 0; i < n; ++i) row(i)[0] = T(y[i]);
        for (int k = 0; k < order_; ++k) {
            const T* factors = factors_.data();
            for (const Step& step : steps_) {
                expand_node(step, factors, k);
                if (step.kind == Kind::combination) factors += 2;
            }
            for (int i = 0; i < n; ++i) {
                const Traced<T>& rate = recording_.rates[i];
                T& next = row(i)[k + 1];
                if (rate.node >= 0)
                    next = rate.factor * at(places_[static_cast<std::size_t>(rate.node)], k);
                else
                    next = k == 0 ? rate.factor : T(0);
                divide(next, static_cast<unsigned long>(k) + 1);
            }
        }
    }

    /// y(t + h) by Horner's rule. In multiprecision without the highest terms if they are below the rounding error,
    /// because steps up to an event may be short.
    template <class P>
    void evaluate(const P& h, P* y) const {
        const auto at_step = [&](const T& step) {
            double log2_step = 0;
            if constexpr (skips_terms) log2_step = log2_magnitude(step);
            for (int i = 0; i < dimension(); ++i) {
                const int last = last_term(i, log2_step);
                T sum = row(i)[last];
                for (int k = last - 1; k >= 0; --k) sum *= step, sum += row(i)[k];
                y[i] = static_cast<P>(sum);
            }
        };
        if constexpr (std::same_as<T, P>)
            at_step(h);
        else
            at_step(T(h));
    }

    /// The order of the last term c_k h^k of state variable i that is not negligible beside the first three, given
    /// log2 |h|. In binary64 the order of the series.
    int last_term(int i, double log2_step) const {
        int last = order_;
        if constexpr (skips_terms) {
            constexpr int guard_bits = 10;
            const auto size = [&](int k) { return log2_magnitude(row(i)[k]) + k * log2_step; };
            double least = -std::numeric_limits<double>::infinity();
            for (int k = 0; k < std::min(3, order_); ++k) least = std::max(least, size(k));
            least -= T::bits + guard_bits;
            while (last > 0 && size(last) < least) --last;
        }
        return last;
    }

  private:
    using Kind = typename TapeNode<T>::Kind;
    static constexpr bool skips_terms = requires { T::bits; };

    // Where the coefficients of a node are: twice the index of the first one, plus 1 if all are kept.
    using Place = std::int32_t;
    static constexpr Place nowhere = -1;
    static constexpr std::size_t most_places = 1'000'000'000;
    // A node other than a state variable. A sine, its cosine and the row a_1, 2 a_2, .. of its argument a are adjacent.
    struct Step {
        Kind kind;
        Place out, a, b;
    };

    Recording<T> recording_;
    int order_ = 0;
    std::size_t stride_ = 1;
    std::vector<Place> places_;    // by node
    std::vector<Step> steps_;      // by node after the state variables
    std::vector<T> factors_;       // two per combination
    std::vector<T> coefficients_;  // state variables first, then the other nodes
    T scratch_{0};

    T* row(int variable) { return coefficients_.data() + static_cast<std::size_t>(variable) * stride_; }
    const T* row(int variable) const { return coefficients_.data() + static_cast<std::size_t>(variable) * stride_; }
    T* all(Place place) { return coefficients_.data() + (place >> 1); }
    T& at(Place place, int k) {
        const std::ptrdiff_t first = place >> 1, step = k & -(place & 1);
        return coefficients_[static_cast<std::size_t>(first + step)];
    }

    // Whether all coefficients of each node are kept.
    std::vector<char> find_rows(SeriesRows rows) const {
        const std::vector<TapeNode<T>>& nodes = recording_.tape.nodes;
        std::vector<char> keeps(nodes.size(), rows == SeriesRows::all ? 1 : 0);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const TapeNode<T>& node = nodes[i];
            if (node.kind == Kind::state || node.kind == Kind::sine || node.kind == Kind::cosine) keeps[i] = 1;
            if (node.kind == Kind::quotient || node.kind == Kind::root) keeps[i] = 1;
            if (node.kind == Kind::product) keeps[static_cast<std::size_t>(node.a)] = 1;
            if (node.kind == Kind::product || node.kind == Kind::quotient) keeps[static_cast<std::size_t>(node.b)] = 1;
        }
        return keeps;
    }
    void place_nodes(SeriesRows rows) {
        const std::vector<TapeNode<T>>& nodes = recording_.tape.nodes;
        const std::vector<char> keeps = find_rows(rows);
        const std::size_t stride = stride_;
        places_.resize(nodes.size());
        std::size_t next = 0;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (next > most_places) throw std::length_error("the system is too large for a Taylor series");
            places_[i] = static_cast<Place>(2 * next + (keeps[i] ? 1 : 0));
            next += keeps[i] ? stride : 1;
            if (nodes[i].kind == Kind::cosine) next += stride;
        }
        coefficients_.resize(next);
        steps_.clear(), factors_.clear();
        const auto place = [&](int node) { return node < 0 ? nowhere : places_[static_cast<std::size_t>(node)]; };
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const TapeNode<T>& node = nodes[i];
            if (node.kind == Kind::state) continue;
            steps_.push_back({node.kind, places_[i], place(node.a), place(node.b)});
            if (node.kind == Kind::combination) factors_.push_back(node.factor_a), factors_.push_back(node.factor_b);
        }
    }

    void expand_node(const Step& step, const T* factors, int k) {
        T& result = at(step.out, k);
        switch (step.kind) {
            case Kind::state:
                break;
            case Kind::combination:
                if (step.b != nowhere) {
                    combine(result, factors[0], at(step.a, k), factors[1], at(step.b, k), scratch_);
                    break;
                }
                result = factors[0] * at(step.a, k);
                if (k == 0) result += factors[1];
                break;
            case Kind::product:
                convolve(result, all(step.a), all(step.b), k, scratch_);
                break;
            case Kind::quotient:
                expand_quotient(step, all(step.out), k);
                break;
            case Kind::sine: {
                T* const slope = all(step.out) + 2 * stride_;
                if (k == 0)
                    sine_cosine(at(step.a, 0), result, at(step.b, 0));
                else
                    slope[k - 1] = T(k) * at(step.a, k), expand_sine(result, slope, all(step.b), k);
                break;
            }
            case Kind::cosine:
                if (k == 0) break;
                expand_sine(result, all(step.out) + stride_, all(step.b), k);
                result = -result;
                break;
            case Kind::root:
                expand_root(at(step.a, k), all(step.out), k);
                break;
        }
    }
    // sum of j a_j c_{k-j}, j = 1..k, divided by k
    void expand_sine(T& result, const T* slope, const T* other, int k) {
        convolve(result, slope, other, k - 1, scratch_);
        divide(result, static_cast<unsigned long>(k));
    }
    void expand_quotient(const Step& step, T* q, int k) {
        const T* b = all(step.b);
        T above = step.a != nowhere ? at(step.a, k) : T(k == 0 ? 1 : 0);
        if (k > 0) {
            convolve(q[k], b + 1, q, k - 1, scratch_);
            above -= q[k];
        }
        q[k] = above / b[0];
    }
    void expand_root(const T& a, T* r, int k) {
        if (k == 0) {
            r[0] = square_root(a);
            return;
        }
        T above = a;
        if (k > 1) {
            convolve(r[k], r + 1, r + 1, k - 2, scratch_);
            above -= r[k];
        }
        r[k] = above / (r[0] + r[0]);
    }
};

}  // namespace polhode
