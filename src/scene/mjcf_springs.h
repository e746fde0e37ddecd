// MJCF's springdamper: computes stiffness and damping from a time constant, a damping ratio and the inertia at the
// joint.
#pragma once

#include <vector>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

/// A joint with a springdamper attribute.
struct MjcfSpringDamper {
    const XMLElement* at = nullptr;
    std::size_t joint = 0;  ///< index of the joint in the robot
    Wide time_constant = 0, damping_ratio = 0;
    Wide stiffness = 0, damping = 0;  ///< computed: N m/rad and N m s, or N/m and N s/m
};

/// Computes stiffness = I / (T z)^2 and damping = 2 I / T from the time constant T (s), the damping ratio z and the
/// inertia I = d / trace, where trace is that of the joint's block of the inverse mass matrix in the initial pose and
/// d its number of degrees of freedom. `armature`: added inertia of each joint in the mass matrix. Source: MuJoCo,
/// mjCModel::AutoSpringDamper and dof_invweight0. Throws InputError if the mass matrix is singular.
void compute_springdampers(const RobotXml& xml, const Robot& robot, const std::vector<double>& armature,
                           std::vector<MjcfSpringDamper>& springs);

}  // namespace polhode
