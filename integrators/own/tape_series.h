// The Taylor coefficients of a long tape in binary64, some twice as fast as by series/series.h: for systems of a
// size that only the running program knows, a mechanism's or the user's own.
//
// In the order k > 0 a node is linear in the coefficients of that order: with P a sum of products of lower orders
//
//   a b:     v_k = P_k + b_0 a_k + a_0 b_k                   P_k = sum of a_j b_{k-j}            0 < j < k
//   a / b:   v_k = (-P_k + a_k - v_0 b_k) / b_0              P_k = sum of b_j v_{k-j}
//   sqrt a:  v_k = (-P_k + a_k) / (2 v_0)                    P_k = sum of v_j v_{k-j}
//   sin a:   v_k = P_k / k + cos a_0 a_k                     P_k = sum of j a_j (cos a)_{k-j}
//   cos a:   v_k = -P_k / k - sin a_0 a_k                    P_k = sum of j a_j (sin a)_{k-j}
//
// and so are sums. Products and sums that one sum alone uses are therefore dissolved into it: what is left to find in
// each order is one sum of terms for each other node, and one P for each sum of products. As soon as an order is known,
// all that it adds to the later P is added, side by side in vector registers: P_{k+j} += x_k y_j + y_k x_j for j < k,
// and x_k y_k to P_{2k}. Each P is summed in this one order whatever the registers: the same bits by every set of
// instructions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "body/elementary.h"
#include "integrators/lanes/lanes.h"
#include "integrators/own/tape_plan.h"
#include "motion/numbers.h"
#include "motion/traced.h"

namespace polhode {

/// A register of so many binary64 numbers, and one of as many places that are taken (all bits) or not (none).
template <int width>
struct Register;
/// @cond specialisations
template <>
struct Register<2> {
    using Lanes = double __attribute__((vector_size(16)));
    using Mask = long long __attribute__((vector_size(16)));
};
template <>
struct Register<4> {
    using Lanes = Lanes4;
    using Mask = long long __attribute__((vector_size(32)));
};
template <>
struct Register<8> {
    using Lanes = Lanes8;
    using Mask = long long __attribute__((vector_size(64)));
};
/// @endcond

/// The coefficients of a recorded system's solution up to the order.
template <int order>
class TapeSeries {
  public:
    /// The same bits by all instructions that the processor has.
    explicit TapeSeries(const truth::Recording<double>& recording, InstructionSet instructions = instruction_set())
        : plan_(recording),
          instructions_(instructions),
          values_(plan_.nodes.size(), 0),
          rest_(plan_.term_end.size(), 0),
          now_(plan_.term_end.size(), 0),
          scale_(plan_.term_end.size(), 1),
          states_(plan_.rates.size() * (order + 1), 0),
          rates_now_(plan_.rates.size(), 0),
          rows_((plan_.source.size() + plan_.slope_of.size()) * stride, 0),
          sums_(plan_.sums.size() * sum_stride + 2 * widest, 0) {}

    /// Expands the solution that starts at y.
    void expand(const double* y) {
        begin(y);
        for (int k = 0;; ++k) {
            if (k > 0) {
                advance();
                keep(k);
            }
            differentiate(k);
            if (k + 1 == order) return;
            if (k > 0) add_to_later(k);
        }
    }
    /// The k-th coefficient of the i-th state variable.
    double coefficient(int i, int k) const { return states_[static_cast<std::size_t>(i) * (order + 1) + k]; }

  private:
    using Node = truth::Node<double>;
    using Kind = Node::Kind;
    static constexpr int stride = (order + 7) / 8 * 8;  ///< of coefficients 1 to order - 1, in whole lines
    // P_2 to P_{order-1}. What registers hold beyond runs into the next sum's first places, which are done with.
    static constexpr int sum_stride = order - 2;
    static constexpr int most_terms = (order - 1) / 2, widest = 8;
    static_assert(sum_stride >= (most_terms + widest - 1) / widest * widest);

    TapePlan plan_;
    InstructionSet instructions_;
    std::vector<double> values_;      // by node: coefficient 0
    std::vector<double> rest_, now_;  // by place: P, scaled, and the coefficient of the order at hand
    std::vector<double> scale_;       // by place: what P is multiplied by
    std::vector<double> states_, rates_now_;
    std::vector<double, LineAllocator<double>> rows_, sums_;

