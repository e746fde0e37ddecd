// The Taylor coefficients of a long tape in binary64, some three times as fast as by series/series.h: for systems of a
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
#include <utility>
#include <vector>

#include "body/elementary.h"
#include "integrators/lanes/lanes.h"
#include "motion/numbers.h"
#include "motion/traced.h"

namespace polhode {

/// The coefficients of a recorded system's solution up to the order.
template <int order>
class TapeSeries {
  public:
    /// The same bits by all instructions that the processor has.
    explicit TapeSeries(const truth::Recording<double>& recording, InstructionSet instructions = instruction_set())
        : instructions_(instructions),
          nodes_(recording.tape.nodes),
          rates_(recording.rates),
          values_(nodes_.size(), 0) {
        dissolve();
        row_of_.assign(nodes_.size(), none);
        term_of_.assign(nodes_.size(), 0);
        for (int i = 0; i < static_cast<int>(nodes_.size()); ++i)
            if (place_of_[i] != none) decode(i);
        // those of equal length one after another: the processor foresees where a loop ends
        std::stable_sort(sums_of_.begin(), sums_of_.end(),
                         [](const Sum& a, const Sum& b) { return a.end - a.first < b.end - b.first; });
        sums_of_.insert(sums_of_.end(), trigonometric_.begin(), trigonometric_.end());
        for (Sum& sum : sums_of_) {
            const int first = sum.first;
            sum.first = static_cast<int>(pairs_.size());
            for (int i = first; i < sum.end; ++i) pairs_.push_back(given_[i]);
            sum.end = static_cast<int>(pairs_.size());
        }
        // the rows of slopes follow the others
        for (Pair& pair : pairs_)
            if (pair.x < 0) pair.x = static_cast<int>(source_.size()) - 1 - pair.x;
        rows_.assign((source_.size() + slope_of_.size()) * stride, 0);
        sums_.assign(sums_of_.size() * sum_stride + 2 * width, 0);
        now_.assign(term_end_.size(), 0);
        rest_.assign(term_end_.size(), 0);
        scale_.assign(term_end_.size(), 1);
        states_.assign(rates_.size() * (order + 1), 0);
        rates_now_.assign(rates_.size(), 0);
    }

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
    using Mask = long long __attribute__((vector_size(64)));
    /// share * the coefficient at that place
    struct Term {
        double share;
        int place;
    };
    /// The share of a term is factor * the value of a node.
    struct Share {
        double factor;
        int term, node;
    };
    /// weight * the products of two rows; x = -1 - i: the i-th row of slopes.
    struct Pair {
        double weight;
        int x, y;
    };
    /// The P of a place: of pairs first to end - 1.
    struct Sum {
        int place, first, end;
    };
    static constexpr int none = -1, width = 8;
    static constexpr int stride = (order + 7) / 8 * 8;  ///< of coefficients 1 to order - 1, in whole lines
    // P_2 to P_{order-1}. What a register holds beyond runs into the next sum's first places, which are done with.
    static constexpr int sum_stride = order - 2;
    static_assert(sum_stride >= 2 * width || (order / 2 <= width + 1 && sum_stride >= width));

    InstructionSet instructions_;
    std::vector<Node> nodes_;
    std::vector<truth::Traced<double>> rates_;
    // by node
    std::vector<double> values_;
    std::vector<int> place_of_;  // none: dissolved
    std::vector<int> row_of_;    // of coefficients that products need
    std::vector<int> term_of_;   // its first term
    // by row
    std::vector<int> source_, slope_of_;  // the place whose a_j, or j a_j, it holds
    // sums of products, those of sines and cosines last
    std::vector<Pair> given_, pairs_;
    std::vector<Sum> sums_of_, trigonometric_;
    // by place, the states' first
    std::vector<int> term_end_;
    std::vector<double> rest_, now_;  // P, scaled, and the coefficient of the order at hand
    std::vector<double> scale_;       // what P is multiplied by
    std::vector<Term> terms_;
    std::vector<Share> shares_;
    std::vector<double> states_, rates_now_;
    std::vector<double, LineAllocator<double>> rows_, sums_;

