// A scene of several bodies with the faults of a hypothesis, advanced by one row of a file.
//
// Bodies are in maximal coordinates (integrators/maximal): a file gives the pose and the velocity of each body, and its
// bodies may be slightly off the joints. Velocities are compared in the coordinates of the joints, where an engine in
// joint coordinates and one that holds bodies together by impulses agree up to their discretisation errors.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "check/hypothesis.h"
#include "integrators/maximal/system.h"

namespace polhode {

/// A constant torque or force against the rate of a joint's coordinate, N m or N.
struct JointFriction {
    std::size_t joint = 0;  ///< in the scene's order
    std::size_t axis = 0;   ///< of a universal joint 0 or 1
    double size = 0;        ///< N m or N
};

/// A cause in a scene of several bodies.
struct SystemCause : Cause {
    std::vector<JointFriction> friction;  ///< beside what the scene has
};

/// How an engine advances several bodies.
enum class SystemRule {
    accurate,        ///< Runge-Kutta steps of order 4
    joint_impulses,  ///< semi-implicit Euler of each body, then impulses that bring the velocities onto the joints
    joint_impulses_implicit,  ///< the same with one Newton step of the implicit gyroscopic term
    joint_rates,              ///< semi-implicit Euler of the joints' coordinates
};
/// For people: "accurate steps".
std::string_view name_of(SystemRule rule);

/// The state of all bodies at one time, as the file has it.
struct SystemState {
    std::vector<BodyMotion<double>> bodies;  ///< in the scene's order
    std::vector<double> angles;              ///< of the joints that count turns (integrators/maximal/system.h)
};

/// The equations of a cause.
class SystemEngine {
  public:
    /// The cause's bodies must be given by numbers. Throws InputError where the scene has no start.
    explicit SystemEngine(const SystemCause& cause);

    const maximal::System<double>& system() const { return *system_; }
    /// How the scene starts, before any impulse.
    std::span<const BodyMotion<double>> start() const { return start_; }

    /// The relative velocities that the joints allow: the rates of coordinates (rad/s, m/s), of spherical joints the
    /// three components of the relative angular velocity, of free bodies w_B and v_W. One vector for all of them.
    std::vector<double> velocities(const SystemState& state) const;
    /// Of each of velocities() the first one of its vector, itself where it is none's component.
    const std::vector<std::size_t>& vector_of_velocity() const { return first_of_; }

    /// velocities() a time `h` (s) after the state at `t` (s), by so many steps of the rule. `next`: the state that the
    /// file has there. What impulses along the joints' constraints could do is no difference from it under
    /// SystemRule::joint_impulses: neither iterations that have not converged nor velocities that close gaps count.
    std::vector<double> predicted(const SystemState& state, const SystemState& next, double t, double h,
                                  SystemRule rule, int steps) const;

  private:
    using Placements = std::vector<maximal::Placement<double>>;

    std::shared_ptr<const Scene> scene_;
    EngineFault engine_;
    std::vector<JointFriction> friction_;
    std::vector<BodyMotion<double>> start_;
    std::shared_ptr<const maximal::System<double>> system_;
    std::vector<std::size_t> first_of_;

    std::vector<double> vector_of(const SystemState& state) const;
    std::vector<double> velocities(const Placements& at) const;
    std::vector<maximal::Wrench<double>> forces(const maximal::Loads<double>& loads, const Placements& at,
                                                const double* angles) const;
    std::vector<double> rate(const maximal::Loads<double>& loads, const std::vector<double>& y) const;
    void accelerate(Placements& at, const std::vector<maximal::Wrench<double>>& on, double h, bool implicit) const;
    void project(Placements& at) const;
    void move(std::vector<double>& y, const Placements& by, double h) const;
    void move_along_joints(std::vector<double>& y, const Placements& at, const std::vector<double>& u, double h) const;
};

}  // namespace polhode
