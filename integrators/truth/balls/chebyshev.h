// Polynomials on [-1, 1] as Chebyshev series with ball coefficients. A series represents every function whose value at
// each x lies in sum c_k T_k(x). Because |T_k| <= 1, the sum of |c_k| bounds the function.
#pragma once

#include <vector>

#include "integrators/truth/balls/ball.h"
#include "motion/traced.h"

namespace polhode::truth {

using ChebyshevSeries = std::vector<Ball>;

/// cos((i + 1/2) pi / m), i = 0..m - 1
Ball chebyshev_point(int i, int m);

/// The polynomial of degree m - 1 that takes the given values at the m Chebyshev points.
ChebyshevSeries interpolated(const std::vector<Ball>& values);

/// Uses T_a T_b = (T_(a+b) + T_|a-b|) / 2. Terms below the working precision are added to the radius of c_0.
ChebyshevSeries product(const ChebyshevSeries& a, const ChebyshevSeries& b);

/// d/dx of a polynomial. Not valid for a series that represents other functions besides the polynomial.
ChebyshevSeries derivative(const ChebyshevSeries& a);

/// Evaluates the series at x by Clenshaw's recurrence.
Ball value_at(const ChebyshevSeries& a, const Ball& x);

/// Upper bound of max |a| on [-1, 1].
Bound sum_of(const ChebyshevSeries& a);

/// Upper bound of max |a'| on [-1, 1], from |T_k'| <= k^2.
Bound slope_of(const ChebyshevSeries& a);

/// The rates of a recorded system along states that are given as Chebyshev series.
std::vector<ChebyshevSeries> rates_along(const Recording<Ball>& recording, const std::vector<ChebyshevSeries>& states);

}  // namespace polhode::truth
