// Eigenvalues of the Jacobian of a motion's right-hand side: the rates of its response to small perturbations.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "motion/problem.h"

namespace polhode {

/// Eigenvalues of a square matrix stored by rows, in no order; empty if an entry is not finite.
std::vector<std::complex<double>> eigenvalues(std::span<const double> J);

/// Eigenvalues at a state of the motion, 1/s, for the system as posed, in no order. Empty if the Jacobian is not
/// finite, and for systems with a model (mechanisms, user-defined systems).
std::vector<std::complex<double>> eigenvalues(const Problem& problem, const Sample& sample);

/// The first eigenvalue of largest magnitude, or its conjugate, with Im >= 0; 0 for an empty list.
std::complex<double> largest_in_magnitude(std::span<const std::complex<double>> eigenvalues);

}  // namespace polhode
