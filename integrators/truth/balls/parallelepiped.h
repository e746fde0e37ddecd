// A set that errors are kept in: the point + Q r, |r_k| <= a bound. After a step it is W Q r + what the step added; Q
// is turned after it by a QR factorisation, so that the set neither wraps nor degenerates (R. Lohner 1987; Nedialkov,
// Jackson & Corliss, Appl. Math. Comput. 105 (1999) 21). Q is any matrix of doubles, taken exactly; its inverse is
// enclosed.
#pragma once

#include <vector>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

class Parallelepiped {
  public:
    /// |e_i| <= radius[i]. scales: the sizes of the variables, in which Q is orthogonal.
    Parallelepiped(std::vector<double> scales, const std::vector<Bound>& radius);

    /// Bounds of |e_i| in the set.
    std::vector<Bound> components() const;
    /// Bounds of |(W e)_i|; W row by row.
    std::vector<Bound> components_after(const std::vector<Ball>& W) const;
    /// The set becomes one that holds W e + added, |added_i| <= the bound.
    void advance(const std::vector<Ball>& W, const std::vector<Bound>& added);

  private:
    std::size_t n_;
    std::vector<double> scales_, Q_;  // Q row by row
    std::vector<Bound> r_;

    std::vector<Ball> times_Q(const std::vector<Ball>& W) const;
    std::vector<Bound> times_r(const std::vector<Ball>& M) const;
};

}  // namespace polhode::truth
