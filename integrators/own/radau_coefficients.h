// Radau IIA formulas with 3, 5 and 7 stages, laid out so that all stages are processed side by side.
#pragma once

#include "integrators/lanes/lanes.h"
#include "integrators/own/four_systems.h"

namespace polhode {

/// Collocation at c_1 .. c_s = 1 over one step (Hairer & Wanner 1996, IV.5): Z = h (A x I) f(y + Z), y1 = y + Z_s, of
/// order 2 s - 1. Lanes beyond stage s are zero.
///
/// A^-1 = T Lambda T^-1 with (s - 1) / 2 complex pairs and one real eigenvalue. One eigenvalue of each pair is
/// stored: real parts in lane l, imaginary parts in lane 4 + l, l = 0, 1, 2. The real eigenvalue is in lane 3.
struct RadauCoefficients {
    int stages = 0;
    Lanes8 nodes{};
    Lanes8 a[8]{};                ///< A by columns
    Lanes8 to_eigenbasis[8]{};    ///< Lambda T^-1 by columns
    Lanes8 from_eigenbasis[8]{};  ///< T by columns: real parts, then imaginary parts
    Complex4 eigenvalue;          ///< eigenvalues of A^-1; 1 in unused lanes
    Lanes8 power[8]{};    ///< lane k, column j: coefficient of x^(k + 1) in the factor of Z_j, for the polynomial at
                          ///< 1 + x
    Lanes8 slope_at_0{};  ///< the derivative of the polynomial at 0 is the sum of slope_at_0[j] Z_j

    int order() const { return 2 * stages - 1; }
};

/// Returns the coefficients for 3, 5 or 7 stages.
const RadauCoefficients& radau_coefficients(int stages);

}  // namespace polhode
