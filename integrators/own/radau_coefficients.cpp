#include "integrators/own/radau_coefficients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "integrators/series/radau_nodes.h"

namespace polhode {
namespace {

using Real = long double;
using Complex = std::complex<Real>;
using Polynomial = std::vector<Real>;  // coefficient of x^k at index k

Polynomial multiply_by_root(const Polynomial& p, Real root) {
    Polynomial product(p.size() + 1, 0);
    for (std::size_t k = 0; k < p.size(); ++k) product[k + 1] += p[k], product[k] -= root * p[k];
    return product;
}

Polynomial derivative(const Polynomial& p) {
    Polynomial d;
    for (std::size_t k = 1; k < p.size(); ++k) d.push_back(static_cast<Real>(k) * p[k]);
    return d;
}

template <class S>
S evaluate(const Polynomial& p, const S& x) {
    S sum(0);
    for (std::size_t k = p.size(); k-- > 0;) sum = sum * x + S(p[k]);
    return sum;
}

// All zeros with non-negative imaginary part, by the Weierstrass (Durand-Kerner) iteration. Conjugate pairs come
// first, sorted by imaginary part, then the real zero.
std::vector<Complex> upper_zeros(Polynomial p) {
    const std::size_t n = p.size() - 1;
    for (Real& c : p) c /= p.back();
    Real radius = 0;
    for (std::size_t k = 0; k < n; ++k)
        radius = std::max(radius, std::pow(std::abs(p[k]), 1 / static_cast<Real>(n - k)));
    std::vector<Complex> zero(n);
    for (std::size_t k = 0; k < n; ++k) zero[k] = radius * std::pow(Complex(0.4L, 0.9L), static_cast<int>(k));
    for (int iteration = 0; iteration < 200; ++iteration)
        for (std::size_t k = 0; k < n; ++k) {
            Complex others = 1;
            for (std::size_t m = 0; m < n; ++m)
                if (m != k) others *= zero[k] - zero[m];
            zero[k] -= evaluate(p, zero[k]) / others;
        }
    std::sort(zero.begin(), zero.end(), [](const Complex& a, const Complex& b) { return a.imag() > b.imag(); });
    zero.resize((n + 1) / 2);
    zero.back().imag(0);
    return zero;
}

// Gauss-Jordan elimination with row exchanges.
std::vector<Real> invert(std::vector<Real> m, std::size_t n) {
    std::vector<Real> inverse(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) inverse[i * n + i] = 1;
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i)
            if (std::abs(m[i * n + k]) > std::abs(m[pivot * n + k])) pivot = i;
        const Real scale = 1 / m[pivot * n + k];
        for (std::size_t j = 0; j < n; ++j) {
            std::swap(m[k * n + j], m[pivot * n + j]), std::swap(inverse[k * n + j], inverse[pivot * n + j]);
            m[k * n + j] *= scale, inverse[k * n + j] *= scale;
        }
        for (std::size_t i = 0; i < n; ++i) {
            if (i == k) continue;
            const Real factor = m[i * n + k];
            for (std::size_t j = 0; j < n; ++j)
                m[i * n + j] -= factor * m[k * n + j], inverse[i * n + j] -= factor * inverse[k * n + j];
        }
    }
    return inverse;
}

using Nodes = RadauNodes<Real>;

// M = product of (x - c_i) and its derivatives.
std::vector<Polynomial> node_polynomials(const Nodes& radau) {
    Polynomial M{1};
    for (const Real& c : radau.c) M = multiply_by_root(M, c);
    std::vector<Polynomial> derivatives{M};
    for (std::size_t k = 0; k < radau.c.size(); ++k) derivatives.push_back(derivative(derivatives.back()));
    return derivatives;
}

