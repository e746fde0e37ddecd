// Values of SDFormat elements: version, flags, names and poses.
#pragma once

#include <string>
#include <vector>

#include "scene/robot_parts.h"
#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

/// Minor numbers of the supported versions 1.3 to 1.12.
inline constexpr int oldest_sdf_version = 3, newest_sdf_version = 12;

/// The minor version of an <sdf> element. A missing version is read as the newest and noted in `assumed`. Throws
/// InputError for an unsupported version.
int sdf_version(const RobotXml& xml, const XMLElement& root, RobotNotes& assumed);

/// Parses "true" or "1", "false" or "0", case-insensitively; false if the element is missing.
bool sdf_flag(const RobotXml& xml, const XMLElement* at);
bool sdf_flag_attribute(const RobotXml& xml, const XMLElement& at, const char* name);

/// The text of an element without surrounding blanks.
std::string sdf_text(const XMLElement& at);
/// The text of a required child; `what` says in the message what to give.
std::string sdf_child_text(const RobotXml& xml, const XMLElement& of, const char* name, const char* what);

/// Position and rotation as written.
struct SdfPlace {
    Vector3<double> position;  ///< m
    RobotRotation turn;
};
/// The numbers of a <pose>; an empty one is the identity.
SdfPlace sdf_place(const RobotXml& xml, const XMLElement& pose);
/// The pose of a <pose> element; the identity for nullptr.
RobotPose sdf_pose(const RobotXml& xml, const XMLElement* pose);
/// The name of the frame that a <pose> is relative to: attribute "relative_to", before 1.7 also "frame". Empty: the
/// default frame.
std::string sdf_relative_to(const XMLElement* pose, int version);

/// Mass properties in a link's frame from its <inertial>, with SDFormat's defaults; ignores `auto`. Appends to
/// `defaults` what the file does not state: "mass", "inertia".
LinkInertial sdf_given_inertial(const RobotXml& xml, const XMLElement* inertial, std::vector<std::string>& defaults);

/// One <collision> of a link whose inertia is computed from collisions.
struct SdfSolid {
    const XMLElement* collision = nullptr;
    RobotPose pose;     ///< in the link's frame
    RobotFiles meshes;  ///< relative to the file of the collision
};
/// Mass properties from collisions and densities (`<inertial auto="true">`). Throws InputError for shapes whose
/// inertia libsdformat does not define. Notes the link in `assumed` if a density or a given mass is used.
MassProperties<Wide> sdf_computed_inertial(const RobotXml& xml, const XMLElement& link, const std::string& name,
                                           const std::vector<SdfSolid>& solids, RobotNotes& assumed);

}  // namespace polhode
