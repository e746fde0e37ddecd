// How the end of a step depends on its beginning: the transition matrix W(t) = d y(t) / d y(0), enclosed for every
// beginning near an exact point, from the variational equation, recorded by carrying W along the tape of the one
// right-hand side:
//
//   W' = J(y(t)) W, W(0) = 1;   P' = J(p) P + d  (Taylor polynomials of y and W together, recorded as one system)
//   E = W - P:   E' = J(y) E + (J(y) - J(p)) P - d,   E(0) = 0
//
// so each column of E is bounded by the logarithmic norm, with what J(y) - J(p) does to P bounded node by node of the
// tape. W only ever multiplies what is as small as the errors: 64 bits and a low order do.
#pragma once

#include <vector>

#include "integrators/series/series.h"
#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/balls/taylor.h"

namespace polhode::truth {

/// Where an entry of W stands.
struct TransitionEntry {
    int row, column;
};

class Transition {
  public:
    /// Of the motion by these equations, of which nothing is kept. `spare_bits`: as PiecePlan has them.
    Transition(const Recording<Ball>& equations, int order, double spare_bits = 0);

    /// Sets the order of the expansions to come, at most the constructor's.
    void set_order(int order) { series_.set_order(order); }
    /// For t in [0, h] and beginnings such that the motion stays within `distance` of that from `point`. An error grows
    /// at most by `growth` on the way, within `allowed` of the motion from `point` (lengths in the norm).
    void expand(const std::vector<Ball>& point, const Bound& h, const Bound& distance, const Bound& growth,
                const Bound& allowed, const WeightedNorm& norm);
    /// W(t), row by row: true for the mean of W over any line of such beginnings, too.
    std::vector<Ball> at(const Ball& t) const;

  private:
    // the variables: y, then the entries of W that are not zero throughout
    int n_;
    long bits_;
    std::vector<TransitionEntry> entries_;
    Series<Ball> series_;
    std::vector<Bound> error_;  // |E|, row by row
};

}  // namespace polhode::truth
