// One extrapolated step of a rotation in registers of eight lanes, all columns side by side.
//
// ColumnRule advances a column of midpoint substeps. FreeColumnRule does the same for torque-free bodies with fewer
// operations. midpoint_step() runs the columns of a row in independent chains (extrapolation_columns.h);
// finish_step() forms the result and its error estimates.
#pragma once

#include <type_traits>

#include "integrators/lanes/rotation_lanes.h"
#include "integrators/own/extrapolation_columns.h"

namespace polhode {

/// Computes the errors in units of the allowed error, and the new state y + z_K + value.
template <class Register>
POLHODE_INLINE void finish_step(const RotationAllowance& allowance, const RotationState& from, const Register& y,
                                const Register& finest, const Register& value, const Register& error,
                                const Register& error_before, double amplification, RotationStep& to) {
    const Register slack = broadcast<Register>(allowance.rounding * amplification) * finest;
    const Register allowed = loaded<Register>(allowance.squared_scale) + slack * slack;
    const Register inverse = broadcast<Register>(1) / allowed;
    to.squared_error = sum_of((error * error) * inverse);
    to.squared_error_before = sum_of((error_before * error_before) * inverse);
    const Register sum = y + finest;
    const Register rest = (value + loaded<Register>(from.lost)) + rounded_away(y, finest, sum);
    const Register next = sum + rest;
    store(to.state.y, next);
    store(to.state.lost, rounded_away(sum, rest, next));
}

/// Rule of a column with substeps h: z_1 = h f(y), z_(m+1) = z_(m-1) + 2h f(y + z_m). It advances the increments z,
/// so that rounding errors are relative to the change over the step, not to y.
template <RotationTerms terms, class Register>
class ColumnRule {
  public:
    struct Column {
        Register twice_h;
    };

    POLHODE_INLINE ColumnRule(const RotationCoefficients& coefficients, const Register& y)
        : rate_(coefficients), y_(y), f_(rate_(y)) {}
    POLHODE_INLINE Column column(double h) const { return {broadcast<Register>(2 * h)}; }
    POLHODE_INLINE Register first(const Column&, double h) const { return broadcast<Register>(h) * f_; }
    POLHODE_INLINE Register change(const Column& column, const Register& z) const {
        return column.twice_h * rate_(y_ + z);
    }
    /// z in the problem's units.
    POLHODE_INLINE Register increment(const Register& z, double) const { return z; }

  private:
    RotationRate<terms, Register> rate_;
    Register y_, f_;
};

/// Column rule without torque, in units of the column: u = h w and s = -q_w,
///
///   u_(m+1) - u_(m-1) = 2 c (u2 u3, ..),   q_(m+1) - q_(m-1) = q (0, u)
///
/// Only the gyroscopic products then have a factor. With -q_z in the eighth lane every component is one product plus
/// a difference of two: 14 operations instead of 17. (Advancing y + z itself instead of z would take 13, but its
/// rounding error close to a separatrix is five times as large.)
template <class Register>
class FreeColumnRule {
  public:
    struct Column {
        Register unit, y;
    };

    POLHODE_INLINE FreeColumnRule(const RotationCoefficients& coefficients, const Register& y)
        : factor_(loaded<Register>(coefficients.product[0]) * loaded<Register>(doubled) + loaded<Register>(eighth)),
          y_(fill_eighth_lane(y)),
          f_(fill_eighth_lane(RotationRate<RotationTerms::none, Register>(coefficients)(y))) {}
    POLHODE_INLINE Column column(double h) const {
        const Register unit = broadcast<Register>(h) * loaded<Register>(rate_mask) + loaded<Register>(signs);
        return {unit, unit * y_};
    }
    POLHODE_INLINE Register first(const Column& column, double h) const {
        return column.unit * (broadcast<Register>(h) * f_);
    }
    POLHODE_INLINE Register change(const Column& column, const Register& z) const {
        const Register y = column.y + z;
        const Register a = factor_ * (permuted<1, 2, 0, 4, 3, 3, 3, 3>(y) * permuted<2, 0, 1, 0, 0, 1, 2, 2>(y));
        const Register b = permuted<6, 6, 6, 5, 5, 6, 4, 5>(y) * permuted<2, 2, 2, 1, 2, 0, 1, 0>(y);
        const Register c = permuted<6, 6, 6, 7, 6, 4, 5, 4>(y) * permuted<2, 2, 2, 2, 1, 2, 0, 1>(y);
        return a + (b - c);
    }
    POLHODE_INLINE Register increment(const Register& z, double inverse_h) const {
        return z * (broadcast<Register>(inverse_h) * loaded<Register>(rate_mask) + loaded<Register>(signs_back));
    }

  private:
    POLHODE_INLINE static Register fill_eighth_lane(const Register& y) { return permuted<0, 1, 2, 3, 4, 5, 6, 6>(y); }

    alignas(64) static constexpr double doubled[8] = {2, 2, 2, -2, -2, -2, -2, 0};
    alignas(64) static constexpr double eighth[8] = {0, 0, 0, 0, 0, 0, 0, 1};
    alignas(64) static constexpr double rate_mask[8] = {1, 1, 1, 0, 0, 0, 0, 0};
    alignas(64) static constexpr double signs[8] = {0, 0, 0, -1, 1, 1, 1, -1};
    alignas(64) static constexpr double signs_back[8] = {0, 0, 0, -1, 1, 1, 1, 0};

