// A body slowed by drag and accelerated by a constant torque, at fixed attitude: the flow of a kick with drag.
//
//   dy/dt = tau - D I^-1 y,   dv/dt = a - k v
#pragma once

#include <cmath>

#include "integrators/series/linear_algebra.h"
#include "motion/equations.h"

namespace polhode {

/// (1 - exp(-x)) / x.
template <class S>
S mean_decay(S x) {
    return x == 0 ? 1 : -std::expm1(-x) / x;
}

/// Change of v over a time h of either sign, for dv/dt = a - k v.
template <class S>
Vector3<S> damped_change(const Vector3<S>& v, const Vector3<S>& a, S k, S h) {
    return (h * mean_decay(k * h)) * (a - k * v);
}

/// With u = V^T I^-1/2 y and the eigenvalues l of I^-1/2 D I^-1/2 = V diag(l) V^T: du/dt = V^T I^-1/2 tau - l u.
template <class S>
class RotationalDampingOf {
  public:
    RotationalDampingOf() = default;
    /// Moments and damping matrix in principal axes.
    RotationalDampingOf(const Vector3<double>& moments, const Matrix3<double>& D) {
        double root[3];
        for (int i = 0; i < 3; ++i) root[i] = std::sqrt(moments[i]), root_[i] = S(root[i]);
        Eigen::Matrix3d M;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) M(i, j) = 0.5 * (D[i][j] + D[j][i]) / (root[i] * root[j]);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(M);
        for (int i = 0; i < 3; ++i) {
            rate_[i] = S(solver.eigenvalues()[i]);
            for (int j = 0; j < 3; ++j) axes_[i][j] = S(solver.eigenvectors()(j, i));
        }
    }

    /// Change of y over a time h of either sign. Only the change is transformed to the eigenvectors' axes and back,
    /// so rounding errors of the transformation are relative to it.
    Vector3<S> change(S h, const Vector3<S>& y, const Vector3<S>& tau) const {
        const Vector3<S> u = axes_ * unscaled(y), f = axes_ * unscaled(tau);
        Vector3<S> moved;
        for (int i = 0; i < 3; ++i) moved[i] = h * mean_decay(rate_[i] * h) * (f[i] - rate_[i] * u[i]);
        const Vector3<S> back = transposed(axes_) * moved;
        return {root_[0] * back[0], root_[1] * back[1], root_[2] * back[2]};
    }

  private:
    Vector3<S> root_, rate_;
    Matrix3<S> axes_;  ///< rows: the eigenvectors

    Vector3<S> unscaled(const Vector3<S>& y) const { return {y[0] / root_[0], y[1] / root_[1], y[2] / root_[2]}; }
};

}  // namespace polhode
