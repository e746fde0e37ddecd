// Linear stability of a step: by what factor it multiplies what it is applied to, at the most.
//
// On y' = lambda y a step is a matrix in z = h lambda, for a Runge-Kutta method the number R(z); on a damped pendulum,
// theta'' = -gamma theta' - k theta, it is one in c = h gamma and s = h^2 k, here always acting on (theta, h theta').
#pragma once

#include <complex>
#include <span>

namespace polhode {

/// |x|; infinite where x is not a number, as after an overflow.
double magnitude(std::complex<double> x);

/// |R(z)|, R(z) = 1 + z b^T (1 - z A)^-1 (1, .., 1), of `b.size()` stages; A row by row, zero above its diagonal.
double runge_kutta_growth(std::span<const double> A, std::span<const double> b, std::complex<double> z);

/// |1 + z|: the explicit Euler method.
double explicit_euler_growth(std::complex<double> z);
/// |1 + z + z^2/2 + z^3/6 + z^4/24|: every explicit method of order 4 in four stages.
double classical_growth(std::complex<double> z);
/// |(1 + z/2) / (1 - z/2)|: the implicit midpoint and the trapezoidal rule.
double midpoint_growth(std::complex<double> z);

/// Radau IIA: the Pade approximation of exp(z) with degrees s - 1 over s (E. Hairer & G. Wanner 1996, IV.3 and IV.5).
double radau_growth(int stages, std::complex<double> z);
template <int stages>
double radau_growth(std::complex<double> z) {
    return radau_growth(stages, z);
}

/// The largest |x| with x^n = c[0] x^(n-1) + .. + c[n-1].
double largest_root(std::span<const std::complex<double>> c);

/// The spectral radius of the matrix ((a, b), (c, d)).
double spectral_radius(double a, double b, double c, double d);

/// The growth of a game's update with its drag explicit, v+ = v - c v - s theta, theta+ = theta + v+.
double semi_implicit_euler_pendulum_growth(double damping, double stiffness);

}  // namespace polhode
