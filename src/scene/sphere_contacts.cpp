#include "scene/sphere_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "body/elementary.h"
#include "body/wide.h"
#include "scene/body_hull.h"
#include "scene/plane_file.h"
#include "scene/scene_keys.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

std::size_t index_of_body(const Scene& scene, const std::string& name) {
    const auto found = std::ranges::find_if(scene.bodies, [&](const NamedBody& body) { return body.name == name; });
    return static_cast<std::size_t>(found - scene.bodies.begin());
}

// Returns the only piece of the body's hull if the body is a sphere about its centre of mass with equal moments.
SupportPiece<Wide> require_sphere(const SceneCheck& check, const Scene& scene, std::size_t index) {
    const Body& body = scene.bodies[index].body;
    const std::string place = fmt::format("/bodies/{}/body", index);
    const char* remedy =
        "contact of several bodies needs spheres: give a \"shape\" or \"contact_shape\" of type sphere";
    if (!body.source || !has_shape(*body.source))
        check.fail(place, "has no shape, but the scene has planes or contacts", remedy);
    const std::vector<SupportPiece<Wide>> pieces = hull<Wide>(*body.source);
    if (pieces.size() != 1 || pieces[0].extended || !(pieces[0].radius > 0))
        check.fail(place, "is not a sphere, but the scene has several bodies with planes or contacts", remedy);
    const MassProperties<Wide> mass = mass_properties<Wide>(body);
    const Vector3<Wide> away = pieces[0].center - mass.center;
    if (!(dot(away, away) <= Wide(1e-24) * pieces[0].radius * pieces[0].radius))
        check.fail(place, "is a sphere whose centre of mass is not its centre",
                   "contact of several bodies needs spheres with their centre of mass in the middle");
    const Wide moment = mass.inertia[0][0];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const Wide difference = mass.inertia[i][j] - (i == j ? moment : Wide(0));
            if (!(difference * difference <= Wide(1e-24) * moment * moment))
                check.fail(place, "is a sphere whose three moments differ",
                           "contact of several bodies needs spheres with three equal moments");
        }
    return pieces[0];
}

void check_entry(const SceneCheck& check, const Scene& scene, std::size_t index,
                 std::set<std::pair<std::size_t, std::size_t>>& known, bool& has_all) {
    const SphereContact& contact = scene.contacts[index];
    const std::string place = fmt::format("/contacts/{}", index);
    check.finite(place + "/restitution", contact.restitution);
    if (!(contact.restitution >= 0 && contact.restitution <= 1))
        check.fail(place + "/restitution", "is " + shortest_decimal(contact.restitution),
                   "the coefficient of restitution must be from 0 (perfectly inelastic) to 1 (elastic)");
    check.not_negative(place + "/friction", contact.friction, "the coefficient of Coulomb friction");
    if (contact.all) {
        if (has_all) check.fail(place + "/all", "is given a second time", "give one entry for all other pairs");
        has_all = true;
        return;
    }
    std::vector<std::string> names;
    for (const NamedBody& body : scene.bodies) names.push_back(body.name);
    for (const auto& [key, name] : {std::pair("/first", contact.first), std::pair("/second", contact.second)})
        if (index_of_body(scene, name) == scene.bodies.size()) {
            const std::string meant = did_you_mean(name, names);
            check.fail(place + key, fmt::format("is \"{}\", which is not the name of a body", one_line(name, 60)),
                       meant.empty() ? "give one of " + join_with_commas(names) : meant);
        }
    const std::size_t first = index_of_body(scene, contact.first), second = index_of_body(scene, contact.second);
    if (first == second)
        check.fail(place + "/second", fmt::format("is \"{}\", like \"first\"", one_line(contact.second, 60)),
                   "give two different bodies");
    if (!known.insert(std::minmax(first, second)).second)
        check.fail(place,
                   fmt::format("names the pair \"{}\" and \"{}\" a second time", one_line(contact.first, 60),
                               one_line(contact.second, 60)),
                   "give each pair once");
}

// Checks that no spheres that collide overlap at the start.
void check_start(const SceneCheck& check, const Scene& scene, const std::vector<SupportPiece<Wide>>& spheres) {
    constexpr double tolerance = 1e-12;
    const auto position = [&](std::size_t i) { return cast<Wide>(scene.bodies[i].initial.position_W); };
    for (const SpherePair& pair : sphere_pairs(scene)) {
        const Vector3<Wide> away = position(pair.first) - position(pair.second);
        const Wide size = spheres[pair.first].radius + spheres[pair.second].radius;
        const Wide gap = square_root(dot(away, away)) - size;
        if (!(gap >= -Wide(tolerance) * size))
            check.fail("/contacts",
                       fmt::format("the spheres \"{}\" and \"{}\" overlap by {} m at the start",
                                   one_line(scene.bodies[pair.first].name, 60),
                                   one_line(scene.bodies[pair.second].name, 60), shortest_decimal(-double(gap))),
                       "move their initial positions apart");
    }
}

}  // namespace

