// Writes a scene as canonical JSON.
#include <fmt/format.h>

#include <utility>

#include "scene/body_file.h"
#include "scene/formula_file.h"
#include "scene/initial_file.h"
#include "scene/joint_file.h"
#include "scene/json_values.h"
#include "scene/load_file.h"
#include "scene/plane_file.h"
#include "scene/scene_file.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"
#include "text/json_document.h"

namespace polhode {
std::string write_scene(const Scene& scene) {
    std::string text = "{\n  \"name\": " + json_string(scene.name);
    const auto member = [&](const char* key, const std::string& value) {
        text += fmt::format(",\n  \"{}\": {}", key, value);
    };
    if (!scene.about.empty()) member("about", json_string(scene.about));
    if (!scene.source.empty()) member("source", json_string(scene.source));
    member("duration", shortest_decimal(scene.duration));
    if (is_mechanism(scene)) {
        member("bodies", write_bodies(scene));
        if (!scene.joints.empty()) member("joints", write_joints(scene));
        if (!scene.loops.empty()) member("loops", write_loops(scene));
        if (!scene.couplings.empty()) member("couplings", write_couplings(scene));
    } else {
        member("body", "{\n    " + write_body(scene.body) + "\n  }");
        member("initial", "{\n    " + write_initial(scene.initial, scene.pivot.has_value(), "\n    ") + "\n  }");
        if (scene.pivot) member("pivot", write_json(*scene.pivot));
    }
    const std::pair<const char*, std::string> of_formulas[] = {
        {"parameters", write_parameters(scene)}, {"tables", write_tables(scene)}, {"let", write_let(scene)}};
    for (const auto& [key, value] : of_formulas)
        if (!value.empty()) member(key, value);
    std::string loads;
    for (const Load& load : scene.loads)
        loads += (loads.empty() ? "\n    " : ",\n    ") + write_load(load, scene.joints);
    if (!loads.empty()) member("loads", "[" + loads + "\n  ]");
    std::string planes;
    for (const Plane& plane : scene.planes) planes += (planes.empty() ? "\n    " : ",\n    ") + write_plane(plane);
    if (!planes.empty()) member("planes", "[" + planes + "\n  ]");
    std::string contacts;
    for (const SphereContact& contact : scene.contacts)
        contacts += (contacts.empty() ? "\n    " : ",\n    ") + write_sphere_contact(contact);
    if (!contacts.empty()) member("contacts", "[" + contacts + "\n  ]");
    std::string tolerated;
    for (const std::string_view block : tolerated_blocks)
        if (const std::optional<double> error = tolerated_error(scene, block))
            tolerated += fmt::format("{}\"{}\": {}", tolerated.empty() ? "" : ", ", block, shortest_decimal(*error));
    if (!tolerated.empty()) member("tolerated", "{" + tolerated + "}");
    return text + "\n}\n";
}

}  // namespace polhode
