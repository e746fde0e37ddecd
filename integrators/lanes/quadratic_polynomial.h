// Quadratic polynomials as a scalar type. Evaluating the right-hand side on them gives its coefficients.
#pragma once

#include <array>

namespace polhode {

/// constant + sum of linear[i] x_i + sum over i <= j of quadratic[i][j] x_i x_j. Products of higher degree are
/// truncated and clear `exact`.
template <int variables>
struct QuadraticPolynomial {
    double constant = 0;
    std::array<double, variables> linear{};
    std::array<std::array<double, variables>, variables> quadratic{};
    bool exact = true;

    QuadraticPolynomial() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): a number is a polynomial
    QuadraticPolynomial(double value) : constant(value) {}
    /// The variable x_i.
    static QuadraticPolynomial variable(int i) {
        QuadraticPolynomial x;
        x.linear[i] = 1;
        return x;
    }
    bool has_linear() const {
        for (double value : linear)
            if (value != 0) return true;
        return false;
    }
    bool has_quadratic() const {
        for (const auto& row : quadratic)
            for (double value : row)
                if (value != 0) return true;
        return false;
    }

    friend QuadraticPolynomial operator+(QuadraticPolynomial a, const QuadraticPolynomial& b) {
        a.constant += b.constant;
        for (int i = 0; i < variables; ++i) {
            a.linear[i] += b.linear[i];
            for (int j = i; j < variables; ++j) a.quadratic[i][j] += b.quadratic[i][j];
        }
        a.exact = a.exact && b.exact;
        return a;
    }
    friend QuadraticPolynomial operator-(const QuadraticPolynomial& a) { return QuadraticPolynomial(-1) * a; }
    friend QuadraticPolynomial operator-(const QuadraticPolynomial& a, const QuadraticPolynomial& b) { return a + -b; }
    friend QuadraticPolynomial operator*(const QuadraticPolynomial& a, const QuadraticPolynomial& b) {
        QuadraticPolynomial c;
        c.constant = a.constant * b.constant;
        for (int i = 0; i < variables; ++i) {
            c.linear[i] = a.constant * b.linear[i] + a.linear[i] * b.constant;
            for (int j = i; j < variables; ++j) {
                c.quadratic[i][j] = a.constant * b.quadratic[i][j] + a.quadratic[i][j] * b.constant;
                c.quadratic[i][j] +=
                    i == j ? a.linear[i] * b.linear[i] : a.linear[i] * b.linear[j] + a.linear[j] * b.linear[i];
            }
        }
        const bool too_high =
            (a.has_quadratic() && (b.has_linear() || b.has_quadratic())) || (b.has_quadratic() && a.has_linear());
        c.exact = a.exact && b.exact && !too_high;
        return c;
    }
};

}  // namespace polhode
