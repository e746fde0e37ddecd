// A body that is slowed by drag and pushed by a constant torque, its attitude held: what a kick does where there is
// drag.
//
//   dy/dt = tau - D I^-1 y,   dv/dt = a - k v
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "motion/equations.h"

namespace polhode {

/// (1 - exp(-x)) / x
inline double mean_decay(double x) { return x == 0 ? 1 : -std::expm1(-x) / x; }

/// By how much v of dv/dt = a - k v changes in a time h of either sign.
inline Vector3<double> damped_change(const Vector3<double>& v, const Vector3<double>& a, double k, double h) {
    return (h * mean_decay(k * h)) * (a - k * v);
}

/// With u = V^T I^-1/2 y and the eigenvalues l of I^-1/2 D I^-1/2 = V diag(l) V^T: du/dt = V^T I^-1/2 tau - l u.
class RotationalDamping {
  public:
    RotationalDamping() = default;
    /// Principal axes.
    RotationalDamping(const Vector3<double>& moments, const Matrix3<double>& D) {
        for (int i = 0; i < 3; ++i) root_[i] = std::sqrt(moments[i]);
        Eigen::Matrix3d M;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) M(i, j) = 0.5 * (D[i][j] + D[j][i]) / (root_[i] * root_[j]);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(M);
        for (int i = 0; i < 3; ++i) {
            rate_[i] = solver.eigenvalues()[i];
            for (int j = 0; j < 3; ++j) axes_[i][j] = solver.eigenvectors()(j, i);
        }
    }

    /// By how much y changes in a time h of either sign: that alone goes to the eigenvectors' axes and back, so that
    /// their rounding is relative to it.
    Vector3<double> change(double h, const Vector3<double>& y, const Vector3<double>& tau) const {
        const Vector3<double> u = axes_ * unscaled(y), f = axes_ * unscaled(tau);
        Vector3<double> moved;
        for (int i = 0; i < 3; ++i) moved[i] = h * mean_decay(rate_[i] * h) * (f[i] - rate_[i] * u[i]);
        const Vector3<double> back = transposed(axes_) * moved;
        return {root_[0] * back[0], root_[1] * back[1], root_[2] * back[2]};
    }

  private:
    Vector3<double> root_, rate_;
    Matrix3<double> axes_;  ///< rows: the eigenvectors

    Vector3<double> unscaled(const Vector3<double>& y) const {
        return {y[0] / root_[0], y[1] / root_[1], y[2] / root_[2]};
    }
};

}  // namespace polhode
