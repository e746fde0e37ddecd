// Linear stability of one step: the largest factor by which it multiplies its argument.
//
// On y' = lambda y a step is a function of z = h lambda; for a Runge-Kutta method it is the number R(z). On a damped
// pendulum, theta'' = -gamma theta' - k theta, it is a matrix in c = h gamma and s = h^2 k on (theta, h theta').
#pragma once

#include <complex>
#include <span>

namespace polhode {

/// |x|; infinite if x is NaN, as after an overflow.
double magnitude(std::complex<double> x);

/// |R(z)|, R(z) = 1 + z b^T (1 - z A)^-1 (1, .., 1), `b.size()` stages. A is stored by rows, zero above its diagonal.
double runge_kutta_amplification(std::span<const double> A, std::span<const double> b, std::complex<double> z);

/// |1 + z|: explicit Euler method.
double explicit_euler_amplification(std::complex<double> z);
/// |1 + z + z^2/2 + z^3/6 + z^4/24|: every explicit method of order 4 with four stages.
double classical_amplification(std::complex<double> z);
/// |(1 + z/2) / (1 - z/2)|: implicit midpoint rule and trapezoidal rule.
double midpoint_amplification(std::complex<double> z);

/// Radau IIA: the Pade approximation of exp(z) of degrees s - 1 over s (E. Hairer & G. Wanner 1996, IV.3 and IV.5).
double radau_amplification(int stages, std::complex<double> z);
template <int stages>
double radau_amplification(std::complex<double> z) {
    return radau_amplification(stages, z);
}

/// The largest |x| that satisfies x^n = c[0] x^(n-1) + .. + c[n-1].
double largest_root(std::span<const std::complex<double>> c);

/// The spectral radius of the matrix ((a, b), (c, d)).
double spectral_radius(double a, double b, double c, double d);

/// The growth factor of semi-implicit Euler with explicit drag, v+ = v - c v - s theta, theta+ = theta + v+.
double semi_implicit_euler_pendulum_amplification(double damping, double stiffness);

}  // namespace polhode
