// Values of MJCF: the settings of <compiler>, orientations and inertials.
#pragma once

#include <optional>
#include <string>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

enum class MjcfInertia { from_geoms, from_inertials, either };

/// MJCF's <compiler>. Of several elements, each attribute's last value counts.
struct MjcfCompiler {
    EulerTurn euler{{0, 1, 2}, {}, true, true};  ///< without its angles
    bool in_degrees = true;
    MjcfInertia inertia = MjcfInertia::either;  ///< inertiafromgeom; either: geoms where there is no <inertial>
    double first_group = 0, last_group = 5;     ///< inertiagrouprange: groups of geoms that have mass
    double least_mass = 0, least_moment = 0;    ///< boundmass, boundinertia
    bool balances = false;                      ///< balanceinertia
    double total_mass = 0;                      ///< settotalmass, where > 0
    std::string mesh_folder;                    ///< meshdir or assetdir, with its slash, or empty
    bool strips_path = false;                   ///< strippath: the names of mesh files without their folders
    bool fuses_static = false;                  ///< fusestatic
    bool aligns_free = false;                   ///< alignfree
    bool drops_visual = false;                  ///< discardvisual
    bool exact_meshes = false;                  ///< exactmeshinertia
    bool fits_box = false;                      ///< fitaabb
};
MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root);

/// The orientation that an element gives by quat, axisangle, euler, xyaxes or zaxis; the identity without these.
Quaternion<Wide> mjcf_turn(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The shortest rotation that maps z to the direction v, of any length but zero; `what` is named where it is zero.
Quaternion<Wide> turn_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v);
/// The rotation by Euler angles in the units and sequence of <compiler>.
Quaternion<Wide> mjcf_euler(const Vector3<double>& angles, const MjcfCompiler& compiler);

/// The pose of an element in its parent element.
RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);

/// The <inertial> of a body.
MassProperties<Wide> mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler);
/// The same with the file's own numbers; none where its orientation is not a quaternion or Euler angles.
std::optional<ImportedBody> mjcf_given_inertial(const RobotXml& xml, const XMLElement& inertial,
                                                const MjcfCompiler& compiler);

}  // namespace polhode
