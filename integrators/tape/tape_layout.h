// Where a program's numbers stand in memory, for the interpreter and for machine code.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "integrators/tape/tape_program.h"

namespace polhode {

/// In units of eight bytes from the beginning of a cache line on: the slots, then for each row and each sum as many
/// lanes as an order has products, then the coefficients of the states, order by order.
struct TapeLayout {
    static constexpr int line = 8;  ///< numbers
    static constexpr int most_order = 32;
    static constexpr int most_lanes = 16;  ///< two lines, of that order

    int order;
    /// Of a row: lane j holds the j-th coefficient, of an inner one lane j - 1. Of a sum: lane j is what the order j
    /// later has so far, of an inner one lane j - 1.
    int lanes;
    int states;  ///< the numbers from one order's coefficients to the next
    std::size_t rows, sums, coefficients, end;

    /// `order_` is from 2 to most_order.
    TapeLayout(const TapeProgram& program, int order_) : order(order_), lanes(lanes_of(order_)) {
        if (order < 2 || order > most_order) throw std::invalid_argument("a series is of order 2 to 32");
        states = whole(program.states);
        rows = static_cast<std::size_t>(whole(program.slots));
        sums = rows + program.rows.size() * static_cast<std::size_t>(lanes);
        coefficients = sums + program.sums.size() * static_cast<std::size_t>(lanes);
        end = coefficients + static_cast<std::size_t>(states) * static_cast<std::size_t>(order + 1);
    }
    /// The lanes that products fill in the order k: those of later orders up to the last but one.
    int filled(int k) const { return std::max(std::min(k, order - 1 - k) + 1, std::min(k - 1, order - k)); }
    static constexpr int whole(int n) { return (n + line - 1) / line * line; }
    static constexpr int lanes_of(int order) { return whole((order - 1) / 2 + 1); }
};
static_assert(TapeLayout::lanes_of(TapeLayout::most_order) == TapeLayout::most_lanes);

}  // namespace polhode
