// Midpoint columns and weights of each extrapolation order, and the arrangement of the columns side by side.
//
// Column j covers the step H in n_j substeps of the explicit midpoint rule. Its error has an expansion in even powers
// of H. The polynomial in (1/n)^2 through K columns gives order 2K at n = infinity:
//
//   T_KK = z_K + sum over j < K of c_j (z_j - z_K),   c_j = product over i != j of n_j^2 / (n_j^2 - n_i^2),
//
// where z_j is the increment of column j (Gragg 1965; Bulirsch & Stoer 1966; Hairer, Norsett & Wanner 1993, II.9).
#pragma once

#include <array>
#include <numeric>

namespace polhode {

inline constexpr int min_columns = 2, max_columns = 9;

/// Rows are numbered by their column count. The last row is for tolerances near rounding: six columns with the
/// smallest possible amplification of rounding errors, each summed with compensation.
inline constexpr int compensated_row = 10, table_rows = 11;

/// The n_j of a row, found by search: least work A_K / (product of n_j)^(1/K) with sum |c_j| <= 30. This sum is the
/// factor by which the rounding error of an increment is amplified; for 2, 4, 6, .. it is 120 at K = 8 and 600 at K =
/// 10.
template <int row>
constexpr auto substeps() {
    if constexpr (row == 2) return std::array{2, 4};
    if constexpr (row == 3) return std::array{4, 6, 8};
    if constexpr (row == 4) return std::array{4, 6, 8, 12};
    if constexpr (row == 5) return std::array{4, 6, 8, 10, 12};
    if constexpr (row == 6) return std::array{4, 6, 8, 10, 12, 16};
    if constexpr (row == 7) return std::array{4, 6, 8, 10, 12, 16, 20};
    if constexpr (row == 8) return std::array{4, 6, 8, 10, 12, 14, 18, 26};
    if constexpr (row == 9) return std::array{4, 6, 8, 10, 12, 14, 16, 22, 32};
    if constexpr (row == compensated_row) return std::array{4, 6, 8, 12, 16, 24};
}
template <int row>
inline constexpr int column_count = static_cast<int>(substeps<row>().size());

/// The n_j in registers of eight, padded with ones.
template <int row>
constexpr auto padded_substeps() {
    constexpr auto n = substeps<row>();
    std::array<double, (n.size() + 7) / 8 * 8> lanes{};
    for (std::size_t j = 0; j < lanes.size(); ++j) lanes[j] = j < n.size() ? n[j] : 1;
    return lanes;
}

/// The weights of T_KK, of T_KK - T_K,K-1 and of T_K-1,K-1 - T_K-1,K-2, where T_k,k-1 omits the first column.
template <int K>
struct ExtrapolationWeights {
    std::array<double, K> value{}, error{}, error_before{};
};

/// The weights at n = infinity of columns first .. last - 1; other weights are zero.
template <auto n>
constexpr auto column_weights(int first, int last) {
    constexpr int K = static_cast<int>(n.size());
    std::array<long double, K> weights{};
    for (int j = first; j < last; ++j) {
        weights[j] = 1;
        for (int i = first; i < last; ++i)
            if (i != j) weights[j] *= static_cast<long double>(n[j] * n[j]) / (n[j] * n[j] - n[i] * n[i]);
    }
    return weights;
}

template <auto n>
constexpr auto compute_weights() {
    constexpr int K = static_cast<int>(n.size());
    ExtrapolationWeights<K> weights;
    const auto all = column_weights<n>(0, K), without_first = column_weights<n>(1, K);
    const auto before = column_weights<n>(0, K - 1), before_without_first = column_weights<n>(1, K - 1);
    for (int j = 0; j < K; ++j) {
        weights.value[j] = static_cast<double>(all[j]);
        weights.error[j] = static_cast<double>(all[j] - without_first[j]);
        weights.error_before[j] = static_cast<double>(before[j] - before_without_first[j]);
    }
    return weights;
}

template <int row>
constexpr auto extrapolation_weights() {
    return compute_weights<substeps<row>()>();
}

/// A row of the extrapolation table that is selected at run time: its columns, their weights and the cost of a step.
struct ExtrapolationRow {
    int columns = 0;
    int evaluations = 0;       ///< evaluations of the right-hand side per step
    int work = 0;              ///< cost of a step, in evaluations
    double amplification = 0;  ///< sum |c_j|
    int odd_multiple = 1;      ///< least common multiple of the odd parts of n_j
    std::array<int, max_columns> substeps{};
    ExtrapolationWeights<max_columns> weights;
};

/// The row for given n_j.
template <auto n>
constexpr ExtrapolationRow make_row() {
    ExtrapolationRow row;
    const auto weights = compute_weights<n>();
    row.columns = static_cast<int>(n.size()), row.evaluations = 1;
    for (int j = 0; j < row.columns; ++j) {
        row.substeps[j] = n[j];
        row.weights.value[j] = weights.value[j];
        row.weights.error[j] = weights.error[j];
        row.weights.error_before[j] = weights.error_before[j];
        row.evaluations += n[j] - 1;
        row.amplification += weights.value[j] < 0 ? -weights.value[j] : weights.value[j];
        int odd = n[j];
        while (odd % 2 == 0) odd /= 2;
        row.odd_multiple = std::lcm(row.odd_multiple, odd);
    }
    row.work = row.evaluations;
    return row;
}
template <int number>
constexpr ExtrapolationRow extrapolation_row() {
    return make_row<substeps<number>()>();
}

using ExtrapolationTable = std::array<ExtrapolationRow, table_rows>;
inline constexpr ExtrapolationTable extrapolation_rows{ExtrapolationRow{},
                                                       ExtrapolationRow{},
                                                       extrapolation_row<2>(),
                                                       extrapolation_row<3>(),
                                                       extrapolation_row<4>(),
                                                       extrapolation_row<5>(),
                                                       extrapolation_row<6>(),
                                                       extrapolation_row<7>(),
                                                       extrapolation_row<8>(),
                                                       extrapolation_row<9>(),
                                                       extrapolation_row<compensated_row>()};

/// The n_j of a row where each column has its own lane. Only the longest column costs time there, so the search
/// minimised n_K / (product of n_j)^(1/K) with sum |c_j| <= 60 (2, 4, .., 16 amplifies rounding by 119). Of the
/// candidates, these took the least time on the catalogue. Longer sequences do not pay where a step would be longer
/// than the sample spacing or where poles of the motion limit it.
template <int K>
constexpr auto lane_substeps() {
    if constexpr (K == 2) return std::array{4, 6};
    if constexpr (K == 3) return std::array{6, 8, 10};
    if constexpr (K == 4) return std::array{6, 8, 10, 14};
    if constexpr (K == 5) return std::array{6, 8, 10, 12, 16};
    if constexpr (K == 6) return std::array{6, 8, 10, 12, 14, 18};
    if constexpr (K == 7) return std::array{4, 6, 8, 10, 12, 14, 18};
    if constexpr (K == 8) return std::array{4, 6, 8, 10, 12, 14, 18, 22};
}
template <int K>
constexpr ExtrapolationRow make_lane_row() {
    constexpr auto n = lane_substeps<K>();
    ExtrapolationRow row = make_row<n>();
    row.work = n[K - 1];
    return row;
}
inline constexpr int max_lane_columns = 8;
inline constexpr ExtrapolationTable lane_rows{ExtrapolationRow{},
                                              ExtrapolationRow{},
                                              make_lane_row<2>(),
                                              make_lane_row<3>(),
                                              make_lane_row<4>(),
                                              make_lane_row<5>(),
                                              make_lane_row<6>(),
                                              make_lane_row<7>(),
                                              make_lane_row<8>(),
                                              ExtrapolationRow{},
                                              extrapolation_row<compensated_row>()};

/// K columns packed into as few chains as the longest column allows, first fit, longest first. A chain runs its
/// columns in sequence. The chains are independent, so the processor overlaps them.
template <int K>
struct ColumnChains {
    int chains = 0;
    std::array<int, K> chain{};     ///< chain of column j
    std::array<int, K> first{};     ///< evaluations in the chain before column j
    std::array<int, K> last{};      ///< evaluations in the chain up to the end of column j
    std::array<int, K + 1> ends{};  ///< 0, then the distinct values of `last`, ascending
    int pieces = 0;                 ///< number of these intervals
};

template <int row>
constexpr auto column_chains() {
    constexpr int K = column_count<row>;
    ColumnChains<K> c;
    const auto n = substeps<row>();
    std::array<int, K> filled{};
    const int capacity = n[K - 1] - 1;
    for (int j = K - 1; j >= 0; --j) {
        int i = 0;
        while (i < c.chains && filled[i] + n[j] - 1 > capacity) ++i;
        if (i == c.chains) ++c.chains;
        c.chain[j] = i, c.first[j] = filled[i];
        filled[i] += n[j] - 1;
        c.last[j] = filled[i];
    }
    for (int end = 1; end <= capacity; ++end) {
        bool found = false;
        for (int j = 0; j < K; ++j) found = found || c.last[j] == end;
        if (found) c.ends[++c.pieces] = end;
    }
    return c;
}

}  // namespace polhode
