// The readers of whole robots, one for each format.
#pragma once

#include <tinyxml2.h>

#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

Robot urdf_robot(const RobotXml& xml, const XMLElement& root);
/// What <default> says is written into the elements.
Robot mjcf_robot(const RobotXml& xml, XMLElement& root);
Robot sdf_robot(const RobotXml& xml, const XMLElement& root);

/// Where an MJCF element is in what it stands in.
RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The mass properties of a geom, in its body's frame: none of one without mass. Throws InputError at what is no
/// sphere, capsule, cylinder, box or ellipsoid.
std::optional<MassProperties<Wide>> mjcf_geom_mass(const RobotXml& xml, const XMLElement& at,
                                                   const MjcfCompiler& compiler);

/// Mass properties in the link's frame.
MassProperties<Wide> mass_of(const ImportedBody& inertial);

/// The names of links or joints with their places in the list. `add` fails at one that is there already, `find` at one
/// that is not.
class RobotNames {
  public:
    RobotNames(const RobotXml& xml, const char* what) : xml_(xml), what_(what) {}

    void add(const XMLElement& at, const std::string& name, std::size_t index);
    std::size_t find(const XMLElement& at, const std::string& name) const;

  private:
    const RobotXml& xml_;
    const char* what_;
    std::map<std::string, std::size_t, std::less<>> index_;
};

/// A named element's own name for messages.
inline std::string name_or(const XMLElement& at, const char* fallback) {
    const char* name = at.Attribute("name");
    return name ? name : fallback;
}

/// A number in degrees or radians, in radians.
inline Wide in_radians(double angle, bool in_degrees) {
    return in_degrees ? Wide(angle) * Elementary<Wide>::pi() / Wide(180) : Wide(angle);
}

}  // namespace polhode
