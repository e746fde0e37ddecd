#include "scene/scene_family.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "scene/builtin.h"

namespace polhode {

FamilyMember family_member(std::string_view scene_name) {
    FamilyMember member;
    const std::size_t slash = scene_name.rfind('/');
    std::string_view rest = scene_name;
    if (slash != scene_name.npos) {
        member.folder = scene_name.substr(0, slash);
        rest = scene_name.substr(slash + 1);
        const std::size_t bar = rest.rfind('_');
        if (bar != rest.npos) {
            const std::string_view number = rest.substr(bar + 1);
            const auto [end, fault] = std::from_chars(number.begin(), number.end(), member.value);
            if (fault == std::errc() && end == number.end()) {
                member.parameter = number;
                rest = rest.substr(0, bar);
            }
        }
    }
    member.family = rest;
    return member;
}

std::vector<std::string> scene_family(std::string_view folder, std::string_view family) {
    std::vector<std::pair<double, std::string>> members;
    for (const BuiltinText& scene : builtin_scenes()) {
        const FamilyMember member = family_member(scene.name);
        if (member.folder == folder && member.family == family) members.emplace_back(member.value, scene.name);
    }
    std::sort(members.begin(), members.end());
    std::vector<std::string> names;
    for (const auto& [value, name] : members) names.push_back(name);
    return names;
}

}  // namespace polhode
