// One extrapolated step of a rotation on registers of eight lanes, all columns side by side.
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include "integrators/kernels/extrapolation_columns.h"
#include "integrators/kernels/rotation_lanes.h"


namespace polhode {

/// A rotation's state: y + lost, `lost` being what the last addition rounded away.
struct RotationState {
    alignas(64) double y[8] = {}, lost[8] = {};
};

/// What a step gave: the squared errors are sums over the components, in units of what is allowed of each.
struct RotationStep {
    RotationState state;
    double squared_error = 0;         ///< the error is of order 2K - 1 in H
    double squared_error_before = 0;  ///< with a column less: of order 2K - 3
};

/// What is allowed of each component; positive, also in the lane that is none.
struct RotationAllowance {
    alignas(64) double squared_scale[8] = {};
    double rounding = 0;  ///< more for every unit of increment and of amplification
};

/// f(integral_constant 0), f(1), .. f(count - 1)
template <class F, int... i>
POLHODE_INLINED void unrolled(std::integer_sequence<int, i...>, const F& f) {
    (f(std::integral_constant<int, i>()), ...);
}
template <int count, class F>
POLHODE_INLINED void unrolled(const F& f) {
    unrolled(std::make_integer_sequence<int, count>(), f);
}

/// The sum of (error_i / allowed_i)^2, allowed_i^2 = scale_i^2 + (rounding z_i)^2; not a number where an error is none.
template <class Register>
POLHODE_INLINED double squared_norm(const Register& error, const Register& allowed) {
    const Register ratios = (error * error) / allowed;
    const Register pairs = ratios + permuted<1, 0, 3, 2, 5, 4, 7, 6>(ratios);
    const Register fours = pairs + permuted<2, 3, 0, 1, 6, 7, 4, 5>(pairs);
    alignas(64) double sums[8];
    store(sums, fours);
    return sums[0] + sums[4];
}

/// z_(m+1) = z_(m-1) + 2h f(y + z_m), z_0 = 0, z_1 = h f(y), on the increments z: their rounding is relative to the
/// step's change, not to y. The step then adds z_n, no last smoothing: n is even.
template <int K, RotationTerms terms, class Register>
POLHODE_INLINED void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                   const RotationState& from, double H, RotationStep& to) {
    constexpr std::array<int, K> n = substeps<K>();
    constexpr ExtrapolationWeights<K> weights = extrapolation_weights<K>();
    constexpr ColumnChains<K> chains = column_chains<K>();

    const RotationRate<terms, Register> rate(coefficients);
    const Register y = loaded<Register>(from.y), f = rate(y), zero = broadcast<Register>(0);
    Register before[chains.chains], now[chains.chains], twice_h[chains.chains], column[K];
    const auto start = [&](auto j) POLHODE_INLINED_LAMBDA {
        constexpr int c = chains.chain[j];
        const double h = H / n[j];
        before[c] = zero, now[c] = broadcast<Register>(h) * f, twice_h[c] = broadcast<Register>(2 * h);
    };
    unrolled<K>([&](auto j) POLHODE_INLINED_LAMBDA {
        if constexpr (chains.first[j] == 0) start(j);
    });
    unrolled<chains.pieces>([&](auto piece) POLHODE_INLINED_LAMBDA {
        constexpr int begin = chains.ends[piece], end = chains.ends[piece + 1];
        for (int i = begin; i < end; ++i)
            unrolled<K>([&](auto j) POLHODE_INLINED_LAMBDA {
                if constexpr (chains.first[j] <= begin && end <= chains.last[j]) {
                    constexpr int c = chains.chain[j];
                    const Register next = before[c] + twice_h[c] * rate(y + now[c]);
                    before[c] = now[c], now[c] = next;
                }
            });
        unrolled<K>([&](auto j) POLHODE_INLINED_LAMBDA {
            if constexpr (chains.last[j] == end) column[j] = now[chains.chain[j]];
        });
        unrolled<K>([&](auto j) POLHODE_INLINED_LAMBDA {
            if constexpr (chains.first[j] == end) start(j);
        });
    });

    Register value = zero, error = zero, error_before = zero;
    unrolled<K - 1>([&](auto j) POLHODE_INLINED_LAMBDA {
        const Register difference = column[j] - column[K - 1];
        value = value + broadcast<Register>(weights.value[j]) * difference;
        error = error + broadcast<Register>(weights.error[j]) * difference;
        error_before = error_before + broadcast<Register>(weights.error_before[j]) * difference;
    });
    const Register rounding = broadcast<Register>(allowance.rounding * extrapolation_rows[K].amplification);
    const Register slack = rounding * column[K - 1];
    const Register allowed = loaded<Register>(allowance.squared_scale) + slack * slack;
    to.squared_error = squared_norm(error, allowed);
    to.squared_error_before = squared_norm(error_before, allowed);
    // y + z_K and what it rounds away (Knuth's sum), then the rest
    const Register sum = y + column[K - 1], part = sum - y;
    const Register rounded = (y - (sum - part)) + (column[K - 1] - part);
    const Register rest = (value + loaded<Register>(from.lost)) + rounded;
    const Register next = sum + rest, kept = next - sum;
    store(to.state.y, next);
    store(to.state.lost, (sum - (next - kept)) + (rest - kept));
}

/// K chosen at run time.
template <RotationTerms terms, class Register>
POLHODE_INLINED void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                   const RotationState& from, double H, int columns, RotationStep& to) {
    unrolled<most_columns - fewest_columns + 1>([&](auto i) POLHODE_INLINED_LAMBDA {
        constexpr int K = fewest_columns + i;
        if (columns == K) midpoint_step<K, terms, Register>(coefficients, allowance, from, H, to);
    });
}

using MidpointStep = void(const RotationCoefficients&, const RotationAllowance&, const RotationState&, double H,
                          int columns, RotationStep& to);
/// The same step, and the same bits, by each instruction set.
MidpointStep midpoint_step_plain, midpoint_step_avx2, midpoint_step_avx512;
/// By the set at hand.
MidpointStep* midpoint_step(InstructionSet set);

template <class Register>
POLHODE_INLINED void midpoint_step(const RotationCoefficients& coefficients, const RotationAllowance& allowance,
                                   const RotationState& from, double H, int columns, RotationStep& to) {
    switch (coefficients.terms) {
        case RotationTerms::none:
            return midpoint_step<RotationTerms::none, Register>(coefficients, allowance, from, H, columns, to);
        case RotationTerms::axial_field:
            return midpoint_step<RotationTerms::axial_field, Register>(coefficients, allowance, from, H, columns, to);
        case RotationTerms::quadratic:
            return midpoint_step<RotationTerms::quadratic, Register>(coefficients, allowance, from, H, columns, to);
    }
}

}  // namespace polhode

