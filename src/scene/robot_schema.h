// The tables of elements and attributes of URDF, MJCF and SDFormat, with what the importer does with each.
//
// The importer itself uses them: survey_robot() walks a file and names every construct that a table does not list as
// modelled or irrelevant. The documentation prints the same tables (`polhode list constructs`).
#pragma once

#include <span>
#include <string_view>

#include "scene/robot_tree.h"

namespace tinyxml2 {
class XMLElement;
}

namespace polhode {

class RobotXml;
using tinyxml2::XMLElement;

enum class RobotVerdict {
    modelled,    ///< part of the scene
    irrelevant,  ///< without effect on the motion of rigid bodies without contact
    omitted,     ///< may change the motion and is not modelled: named by `describe`
};

/// One element or attribute of a format.
struct RobotConstruct {
    std::string_view parent;     ///< tag of the element's parent; "*": any; "": the root
    std::string_view element;    ///< tag
    std::string_view attribute;  ///< empty: the element itself and its text
    RobotVerdict verdict = RobotVerdict::modelled;
    /// Modelled: as what. Irrelevant: why. Omitted: the heading under which it is named, in the plural.
    std::string_view note;
    /// Omitted: values without effect, separated by "|"; a number stands for all numbers of the attribute or text.
    std::string_view neutral = {};
    /// Omitted: whether this element has an effect; nullptr: see `neutral`.
    bool (*has_effect)(const XMLElement&) = nullptr;
};

std::span<const RobotConstruct> urdf_constructs();
std::span<const RobotConstruct> mjcf_constructs();
std::span<const RobotConstruct> sdf_constructs();

/// A format with its table.
struct RobotFormat {
    const char* name;  ///< "URDF"
    const char* root;  ///< tag of the root element
    std::span<const RobotConstruct> (*constructs)();
};
std::span<const RobotFormat> robot_formats();

/// Adds to `omitted` what the file has and the table lists as omitted, and every element and attribute that the table
/// does not list ("unknown element <x>"). Descends into modelled elements only.
void survey_robot(const RobotXml& xml, const XMLElement& root, std::span<const RobotConstruct> constructs,
                  RobotNotes& omitted);

/// The name of an element in notes: its own, or that of the nearest named element around it, else its line.
std::string robot_note_name(const RobotXml& xml, const XMLElement& at);

}  // namespace polhode
