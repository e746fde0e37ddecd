// Where a program's numbers stand in memory, for the interpreter and for machine code.
#pragma once

#include <algorithm>
#include <cstddef>

#include "integrators/tape/tape_program.h"

namespace polhode {

/// In units of eight bytes from the beginning of a cache line on: the slots, then for each row and each sum as many lanes
/// as an order has products, then the coefficients of the states, order by order.
struct TapeLayout {
    static constexpr int line = 8;        ///< numbers
    static constexpr int most_order = 34;  ///< lanes for two lines

    int order;
    int lanes;   ///< of a row: lane j - 1 holds the j-th coefficient; of a sum, the order that is j later
    int states;  ///< the numbers from one order's coefficients to the next
    std::size_t rows, sums, coefficients, end;

    TapeLayout(const TapeProgram& program, int order_) : order(order_), lanes(whole((order_ - 1) / 2)) {
        states = whole(program.states);
        rows = static_cast<std::size_t>(whole(program.slots));
        sums = rows + program.rows.size() * static_cast<std::size_t>(lanes);
        coefficients = sums + program.sums.size() * static_cast<std::size_t>(lanes);
        end = coefficients + static_cast<std::size_t>(states) * static_cast<std::size_t>(order + 1);
    }
    /// The lanes that products of the newest order m fill: those of later orders up to the last but one.
    int filled(int m) const { return std::min(m, order - 1 - m); }
    static int whole(int n) { return (n + line - 1) / line * line; }
};

}  // namespace polhode
