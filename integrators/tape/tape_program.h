// A recorded system compiled to a program for its Taylor coefficients in binary64: straight-line operations on
// numbered memory slots. The interpreter (tape_interpreter.h) and the code generator (tape_code.h) share it.
//
// In each order k > 0, the coefficient of a node follows from sums of products (W) and, except for products, from
// sums over lower orders (P):
//
//   a b:     v_k = W_k                                       W_k = sum of a_j b_{k-j}            0 <= j <= k
//   a / b:   v_k = (-P_k + a_k - v_0 b_k) / b_0              P_k = sum of b_j v_{k-j}            0 < j < k
//   sqrt a:  v_k = (-P_k + a_k) / (2 v_0)                    P_k = sum of v_j v_{k-j}
//   sin a:   v_k = P_k / k + cos a_0 a_k                     P_k = sum of j a_j (cos a)_{k-j}
//   cos a:   v_k = -P_k / k - sin a_0 a_k                    P_k = sum of j a_j (sin a)_{k-j}
//
// A product or sum that is used by only one sum is merged into it. In each order, every remaining node then needs one
// sum of terms and one W for all its products. Once order m of two factors is known, its contributions to W_m and to
// all later W are added side by side in vector registers: W_{m+j} += x_m y_j + y_m x_j for j < m, and W_{2m} += x_m
// y_m. Sums P work the same way, one order later.
//
// Products are added with fused multiply-adds, which round once (IEEE 754-2008, 5.4.1). This takes half the
// operations and two thirds of the latency, and gives the same bits on every processor, in compiled code and in the
// interpreter.
// processor, by code and by the interpreter.
#pragma once

#include <vector>

#include "motion/traced.h"

namespace polhode {

/// The operations of a recorded system, by order.
struct TapeProgram {
    static constexpr int none = -1;

    /// Operations on numbers in slots: to = ..
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
        sine_cosine,          ///< sin a; cos a goes to b
        sum                   ///< W of sum a in the current order; also adds this order's contributions to later
                              ///< orders
    };
    struct Operation {
        Kind kind = Kind::add;
        int to = none, a = none, b = none, c = none;
    };
    /// Product of two rows, times the number in slot `weight` unless it is `none`, times -1 if `negative`.
    struct Pair {
        int x, y;
        int weight;
        bool negative;
    };
    /// Sum of the pairs `first` to `end` - 1. The first pair has no weight and is not negative.
    struct Sum {
        int to, first, end;
    };
    /// The coefficients of a slot as factors of products: up to the current order in W, up to the previous one in P.
    struct Row {
        int slot;
        int value;  ///< slot of coefficient 0; none: a row of P

        bool is_inner() const { return value == none; }
    };
    /// (k + 1) y_{k+1}: the number in slot `from`, times that in slot `factor` unless it is `none`.
    struct Rate {
        int from, factor;
    };
    struct Constant {
        int slot;
        double value;
    };

    int states;                       ///< slot i < states holds the newest coefficient of state i
    int slots;                        ///< total number
    std::vector<Constant> constants;  ///< initial slot contents; all other slots start at zero
    std::vector<int> values;          ///< by state: the slot of y_0
    std::vector<Operation> begin;     ///< order 0, and the factors that later orders multiply by
    std::vector<Rate> first_rates;    ///< by state: the rates of order 0
    // Operations of each later order.
    std::vector<Row> rows;
    std::vector<Pair> pairs;
    std::vector<Sum> sums;  ///< the sums of P come first, as they are computed first
    int inner = 0;          ///< number of sums of P
    std::vector<Operation> step;
    std::vector<Rate> rates;  ///< by state
    // Slots of numbers that depend on the current order k.
    int order = none;                      ///< k, where used
    int inverse_order = none;              ///< 1/k, where used
    int next = none, inverse_next = none;  ///< k + 1 and 1/(k + 1)

    /// Purpose of a program: coefficients of any order, or only the rates. The rates are first_rates, not divided by
    /// k + 1.
    enum class Purpose { series, rates };

    explicit TapeProgram(const Recording<double>& recording, Purpose purpose = Purpose::series);
};

}  // namespace polhode
