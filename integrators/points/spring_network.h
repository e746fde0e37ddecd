// The links of a body made of points as springs with parallel dampers: with u = d / |d|,
//   f = -(k (|d| - l) + c d'.u) u   on one end, the opposite on the other.
// The dampers dissipate only vibrations, because a rigid motion does not change distances.
#pragma once

#include "integrators/points/point_body.h"
#include "integrators/series/linear_algebra.h"

namespace polhode {

/// Computes the accelerations of points on springs, and their Jacobians.
class SpringNetwork {
  public:
    /// Stiffness k (N/m) and damping c (N s/m) of every link, and with a pivot also of the spring and damper that
    /// hold the material point there, f_i = -c_i (k sum c_j r_j + c sum c_j v_j). `body` must outlive this object.
    SpringNetwork(const PointBody& body, double stiffness, double damping = 0)
        : body_(&body), specific_stiffness_(stiffness / body.point_mass), damping_per_stiffness_(damping / stiffness) {}

    /// Computes a (3N numbers, m/s^2), the accelerations in the state y = r, v.
    void accelerations(const double* y, double* a) const;

    /// da/dr of the springs (1/s^2), 3N x 3N.
    Eigen::MatrixXd jacobian(const double* r) const;
    /// da/dv (1/s).
    Eigen::MatrixXd velocity_jacobian(const double* r) const;
    bool is_damped() const { return damping_per_stiffness_ != 0; }

    /// Stretches points that move as a rigid body at their nominal distances (y = r, v; 6N numbers), including their
    /// velocities, so that the springs provide the accelerations of the rotation,
    ///   da/dr u = w x (w x r) + w' x r,   J w' = -w x J w.
    /// The remaining vibration has (rate/frequency) times the amplitude of the stretch. Solvers can then step over
    /// vibrations instead of resolving them.
    void apply_rotation_stretch(const Vector3<double>& angular_velocity_W, double* y) const;

  private:
    // Jacobian of springs whose tension, per stiffness and length, is `tension_free` ? 0 : 1 - l / |d|.
    Eigen::MatrixXd compute_jacobian(const double* r, bool tension_free) const;

    const PointBody* body_;
    double specific_stiffness_;     ///< k / m_i, 1/s^2
    double damping_per_stiffness_;  ///< c / k, s
};

}  // namespace polhode
