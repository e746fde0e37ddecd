// Values of MJCF: <compiler> settings, orientations and inertials.
#pragma once

#include <optional>
#include <string>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

/// The source of inertia: <compiler inertiafromgeom>.
enum class MjcfInertia { from_geoms, from_inertials, either };

/// MJCF's <compiler>. If there are several elements, the last value of each attribute applies.
struct MjcfCompiler {
    EulerRotation euler{{0, 1, 2}, {}, true, true};  ///< sequence and units; the angles are unused
    bool in_degrees = true;
    MjcfInertia inertia = MjcfInertia::either;  ///< inertiafromgeom; either: geoms unless there is an <inertial>
    double first_group = 0, last_group = 5;     ///< inertiagrouprange: groups of geoms that have mass
    double least_mass = 0, least_moment = 0;    ///< boundmass, boundinertia
    bool balances = false;                      ///< balanceinertia
    double total_mass = 0;                      ///< settotalmass, if > 0
    std::string mesh_folder;                    ///< meshdir or assetdir, with a final slash, or empty
    bool strips_path = false;                   ///< strippath: mesh file names lose their folders
    bool fuses_static = false;                  ///< fusestatic
    bool aligns_free = false;                   ///< alignfree
    bool drops_visual = false;                  ///< discardvisual
    bool exact_meshes = false;                  ///< exactmeshinertia
    bool fits_box = false;                      ///< fitaabb
};
/// Reads the settings of <compiler> elements. Throws InputError.
MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root);

/// The orientation of an element by quat, axisangle, euler, xyaxes or zaxis; the identity if it has none of these.
Quaternion<Wide> mjcf_rotation(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The shortest rotation that maps z to the direction of v, of any nonzero length. A zero v is reported as `what`.
Quaternion<Wide> rotation_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v);
/// The rotation by Euler angles in the units and sequence of <compiler>.
Quaternion<Wide> mjcf_euler(const Vector3<double>& angles, const MjcfCompiler& compiler);

/// The pose of an element in its parent element.
RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);

/// The mass properties of an <inertial> element.
MassProperties<Wide> mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler);
/// An <inertial> with the numbers as written in the file. Returns nothing unless its orientation is a quaternion or
/// Euler angles.
std::optional<ImportedBody> mjcf_given_inertial(const RobotXml& xml, const XMLElement& inertial,
                                                const MjcfCompiler& compiler);

}  // namespace polhode
