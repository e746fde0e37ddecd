// MJCF's springdamper: stiffness and damping from a time constant, a damping ratio and the inertia at the joint.
#pragma once

#include <vector>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

struct MjcfSpringDamper {
    const XMLElement* at = nullptr;
    std::size_t joint = 0;  ///< of the robot
    Wide time_constant = 0, damping_ratio = 0;
    Wide stiffness = 0, damping = 0;  ///< computed: N m/rad and N m s, or N/m and N s/m
};

/// Computes stiffness = I / (T z)^2 and damping = 2 I / T with the time constant T, the damping ratio z and the mean I
/// of the joint's inverse inertias: d / trace of the joint's block of the inverse mass matrix with d degrees of
/// freedom, in the pose as written. `armature`: of each joint, in the mass matrix (MuJoCo's mjCModel::AutoSpringDamper
/// and dof_invweight0). Throws InputError where the mass matrix is singular.
void compute_springdampers(const RobotXml& xml, const Robot& robot, const std::vector<double>& armature,
                           std::vector<MjcfSpringDamper>& springs);

}  // namespace polhode
