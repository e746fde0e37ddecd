// Momenta and forces of a tree at a state in the directions of its rates, as a variational integrator requires them.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/tree.h"

namespace polhode::multibody {

/// Values at a state (x, v), in the order of the rates; attitudes by rotation vectors in the link's axes.
struct DiscreteForces {
    std::vector<double> momentum;  ///< p = dT/dv
    std::vector<double> force;     ///< dT/dx + Q
};

/// Recursive sweeps over a tree: momenta, derivatives of the kinetic energy with respect to coordinates, and the
/// generalized forces Q that cause given accelerations (Newton-Euler equations).
class JointSweeps {
  public:
    /// `y` = (x, v); `at`: computed by tree.move() for y; `a`: accelerations of the rates under the loads.
    void compute(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a,
                 DiscreteForces& out);

  private:
    std::vector<Vector3<double>> speed_;  // velocities of the links' origins, in link axes
    std::vector<Pair6<double>> momentum_, acceleration_, wrench_;

    void sweep_outward(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a);
};

/// Maps of a rotation exp(xi) between two attitudes q and q exp(xi), xi = h w in body axes, with E = [xi] x:
///   A = 1 + E/2 + c E^2,  c = (1 - (theta/2) cot(theta/2)) / theta^2,  theta = |xi|     (dexp^-1 of -xi)
///   tanh(E/4) = (tan(theta/4) / theta) E
/// For variations eta_k of q and eta_k+1 of q exp(xi), the variation of xi is A eta_k+1 - A^T eta_k, and that of the
/// midpoint attitude q exp(xi/2) is (1 + tanh(E/4)) eta_k+1 / 2 + (1 - tanh(E/4)) eta_k / 2.
class RotationMaps {
  public:
    explicit RotationMaps(const Vector3<double>& xi);

    /// Contribution of a momentum dT/dw and of h/2 times a midpoint force at the start: A w - (1 + tanh(E/4)) f.
    Vector3<double> start_momentum(const Vector3<double>& momentum, const Vector3<double>& half_force) const;
    /// Contribution at the end: A^T w + (1 - tanh(E/4)) f.
    Vector3<double> end_momentum(const Vector3<double>& momentum, const Vector3<double>& half_force) const;

  private:
    Vector3<double> xi_;
    double quadratic_, tangent_;
};

}  // namespace polhode::multibody
