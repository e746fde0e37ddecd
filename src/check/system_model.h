// An engine for several bodies with the faults of a hypothesis. It predicts the next row of a file.
//
// Bodies are in maximal coordinates (integrators/maximal): a file has the pose and velocity of each body, and joints
// may have small gaps. Velocities are compared in joint coordinates. There, engines in joint coordinates and engines
// that connect bodies by impulses agree up to their discretisation errors.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "check/hypothesis.h"
#include "integrators/maximal/system.h"

namespace polhode {

/// Coulomb friction of a joint coordinate: a constant torque or force against its rate.
struct JointFriction {
    std::size_t joint = 0;  ///< in the scene's order
    std::size_t axis = 0;   ///< 0 or 1 for a universal joint, else 0
    double size = 0;        ///< N m or N
};

/// A cause in a scene of several bodies.
struct SystemCause : Cause {
    std::vector<JointFriction> friction;  ///< in addition to the scene's
};

/// Update rules for several bodies.
enum class SystemRule {
    accurate,        ///< Runge-Kutta steps of order 4
    joint_impulses,  ///< semi-implicit Euler of each body, then impulses that make the velocities satisfy the joints
    joint_impulses_implicit,  ///< joint_impulses with one Newton step of the implicit gyroscopic term
    joint_rates,              ///< semi-implicit Euler of the joints' coordinates
};
/// Name for users: "accurate steps".
std::string_view name_of(SystemRule rule);

/// The state of all bodies at one time of the file.
struct SystemState {
    std::vector<BodyMotion<double>> bodies;  ///< in the scene's order
    std::vector<double> angles;  ///< angles of joints whose turns are counted (integrators/maximal/system.h)
};

/// The equations of motion of a cause.
class SystemEngine {
  public:
    /// The bodies must have numeric mass properties. Throws InputError if the scene has no valid start.
    explicit SystemEngine(const SystemCause& cause);

    const maximal::System<double>& system() const { return *system_; }
    /// The scene's initial state, before any impulse.
    std::span<const BodyMotion<double>> start() const { return start_; }

    /// The relative velocities that the joints allow, in one vector: rates of joint coordinates (rad/s, m/s), three
    /// components of the relative angular velocity for spherical joints, w_B and v_W for free bodies.
    std::vector<double> velocities(const SystemState& state) const;
    /// For each entry of velocities(), the index of the first component of its vector; its own index for a scalar.
    const std::vector<std::size_t>& vector_of_velocity() const { return first_of_; }

    /// Predicts velocities() at time `t` + `h` (s) from the state at `t`, with `steps` steps of the rule. `next`: the
    /// file's state there. SystemRule::joint_impulses projects out differences along the joints' constraints, so that
    /// unconverged iterations and velocities that close gaps do not count.
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
