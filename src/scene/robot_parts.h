// The readers of URDF, MJCF and SDFormat, and their shared helpers.
#pragma once

#include <tinyxml2.h>

#include <functional>
#include <variant>

#include "scene/robot_schema.h"
#include "scene/robot_tree.h"
#include "scene/robot_xml.h"

namespace polhode {

/// Reads the robot of a URDF file. Throws InputError.
Robot urdf_robot(const RobotXml& xml, const XMLElement& root);
/// Reads the robot of an MJCF file; resolves included files and <default> in the document of `root`. Throws InputError.
Robot mjcf_robot(const RobotXml& xml, XMLElement& root);
/// Reads the robot of an SDFormat file. `model`: the model to read; empty: all models. Throws InputError.
Robot sdf_robot(const RobotXml& xml, const XMLElement& root, const std::string& model);

/// The mass properties of one link: an inertial as written in the file, or properties computed from shapes.
using LinkInertial = std::variant<ImportedBody, MassProperties<Wide>>;
LinkInertial urdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link);
LinkInertial mjcf_body_inertial(const RobotXml& xml, XMLElement& root, const std::string& body);
LinkInertial sdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link);

/// Mass properties in the link's frame.
MassProperties<Wide> mass_of(const LinkInertial& inertial);

/// The only element with this tag and name below `root`. `name` may be qualified by surrounding models:
/// "model::link". Throws InputError if there is none or more than one.
const XMLElement& named_element(const RobotXml& xml, const XMLElement& root, const char* tag, const std::string& name);

/// Maps names of links or joints to indices. `add` throws for a name that exists, `find` for one that does not.
class RobotNames {
  public:
    RobotNames(const RobotXml& xml, const char* what) : xml_(xml), what_(what) {}

    void add(const XMLElement& at, const std::string& name, std::size_t index);
    std::size_t find(const XMLElement& at, const std::string& name) const;
    bool has(const std::string& name) const { return index_.contains(name); }

  private:
    const RobotXml& xml_;
    const char* what_;
    std::map<std::string, std::size_t, std::less<>> index_;
};

/// The element's name attribute, or `fallback`.
inline std::string name_or(const XMLElement& at, const char* fallback) {
    const char* name = at.Attribute("name");
    return name ? name : fallback;
}

/// Converts an angle to radians.
inline Wide in_radians(double angle, bool in_degrees) {
    return in_degrees ? Wide(angle) * Elementary<Wide>::pi() / Wide(180) : Wide(angle);
}

}  // namespace polhode
