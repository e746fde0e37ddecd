// Quantities of a system of several bodies computed from the motions of its bodies alone: energy, momenta and the
// violation of its joints. Works for any trajectory and for the reference.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "body/body_motion.h"
#include "body/mass_properties.h"
#include "body/wide.h"
#include "scene/scene.h"

namespace polhode {

/// The names of a scene's bodies in order; empty in a scene of one body.
std::vector<std::string> body_names(const Scene& scene);
/// The index of a body by its name; -1 for "world".
int body_index(const Scene& scene, const std::string& name);
/// The index of a joint by its name; -1 if it does not exist.
int joint_index(const Scene& scene, const std::string& name);
/// The names of a scene's joints, then of its loops, in order.
std::vector<std::string> joint_names(const Scene& scene);

/// Tracks joint coordinates along a motion, from the scene's start. A motion determines an angle only up to full
/// revolutions, which a spring's energy depends on. The angle at the next time is the one nearest to the
/// extrapolation by the mean of the rates at both times, which must be accurate to half a revolution.
class JointCoordinates {
  public:
    /// The initial state of the scene, at t = 0.
    explicit JointCoordinates(const Scene& scene);

    /// The coordinates (rad or m) at the last time: two per joint in the scene's order, of which most joints use one.
    /// Joints without stiffness keep their initial values.
    std::span<const std::array<double, 2>> values() const { return values_; }

    /// Sets coordinates near those at time `t` (s), known from another source, so that revolutions are not tracked
    /// from before.
    void set(double t, std::span<const std::array<double, 2>> values);
    /// The number of full revolutions to add to `angle` (rad) at time `t` (s), where the coordinate's rate is `rate`
    /// (rad/s). Does not change the stored state: see keep().
    double turns(std::size_t joint, std::size_t axis, double t, double angle, double rate) const;
    /// Stores the coordinate of a joint and its rate at `t`.
    void keep(std::size_t joint, std::size_t axis, double t, double value, double rate);

  private:
    std::vector<std::array<double, 2>> values_, rates_, times_;
};

/// Energy and momenta of the whole system at one time.
template <class P>
struct SystemInvariants {
    P kinetic = P(0);  ///< kinetic energy, J; includes d x'^2 / 2 of each armature d
    /// Kinetic energy plus the potentials of gravity, springs, point springs, forces constant in the world at a body
    /// point, and joint stiffness, J.
    P energy = P(0);
    /// About the world's origin; if no joint ties the bodies to the world, about their common centre of mass. kg
    /// m^2/s
    Vector3<P> angular_momentum_W;
    Vector3<P> linear_momentum_W;  ///< kg m/s
    /// The sum of the lengths of the terms of angular_momentum_W, plus the angular momentum that the bodies would
    /// have if they rotated by one radian in the scene's duration, kg m^2/s. angular_momentum_W counts as zero within
    /// the round-off of this size.
    P angular_size = P(0);
    P linear_size = P(0);  ///< the corresponding size of linear_momentum_W, kg m/s
};

/// Violation of the joints and loops at one time.
template <class P>
struct JointViolations {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);  ///< no joint

    P gap = P(0);   ///< largest distance between points that should coincide, m
    P turn = P(0);  ///< largest angle between axes (or attitudes) that should coincide, rad
    /// Index in joint_names() of the joint with the largest gap; none if there is no gap.
    std::size_t gap_joint = none;
    std::size_t turn_joint = none;  ///< index of the joint with the largest turn; none if there is no turn
};

/// The mass properties of each body, exact in the scalar P. Instantiated for double and Wide; for other scalars
/// include motion/mechanism_motion_of.h.
template <class P>
std::vector<MassProperties<P>> bodies_mass_properties(const Scene& scene);

/// Evaluates the motions of a scene's bodies in maximal coordinates, independently of the tree recursion.
/// Instantiated for double and Wide; for other scalars include motion/mechanism_motion_of.h.
template <class P>
class MechanismMeasure {
  public:
    /// From a valid scene of several bodies.
    explicit MechanismMeasure(const Scene& scene);

    /// The number of bodies.
    std::size_t bodies() const { return bodies_.size(); }
    /// Whether a joint or a loop connects a body to the world.
    bool is_tied_to_world() const { return tied_to_world_; }
    /// The distance from each joint's child point (a loop's point on its second body) to that body's centre of mass,
    /// m, in the order of joint_names().
    std::vector<P> arms() const;

    /// Invariants of the motions of all bodies, in the scene's order, at time t (s) under the loads that act then.
    /// `coordinates` holds the joint coordinates at an earlier time and is updated.
    SystemInvariants<P> invariants(double t, std::span<const BodyMotion<P>> motions,
                                   JointCoordinates& coordinates) const;
    /// Violations of the joints by the motions of all bodies, in the scene's order. `gap` of a prismatic joint is the
    /// distance from its line, of a distance loop the deviation from its length. `turn` of a universal joint is the
    /// deviation of the angle between its axes, of prismatic and fixed joints the whole undesired rotation.
    JointViolations<P> violations(std::span<const BodyMotion<P>> motions) const;

  private:
    /// A point fixed in a body (from its centre of mass) or in the world.
    struct Point {
        int body = -1;  // -1: the world
        Vector3<P> arm;
    };
    struct Link {
        JointType type = JointType::revolute;
        Point parent, child;
        Quaternion<P> q0;
        std::array<Vector3<P>, 2> axes;  // unit
        P between = P(0);                // axes[0] . axes[1]
        std::array<P, 2> stiffness{P(0), P(0)}, rest{P(0), P(0)};
        Quaternion<P> rest_orientation;
        bool springy = false;
        std::array<P, 2> armature{P(0), P(0)};
        bool has_armature = false;
    };
    struct Closure {
        LoopType type = LoopType::spherical;
        Point first, second;
        Vector3<P> first_axis, second_axis;
        P length = P(0);
    };
    struct Field {
        Vector3<P> acceleration_W;
        Window window;
    };
    struct Pull {
        Point point;
        Vector3<P> force_W;
        Window window;
    };
    struct Twist {
        int body = -1;
        P stiffness = P(0);
        Quaternion<P> rest;  // conjugate
        Window window;
    };
    struct Strut {
        Point first, second;
        P stiffness = P(0), rest_length = P(0);
        Window window;
    };
    using Motions = std::span<const BodyMotion<P>>;

    std::vector<MassProperties<P>> bodies_;
    P slow_angular_ = P(0), slow_linear_ = P(0);  // of bodies that rotate by one radian in the scene's duration
    std::vector<Link> links_;
    std::vector<Closure> closures_;
    std::vector<Field> fields_;
    std::vector<Pull> pulls_;
    std::vector<Twist> twists_;
    std::vector<Strut> struts_;
    bool tied_to_world_ = false;

    static Vector3<P> placed(const Point& point, Motions motions);
    static Quaternion<P> attitude(const Point& point, Motions motions);
    static Quaternion<P> joint_rotation(const Link& link, Motions motions);
    P potential(double t, Motions motions) const;
    P armature_energy(const Link& link, Motions motions) const;
    P spring_energy(std::size_t joint, double t, Motions motions, JointCoordinates& coordinates) const;
};

/// @cond internal
extern template class MechanismMeasure<double>;
extern template class MechanismMeasure<Wide>;
/// @endcond

}  // namespace polhode