// Stores the eigenvalues of A^-1, T and Lambda T^-1.
//
// Let p have degree s - 1 and A p = m p at the c_i. Then P(x) = integral of p from 0 to x equals m P' + M with M
// = product of (x - c_i), so P = sum of m^k M^(k). P(0) = 0 gives the eigenvalues 1 / m of A^-1, and P' at the
// c_i gives the eigenvectors.
void store_eigenbasis(const Nodes& radau, RadauCoefficients& result) {
    const std::size_t s = radau.c.size();
    const std::vector<Polynomial> derivatives = node_polynomials(radau);
    Polynomial characteristic(s + 1);
    for (std::size_t k = 0; k <= s; ++k) characteristic[s - k] = derivatives[k][0];
    const std::vector<Complex> eigenvalues = upper_zeros(characteristic);

    const auto lane_of = [&](std::size_t pair) { return pair + 1 == eigenvalues.size() ? std::size_t{3} : pair; };
    std::vector<Real> T(s * s);
    std::vector<std::size_t> lanes;  // of T's columns
    result.eigenvalue.re = Lanes4{1, 1, 1, 1};
    for (std::size_t pair = 0; pair < eigenvalues.size(); ++pair) {
        const Complex lambda = eigenvalues[pair];
        const std::size_t lane = lane_of(pair), column = lanes.size();
        const bool real = lane == 3;
        result.eigenvalue.re[lane] = static_cast<double>(lambda.real());
        result.eigenvalue.im[lane] = static_cast<double>(lambda.imag());
        lanes.push_back(lane);
        if (!real) lanes.push_back(4 + lane);
        const auto component = [&](std::size_t i) {
            Complex sum = 0, power = 1;
            for (std::size_t k = 1; k <= s; ++k, power /= lambda) sum += power * evaluate(derivatives[k], radau.c[i]);
            return sum;
        };
        const Complex last = component(s - 1);
        for (std::size_t i = 0; i < s; ++i) {
            const Complex v = component(i) / last;
            // A pair contributes v W plus its conjugate.
            T[i * s + column] = real ? v.real() : 2 * v.real();
            if (!real) T[i * s + column + 1] = -2 * v.imag();
        }
    }
    const std::vector<Real> back = invert(T, s);
    for (std::size_t column = 0; column < s; ++column) {
        const std::size_t lane = lanes[column];
        for (std::size_t i = 0; i < s; ++i) result.from_eigenbasis[lane][i] = static_cast<double>(T[i * s + column]);
        if (lane > 3) continue;
        const Complex lambda = eigenvalues[lane == 3 ? eigenvalues.size() - 1 : lane];
        for (std::size_t j = 0; j < s; ++j) {
            const Complex w(back[column * s + j], lane == 3 ? 0 : back[(column + 1) * s + j]), scaled = lambda * w;
            result.to_eigenbasis[j][lane] = static_cast<double>(scaled.real());
            result.to_eigenbasis[j][4 + lane] = static_cast<double>(scaled.imag());
        }
    }
}

// Stores the Lagrange basis on 0 and the c_i, in powers of x - 1. The polynomial of node 0 is multiplied by Z = 0.
void store_lagrange_basis(const Nodes& radau, RadauCoefficients& result) {
    const std::size_t s = radau.c.size();
    for (std::size_t j = 0; j < s; ++j) {
        Polynomial basis{radau.weights[j + 1]}, at_0{radau.weights[j + 1]};
        for (std::size_t m = 0; m <= s; ++m)
            if (m != j + 1) {
                basis = multiply_by_root(basis, radau.nodes[m] - 1);
                at_0 = multiply_by_root(at_0, radau.nodes[m]);
            }
        for (std::size_t k = 0; k < s; ++k) result.power[j][k] = static_cast<double>(basis[k + 1]);
        result.slope_at_0[j] = static_cast<double>(at_0[1]);
    }
}

RadauCoefficients compute_coefficients(int stages) {
    const Nodes radau(stages);
    const auto s = static_cast<std::size_t>(stages);
    RadauCoefficients result;
    result.stages = stages;
    for (std::size_t i = 0; i < s; ++i) {
        result.nodes[i] = static_cast<double>(radau.c[i]);
        for (std::size_t j = 0; j < s; ++j) result.a[j][i] = static_cast<double>(radau.a[i * s + j]);
    }
    store_eigenbasis(radau, result);
    store_lagrange_basis(radau, result);
    return result;
}

}  // namespace

const RadauCoefficients& radau_coefficients(int stages) {
    static const std::array<RadauCoefficients, 3> all{compute_coefficients(3), compute_coefficients(5),
                                                      compute_coefficients(7)};
    return all[static_cast<std::size_t>((stages - 3) / 2)];
}

}  // namespace polhode
