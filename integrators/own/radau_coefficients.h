// Radau IIA's formulas of 3, 5 and 7 stages, laid out so that all stages are worked on side by side.
#pragma once

#include "integrators/lanes/lanes.h"
#include "integrators/own/four_systems.h"

namespace polhode {

/// Collocation at c_1 .. c_s = 1 over one step (Hairer & Wanner 1996, IV.5): Z = h (A x I) f(y + Z), y1 = y + Z_s, of
/// order 2 s - 1. Lanes beyond the s-th stage are zero.
///
/// A^-1 = T Lambda T^-1 with (s - 1) / 2 complex pairs and one real eigenvalue. Of each pair one is kept: lane l of the
/// real parts and lane 4 + l of the imaginary ones, l = 0, 1, 2; the real one is lane 3.
struct RadauCoefficients {
    int stages = 0;
    Lanes8 nodes{};
    Lanes8 a[8]{};        ///< A by columns
    Lanes8 inward[8]{};   ///< Lambda T^-1 by columns
    Lanes8 outward[8]{};  ///< T by columns: those of real parts, then those of imaginary ones
    Complex4 eigenvalue;  ///< of A^-1; 1 where there is none
    Lanes8 power[8]{};    ///< lane k, column j: coefficient of x^(k + 1) in Z_j's part of the polynomial at 1 + x
    Lanes8 slope_at_0{};  ///< the polynomial's derivative at 0 is the sum of these times Z_j

    int order() const { return 2 * stages - 1; }
};

/// The coefficients for 3, 5 or 7 stages.
const RadauCoefficients& radau_coefficients(int stages);

}  // namespace polhode
