// Four complex linear systems (mu_l - J) x_l = r_l with one real matrix J, side by side. Collocation methods solve
// one for each eigenvalue of their coefficient matrix.
#pragma once

#include "integrators/lanes/lanes.h"

namespace polhode {

/// Four complex numbers side by side.
struct Complex4 {
    Lanes4 re{}, im{};

    friend Complex4 operator*(const Complex4& a, const Complex4& b) {
        return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    }
    friend Complex4 operator-(const Complex4& a, const Complex4& b) { return {a.re - b.re, a.im - b.im}; }
    friend Complex4 operator+(const Complex4& a, const Complex4& b) { return {a.re + b.re, a.im + b.im}; }
    friend Complex4 operator-(const Complex4& a) { return {-a.re, -a.im}; }
};

inline Complex4 reciprocal(const Complex4& z) {
    const Lanes4 scale = 1 / (z.re * z.re + z.im * z.im);
    return {z.re * scale, -(z.im * scale)};
}

/// J is the Jacobian of a body's motion (motion/systems.h): the first components are the rates, the others the
/// position and attitude. Elimination goes from the last component to the first. No pivot of the latter block can
/// vanish while Re mu > 0: those of v and p are mu + k and mu; those of q are ratios of minors of mu - Omega / 2 with
/// a skew Omega, whose eigenvalues are mu and mu +- i |w| / 2. No row exchanges are needed, so all four systems take
/// the same path. Rounding grows with |w| / |mu|, which is small for steps of less than one revolution. The remaining
/// block of the rates is inverted by cofactors.
template <int N, int rates>
class FourSystems {
  public:
    /// Requires Re mu > 0. J is stored row by row.
    [[gnu::always_inline]] inline void factor(const Complex4& mu, const double* J) {
        for (int i = 0; i < N; ++i)
            for (int j = 0; j < N; ++j) {
                const double x = -J[i * N + j];
                entry_[i][j].re = Lanes4{x, x, x, x};
                entry_[i][j].im = Lanes4{};
                if (i == j) entry_[i][j] = entry_[i][j] + mu;
            }
        for (int k = N - 1; k >= rates; --k) {
            entry_[k][k] = reciprocal(entry_[k][k]);
            for (int i = 0; i < k; ++i) {
                const Complex4 factor = entry_[i][k] * entry_[k][k];
                entry_[i][k] = factor;
                for (int j = 0; j < k; ++j) entry_[i][j] = entry_[i][j] - factor * entry_[k][j];
            }
        }
        invert_rates();
    }

    /// Solves in place: r in, x out.
    [[gnu::always_inline]] inline void solve(Complex4* x) const {
        for (int k = N - 1; k >= rates; --k)
            for (int i = 0; i < k; ++i) x[i] = x[i] - entry_[i][k] * x[k];
        Complex4 r[rates];
        for (int i = 0; i < rates; ++i) {
            r[i] = entry_[i][0] * x[0];
            for (int j = 1; j < rates; ++j) r[i] = r[i] + entry_[i][j] * x[j];
        }
        for (int i = 0; i < rates; ++i) x[i] = r[i];
        for (int k = rates; k < N; ++k) {
            for (int j = 0; j < k; ++j) x[k] = x[k] - entry_[k][j] * x[j];
            x[k] = entry_[k][k] * x[k];
        }
    }

  private:
    [[gnu::always_inline]] inline void invert_rates() {
        if constexpr (rates == 1) {
            entry_[0][0] = reciprocal(entry_[0][0]);
        } else {
            Complex4 cofactor[3][3];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                    cofactor[j][i] = entry_[i1][j1] * entry_[i2][j2] - entry_[i1][j2] * entry_[i2][j1];
                }
            const Complex4 scale = reciprocal(entry_[0][0] * cofactor[0][0] + entry_[0][1] * cofactor[1][0] +
                                              entry_[0][2] * cofactor[2][0]);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) entry_[i][j] = scale * cofactor[i][j];
        }
    }

    // Factors above the diagonal, rows below it, reciprocal pivots on it. The block of the rates is inverted.
    Complex4 entry_[N][N];
};

}  // namespace polhode
