// Coordinates and rates of the joints of several bodies, computed from the motions of the bodies. Works for the
// trajectory of any method and for the reference.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "body/body_motion.h"
#include "body/wide.h"
#include "motion/mechanism_motion.h"
#include "scene/scene.h"

namespace polhode {

/// The coordinates and rates of a joint at one time.
template <class P>
struct JointMotion {
    JointType type = JointType::revolute;     ///< determines which of the following members are used
    std::array<P, 2> coordinate{P(0), P(0)};  ///< rad with full revolutions, or m; [1] only for a universal joint
    std::array<P, 2> rate{P(0), P(0)};        ///< rad/s or m/s
    Quaternion<P> orientation;                ///< spherical: J, child axes to those at coordinate zero; |J| = 1
    Vector3<P> angular_velocity;              ///< spherical: child relative to parent, child axes, rad/s

    /// The coordinates: one (revolute, prismatic), two (universal), the four components of J (spherical) or none
    /// (fixed).
    std::vector<P> coordinates() const;
    /// The time derivatives of coordinates().
    std::vector<P> rates() const;
};

/// Computes joint motions from the motions of all bodies. With J = q0* q_parent* q_child, the angle of a revolute joint
/// is that of J about its axis, a universal joint's angles are those of J = exp(axes[0] x) exp(axes[1] y), and the
/// displacement of a prismatic joint is measured along its axis in the parent. Where a method lets the joints drift
/// apart, these are the coordinates of the nearest motion of the joint. Instantiated for double and Wide.
template <class P>
class JointKinematics {
  public:
    /// From a valid scene of several bodies.
    explicit JointKinematics(const Scene& scene);

    /// The motions of all joints at time t (s), in the scene's order, from those of all bodies, with |q| = 1.
    /// `tracked` holds the coordinates at an earlier time, to which full revolutions refer, and is updated.
    /// `previous`: the result at an earlier time, to whose quaternions those of spherical joints are nearest; empty:
    /// to the initial ones.
    std::vector<JointMotion<P>> at(double t, std::span<const BodyMotion<P>> motions, JointCoordinates& tracked,
                                   std::span<const JointMotion<P>> previous = {}) const;

  private:
    struct Link {
        JointType type = JointType::revolute;
        int parent = -1, child = -1;           // indices of bodies; -1: the world
        Vector3<P> parent_point, child_point;  // from the body's centre of mass; for the world, from W's origin
        Quaternion<P> q0;                      // unit
        std::array<Vector3<P>, 2> axes;        // unit
        Quaternion<P> start;                   // spherical: J at t = 0
    };
    std::vector<Link> links_;

    JointMotion<P> motion_of(const Link& link, std::span<const BodyMotion<P>> motions) const;
};

/// A header line t,joint,coordinate,rate, then at each time one line per coordinate, in the order of the joints and of
/// JointMotion::coordinates(). `times`: s. `motions`: at each time one per joint. `names`: the joints' names, without
/// those of loops.
std::string joints_csv(std::span<const double> times, std::span<const JointMotion<double>> motions,
                       std::span<const std::string> names);

/// @cond internal
extern template struct JointMotion<double>;
extern template struct JointMotion<Wide>;
extern template class JointKinematics<double>;
extern template class JointKinematics<Wide>;
/// @endcond

}  // namespace polhode
