// Enclosure of a recorded polynomial system by Taylor series with a proven defect.
//
// From an exact point, balls c_k hold the Taylor coefficients of the solution through it. Let p be the polynomial of
// degree N with the true coefficients (numbers within the balls). Then p' and f(p) agree in every order below N, so
//
//   d(t) = p'(t) - f(p(t)) = -(terms of f(p) of order N and more),
//
// bounded on [0, h] along the tape: a node is its first N terms and a remainder R, with |.| summed term by term,
//
//   R(a b) = S(a, b) + |a| R(b) + R(a) |b| + R(a) R(b),    S(a, b) = sum of |a_j| |b_k| h^(j+k) over j + k >= N
//   R(a / b) = (S(b, q) + R(a) + R(b) |q|) / min |b|       q: the first terms of a / b; a / b - q = (a - b q) / b
//   R(sqrt a) = (S(r, r) + R(a)) / min r                   r: the first terms of sqrt a; (a - r^2) / (sqrt a + r)
//   R(sin a), R(cos a) = S(a, s) + S(a, c) + R(a)
//
// all in bounds rounded upward. For the last line, let A, s, c be the first terms of a and of its sine and cosine. The
// differences of sin A and cos A from s and c rotate by the angle A and grow by A' c - s' and -A' s - c'. Only orders
// from N - 1 on remain of these; a term t^(j+k-1) contributes |A_j| |c_k| h^(j+k) j / (j + k). No a-priori box has to
// be guessed. The distance of the motion from p follows from d by the logarithmic norm (norm.h) on the box swept by p
// and the allowed distance. While the bound stays within the allowed distance the motion is in the box, and by
// continuity it remains there (Hairer, Norsett & Wanner I.10).
#pragma once

#include <vector>

#include "integrators/series/series.h"
#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"

namespace polhode::truth {

/// |coefficient| h^k of the first N terms of every node, and |c_N| h^N of the state variables.
struct TermBounds {
    int order = 0;
    std::vector<Bound> node;   ///< `order` terms per node, node by node
    std::vector<Bound> least;  ///< lower bound of |c_0| of each node
    std::vector<Bound> last;   ///< |c_N| h^N of the state variables
};
TermBounds term_bounds(const Series<Ball>& series, const Bound& h);

/// Bounds on [0, h] along the polynomials.
struct Defect {
    std::vector<Bound> node;   ///< upper bound of |value| of every node of the tape
    std::vector<Bound> least;  ///< lower bound of |value| of every node
    std::vector<Bound> rate;   ///< upper bound of |d_i| of the state variables
};
Defect defect(const Recording<Ball>& recording, const TermBounds& terms);

/// Upper bounds of |f_i(y + e) - f_i(y)| along the polynomials y, where |e_j| <= moved[j]. With da the change of a:
///   |d(a b)| <= |a| |db| + |da| |b| + |da| |db|,  |d(a / b)| <= (|da| + |a / b| |db|) / (|b| - |db|),
///   |d sqrt a| <= |da| / sqrt a,  |d sin a| <= |da|.
std::vector<Bound> change_of_rates(const Recording<Ball>& recording, const Defect& along,
                                   const std::vector<Bound>& moved);

/// Boxes that contain p on each of `count` equal parts of [0, h], each widened by `margin`.
std::vector<std::vector<Ball>> swept_boxes(const Series<Ball>& series, const TermBounds& terms, const Ball& h,
                                           const std::vector<Bound>& margin, int count);

}  // namespace polhode::truth
