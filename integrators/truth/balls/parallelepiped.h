// A set that encloses errors: point + Q r with |r_k| <= a bound. A step maps it to W Q r plus the errors of the step. A
// QR factorisation then gives the new Q, which avoids wrapping and degeneration (R. Lohner 1987; Nedialkov, Jackson &
// Corliss, Appl. Math. Comput. 105 (1999) 21). Q is an arbitrary matrix of doubles, taken exactly; its inverse is
// enclosed.
#pragma once

#include <vector>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

class Parallelepiped {
  public:
    /// The set |e_i| <= radius[i]. `scales` are the sizes of the variables; Q is orthogonal in units of them.
    Parallelepiped(std::vector<double> scales, const std::vector<Bound>& radius);

    /// Upper bounds of |e_i| over the set.
    std::vector<Bound> components() const;
    /// Upper bounds of |(W e)_i| over the set. W is stored by rows.
    std::vector<Bound> components_after(const std::vector<Ball>& W) const;
    /// Replaces the set by one that contains W e + added, |added_i| <= the given bounds.
    void advance(const std::vector<Ball>& W, const std::vector<Bound>& added);

  private:
    std::size_t n_;
    std::vector<double> scales_, Q_;  // Q is stored by rows
    std::vector<Bound> r_;

    std::vector<Ball> times_Q(const std::vector<Ball>& W) const;
    std::vector<Bound> times_r(const std::vector<Ball>& M) const;
};

}  // namespace polhode::truth
