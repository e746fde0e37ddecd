// Finds the physically possible inertia tensor nearest to an impossible one.
#pragma once

#include <string>

#include "body/algebra.h"
#include "body/wide.h"

namespace polhode {

/// The tensor nearest to the given one whose principal moments satisfy the triangle inequality a + b >= c in every
/// order.
struct InertiaRepair {
    Matrix3<Wide> inertia;  ///< with the given principal axes, kg m^2
    double largest = 0;     ///< the largest principal moment that was given, kg m^2
    double excess = 0;      ///< largest moment minus the sum of the other two, as a fraction of `largest`; 0: possible
    double change = 0;      ///< largest change of a principal moment, kg m^2
    bool is_small = false;  ///< excess <= 1e-3: rounding of the numbers in the file

    /// "breaks the triangle inequality: its largest moment exceeds the sum of the other two by 0.012 of itself"
    std::string description() const;
};

/// Finds the smallest change (Euclidean norm of the change of the three principal moments) that makes the tensor
/// possible. A tensor that is possible within 1e-12 of its largest moment is returned unchanged.
InertiaRepair repair_inertia(const Matrix3<Wide>& inertia);

/// Rounds each entry to binary64. The result is symmetric.
Matrix3<double> round_tensor(const Matrix3<Wide>& inertia);

}  // namespace polhode
