// Memory layout of a tape program's numbers, shared by the interpreter and compiled code.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "integrators/tape/tape_program.h"

namespace polhode {

/// Offsets in units of eight bytes from the start of a cache line: the slots, then the lanes of each row and of each
/// sum (as many lanes as an order has products), then the coefficients of the states, order by order.
struct TapeLayout {
    static constexpr int line = 8;  ///< numbers per cache line
    static constexpr int most_order = 32;
    static constexpr int most_lanes = 16;  ///< two lines, at most_order

    int order;
    /// Lanes per row or sum. Lane j of a row holds coefficient j, or j + 1 in a row of P. Lane j of a sum accumulates
    /// the value for j orders later, or j + 1 in a sum of P.
    int lanes;
    int states;  ///< stride from one order's coefficients to the next, in numbers
    std::size_t rows, sums, coefficients, end;

    /// Requires 2 <= order_ <= most_order; throws std::invalid_argument otherwise.
    TapeLayout(const TapeProgram& program, int order_) : order(order_), lanes(lanes_of(order_)) {
        if (order < 2 || order > most_order) throw std::invalid_argument("the order must be between 2 and 32");
        states = whole(program.states);
        rows = static_cast<std::size_t>(whole(program.slots));
        sums = rows + program.rows.size() * static_cast<std::size_t>(lanes);
        coefficients = sums + program.sums.size() * static_cast<std::size_t>(lanes);
        end = coefficients + static_cast<std::size_t>(states) * static_cast<std::size_t>(order + 1);
    }
    /// Number of lanes that products fill in order k, for later orders up to the last but one.
    int filled(int k) const { return std::max(std::min(k, order - 1 - k) + 1, std::min(k - 1, order - k)); }
    static constexpr int whole(int n) { return (n + line - 1) / line * line; }
    static constexpr int lanes_of(int order) { return whole((order - 1) / 2 + 1); }
};
static_assert(TapeLayout::lanes_of(TapeLayout::most_order) == TapeLayout::most_lanes);

}  // namespace polhode