    // places for all but the sums and products that are used by one sum alone
    void dissolve() {
        const int count = static_cast<int>(nodes_.size());
        std::vector<int> uses(nodes_.size(), 0);
        for (int i = 0; i < count; ++i) {
            const bool by_sum = nodes_[i].kind == Kind::combination;
            if (nodes_[i].kind == Kind::state) continue;
            for (const int operand : {nodes_[i].a, nodes_[i].b})
                if (operand >= 0) uses[operand] += by_sum ? 1 : 2;
        }
        for (const truth::Traced<double>& rate : rates_)
            if (rate.node >= 0) uses[rate.node] += 2;
        place_of_.assign(nodes_.size(), none);
        int places = 0;
        for (int i = 0; i < count; ++i) {
            const bool is_linear = nodes_[i].kind == Kind::combination || nodes_[i].kind == Kind::product;
            if (!is_linear || uses[i] > 1) place_of_[i] = places++;
        }
    }
    int row(int node) {
        if (row_of_[node] == none) {
            row_of_[node] = static_cast<int>(source_.size());
            source_.push_back(place_of_[node]);
        }
        return row_of_[node];
    }
    void add_term(int node, double share) { terms_.push_back({share, place_of_[node]}); }
    void decode(int i) {
        const Node& node = nodes_[i];
        const int first = static_cast<int>(given_.size());
        const bool is_trigonometric = node.kind == Kind::sine || node.kind == Kind::cosine;
        term_of_[i] = static_cast<int>(terms_.size());
        switch (node.kind) {
            case Kind::state:
                break;
            case Kind::combination:
            case Kind::product:
                decode_sum(i);
                break;
            case Kind::quotient:
                add_term(node.b, 0);
                if (node.a >= 0) add_term(node.a, 0);
                given_.push_back({1, row(node.b), row(i)});
                break;
            case Kind::sine:
                slope_of_.push_back(place_of_[node.a]);
                [[fallthrough]];
            case Kind::cosine:
                add_term(node.a, 0);
                given_.push_back({1, -static_cast<int>(slope_of_.size()), row(node.b)});
                break;
            case Kind::root:
                add_term(node.a, 0);
                given_.push_back({1, row(i), row(i)});
                break;
        }
        term_end_.push_back(static_cast<int>(terms_.size()));
        const int end = static_cast<int>(given_.size());
        if (end > first) (is_trigonometric ? trigonometric_ : sums_of_).push_back({place_of_[i], first, end});
    }
    // a sum or a product, with all that is dissolved into it
    void decode_sum(int i) {
        std::vector<std::pair<int, double>> open{{i, 1.0}};
        while (!open.empty()) {
            const auto [at, factor] = open.back();
            open.pop_back();
            const Node& node = nodes_[at];
            if (at != i && place_of_[at] != none) {
                add_term(at, factor);
            } else if (node.kind == Kind::combination) {
                if (node.b >= 0) open.emplace_back(node.b, factor * node.factor_b);
                open.emplace_back(node.a, factor * node.factor_a);
            } else {
                for (const auto& [own, other] : {std::pair(node.a, node.b), std::pair(node.b, node.a)}) {
                    shares_.push_back({factor, static_cast<int>(terms_.size()), other});
                    add_term(own, 0);
                }
                given_.push_back({factor, row(node.a), row(node.b)});
            }
        }
    }
    // the values, and how each node follows its operands
    void begin(const double* y) {
        double* const v = values_.data();
        for (std::size_t i = 0; i < rates_.size(); ++i) v[i] = states_[i * (order + 1)] = y[i];
        for (std::size_t i = rates_.size(); i < nodes_.size(); ++i) {
            const Node& node = nodes_[i];
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
        for (const Share& share : shares_) terms_[share.term].share = share.factor * v[share.node];
        std::fill(rest_.begin(), rest_.end(), 0.0);
    }
    void begin_other(int i) {
        const Node& node = nodes_[i];
        double* const v = values_.data();
        Term* const term = &terms_[term_of_[i]];
        double& scale = scale_[place_of_[i]];
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
            term[0].share = v[node.b], terms_[term_of_[node.b]].share = -v[i];
            scale_[place_of_[node.b]] = -1;
        }
    }
    void advance() {
        double* const now = now_.data();
        const double* const rest = rest_.data();
        const Term* const terms = terms_.data();
        int term = 0;
        for (std::size_t place = rates_.size(); place < now_.size(); ++place) {
            double sum = rest[place];
            for (const int end = term_end_[place]; term < end; ++term)
                sum += terms[term].share * now[terms[term].place];
            now[place] = sum;
        }
    }
    void keep(int k) {
        double* at = rows_.data() + (k - 1);
        for (const int place : source_) *at = now_[place], at += stride;
        for (const int place : slope_of_) *at = k * now_[place], at += stride;
    }
    // (k + 1) y_{k+1} = f_k
    void differentiate(int k) {
        for (std::size_t i = 0; i < rates_.size(); ++i) {
            const truth::Traced<double>& rate = rates_[i];
            if (rate.node < 0)
                rates_now_[i] = k == 0 ? rate.factor : 0.0;
            else
                rates_now_[i] = rate.factor * (k == 0 ? values_[rate.node] : now_[place_of_[rate.node]]);
        }
        for (std::size_t i = 0; i < rates_.size(); ++i)
            now_[i] = states_[i * (order + 1) + k + 1] = rates_now_[i] / (k + 1);
    }

