#include "scene/scene_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include "scene/builtin.h"
#include "scene/json_document.h"
#include "scene/message.h"

namespace polhode {
namespace {

Vector3<double> vector3(const JsonNode& node) {
    if (node.elements().size() != 3) node.fail(node.described(), "give 3 numbers [x, y, z]");
    return {node.elements()[0]->number(), node.elements()[1]->number(), node.elements()[2]->number()};
}

Quaternion<double> quaternion(const JsonNode& node) {
    const auto& e = node.elements();
    if (e.size() != 4) node.fail(node.described(), "give a quaternion of 4 numbers [w, x, y, z]");
    return {e[0]->number(), e[1]->number(), e[2]->number(), e[3]->number()};
}

Frame frame(const JsonNode& node) {
    if (node.string() == "body") return Frame::body;
    if (node.string() == "world") return Frame::world;
    node.fail(node.described(), "give \"body\" or \"world\"");
}

void refuse_unavailable(const JsonNode& object, std::initializer_list<const char*> keys, const char* remedy) {
    for (const char* key : keys)
        if (const JsonNode* node = object.find(key))
            node->fail(fmt::format("\"{}\" is not available yet", key), remedy);
}

Matrix3<double> inertia(const JsonNode& node) {
    const char* remedy = "give 3 moments or a 3x3 matrix in kg m^2";
    const auto& e = node.elements();
    if (e.size() != 3) node.fail(node.described(), remedy);
    if (!e[0]->is_array()) {
        for (const JsonNode* moment : e)
            if (!moment->is_number()) moment->fail(moment->described(), remedy);
        return diagonal(vector3(node));
    }
    Matrix3<double> m;
    for (int i = 0; i < 3; ++i) {
        if (!e[i]->is_array() || e[i]->elements().size() != 3) e[i]->fail(e[i]->described(), "give a row of 3 numbers");
        m[i] = vector3(*e[i]);
    }
    return m;
}

Body body(const JsonNode& node) {
    refuse_unavailable(node, {"shape", "parts", "points", "mesh", "import", "density"},
                       "give \"mass\", \"inertia\" and \"center_of_mass\"");
    node.only({"mass", "inertia", "center_of_mass"});
    Body b;
    b.mass = node.required("mass", "the mass in kg").number();
    b.inertia_B = inertia(node.required("inertia", "3 moments or a 3x3 matrix about the centre of mass in kg m^2"));
    if (const JsonNode* center = node.find("center_of_mass")) b.center_of_mass = vector3(*center);
    return b;
}

Initial initial(const JsonNode& node, bool pivoted) {
    node.only({"orientation", "angular_velocity", "angular_velocity_frame", "position", "velocity"});
    Initial start;
    if (const JsonNode* q = node.find("orientation")) start.orientation = quaternion(*q);
    if (const JsonNode* w = node.find("angular_velocity")) start.angular_velocity = vector3(*w);
    if (const JsonNode* f = node.find("angular_velocity_frame")) start.angular_velocity_frame = frame(*f);
    for (const char* key : {"position", "velocity"}) {
        const JsonNode* given = node.find(key);
        if (!given) continue;
        if (pivoted)
            given->fail("stands beside a pivot",
                        "leave it out: the pivot and the attitude say where the centre of mass is");
        (key[0] == 'p' ? start.position_W : start.velocity_W) = vector3(*given);
    }
    return start;
}

Window window(const JsonNode& node) {
    Window w;
    if (const JsonNode* from = node.find("from")) w.from = from->number();
    if (const JsonNode* until = node.find("until")) w.until = until->number();
    return w;
}

Frame point_frame(const JsonNode& node) {
    const JsonNode* given = node.find("point_frame");
    return given ? frame(*given) : Frame::body;
}

Load gravity(const JsonNode& node) {
    node.only({"type", "acceleration", "from", "until"});
    return Gravity{vector3(node.required("acceleration", "[x, y, z] in m/s^2, world axes")), window(node)};
}

Load constant_torque(const JsonNode& node) {
    node.only({"type", "vector", "frame", "from", "until"});
    return Torque{vector3(node.required("vector", "[x, y, z] in N m")),
                  frame(node.required("frame", "\"body\" or \"world\"")), window(node)};
}

Load force(const JsonNode& node) {
    node.only({"type", "vector", "frame", "point", "point_frame", "from", "until"});
    return Force{vector3(node.required("vector", "[x, y, z] in N")),
                 frame(node.required("frame", "\"body\" or \"world\"")),
                 vector3(node.required("point", "where it acts: [x, y, z] in m")), point_frame(node), window(node)};
}

Load impulse(const JsonNode& node) {
    node.only({"type", "vector", "frame", "point", "point_frame", "at"});
    return Impulse{vector3(node.required("vector", "[x, y, z] in N s")),
                   frame(node.required("frame", "\"body\" or \"world\"")),
                   vector3(node.required("point", "where it acts: [x, y, z] in m")), point_frame(node),
                   node.required("at", "the time in s").number()};
}

Load drag(const JsonNode& node) {
    node.only({"type", "rotational", "translational", "from", "until"});
    const JsonNode* rotational = node.find("rotational");
    const JsonNode* translational = node.find("translational");
    if (!rotational && !translational)
        node.fail("has neither \"rotational\" nor \"translational\"", "give at least one of them");
    Drag load;
    if (rotational) load.rotational = vector3(*rotational);
    if (translational) load.translational = translational->number();
    load.window = window(node);
    return load;
}

Load spring(const JsonNode& node) {
    node.only({"type", "stiffness", "rest_orientation", "from", "until"});
    Spring load;
    load.stiffness = node.required("stiffness", "the stiffness in N m").number();
    if (const JsonNode* rest = node.find("rest_orientation")) load.rest_orientation = quaternion(*rest);
    load.window = window(node);
    return load;
}

Load load(const JsonNode& node) {
    static constexpr std::pair<const char*, Load (*)(const JsonNode&)> kinds[] = {
        {"gravity", gravity}, {"torque", constant_torque}, {"force", force}, {"impulse", impulse},
        {"drag", drag},       {"spring", spring}};
    std::vector<std::string> names;
    for (const auto& [name, read] : kinds) names.push_back(name);
    const JsonNode& type = node.required("type", "one of " + listed(names));
    for (const auto& [name, read] : kinds)
        if (type.string() == name) return read(node);
    const std::string meant = did_you_mean(type.string(), names);
    type.fail(type.described(), fmt::format("{}{}give one of {}", meant, meant.empty() ? "" : " ", listed(names)));
}

Scene scene(const JsonNode& root) {
    if (!root.is_object()) root.fail(root.described(), "give an object {\"name\": .., \"duration\": .., \"body\": ..}");
    refuse_unavailable(root, {"planes"}, "leave it out");
    root.only({"name", "about", "source", "duration", "body", "initial", "pivot", "loads", "tolerated"});
    Scene s;
    s.name = root.required("name", "the scene's name").string();
    if (const JsonNode* about = root.find("about")) s.about = about->string();
    if (const JsonNode* source = root.find("source")) s.source = source->string();
    s.duration = root.required("duration", "the duration in s, > 0").number();
    s.body = body(root.required("body", "the mass properties {\"mass\": .., \"inertia\": ..}"));
    if (const JsonNode* pivot = root.find("pivot")) s.pivot = vector3(*pivot);
    if (const JsonNode* start = root.find("initial")) s.initial = initial(*start, s.pivot.has_value());
    if (const JsonNode* loads = root.find("loads"))
        for (const JsonNode* one : loads->elements()) s.loads.push_back(load(*one));
    if (const JsonNode* tolerated = root.find("tolerated")) {
        tolerated->only({"attitude"});
        s.tolerated_attitude = tolerated->required("attitude", "the largest attitude error in rad").number();
    }
    return s;
}

bool is_file(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0;
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& file) {
    const JsonDocument document(text, file);
    Scene parsed = scene(document.root());
    validate(parsed, file);
    return parsed;
}

Scene read_scene(const std::string& path) { return parse_scene(read_text(path), path); }

Scene find_scene(const std::string& name_or_path) {
    if (const std::string_view text = builtin_scene_text(name_or_path); !text.empty())
        return parse_scene(text, name_or_path);
    const bool path_like = name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".json");
    if (path_like || is_file(name_or_path)) return read_scene(name_or_path);
    const std::string meant = did_you_mean(name_or_path, builtin_scene_names());
    throw InputError(name_or_path, "", "is neither a built-in scene nor a file",
                     meant.empty() ? "built-in scenes: " + listed(builtin_scene_names()) : meant);
}

}  // namespace polhode
