// Transition matrix of a step: W(t) = d y(t) / d y(0), enclosed for every start near an exact point. It solves the
// variational equation, which is recorded by carrying W along the tape of the right-hand side:
//
//   W' = J(y(t)) W, W(0) = 1;   P' = J(p) P + d  (Taylor polynomials of y and W together, recorded as one system)
//   E = W - P:   E' = J(y) E + (J(y) - J(p)) P - d,   E(0) = 0
//
// Each column of E is bounded by the logarithmic norm. The effect of J(y) - J(p) on P is bounded node by node along the
// tape. W multiplies only errors, so that 96 bits plus the spare bits and a low order are sufficient.
#pragma once

#include <vector>

#include "integrators/series/series.h"
#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/balls/taylor.h"

namespace polhode::truth {

/// Position of an entry in W.
struct TransitionEntry {
    int row, column;
};

class Transition {
  public:
    /// Records the equations of W from `equations`, to which no reference is kept. `spare_bits`: see PiecePlan.
    Transition(const Recording<Ball>& equations, int order, double spare_bits = 0);

    /// Sets the order of the following expansions, at most the constructor's.
    void set_order(int order) { series_.set_order(order); }
    /// Expands W for t in [0, h] and for starts whose motion stays within `distance` of the motion from `point`.
    /// `growth` bounds the error growth within `allowed` of the motion from `point`. Lengths are in the norm.
    void expand(const std::vector<Ball>& point, const Bound& h, const Bound& distance, const Bound& growth,
                const Bound& allowed, const WeightedNorm& norm);
    /// Whether the last expansion has bounds on [0, h].
    bool is_bounded() const;
    /// W(t), stored by rows. Also encloses the mean of W over any line of such starts.
    std::vector<Ball> at(const Ball& t) const;

  private:
    // the variables: y, then the entries of W that are not identically zero
    int n_;
    long bits_;
    std::vector<TransitionEntry> entries_;
    Series<Ball> series_;
    std::vector<Bound> error_;  // upper bound of |E|, stored by rows
};

}  // namespace polhode::truth
