// One extrapolated step of a rotation on registers of eight lanes, all columns side by side.
#pragma once

#include <array>

#include "integrators/kernels/extrapolation_columns.h"
#include "integrators/kernels/rotation_lanes.h"

namespace polhode {

/// The errors in units of what is allowed, and y + z_K + value.
template <class Register>
POLHODE_INLINE void finish_step(const RotationAllowance& allowance, const RotationState& from, const Register& y,
                                const Register& finest, const Register& value, const Register& error,
                                const Register& error_before, double amplification, RotationStep& to) {
    const Register slack = broadcast<Register>(allowance.rounding * amplification) * finest;
    const Register allowed = loaded<Register>(allowance.squared_scale) + slack * slack;
    to.squared_error = squared_norm(error, allowed);
    to.squared_error_before = squared_norm(error_before, allowed);
    const Register sum = y + finest;
    const Register rest = (value + loaded<Register>(from.lost)) + rounded_away(y, finest, sum);
    const Register next = sum + rest;
    store(to.state.y, next);
    store(to.state.lost, rounded_away(sum, rest, next));
}

/// z_(m+1) = z_(m-1) + 2h f(y + z_m), z_0 = 0, z_1 = h f(y), on the increments z: their rounding is relative to the
/// step's change, not to y. The step then adds z_n, no last smoothing: n is even.
template <int row, RotationTerms terms, class Register>
POLHODE_INLINE void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double H, RotationStep& to) {
    constexpr int K = columns_of<row>;
    constexpr bool careful = row == careful_row;
    constexpr auto n = substeps<row>();
    constexpr auto weights = extrapolation_weights<row>();
    constexpr auto chains = column_chains<row>();

    const RotationRate<terms, Register> rate(coefficients);
    const Register y = loaded<Register>(from.y), f = rate(y), zero = broadcast<Register>(0);
    Register before[chains.chains], now[chains.chains], twice_h[chains.chains], column[K];
    // what was rounded away from each of them; not used unless careful
    Register lost_before[chains.chains], lost_now[chains.chains], lost_column[K];
    const auto start = [&](auto j) POLHODE_INLINE_LAMBDA {
        constexpr int c = chains.chain[j];
        const double h = H / n[j];
        before[c] = zero, now[c] = broadcast<Register>(h) * f, twice_h[c] = broadcast<Register>(2 * h);
        if constexpr (careful) lost_before[c] = zero, lost_now[c] = zero;
    };
    unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
        if constexpr (chains.first[j] == 0) start(j);
    });
    unrolled<chains.pieces>([&](auto piece) POLHODE_INLINE_LAMBDA {
        constexpr int begin = chains.ends[piece], end = chains.ends[piece + 1];
        for (int i = begin; i < end; ++i)
            unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
                if constexpr (chains.first[j] <= begin && end <= chains.last[j]) {
                    constexpr int c = chains.chain[j];
                    if constexpr (careful) {
                        const Register change = twice_h[c] * rate(y + (now[c] + lost_now[c])) + lost_before[c];
                        const Register next = before[c] + change;
                        lost_before[c] = lost_now[c], lost_now[c] = rounded_away(before[c], change, next);
                        before[c] = now[c], now[c] = next;
                    } else {
                        const Register next = before[c] + twice_h[c] * rate(y + now[c]);
                        before[c] = now[c], now[c] = next;
                    }
                }
            });
        unrolled<K>([&](auto j) POLHODE_INLINE_LAMBDA {
            if constexpr (chains.last[j] == end) {
                column[j] = now[chains.chain[j]];
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

/// The row chosen at run time.
template <RotationTerms terms, class Register>
POLHODE_INLINE void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                  const RotationState& from, double H, int row, RotationStep& to) {
    unrolled<rows - fewest_columns>([&](auto i) POLHODE_INLINE_LAMBDA {
        constexpr int number = fewest_columns + i;
        if (row == number) midpoint_step<number, terms, Register>(coefficients, allowance, from, H, to);
    });
}

using MidpointStep = void(const RotationCoefficients&, const RotationAllowance&, const RotationState&, double H,
                          int row, RotationStep& to);
/// The same step, and the same bits, by each instruction set.
MidpointStep midpoint_step_plain, midpoint_step_avx2, midpoint_step_avx512;
/// By the set at hand.
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
            return midpoint_step<RotationTerms::quadratic, Register>(coefficients, allowance, from, H, row, to);
    }
}

}  // namespace polhode
