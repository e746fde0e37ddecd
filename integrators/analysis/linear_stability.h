// Linear stability of the methods: the longest stable step for decaying and for oscillating motion.
#pragma once

#include <complex>
#include <optional>

#include "integrators/method.h"

namespace polhode {

/// Spectral radius of one step if the eigenvalues of the motion times the step are z and its conjugate. Uses
/// Method::amplification, or Method::pendulum_amplification with h gamma = -2 Re z and h^2 k = |z|^2. For real z (drag
/// alone), h gamma = -z. Empty if the method has neither function.
std::optional<double> linear_amplification(const Method& method, std::complex<double> z);

/// The largest r with linear_amplification(r exp(i angle)) <= 1 on all of [0, r], within 1e-6. Returns 0 if it exceeds
/// 1 at once and infinity if it does not exceed 1 up to r = 1e8. Not detected: excesses below 1e-12, and windows of
/// instability narrower than the scan step (1e-3 up to r = 100, then 1 % of r). Empty if the method has no growth.
std::optional<double> stable_length(const Method& method, double angle);

/// stable_length() along the negative real axis: the largest stable h |lambda| of drag.
std::optional<double> real_interval(const Method& method);
/// stable_length() along the imaginary axis: the largest stable step times angular frequency of a spring.
std::optional<double> imaginary_interval(const Method& method);

}  // namespace polhode
