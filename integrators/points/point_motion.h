// Motion of a body made of points: its start, the effect of loads on each point, and the equivalent rigid motion.
//
// State: r_i, then v_i of every point, world axes. Loads act through their resultants. The force F and torque tau
// about the centre of mass (about the pivot if there is one) become the field of accelerations that they give a rigid
// body,
//   a_i = F/m + J^-1 tau x (r_i - c),   J the tensor of the points,
// so that force and torque are exact and only the rotation itself strains the distances.
#pragma once

#include "integrators/points/point_body.h"

namespace polhode {

/// Rigid-body interface of the points: initial state, events, loads and samples.
class PointMotion {
  public:
    /// Both arguments must outlive this object.
    PointMotion(const Problem& problem, const PointBody& body) : problem_(&problem), body_(&body) {}

    /// Sets y (6N numbers) at t = 0: r_i = p + R x_i, v_i = v + w x R x_i. Returns w in world axes, rad/s.
    Vector3<double> initial(double* y) const;

    /// Handles an event. Impulses act on the equivalent rigid motion and reset the points to the resulting one, at
    /// their nominal distances. Then selects the loads of the segment. Returns w in world axes after the impulses, if
    /// there are any.
    std::optional<Vector3<double>> enter(const Segment& segment, double* y);

    /// Adds the loads' accelerations (m/s^2) to a (3N numbers).
    void add_loads(double t, const double* y, double* a) const;
    bool has_loads() const { return has_loads_; }

    /// Attitude by best_rotation, w = J^-1 L with L and J about the centre of mass, p and v of the centre of mass.
    Sample sample(double t, const double* y) const;

  private:
    struct RigidState {
        PointCloud cloud;
        Vector3<double> velocity_W, angular_velocity_W;
        Quaternion<double> q;  ///< body to world; only if requested
    };
    RigidState compute_rigid_state(const double* y, bool attitude) const;
    void set_points(const Quaternion<double>& q, const Vector3<double>& angular_velocity_W,
                    const Vector3<double>& position_W, const Vector3<double>& velocity_W, double* y) const;

    const Problem* problem_;
    const PointBody* body_;
    const Segment* segment_ = nullptr;
    bool has_loads_ = false;
};

}  // namespace polhode
