// A recorded system made ready for its Taylor coefficients in binary64: straight lines of operations on numbered places
// in memory, for the interpreter (tape_interpreter.h) and for machine code (tape_code.h) alike.
//
// In the order k > 0 the coefficient of a node follows from sums of products, and of some but those of lower orders:
//
//   a b:     v_k = W_k                                       W_k = sum of a_j b_{k-j}            0 <= j <= k
//   a / b:   v_k = (-P_k + a_k - v_0 b_k) / b_0              P_k = sum of b_j v_{k-j}            0 < j < k
//   sqrt a:  v_k = (-P_k + a_k) / (2 v_0)                    P_k = sum of v_j v_{k-j}
//   sin a:   v_k = P_k / k + cos a_0 a_k                     P_k = sum of j a_j (cos a)_{k-j}
//   cos a:   v_k = -P_k / k - sin a_0 a_k                    P_k = sum of j a_j (sin a)_{k-j}
//
// Products and sums that one sum alone uses are dissolved into it: what is left to find in each order is one sum of
// terms for each other node, and one W for all its products. As soon as an order m of two factors is known, all that it
// adds to W_m and to the later ones is added, side by side in vector registers: W_{m+j} += x_m y_j + y_m x_j for j < m,
// and x_m y_m to W_{2m}; likewise for P, one order later.
//
// Products are added by fused multiplication and addition, rounded once (IEEE 754-2008, 5.4.1): half the operations,
// two thirds of the time that each waits for the one before, and as well defined as any other: the same bits by every
// processor, by code and by the interpreter.
#pragma once

#include <vector>

#include "motion/traced.h"

namespace polhode {

struct TapeProgram {
    static constexpr int none = -1;

    /// What is done to numbers in slots: to = ..
    enum class Kind {
        add,                  ///< a + b
        subtract,             ///< a - b
        multiply,             ///< a b
        product_plus,         ///< a b + c
        product_minus,        ///< a b - c
        minus_product,        ///< c - a b
        minus_product_minus,  ///< -a b - c
        divide,               ///< a / b
        root,                 ///< the square root of a
        sine_cosine,          ///< the sine of a; its cosine to b
        sum                   ///< W of the order at hand, of the a-th sum, with what that order adds to later ones
    };
    struct Operation {
        Kind kind = Kind::add;
        int to = none, a = none, b = none, c = none;
    };
    /// The products of two rows, times the number in the slot `weight`, if there is one, times -1 if negative.
    struct Pair {
        int x, y;
        int weight;
        bool negative;
    };
    /// The sum of the pairs first to end - 1, the first of which has no weight and is not negative.
    struct Sum {
        int to, first, end;
    };
    /// The coefficients of a slot as products need them: in W up to the order at hand, in P up to the one before.
    struct Row {
        int slot;
        int value;  ///< the slot of the coefficient 0; none: in P

        bool is_inner() const { return value == none; }
    };
    /// (k + 1) y_{k+1}: the number in a slot, times that in another, if there is one.
    struct Rate {
        int from, factor;
    };
    struct Constant {
        int slot;
        double value;
    };

    int states;                       ///< of which slot i holds the newest coefficient of the i-th
    int slots;                        ///< in all
    std::vector<Constant> constants;  ///< what slots hold before anything is done; all others zero
    std::vector<int> values;          ///< by state: the slot of y_0
    std::vector<Operation> begin;     ///< order 0, and what the later ones multiply by
    std::vector<Rate> first_rates;    ///< then, by state
    // each later order
    std::vector<Row> rows;
    std::vector<Pair> pairs;
    std::vector<Sum> sums;  ///< those of P first: they are found before all else
    int inner = 0;          ///< so many
    std::vector<Operation> step;
    std::vector<Rate> rates;  ///< by state
    // slots of what depends on the order at hand, k
    int order = none;                      ///< k, where used
    int inverse_order = none;              ///< 1/k, where used
    int next = none, inverse_next = none;  ///< k + 1 and 1/(k + 1)

    /// What a program is for: the coefficients of any order; or rates alone, which are its first_rates, not divided.
    enum class Purpose { series, rates };

    explicit TapeProgram(const Recording<double>& recording, Purpose purpose = Purpose::series);
};

}  // namespace polhode
