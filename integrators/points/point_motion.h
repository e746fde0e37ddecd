// The motion of a body made of points: how it starts, what its loads do to each point, and the rigid motion that the
// points stand for.
//
// State: r_i then v_i of every point, world axes. Loads act through their resultants: force F and torque tau about the
// centre of mass (about the pivot where there is one) become the field of accelerations that they give a rigid body,
//   a_i = F/m + J^-1 tau x (r_i - c),   J the points' own tensor,
// so that force and torque are exact, and no distance is strained but by the rotation itself.
#pragma once

#include "integrators/points/point_body.h"

namespace polhode {

class PointMotion {
  public:
    /// Both must outlive it.
    PointMotion(const Problem& problem, const PointBody& body) : problem_(&problem), body_(&body) {}

    /// y (6N numbers) at t = 0: r_i = p + R x_i, v_i = v + w x R x_i. Returns w in world axes.
    Vector3<double> initial(double* y) const;

    /// An event: its impulses act on the rigid motion that the points stand for, and put them into the one that
    /// follows, at their own distances; then its loads act. Returns w in world axes after the impulses, if any.
    std::optional<Vector3<double>> enter(const Segment& segment, double* y);

    /// Adds the loads' accelerations (m/s^2) to a (3N numbers).
    void add_loads(double t, const double* y, double* a) const;
    bool loaded() const { return loaded_; }

    /// Attitude by best_rotation, w = J^-1 L with L and J about the centre of mass, p and v of the centre of mass.
    Sample sample(double t, const double* y) const;

  private:
    struct Reading {
        PointCloud cloud;
        Vector3<double> velocity_W, angular_velocity_W;
        Quaternion<double> q;  ///< body to world; only where asked for
    };
    Reading read(const double* y, bool attitude) const;
    void place(const Quaternion<double>& q, const Vector3<double>& angular_velocity_W,
               const Vector3<double>& position_W, const Vector3<double>& velocity_W, double* y) const;

    const Problem* problem_;
    const PointBody* body_;
    const Segment* segment_ = nullptr;
    bool loaded_ = false;
};

}  // namespace polhode
