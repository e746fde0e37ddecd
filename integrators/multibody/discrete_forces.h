// What a variational integrator asks of a tree at a state: momenta and forces in the directions of its rates.
#pragma once

#include <cstddef>
#include <vector>

#include "motion/tree.h"

namespace polhode::multibody {

/// Of a state (x, v), in the order of the rates; those of attitudes by turns in the link's axes.
struct DiscreteForces {
    std::vector<double> momentum;  ///< p = dT/dv
    std::vector<double> force;     ///< dT/dx + Q
};

/// Sweeps over a tree: momenta, what kinetic energy changes by coordinates, and by Newton and Euler's equations the
/// generalized forces Q that bring about accelerations.
class JointSweeps {
  public:
    /// `y` = (x, v), `at`: what tree.move() makes of it, `a`: the rates' accelerations under the loads.
    void run(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a,
             DiscreteForces& out);

  private:
    std::vector<Vector3<double>> speed_;  // of the links' origins, their axes
    std::vector<Pair6<double>> momentum_, acceleration_, wrench_;

    void sweep_out(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a);
};

/// The maps of a turn exp(xi) between two attitudes q and q exp(xi), xi = h w in the body's axes, with E = [xi] x:
///   A = 1 + E/2 + c E^2,  c = (1 - (theta/2) cot(theta/2)) / theta^2,  theta = |xi|     (dexp^-1 of -xi)
///   tanh(E/4) = (tan(theta/4) / theta) E
/// For turns eta_k of q and eta_k+1 of q exp(xi) the change of xi is A eta_k+1 - A^T eta_k, and the attitude half-way,
/// q exp(xi/2), turns by (1 + tanh(E/4)) eta_k+1 / 2 + (1 - tanh(E/4)) eta_k / 2.
class TurnMaps {
  public:
    explicit TurnMaps(const Vector3<double>& xi);

    /// What a momentum dT/dw and a force half-way, times h/2, give at the begin: A w - (1 + tanh(E/4)) f.
    Vector3<double> at_begin(const Vector3<double>& momentum, const Vector3<double>& half_force) const;
    /// And at the end: A^T w + (1 - tanh(E/4)) f.
    Vector3<double> at_end(const Vector3<double>& momentum, const Vector3<double>& half_force) const;

  private:
    Vector3<double> xi_;
    double quadratic_, tangent_;
};

}  // namespace polhode::multibody
