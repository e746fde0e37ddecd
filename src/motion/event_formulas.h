// Values of formulas along a motion, whose zeros are events (scene/event_expression.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "motion/joint_motion.h"
#include "motion/trajectory.h"
#include "scene/event_expression.h"

namespace polhode {

/// Scalar formulas of time and state of a scene.
class EventFormulas {
  public:
    /// From a valid scene. Throws InputError at a fault in a formula.
    EventFormulas(const Scene& scene, const std::vector<std::string>& formulas);

    /// The number of formulas.
    std::size_t size() const { return compiled_.outputs.size(); }
    /// Whether a formula reads the coordinate or the rate of a joint.
    bool reads_joints() const { return reads_joints_; }
    /// The values of all formulas at one time, from the motions of all bodies and of all joints, in the scene's order.
    /// `joints` may be empty unless reads_joints().
    std::vector<double> values(const Bodies& bodies, std::span<const JointMotion<double>> joints) const;

  private:
    EventExpression compiled_;
    std::vector<double> uniform_;
    std::vector<char> needed_;
    std::size_t joint_count_ = 0;
    bool reads_joints_ = false;

    std::vector<double> inputs(const Bodies& bodies, std::span<const JointMotion<double>> joints) const;
};

}  // namespace polhode
