// Tables of the elements and attributes of URDF, MJCF and SDFormat, with how the importer treats each.
//
// The importer uses these tables itself: survey_robot() walks a file and reports every construct that a table does
// not list as modelled or irrelevant. The documentation prints the same tables (`polhode list constructs`).
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

/// How the importer treats a construct.
enum class RobotVerdict {
    modelled,    ///< part of the scene
    irrelevant,  ///< no effect on the motion of rigid bodies without contact
    omitted,     ///< may change the motion but is not modelled; `describe` reports it
    partial,     ///< modelled where a scene can represent it, else omitted; the importer removes the note
};

/// One element or attribute of a format.
struct RobotConstruct {
    std::string_view parent;     ///< tag of the parent element; "*": any; "": the root
    std::string_view element;    ///< tag
    std::string_view attribute;  ///< empty: the element itself and its text
    RobotVerdict verdict = RobotVerdict::modelled;
    /// Modelled: how. Irrelevant: why. Omitted and partial: the heading of the note, in the plural.
    std::string_view note;
    /// Omitted, partial: values without effect, separated by "|". A number must match all numbers of the attribute or
    /// text.
    std::string_view neutral = {};
    /// Omitted, partial: whether this element has an effect; nullptr: use `neutral`.
    bool (*has_effect)(const XMLElement&) = nullptr;
};

/// The table of each format.
std::span<const RobotConstruct> urdf_constructs();
std::span<const RobotConstruct> mjcf_constructs();
std::span<const RobotConstruct> sdf_constructs();

/// A format and its table.
struct RobotFormat {
    const char* name;  ///< "URDF"
    const char* root;  ///< tag of the root element
    std::span<const RobotConstruct> (*constructs)();
};
/// All formats.
std::span<const RobotFormat> robot_formats();

/// Adds to `omitted` every construct of the file that the table lists as omitted, and every element and attribute
/// that the table does not list ("unknown element <x>"). Descends only into modelled elements.
void survey_robot(const RobotXml& xml, const XMLElement& root, std::span<const RobotConstruct> constructs,
                  RobotNotes& omitted);

/// The name of an element in notes: its own, that of the nearest named ancestor, or else its line.
std::string robot_note_name(const RobotXml& xml, const XMLElement& at);

}  // namespace polhode
