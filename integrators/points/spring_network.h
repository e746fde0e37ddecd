// The links of a body made of points as springs, with dampers along them: with u = d / |d|,
//   f = -(k (|d| - l) + c d'.u) u   on one end, the opposite on the other.
// Dampers take energy from vibrations alone: a rigid motion does not move them.
#pragma once

#include "integrators/points/point_body.h"
#include "integrators/series/linear_algebra.h"

namespace polhode {

class SpringNetwork {
  public:
    /// Stiffness k (N/m) and damping c (N s/m) of every link; with a pivot also of the spring and damper that hold the
    /// material point there, f_i = -c_i (k sum c_j r_j + c sum c_j v_j). The body must outlive it.
    SpringNetwork(const PointBody& body, double stiffness, double damping = 0)
        : body_(&body), specific_stiffness_(stiffness / body.point_mass), damping_per_stiffness_(damping / stiffness) {}

    /// a (3N numbers, m/s^2) = the accelerations in the state y = r, v.
    void accelerations(const double* y, double* a) const;

    /// da/dr of the springs (1/s^2), 3N x 3N.
    Eigen::MatrixXd jacobian(const double* r) const;
    /// da/dv (1/s).
    Eigen::MatrixXd velocity_jacobian(const double* r) const;
    bool damped() const { return damping_per_stiffness_ != 0; }

    /// Stretches points that move as a rigid body at their unstretched distances (y = r, v; 6N numbers), and their
    /// velocities with them, so that the springs provide what the rotation needs,
    ///   da/dr u = w x (w x r) + w' x r,   J w' = -w x J w,
    /// and hardly vibrate: what is left has (rate/frequency) times the stretch. Solvers that would rather step over
    /// vibrations than follow them have this to thank.
    void settle(const Vector3<double>& angular_velocity_W, double* y) const;

  private:
    // of springs whose tension, per stiffness and length, is `relaxed` ? 0 : 1 - l / |d|
    Eigen::MatrixXd matrix(const double* r, bool relaxed) const;

    const PointBody* body_;
    double specific_stiffness_;     ///< k / m_i, 1/s^2
    double damping_per_stiffness_;  ///< c / k, s
};

}  // namespace polhode