    // the values, and how each node follows its operands
    void begin(const double* y) {
        double* const v = values_.data();
        for (std::size_t i = 0; i < plan_.rates.size(); ++i) v[i] = states_[i * (order + 1)] = y[i];
        for (std::size_t i = plan_.rates.size(); i < plan_.nodes.size(); ++i) {
            const Node& node = plan_.nodes[i];
            switch (node.kind) {
                case Kind::state:
                case Kind::cosine:
                    break;
                case Kind::combination:
                    v[i] = node.factor_a * v[node.a] + (node.b >= 0 ? node.factor_b * v[node.b] : node.factor_b);
                    break;
                case Kind::product:
                    v[i] = v[node.a] * v[node.b];
                    break;
                default:
                    begin_other(static_cast<int>(i));
            }
        }
        for (const TapePlan::Share& share : plan_.shares) plan_.terms[share.term].share = share.factor * v[share.node];
        std::fill(rest_.begin(), rest_.end(), 0.0);
    }
    void begin_other(int i) {
        const Node& node = plan_.nodes[i];
        double* const v = values_.data();
        TapePlan::Term* const term = &plan_.terms[plan_.term_of[i]];
        double& scale = scale_[plan_.place_of[i]];
        if (node.kind == Kind::quotient) {
            v[i] = (node.a >= 0 ? v[node.a] : 1) / v[node.b];
            term[0].share = -v[i] / v[node.b];
            if (node.a >= 0) term[1].share = 1 / v[node.b];
            scale = -1 / v[node.b];
        } else if (node.kind == Kind::root) {
            v[i] = std::sqrt(v[node.a]);
            term[0].share = 0.5 / v[i];
            scale = -term[0].share;
        } else {
            sine_cosine(v[node.a], v[i], v[node.b]);
            term[0].share = v[node.b], plan_.terms[plan_.term_of[node.b]].share = -v[i];
            scale_[plan_.place_of[node.b]] = -1;
        }
    }
    void advance() {
        double* const now = now_.data();
        const double* const rest = rest_.data();
        const TapePlan::Term* const terms = plan_.terms.data();
        int term = 0;
        for (std::size_t place = plan_.rates.size(); place < now_.size(); ++place) {
            double sum = rest[place];
            for (const int end = plan_.term_end[place]; term < end; ++term)
                sum += terms[term].share * now[terms[term].place];
            now[place] = sum;
        }
    }
    void keep(int k) {
        if (rows_.empty()) return;
        double* at = rows_.data() + (k - 1);
        for (const int place : plan_.source) *at = now_[place], at += stride;
        for (const int place : plan_.slope_of) *at = k * now_[place], at += stride;
    }
    // (k + 1) y_{k+1} = f_k
    void differentiate(int k) {
        for (std::size_t i = 0; i < plan_.rates.size(); ++i) {
            const truth::Traced<double>& rate = plan_.rates[i];
            if (rate.node < 0)
                rates_now_[i] = k == 0 ? rate.factor : 0.0;
            else
                rates_now_[i] = rate.factor * (k == 0 ? values_[rate.node] : now_[plan_.place_of[rate.node]]);
        }
        for (std::size_t i = 0; i < plan_.rates.size(); ++i)
            now_[i] = states_[i * (order + 1) + k + 1] = rates_now_[i] / (k + 1);
    }

    void add_to_later(int k) {
        switch (instructions_) {
            case InstructionSet::avx512:
                return add_avx512(*this, k);
            case InstructionSet::avx2:
                return add_avx2(*this, k);
            case InstructionSet::plain:
                return add<2>(*this, k);
        }
    }
    POLHODE_TARGET_AVX2 static void add_avx2(TapeSeries& series, int k) { add<4>(series, k); }
    POLHODE_TARGET_AVX512 static void add_avx512(TapeSeries& series, int k) { add<8>(series, k); }

    // in registers of so many numbers, as few as hold the terms
    template <int width, int blocks = 1>
    POLHODE_INLINE static void add(TapeSeries& series, int k) {
        if constexpr (blocks * width < most_terms)
            if (std::min(k, order - 1 - k) > blocks * width) return add<width, blocks + 1>(series, k);
        const std::size_t algebraic = series.plan_.algebraic;
        add<width, blocks>(series, k, 0, algebraic, 1);
        add<width, blocks>(series, k, algebraic, series.plan_.sums.size(), 1.0 / (k + 1));
    }
    template <int width, int blocks>
    POLHODE_INLINE static void add(TapeSeries& series, int k, std::size_t first, std::size_t end, double share) {
        using Lanes = typename Register<width>::Lanes;
        using Mask = typename Register<width>::Mask;
        const double* const rows = series.rows_.data();
        double* const rest = series.rest_.data();
        const double* const scale = series.scale_.data();
        // both of j < k, one of j = k; sums that have begun
        Mask of_x[blocks], of_y[blocks], begun[blocks];
        for (int block = 0; block < blocks; ++block) {
            up_to(k - 1 - block * width, of_x[block]);
            up_to(k - block * width, of_y[block]);
            up_to(k - 2 - block * width, begun[block]);
        }
        const TapePlan::Pair* const pairs = series.plan_.pairs.data();
        double* at = series.sums_.data() + first * sum_stride + (k - 1);
        for (std::size_t i = first; i < end; ++i, at += sum_stride) {
            const TapePlan::Sum& sum = series.plan_.sums[i];
            Lanes p[blocks];
            for (int block = 0; block < blocks; ++block) load(at + block * width, begun[block], p[block]);
            for (int j = sum.first; j < sum.end; ++j) {
                const TapePlan::Pair& pair = pairs[j];
                const double* const x = rows + static_cast<std::size_t>(pair.x) * stride;
                const double* const y = rows + static_cast<std::size_t>(pair.y) * stride;
                const double x_k = pair.weight * x[k - 1], y_k = pair.weight * y[k - 1];
                for (int block = 0; block < blocks; ++block) {
                    Lanes x_j, y_j;
                    load(x + block * width, of_x[block], x_j);
                    load(y + block * width, of_y[block], y_j);
                    p[block] += x_k * y_j + y_k * x_j;
                }
            }
            for (int block = 0; block < blocks; ++block) std::memcpy(at + block * width, &p[block], sizeof p[block]);
            rest[sum.place] = scale[sum.place] * share * p[0][0];
        }
    }
    // the first `last` places
    template <class Mask>
    POLHODE_INLINE static void up_to(int last, Mask& mask) {
        for (std::size_t j = 0; j < sizeof(Mask) / 8; ++j) mask[j] = static_cast<long long>(j);
        mask = mask < Mask{} + static_cast<long long>(last);
    }
    template <class Mask, class Lanes>
    POLHODE_INLINE static void load(const double* from, const Mask& mask, Lanes& to) {
        Mask bits;
        std::memcpy(&bits, from, sizeof bits);
        bits &= mask;
        to = reinterpret_cast<Lanes>(bits);
    }
};

}  // namespace polhode
