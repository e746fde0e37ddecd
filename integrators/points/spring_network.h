// The links of a body made of points as springs: f = -k (|d| - l) d / |d| on one end, the opposite on the other.
#pragma once

#include <Eigen/Core>

#include "integrators/points/point_body.h"

namespace polhode {

class SpringNetwork {
  public:
    /// `stiffness` (N/m) of every link; with a pivot also of the spring that holds the material point there,
    /// f_i = -k c_i sum c_j r_j. The body must outlive it.
    SpringNetwork(const PointBody& body, double stiffness)
        : body_(&body), specific_stiffness_(stiffness / body.point_mass) {}

    /// a (3N numbers, m/s^2) = the springs' accelerations at r.
    void accelerations(const double* r, double* a) const;

    /// da/dr (1/s^2), 3N x 3N.
    Eigen::MatrixXd jacobian(const double* r) const;

  private:
    const PointBody* body_;
    double specific_stiffness_;  ///< k / m_i, 1/s^2
};

/// Angular frequencies (rad/s) of the network's slowest and fastest vibration about its rest.
struct SpringFrequencies {
    double slowest = 0, fastest = 0;
};
SpringFrequencies spring_frequencies(const PointBody& body, double stiffness);

/// N/m: so that the slowest vibration has 10^3 times the scene's largest angular velocity (or, in a scene without
/// rotation, of one radian in its duration). The stretch under rotation is then about 10^-6.
double default_stiffness(const Problem& problem, const PointBody& body);

}  // namespace polhode
