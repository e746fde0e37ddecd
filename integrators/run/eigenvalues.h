// The rates at which a motion answers to small changes: eigenvalues of the Jacobian of its right-hand side.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "motion/problem.h"

namespace polhode {

/// Of a square matrix whose entries stand row by row, in no order; empty where one of them is not finite.
std::vector<std::complex<double>> eigenvalues(std::span<const double> J);

/// At a state of the motion, of the system as it was posed, 1/s, in no order; empty where the Jacobian is not finite.
std::vector<std::complex<double>> eigenvalues(const Problem& problem, const Sample& sample);

/// The first one of largest magnitude, or its conjugate: the one with Im >= 0; 0 of none.
std::complex<double> largest_in_magnitude(std::span<const std::complex<double>> eigenvalues);

}  // namespace polhode
