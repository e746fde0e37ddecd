// Writes the parts of golden data that are specific to several bodies.
#include <algorithm>
#include <map>
#include <set>

#include "check/golden_code.h"
#include "motion/mechanism_motion.h"
#include "scene/scene_file.h"

namespace polhode::golden_code {
namespace {

// Moves the scalar of each quaternion in the JSON of joints and bodies to the end.
void put_scalars_last(ordered_json& document) {
    for (auto& [key, value] : document.items()) {
        const bool quaternion =
            key == "orientation" || key == "parent_orientation" || key == "rest_orientation" || key == "rest";
        if (quaternion && value.is_array() && value.size() == 4)
            std::rotate(value.begin(), value.begin() + 1, value.end());
        else if (value.is_structured())
            put_scalars_last(value);
    }
}

// Converts names to unique identifiers.
class Identifiers {
  public:
    std::string operator()(const std::string& name) {
        std::string made = identifier(name);
        for (int n = 2; !taken_.insert(made).second; ++n) made = fmt::format("{}_{}", identifier(name), n);
        return made;
    }

  private:
    std::set<std::string> taken_;
};

int place_in(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::ranges::find(names, name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::map<std::string, std::string> units_of_members(const std::string& m) {
    return {{"parent_point", m + ", parent's axes from its origin"},
            {"child_point", m + ", child's axes from its origin"},
            {"first_point", m + ", that body's axes from its origin"},
            {"second_point", m + ", that body's axes from its origin"},
            {"parent_orientation", "child axes at zero to parent axes"},
            {"axis", "child's axes"},
            {"axes", "middle frame's, then child's axes"},
            {"angle", "rad"},
            {"angles", "rad"},
            {"rate", "rad/s"},
            {"rates", "rad/s"},
            {"displacement", m},
            {"speed", m + "/s"},
            {"length", m},
            {"offset", m},
            {"torsional_friction", m},
            {"rolling_friction", m},
            {"rest_length", m},
            {"point", m},
            {"from", "s"},
            {"until", "s"},
            {"at", "s"}};
}

void add_body_constants(const ordered_json& bodies, const std::string& m, FieldList& all) {
    ordered_json mass = ordered_json::array(), center = mass, inertia = mass;
    for (const ordered_json& one : bodies) {
        const ordered_json& body = one["body"];
        mass.push_back(body["mass"]), center.push_back(body["center_of_mass"]);
        ordered_json tensor = ordered_json::array();
        for (const ordered_json& row : body["inertia"])
            for (const ordered_json& x : row) tensor.push_back(x);
        inertia.push_back(tensor);
    }
    all.add("mass", mass, "kg, one per body");
    all.add("center_of_mass", center, m + ", from the body's origin, body axes");
    all.add("inertia", inertia, "kg " + m + "^2, about the centre of mass, body axes: three rows of a matrix");
}

// Adds the members of joints, loops and loads. Refers to bodies and joints by index.
class MemberFields {
  public:
    // `m`: the unit of length
    MemberFields(const Scene& scene, const std::string& m, FieldList& all)
        : bodies_(body_names(scene)), joints_(joint_names(scene)), units_(units_of_members(m)), all_(all) {}

    int joint_index(const std::string& name) const { return place_in(joints_, name); }

    void add(const std::string& prefix, const std::string& key, const ordered_json& value) {
        if (key == "name" || key == "dependent") return;
        if (value.is_object()) {
            for (const auto& [inner, number] : value.items()) add(prefix + "initial_", inner, number);
        } else if (value.is_string()) {
            const std::string word = value;
            if (key == "type") {
                const std::vector<std::string> types{"revolute",  "prismatic", "spherical",
                                                     "universal", "fixed",     "distance"};
                if (const int type = place_in(types, word); type >= 0)
                    all_.add(prefix + "type", type,
                             word + ": 0 revolute, 1 prismatic, 2 spherical, 3 universal, 4 fixed, 5 distance");
            } else if (key == "frame" || key == "point_frame" || key == "angular_velocity_frame") {
                all_.add(prefix + key + "_is_body", word == "body" ? 1 : 0, "1: body axes, 0: world axes");
            } else if (key == "restitution_law") {
                all_.add(prefix + key, restitution_law_number(word), restitution_laws);
            } else if (key == "joint") {
                all_.add(prefix + key, place_in(joints_, word), word);
            } else {
                all_.add(prefix + key, place_in(bodies_, word), word + ": index of the body, -1 for the world");
            }
        } else if (value.is_boolean()) {
            all_.add(prefix + key, value ? 1 : 0, "1: true, 0: false");
        } else if (!(value.is_array() && value.empty())) {
            all_.add(prefix + key, value, units_.contains(key) ? units_.at(key) : "");
        }
    }

  private:
    std::vector<std::string> bodies_, joints_;
    std::map<std::string, std::string> units_;
    FieldList& all_;
};

}  // namespace

ordered_json system_surroundings(const Golden& g, const Numbers& number) {
    ordered_json written = number.all_of(ordered_json::parse(write_scene(g.scene))), all;
    if (scalar_last(g)) put_scalars_last(written);
    all["bodies"] = ordered_json::array();
    for (std::size_t b = 0; b < g.scene.bodies.size(); ++b) {
        const NamedBody& body = g.scene.bodies[b];
        ordered_json one{{"name", body.name},
                         {"body",
                          {{"mass", number(body.body.mass)},
                           {"center_of_mass", number(body.body.center_of_mass)},
                           {"inertia", number(body.body.inertia_B)}}}};
        if (b < g.shapes.size()) one["shape"] = shape_of(g.shapes[b], number);
        if (written["bodies"][b].contains("initial")) one["initial"] = written["bodies"][b]["initial"];
        all["bodies"].push_back(std::move(one));
    }
    for (const char* list : {"joints", "loops", "loads"}) all[list] = written.value(list, ordered_json::array());
    for (const char* list : {"planes", "contacts"})
        if (written.contains(list)) all[list] = written[list];
    add_names_of_formulas(written, all);
    return all;
}

void add_names_of_formulas(const ordered_json& written, ordered_json& all) {
    for (const char* key : {"parameters", "tables", "let"})
        if (written.contains(key)) all[key] = written[key];
}

ordered_json shape_of(const std::vector<SupportPiece<double>>& pieces, const Numbers& number) {
    ordered_json all = ordered_json::array();
    for (const SupportPiece<double>& piece : pieces) {
        ordered_json one{{"center", number(piece.center)}};
        if (piece.extended) one["semi_axes"] = number(transposed(piece.semi_axes));
        if (piece.radius > 0) one["radius"] = number(piece.radius);
        all.push_back(std::move(one));
    }
    return all;
}

void add_system_fields(const Golden& g, const ordered_json& around, const std::string& m, FieldList& all) {
    const std::vector<std::string> bodies = body_names(g.scene);
    Identifiers body_identifiers, joint_identifiers;
    all.add("bodies", bodies.size(), "");
    for (std::size_t b = 0; b < bodies.size(); ++b) all.add("body_" + body_identifiers(bodies[b]), b, bodies[b]);
    add_body_constants(around["bodies"], m, all);
    // spheres with contacts have centres of mass in their middles
    ordered_json radius = ordered_json::array();
    for (const auto& pieces : g.shapes) radius.push_back(pieces.empty() ? 0 : pieces.front().radius);
    if (!radius.empty()) all.add("radius", radius, m + ", one per body");
    all.add("joints", around["joints"].size(), "");
    all.add("loops", around["loops"].size(), "");

    MemberFields members(g.scene, m, all);
    for (const char* list : {"joints", "loops"})
        for (const ordered_json& one : around[list]) {
            const std::string prefix = (list[0] == 'j' ? "joint_" : "loop_") + joint_identifiers(one["name"]) + "_";
            all.add(prefix + "number", members.joint_index(one["name"]), one["name"]);
            for (const auto& [key, value] : one.items()) members.add(prefix, key, value);
        }
    for (const char* list : {"planes", "contacts"})
        for (std::size_t i = 0; around.contains(list) && i < around[list].size(); ++i)
            for (const auto& [key, value] : around[list][i].items())
                members.add(fmt::format("{}_{}_", list[0] == 'p' ? "plane" : "contact", i), key, value);
    for (std::size_t i = 0; i < around["loads"].size(); ++i) {
        const ordered_json& load = around["loads"][i];
        const std::string prefix = fmt::format("{}_{}_", load.value("type", std::string("load")), i);
        for (const auto& [key, value] : load.items())
            if (key != "type") members.add(prefix, key, value);
    }
}

}  // namespace polhode::golden_code
