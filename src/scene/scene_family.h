// Families of scenes: FOLDER/FAMILY_PARAMETER.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// What a scene's name says: "extreme/drag_1e6" is the member 10^6 of the family drag in the folder extreme.
struct FamilyMember {
    std::string folder, family, parameter;  ///< each empty where the name has none
    double value = 0;                       ///< the parameter's
};

/// A name without a folder, or without a number after its last underscore, has no parameter: it is its family's only
/// member.
FamilyMember family_member(std::string_view scene_name);

/// The built-in scenes of a family, in order of their parameters.
std::vector<std::string> scene_family(std::string_view folder, std::string_view family);

}  // namespace polhode