std::vector<SpherePair> sphere_pairs(const Scene& scene) {
    std::set<std::pair<std::size_t, std::size_t>> named;
    for (const SphereContact& contact : scene.contacts)
        if (!contact.all)
            named.insert(std::minmax(index_of_body(scene, contact.first), index_of_body(scene, contact.second)));
    std::vector<SpherePair> pairs;
    for (const SphereContact& contact : scene.contacts) {
        if (!contact.all) {
            pairs.push_back({index_of_body(scene, contact.first), index_of_body(scene, contact.second),
                             contact.restitution, contact.friction});
            continue;
        }
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            for (std::size_t j = i + 1; j < scene.bodies.size(); ++j)
                if (!named.contains({i, j})) pairs.push_back({i, j, contact.restitution, contact.friction});
    }
    return pairs;
}

Scene scene_of_sphere(const Scene& scene, std::size_t body) {
    if (!has_sphere_contacts(scene)) return scene;
    Scene alone;
    const NamedBody& one = scene.bodies[body];
    alone.directory = scene.directory, alone.name = scene.name, alone.duration = scene.duration;
    alone.body = one.body, alone.initial = one.initial, alone.planes = scene.planes;
    for (Load load : scene.loads) {
        if (!load_body(load).empty() && load_body(load) != one.name) continue;
        std::visit(
            [](auto& each) {
                if constexpr (requires { each.body; }) each.body.clear();
            },
            load);
        alone.loads.push_back(load);
    }
    return alone;
}

ContactNames contact_names(const Scene& scene, std::size_t contact) {
    const std::size_t planes = scene.planes.size(), others = planes + scene.bodies.size(), other = contact % others;
    const std::string_view name = scene_body(scene, contact / others).name;
    return {name.empty() ? "body" : std::string(name),
            other < planes ? plane_name(scene, other) : scene.bodies[other - planes].name};
}

SphereContact parse_sphere_contact(const JsonNode& node) {
    node.require_known_keys(keys_of(scene_keys(), "contact"));
    SphereContact contact;
    if (const JsonNode* all = node.find("all")) {
        contact.all = all->boolean();
        if (!contact.all) all->fail("is false", "give true, or \"first\" and \"second\"");
        for (const char* key : {"first", "second"})
            if (const JsonNode* name = node.find(key))
                name->fail("is given together with \"all\"", "give \"first\" and \"second\", or \"all\": true");
    } else {
        contact.first = node.require_member("first", "the name of a body").string();
        contact.second = node.require_member("second", "the name of another body").string();
    }
    contact.restitution = node.require_member("restitution", "the coefficient of restitution, 0 to 1").number();
    if (const JsonNode* friction = node.find("friction")) contact.friction = friction->number();
    return contact;
}

std::string write_sphere_contact(const SphereContact& contact) {
    const std::string which = contact.all ? std::string(R"("all": true)")
                                          : fmt::format(R"("first": {}, "second": {})", json_string(contact.first),
                                                        json_string(contact.second));
    return fmt::format(R"({{{}, "restitution": {}, "friction": {}}})", which, shortest_decimal(contact.restitution),
                       shortest_decimal(contact.friction));
}

void check_sphere_contacts(const SceneCheck& check, const Scene& scene) {
    if (!has_sphere_contacts(scene)) return;
    const char* what = scene.contacts.empty() ? "/planes" : "/contacts";
    if (!scene.joints.empty() || !scene.loops.empty() || !scene.couplings.empty())
        check.fail(what, "are given together with joints, loops or couplings",
                   "remove them: contact is supported for one body, or for free spheres without joints");
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const Load& load = scene.loads[i];
        if (std::holds_alternative<FormulaLoad>(load) || std::holds_alternative<PointSpring>(load) ||
            std::holds_alternative<UserTorque>(load))
            check.fail(fmt::format("/loads/{}", i), "is not supported together with planes or contacts of spheres",
                       "give loads of the types gravity, torque, force, impulse, drag or spring");
    }
    std::set<std::pair<std::size_t, std::size_t>> known;
    bool has_all = false;
    for (std::size_t i = 0; i < scene.contacts.size(); ++i) check_entry(check, scene, i, known, has_all);
    std::vector<SupportPiece<Wide>> spheres;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) spheres.push_back(require_sphere(check, scene, i));
    check_start(check, scene, spheres);
}

}  // namespace polhode
