// Derivatives of a motion with respect to numbers of the scene: mass properties, initial state, loads, joints.
//
// The state y of the tree in joint coordinates (motion/tree.h) is integrated on dual numbers, whose constants are dual
// numbers, too: y and S = dy/dp satisfy y' = f(y, p), S' = df/dy S + df/dp, without further formulas. The derivatives
// of the constants come from two scenes in which the number is slightly larger and smaller. The constants are exact
// in 113 bits, so that their differences are accurate to about 1e-21. A scene of one body is a tree of one link.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// A scene on both sides of a change of one number.
struct SceneChange {
    Scene ahead;    ///< with the larger number
    Scene behind;   ///< with the smaller number, by the same distance from the scene's
    double by = 0;  ///< difference of the two numbers, > 0
};

/// Parameters of sensitivities().
struct SensitivitySettings {
    double tolerance = 1e-12;                                        ///< relative, of the motion and of each derivative
    long max_steps = 10'000'000;                                     ///< fail if more are needed
    double seconds_limit = std::numeric_limits<double>::infinity();  ///< processor time of the thread, s
};

/// Derivatives of a motion.
struct Sensitivities {
    Status status = Status::ok;   ///< unsupported: the scene has planes or loads without derivatives
    std::string message;          ///< why the status is not ok
    int bodies = 1;               ///< number of bodies at each time
    std::size_t parameters = 0;   ///< number of changes
    std::vector<Sample> samples;  ///< the motion, by time, then by body
    /// By time, body, quantity and parameter. The quantities are the rotation vector of the change of the attitude
    /// (world axes, rad), the angular velocity in world axes, and the position and velocity of the centre of mass.
    std::vector<double> derivatives;
    long steps = 0;  ///< number of steps, over all passes

    /// Number of quantities of a body.
    static constexpr std::size_t quantities = 12;
};

/// The part of a scene whose events sensitivities() does not follow: planes, contacts of spheres, limits, friction or
/// prescribed motions of joints. Empty if the scene has none of these.
std::string part_with_events(const Scene& scene);

/// Computes the derivatives of the motion at the given times, s, which must increase from 0 or later to at most the
/// scene's duration, with respect to the number that each change concerns. Solves the variational equation by DOP853,
/// eight parameters in a pass. Where an event changes the equations, the derivatives jump, as its time depends on the
/// number (switches of formulas, times of impulses, windows and samples). Unsupported: planes, contacts of spheres,
/// limits and friction of joints, prescribed motions, and user-defined torques; failed: a motion that slides along a
/// switching surface. Throws InputError if the scene is invalid, std::invalid_argument if the times are.
Sensitivities sensitivities(const Scene& scene, std::span<const SceneChange> changes, const std::vector<double>& times,
                            const SensitivitySettings& settings = {});

}  // namespace polhode