    void add_to_later(int k) {
        switch (instructions_) {
            case InstructionSet::avx512:
                return add_avx512(*this, k);
            case InstructionSet::avx2:
                return add_avx2(*this, k);
            case InstructionSet::plain:
                return add(*this, k);
        }
    }
    POLHODE_TARGET_AVX2 static void add_avx2(TapeSeries& series, int k) { add(series, k); }
    POLHODE_TARGET_AVX512 static void add_avx512(TapeSeries& series, int k) { add(series, k); }
    POLHODE_INLINE static void add(TapeSeries& series, int k) {
        const std::size_t all = series.sums_of_.size(), algebraic = all - series.trigonometric_.size();
        const double share = 1.0 / (k + 1);
        if (std::min(k, order - 1 - k) > width) {
            add<2>(series, k, 0, algebraic, 1);
            add<2>(series, k, algebraic, all, share);
        } else {
            add<1>(series, k, 0, algebraic, 1);
            add<1>(series, k, algebraic, all, share);
        }
    }
    // places 1 to last of a register for j = 1 + 8 block, ..
    POLHODE_INLINE static Mask up_to(int last, int block) {
        const long long places = last - block * width;
        return Mask{1, 2, 3, 4, 5, 6, 7, 8} <= (Mask{} + places);
    }
    POLHODE_INLINE static Lanes8 load(const double* from, const Mask& mask) {
        Mask bits;
        std::memcpy(&bits, from, sizeof bits);
        bits &= mask;
        return reinterpret_cast<Lanes8>(bits);
    }
    template <int blocks>
    POLHODE_INLINE static void add(TapeSeries& series, int k, std::size_t first, std::size_t end, double share) {
        static_assert(blocks <= 2);
        const double* const rows = series.rows_.data();
        double* const rest = series.rest_.data();
        const double* const scale = series.scale_.data();
        // both of j < k, one of j = k; sums that have begun
        Mask of_x[blocks], of_y[blocks], begun[blocks];
        for (int block = 0; block < blocks; ++block) {
            of_x[block] = up_to(k - 1, block), of_y[block] = up_to(k, block), begun[block] = up_to(k - 2, block);
        }
        const Pair* const pairs = series.pairs_.data();
        double* at = series.sums_.data() + first * sum_stride + (k - 1);
        for (std::size_t i = first; i < end; ++i, at += sum_stride) {
            const Sum& sum = series.sums_of_[i];
            Lanes8 p[blocks];
            for (int block = 0; block < blocks; ++block) p[block] = load(at + block * width, begun[block]);
            for (int j = sum.first; j < sum.end; ++j) {
                const Pair& pair = pairs[j];
                const double* const x = rows + static_cast<std::size_t>(pair.x) * stride;
                const double* const y = rows + static_cast<std::size_t>(pair.y) * stride;
                const double x_k = pair.weight * x[k - 1], y_k = pair.weight * y[k - 1];
                for (int block = 0; block < blocks; ++block)
                    p[block] += x_k * load(y + block * width, of_y[block]) + y_k * load(x + block * width, of_x[block]);
            }
            for (int block = 0; block < blocks; ++block) std::memcpy(at + block * width, &p[block], sizeof p[block]);
            rest[sum.place] = scale[sum.place] * share * p[0][0];
        }
    }
};

}  // namespace polhode
