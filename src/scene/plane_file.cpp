#include "scene/plane_file.h"

#include <fmt/format.h>

#include <array>

#include "scene/json_values.h"
#include "scene/scene_keys.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::array<const char*, 3> restitution_laws{"stronge", "poisson", "newton"};

RestitutionLaw parse_restitution_law(const JsonNode& node) {
    for (std::size_t i = 0; i < restitution_laws.size(); ++i)
        if (node.string() == restitution_laws[i]) return static_cast<RestitutionLaw>(i);
    const std::string meant = did_you_mean(node.string(), {restitution_laws.begin(), restitution_laws.end()});
    node.fail(node.describe(),
              fmt::format("{}{}give one of \"stronge\", \"poisson\", \"newton\"", meant, meant.empty() ? "" : " "));
}

}  // namespace

const char* name_of(RestitutionLaw law) { return restitution_laws.at(static_cast<std::size_t>(law)); }

Plane parse_plane(const JsonNode& node) {
    node.require_known_keys(keys_of(scene_keys(), "plane"));
    Plane p;
    p.normal_W = vector3(node.require_member("normal", "[x, y, z], world axes, towards the body"));
    if (const JsonNode* offset = node.find("offset")) p.offset = offset->number();
    p.restitution = node.require_member("restitution", "the coefficient of restitution, 0 to 1").number();
    if (const JsonNode* friction = node.find("friction")) p.friction = friction->number();
    if (const JsonNode* friction = node.find("torsional_friction")) p.torsional_friction = friction->number();
    if (const JsonNode* friction = node.find("rolling_friction")) p.rolling_friction = friction->number();
    if (const JsonNode* law = node.find("restitution_law")) p.restitution_law = parse_restitution_law(*law);
    if (const JsonNode* name = node.find("name")) {
        p.name = name->string();
        if (p.name.empty()) name->fail("is empty", "give the plane a name, or remove \"name\"");
    }
    return p;
}

std::string write_plane(const Plane& plane) {
    std::string text = fmt::format(R"({{"normal": {}, "offset": {}, "restitution": {}, "friction": {})",
                                   write_json(plane.normal_W), shortest_decimal(plane.offset),
                                   shortest_decimal(plane.restitution), shortest_decimal(plane.friction));
    if (plane.torsional_friction != 0)
        text += fmt::format(R"(, "torsional_friction": {})", shortest_decimal(plane.torsional_friction));
    if (plane.rolling_friction != 0)
        text += fmt::format(R"(, "rolling_friction": {})", shortest_decimal(plane.rolling_friction));
    if (plane.restitution_law != RestitutionLaw::stronge)
        text += fmt::format(R"(, "restitution_law": "{}")", name_of(plane.restitution_law));
    if (!plane.name.empty()) text += fmt::format(R"(, "name": {})", json_string(plane.name));
    return text + "}";
}

std::string plane_name(const Scene& scene, std::size_t index) {
    const std::string& name = scene.planes[index].name;
    return name.empty() ? fmt::format("plane {}", index + 1) : name;
}

}  // namespace polhode
