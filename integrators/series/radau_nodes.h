// Radau IIA collocation tables for any number of stages, in any scalar (Hairer & Wanner, Solving ODEs II, IV.5).
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace polhode {

/// P_k(x) for k = 0..n, by Bonnet's recurrence.
template <class P>
std::vector<P> legendre(const P& x, int n) {
    std::vector<P> value{P(1), x};
    for (int k = 2; k <= n; ++k) value.push_back((P(2 * k - 1) * x * value[k - 1] - P(k - 1) * value[k - 2]) / P(k));
    return value;
}

/// The collocation table of `stages` stages.
template <class P>
struct RadauNodes {
    int stages;
    std::vector<P> c;             ///< nodes in (0, 1]; the last one is 1
    std::vector<P> b;             ///< weights
    std::vector<P> a;             ///< a[i * stages + j] = integral of the j-th Lagrange polynomial from 0 to c_i
    std::vector<P> nodes;         ///< 0 and the c_i, where the collocation polynomial is known
    std::vector<P> weights;       ///< barycentric weights of `nodes`
    std::vector<P> last;          ///< Legendre coefficient of degree `stages`: dot product of `last` and the values at
                                  ///< `nodes`
    std::vector<P> last_but_one;  ///< Legendre coefficient of degree stages - 1, from the values at the c_i
                                  ///< (quadrature)

    explicit RadauNodes(int s);

    /// Lagrange basis on `nodes` at theta.
    std::vector<P> basis(const P& theta) const { return lagrange(nodes, weights, theta); }

  private:
    static std::vector<P> barycentric(const std::vector<P>& nodes) {
        std::vector<P> weights;
        for (std::size_t j = 0; j < nodes.size(); ++j) {
            P product(1);
            for (std::size_t m = 0; m < nodes.size(); ++m)
                if (m != j) product *= nodes[j] - nodes[m];
            weights.push_back(P(1) / product);
        }
        return weights;
    }
    static std::vector<P> lagrange(const std::vector<P>& nodes, const std::vector<P>& weights, const P& x) {
        std::vector<P> value(nodes.size(), P(0));
        P all(1);
        for (std::size_t j = 0; j < nodes.size(); ++j) {
            if (x == nodes[j]) {
                value[j] = P(1);
                return value;
            }
            all *= x - nodes[j];
        }
        for (std::size_t j = 0; j < nodes.size(); ++j) value[j] = all * weights[j] / (x - nodes[j]);
        return value;
    }
};

template <class P>
RadauNodes<P>::RadauNodes(int s) : stages(s), a(static_cast<std::size_t>(s) * s) {
    for (int i = 0; i < s; ++i) {
        // Zeros of P_{s-1} - P_s by Newton's method; the last one is 1.
        P x(std::cos(2 * std::numbers::pi * (s - 1 - i) / (2 * s - 1)));
        for (int iteration = 0; i < s - 1 && iteration < 12; ++iteration) {
            const std::vector<P> p = legendre(x, s);
            // (x^2 - 1) P_k' = k (x P_k - P_{k-1})
            const P slope = (P(s - 1) * (x * p[s - 1] - p[s - 2]) - P(s) * (x * p[s] - p[s - 1])) / (x * x - P(1));
            x -= (p[s - 1] - p[s]) / slope;
        }
        const P end = legendre(x, s)[s - 1];
        c.push_back((P(1) + x) / P(2));
        b.push_back((P(1) + x) / (P(2) * P(s) * P(s) * end * end));
    }
    const std::vector<P> own = barycentric(c);
    // The rule integrates polynomials of degree 2 s - 2 exactly, including the Lagrange polynomials on [0, c_i].
    for (int i = 0; i < s; ++i)
        for (int m = 0; m < s; ++m) {
            const std::vector<P> value = lagrange(c, own, c[i] * c[m]);
            for (int j = 0; j < s; ++j) a[static_cast<std::size_t>(i) * s + j] += c[i] * b[m] * value[j];
        }
    nodes.assign(1, P(0));
    nodes.insert(nodes.end(), c.begin(), c.end());
    weights = barycentric(nodes);
    // A Legendre polynomial on [0, 1] has the leading coefficient C(2 s, s).
    P leading(1);
    for (int k = 1; k <= s; ++k) leading *= P(s + k) / P(k);
    last_but_one.assign(1, P(0));
    for (const P& weight : weights) last.push_back(weight / leading);
    for (int j = 0; j < s; ++j) last_but_one.push_back(P(2 * s - 1) * b[j] * legendre(P(P(2) * c[j] - P(1)), s)[s - 1]);
}

}  // namespace polhode
