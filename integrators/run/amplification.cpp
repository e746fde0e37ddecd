#include "integrators/run/amplification.h"

#include <cmath>
#include <limits>
#include <vector>

#include "integrators/series/linear_algebra.h"

namespace polhode {

using Complex = std::complex<double>;

double magnitude(Complex x) {
    const double size = std::abs(x);
    return std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
}

double runge_kutta_amplification(std::span<const double> A, std::span<const double> b, Complex z) {
    const std::size_t stages = b.size();
    std::vector<Complex> k(stages);
    Complex sum = 0;
    for (std::size_t i = 0; i < stages; ++i) {
        Complex y = 1;
        for (std::size_t j = 0; j < i; ++j) y += A[i * stages + j] * k[j];
        k[i] = z * y / (1.0 - A[i * stages + i] * z);
        sum += b[i] * k[i];
    }
    return magnitude(1.0 + sum);
}

double explicit_euler_amplification(Complex z) { return magnitude(1.0 + z); }

double classical_amplification(Complex z) {
    return magnitude(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

double midpoint_amplification(Complex z) { return magnitude((2.0 + z) / (2.0 - z)); }

double radau_amplification(int stages, Complex z) {
    // Degrees k over j: the term of z^(i+1) is the term of z^i times (k - i) / ((i + 1) (j + k - i)) z. Both
    // polynomials are divided by z^j for large |z| to avoid overflow.
    const int k = stages - 1, j = stages;
    const bool large = std::abs(z) > 1;
    const auto polynomial = [&](int degree, Complex x) {
        Complex sum = 0, term = large ? 1.0 / std::pow(z, j) : Complex(1);
        for (int i = 0; i <= degree; ++i) {
            sum += term;
            term *= static_cast<double>(degree - i) / ((i + 1.0) * (j + k - i)) * x;
        }
        return sum;
    };
    return magnitude(polynomial(k, z) / polynomial(j, -z));
}

double largest_root(std::span<const Complex> c) {
    const auto n = static_cast<Eigen::Index>(c.size());
    Eigen::MatrixXcd companion = Eigen::MatrixXcd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) companion(0, i) = c[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 1; i < n; ++i) companion(i, i - 1) = 1;
    if (!companion.allFinite()) return std::numeric_limits<double>::infinity();
    return companion.eigenvalues().cwiseAbs().maxCoeff();
}

double spectral_radius(double a, double b, double c, double d) {
    const double half_trace = (a + d) / 2, half_difference = (a - d) / 2;
    const double discriminant = half_difference * half_difference + b * c;
    if (discriminant < 0) return std::sqrt(half_trace * half_trace - discriminant);
    const double size = std::abs(half_trace) + std::sqrt(discriminant);
    return std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
}

double semi_implicit_euler_pendulum_amplification(double damping, double stiffness) {
    return spectral_radius(1 - stiffness, 1 - damping, -stiffness, 1 - damping);
}

}  // namespace polhode
