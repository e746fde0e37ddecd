// A long tape made ready for its Taylor coefficients (tape_series.h): what is left to find in each order is one sum of
// terms for each place, and for some of them one sum of products of lower orders.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/traced.h"

namespace polhode {

/// A node of the tape has a place, or is a sum or a product that one sum alone uses and is dissolved into it. The
/// places of the state variables come first, in their order. A row holds the coefficients of a place that products
/// need.
struct TapePlan {
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
    /// weight * the products of two rows
    struct Pair {
        double weight;
        int x, y;
    };
    /// The sum of pairs first to end - 1, for a place.
    struct Sum {
        int place, first, end;
    };
    static constexpr int none = -1;

    std::vector<truth::Node<double>> nodes;
    std::vector<truth::Traced<double>> rates;
    // by node
    std::vector<int> place_of;  ///< none: dissolved
    std::vector<int> term_of;   ///< the first term of what has a place
    // by place
    std::vector<int> term_end;  ///< the end of its terms
    std::vector<Term> terms;    ///< with the shares that are constant
    std::vector<Share> shares;  ///< those that are not, but of quotients, roots, sines and cosines
    // by row
    std::vector<int> source;    ///< the place whose coefficients a_j it holds
    std::vector<int> slope_of;  ///< the place whose j a_j it holds: rows that follow the others
    std::vector<Pair> pairs;
    std::vector<Sum> sums;  ///< the short ones first
    std::size_t algebraic;  ///< from here on sums are of sines and cosines

    explicit TapePlan(const truth::Recording<double>& recording);
};

}  // namespace polhode
