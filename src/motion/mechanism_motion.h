// What a system of several bodies has by the motions of its bodies alone: energy and momenta, and how far its joints
// are from closed. For trajectories of anyone's making, and for the truth.
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

/// The names of a scene's bodies, in its order; empty in a scene of one.
std::vector<std::string> body_names(const Scene& scene);
/// The index of a body by its name; -1 for "world".
int body_index(const Scene& scene, const std::string& name);
/// The index of a joint by its name; -1 where there is none.
int joint_index(const Scene& scene, const std::string& name);
/// The names of a scene's joints, then of its loops, in the scene's order.
std::vector<std::string> joint_names(const Scene& scene);

/// The coordinates of joints along a motion, from the scene's start on. A motion tells an angle up to whole turns, and
/// a spring counts them: the angle at the next time is the one nearest to where the mean of the rates at both times
/// leads to, which must be within half a turn.
class JointCoordinates {
  public:
    /// As the scene starts, at t = 0.
    explicit JointCoordinates(const Scene& scene);

    /// The coordinates (rad or m) at the time last looked at: of each joint in the scene's order two, of which most
    /// have one. Those of joints without a stiffness stay as they start.
    std::span<const std::array<double, 2>> values() const { return values_; }

    /// At time `t` (s) the coordinates are near these, known from elsewhere: no angle is followed from before.
    void set(double t, std::span<const std::array<double, 2>> values);
    /// Goes on to the time `t` (s), where a coordinate's rate is `rate`: the one of `angle` and whole turns beside it
    /// (rad) that is meant, as the number of turns to be added. What is kept changes at `arrived`.
    double turns(std::size_t joint, std::size_t axis, double t, double angle, double rate) const;
    /// The coordinate of a joint and its rate at `t`.
    void keep(std::size_t joint, std::size_t axis, double t, double value, double rate);

  private:
    std::vector<std::array<double, 2>> values_, rates_, times_;
};

/// What bodies have together at one time.
template <class P>
struct SystemInvariants {
    P kinetic = P(0);  ///< energy, J
    /// Kinetic energy and the potentials of gravity, springs, point springs, forces constant in the world at a body
    /// point and of the joints' stiffness, J.
    P energy = P(0);
    /// About the world's origin; about the centre of mass of all where no joint ties them to the world. kg m^2/s
    Vector3<P> angular_momentum_W;
    Vector3<P> linear_momentum_W;  ///< kg m/s
    /// The sum of the lengths of what angular_momentum_W is made of and of what the bodies would have if they turned by
    /// a radian in the scene's duration, kg m^2/s: it vanishes to round-off of this.
    P angular_size = P(0);
    P linear_size = P(0);  ///< the same of linear_momentum_W, kg m/s
};

/// How far joints and loops are from closed at one time.
template <class P>
struct JointViolations {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);  ///< no joint

    P gap = P(0);   ///< largest distance between points that should coincide, m
    P turn = P(0);  ///< largest angle between axes (or attitudes) that should coincide, rad
    /// Where the gap is, of joint_names(); none where there is none.
    std::size_t gap_joint = none;
    std::size_t turn_joint = none;  ///< where the turn is, likewise
};

/// The mass properties of each body, exact in the scalar P. Made for double and Wide; for any other scalar include
/// motion/mechanism_motion_of.h.
template <class P>
std::vector<MassProperties<P>> bodies_mass_properties(const Scene& scene);

/// Measures the motions of a scene's bodies, in maximal coordinates: nothing of a tree's recursion enters. Made for
/// double and Wide; for any other scalar include motion/mechanism_motion_of.h.
template <class P>
class MechanismMeasure {
  public:
    /// Of a valid scene of several bodies.
    explicit MechanismMeasure(const Scene& scene);

    /// How many bodies there are.
    std::size_t bodies() const { return bodies_.size(); }
    /// Whether a joint or a loop ties a body to the world.
    bool tied() const { return tied_; }
    /// From the point of each joint's child (a loop's second body) to its centre of mass, m, in the order of
    /// joint_names().
    std::vector<P> arms() const;

    /// Of the motions of all bodies at time t (s), in the scene's order, under the loads that act then. `coordinates`:
    /// of this motion at an earlier time; they follow.
    SystemInvariants<P> invariants(double t, std::span<const BodyMotion<P>> motions,
                                   JointCoordinates& coordinates) const;
    /// Of the motions of all bodies, in the scene's order. What `gap` and `turn` mean: of a prismatic joint the
    /// distance from its line; of a distance loop from its length; of a universal joint how far the angle between its
    /// axes is from what it should be; of prismatic and fixed joints the whole rotation that should not be there.
    JointViolations<P> violations(std::span<const BodyMotion<P>> motions) const;

  private:
    /// A point fixed in a body, from its centre of mass, or in the world.
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
    P slow_angular_ = P(0), slow_linear_ = P(0);  // of bodies that turn by a radian in the scene's duration
    std::vector<Link> links_;
    std::vector<Closure> closures_;
    std::vector<Field> fields_;
    std::vector<Pull> pulls_;
    std::vector<Twist> twists_;
    std::vector<Strut> struts_;
    bool tied_ = false;

    static Vector3<P> placed(const Point& point, Motions motions);
    static Quaternion<P> attitude(const Point& point, Motions motions);
    static Quaternion<P> turned(const Link& link, Motions motions);
    P potential(double t, Motions motions) const;
    P spring_energy(std::size_t joint, double t, Motions motions, JointCoordinates& coordinates) const;
};

/// @cond internal
extern template class MechanismMeasure<double>;
extern template class MechanismMeasure<Wide>;
/// @endcond

}  // namespace polhode
