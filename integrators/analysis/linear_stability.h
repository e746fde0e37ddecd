// Linear stability of the methods: how far a step may reach on motion that decays, and on motion that swings.
#pragma once

#include <complex>
#include <optional>

#include "integrators/method.h"

namespace polhode {

/// Spectral radius of one step of the method where the motion's eigenvalues times the step are z and its conjugate:
/// Method::growth, or Method::pendulum_growth with h gamma = -2 Re z and h^2 k = |z|^2. Where z is real: of drag alone,
/// h gamma = -z. Empty where the method has neither function.
std::optional<double> linear_growth(const Method& method, std::complex<double> z);

/// The largest r such that linear_growth(r exp(i angle)) <= 1 all the way from 0 to r, within 1e-6; 0 where it exceeds
/// 1 at once, infinity where it does not up to r = 1e8. Windows of instability narrower than a thousandth are not
/// looked for, nor an excess below 1e-12. Empty where there is no theory.
std::optional<double> stable_length(const Method& method, double angle);

/// stable_length() along the negative real axis: the h |lambda| of drag that it bears.
std::optional<double> real_interval(const Method& method);
/// Along the imaginary axis: the h times frequency of a spring.
std::optional<double> imaginary_interval(const Method& method);

}  // namespace polhode