    Register factor_, y_, f_;
};

/// Careful columns keep their rounding errors, which are not meaningful in a column's units.
template <RotationTerms terms, bool careful, class Register>
using ColumnRuleFor =
    std::conditional_t<terms == RotationTerms::none && !careful, FreeColumnRule<Register>, ColumnRule<terms, Register>>;

/// Computes all columns. The step adds z_n without final smoothing, since n is even.
template <int row, RotationTerms terms, class Register>
POLHODE_INLINE void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double H, RotationStep& to) {
    constexpr int K = column_count<row>;
    constexpr bool careful = row == compensated_row;
    constexpr auto n = substeps<row>();
    constexpr auto weights = extrapolation_weights<row>();
    constexpr auto chains = column_chains<row>();

    using Rule = ColumnRuleFor<terms, careful, Register>;
    const Register y = loaded<Register>(from.y), zero = broadcast<Register>(0);
    const Rule rule(coefficients, y);
    typename Rule::Column at[chains.chains];
    Register before[chains.chains], now[chains.chains], column[K];
    // Rounding errors of the above; used only if `careful`.
    Register lost_before[chains.chains], lost_now[chains.chains], lost_column[K];
    // H / n_j, exact; one division for eight columns.
    alignas(64) static constexpr auto divisors = padded_substeps<row>();
    alignas(64) double h_of[divisors.size()];
    for (std::size_t first = 0; first < divisors.size(); first += 8)
        store(h_of + first, broadcast<Register>(H) / loaded<Register>(divisors.data() + first));
    const auto start = [&](auto j) POLHODE_INLINE_LAMBDA {
        constexpr int c = chains.chain[j];
        const double h = h_of[j];
        at[c] = rule.column(h);
        before[c] = zero, now[c] = rule.first(at[c], h);
        if constexpr (careful) lost_before[c] = zero, lost_now[c] = zero;
    };
    unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
        if constexpr (chains.first[j] == 0) start(j);
    });
    const double inverse_H = 1 / H;
    unrolled<chains.pieces>([&](auto piece) POLHODE_INLINE_LAMBDA {
        constexpr int begin = chains.ends[piece], end = chains.ends[piece + 1];
        for (int i = begin; i < end; ++i)
            unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
                if constexpr (chains.first[j] <= begin && end <= chains.last[j]) {
                    constexpr int c = chains.chain[j];
                    if constexpr (careful) {
                        const Register change = rule.change(at[c], now[c] + lost_now[c]) + lost_before[c];
                        const Register next = before[c] + change;
                        lost_before[c] = lost_now[c], lost_now[c] = rounded_away(before[c], change, next);
                        before[c] = now[c], now[c] = next;
                    } else {
                        const Register next = before[c] + rule.change(at[c], now[c]);
                        before[c] = now[c], now[c] = next;
                    }
                }
            });
        unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
            if constexpr (chains.last[j] == end) {
                column[j] = rule.increment(now[chains.chain[j]], n[j] * inverse_H);
                if constexpr (careful) lost_column[j] = lost_now[chains.chain[j]];
            }
        });
        unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
            if constexpr (chains.first[j] == end) start(j);
        });
    });

    const Register& finest = column[K - 1];
    Register value = zero, error = zero, error_before = zero;
    unrolled<K - 1>([&](auto j) POLHODE_INLINE_LAMBDA {
        Register difference = column[j] - finest;
        if constexpr (careful) difference = difference + (lost_column[j] - lost_column[K - 1]);
        value = value + broadcast<Register>(weights.value[j]) * difference;
        error = error + broadcast<Register>(weights.error[j]) * difference;
        error_before = error_before + broadcast<Register>(weights.error_before[j]) * difference;
    });
    if constexpr (careful) value = value + lost_column[K - 1];
    finish_step(allowance, from, y, finest, value, error, error_before, extrapolation_rows[row].amplification, to);
}

/// Step with the row selected at run time.
template <RotationTerms terms, class Register>
POLHODE_INLINE void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double H, int row, RotationStep& to) {
    unrolled<table_rows - min_columns>([&](auto i) POLHODE_INLINE_LAMBDA {
        constexpr int number = min_columns + i;
        if (row == number) midpoint_step<number, terms, Register>(coefficients, allowance, from, H, to);
    });
}

using MidpointStep = void(const RotationCoefficients&, const RotationAllowance&, const RotationState&, double H,
                          int row, RotationStep& to);
/// One step, compiled for each instruction set. All give the same bits.
MidpointStep midpoint_step_plain, midpoint_step_avx2, midpoint_step_avx512;
/// Returns the step function for an instruction set that the processor supports.
MidpointStep* midpoint_step(InstructionSet set);

template <class Register>
POLHODE_INLINE void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double H, int row, RotationStep& to) {
    switch (coefficients.terms) {
        case RotationTerms::none:
            return midpoint_step<RotationTerms::none, Register>(coefficients, allowance, from, H, row, to);
        case RotationTerms::axial_field:
            return midpoint_step<RotationTerms::axial_field, Register>(coefficients, allowance, from, H, row, to);
        case RotationTerms::quadratic:
            // Compiled columns are faster (lane_columns.h).
            return;
    }
}

}  // namespace polhode
