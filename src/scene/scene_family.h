// Families of scenes: FOLDER/FAMILY_PARAMETER.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// The parts of a scene's name: "extreme/drag_1e6" is the member 10^6 of the family drag in the folder extreme.
struct FamilyMember {
    std::string folder, family, parameter;  ///< empty if the name does not have it
    double value = 0;                       ///< numeric value of the parameter
};

/// Splits a scene's name. A name without a folder, or without a number after its last underscore, has no parameter
/// and is the only member of its family.
FamilyMember family_member(std::string_view scene_name);

/// The built-in scenes of a family, sorted by parameter.
std::vector<std::string> scene_family(std::string_view folder, std::string_view family);

}  // namespace polhode
