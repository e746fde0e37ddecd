// Orientations, inertials and geoms of MJCF.
#pragma once

#include <optional>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

/// MJCF's <compiler>.
struct MjcfCompiler {
    EulerTurn euler{{0, 1, 2}, {}, true, true};  ///< with the angles left open
    bool in_degrees = true;
};
MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root);
/// The turn that an MJCF element gives by quat, axisangle, euler, xyaxes or zaxis: none where there is none of them.
Quaternion<Wide> mjcf_turn(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The least turn that brings z to the direction v, of any length but zero; `what` is named where it is zero.
Quaternion<Wide> turn_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v);

/// Where an MJCF element is in what it stands in.
RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The <inertial> of a body.
ImportedBody mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler);
/// The mass properties of a geom, in its body's frame: none of one without mass. Throws InputError at what is no
/// sphere, capsule, cylinder, box or ellipsoid.
std::optional<MassProperties<Wide>> mjcf_geom_mass(const RobotXml& xml, const XMLElement& at,
                                                   const MjcfCompiler& compiler);

}  // namespace polhode
