// Polynomials on [-1, 1] as Chebyshev series with balls for coefficients. A series stands for every function whose
// value at each x lies in sum c_k T_k(x); |T_k| <= 1 makes the sum of |c_k| a bound.
#pragma once

#include <vector>

#include "integrators/truth/balls/ball.h"
#include "motion/traced.h"

namespace polhode::truth {

using ChebyshevSeries = std::vector<Ball>;

/// cos((i + 1/2) pi / m), i = 0..m - 1
Ball chebyshev_point(int i, int m);

/// The polynomial of degree m - 1 through the values at the m points.
ChebyshevSeries interpolated(const std::vector<Ball>& values);

/// T_a T_b = (T_(a+b) + T_|a-b|) / 2; what falls below the working precision goes into the radius of c_0.
ChebyshevSeries product(const ChebyshevSeries& a, const ChebyshevSeries& b);

/// d/dx of a polynomial (exact coefficients stay meant: not for series that stand for other functions).
ChebyshevSeries derivative(const ChebyshevSeries& a);

/// By Clenshaw's recurrence.
Ball value_at(const ChebyshevSeries& a, const Ball& x);

/// max |a| on [-1, 1] is at most this.
Bound sum_of(const ChebyshevSeries& a);

/// max |a'| on [-1, 1] is at most this: |T_k'| <= k^2.
Bound slope_of(const ChebyshevSeries& a);

/// The rates of a recorded system along states that are such series.
std::vector<ChebyshevSeries> rates_along(const Recording<Ball>& recording, const std::vector<ChebyshevSeries>& states);

}  // namespace polhode::truth
