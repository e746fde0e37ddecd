#include "scene/scene_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "scene/body_file.h"
#include "scene/builtin.h"
#include "scene/json_values.h"
#include "scene/scene_keys.h"
#include "text/message.h"

namespace polhode {
namespace {

Frame frame(const JsonNode& node) {
    if (node.string() == "body") return Frame::body;
    if (node.string() == "world") return Frame::world;
    node.fail(node.described(), "give \"body\" or \"world\"");
}

Initial initial(const JsonNode& node, bool pivoted) {
    node.only(keys_of(scene_keys(), "initial"));
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
    return Gravity{vector3(node.required("acceleration", "[x, y, z] in m/s^2, world axes")), window(node)};
}

Load constant_torque(const JsonNode& node) {
    return Torque{vector3(node.required("vector", "[x, y, z] in N m")),
                  frame(node.required("frame", "\"body\" or \"world\"")), window(node)};
}

Load force(const JsonNode& node) {
    return Force{vector3(node.required("vector", "[x, y, z] in N")),
                 frame(node.required("frame", "\"body\" or \"world\"")),
                 vector3(node.required("point", "where it acts: [x, y, z] in m")), point_frame(node), window(node)};
}

Load impulse(const JsonNode& node) {
    return Impulse{vector3(node.required("vector", "[x, y, z] in N s")),
                   frame(node.required("frame", "\"body\" or \"world\"")),
                   vector3(node.required("point", "where it acts: [x, y, z] in m")), point_frame(node),
                   node.required("at", "the time in s").number()};
}

Load drag(const JsonNode& node) {
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
        if (type.string() == name) {
            node.only(keys_of(scene_keys(), fmt::format("load {}", name)));
            return read(node);
        }
    const std::string meant = did_you_mean(type.string(), names);
    type.fail(type.described(), fmt::format("{}{}give one of {}", meant, meant.empty() ? "" : " ", listed(names)));
}

Plane plane(const JsonNode& node) {
    node.only(keys_of(scene_keys(), "plane"));
    Plane p;
    p.normal_W = vector3(node.required("normal", "[x, y, z], world axes, towards the body"));
    if (const JsonNode* offset = node.find("offset")) p.offset = offset->number();
    p.restitution = node.required("restitution", "how much of the normal speed an impact gives back, 0 to 1").number();
    if (const JsonNode* friction = node.find("friction")) p.friction = friction->number();
    return p;
}

Scene scene(const JsonNode& root, const std::string& directory) {
    if (!root.is_object()) root.fail(root.described(), "give an object {\"name\": .., \"duration\": .., \"body\": ..}");
    root.only(keys_of(scene_keys(), "scene"));
    Scene s;
    s.directory = directory;
    s.name = root.required("name", "the scene's name").string();
    if (const JsonNode* about = root.find("about")) s.about = about->string();
    if (const JsonNode* source = root.find("source")) s.source = source->string();
    s.duration = root.required("duration", "the duration in s, > 0").number();
    s.body = parse_body(root.required("body", "the mass properties {\"mass\": .., \"inertia\": ..}"), directory);
    if (const JsonNode* pivot = root.find("pivot")) s.pivot = vector3(*pivot);
    if (const JsonNode* start = root.find("initial")) s.initial = initial(*start, s.pivot.has_value());
    if (const JsonNode* loads = root.find("loads"))
        for (const JsonNode* one : loads->elements()) s.loads.push_back(load(*one));
    if (const JsonNode* planes = root.find("planes"))
        for (const JsonNode* one : planes->elements()) s.planes.push_back(plane(*one));
    if (const JsonNode* tolerated = root.find("tolerated")) {
        tolerated->only(keys_of(scene_keys(), "tolerated"));
        for (const JsonNode* error : tolerated->members()) s.tolerated[error->key()] = error->number();
        if (s.tolerated.empty()) tolerated->fail("is empty", "{\"attitude\": 1e-3}, or no tolerated at all");
    }
    return s;
}

bool is_file(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0;
}

// Whether it begins with a folder of built-in scenes.
bool in_builtin_folder(std::string_view name) {
    const std::size_t slash = name.find('/');
    if (slash == name.npos) return false;
    for (const BuiltinText& scene : builtin_scenes())
        if (scene.name.starts_with(name.substr(0, slash + 1))) return true;
    return false;
}

// The built-in scenes meant by a name that is none: first the one that is called so in a folder.
std::string scenes_meant(const std::string& name) {
    for (const BuiltinText& scene : builtin_scenes())
        if (scene.name.ends_with("/" + name)) return fmt::format("did you mean {}?", scene.name);
    return did_you_mean(name, builtin_scene_names());
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& file, const std::string& directory) {
    const JsonDocument document(text, file);
    Scene parsed = scene(document.root(), directory);
    validate(parsed, file);
    return parsed;
}

Scene read_scene(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return parse_scene(read_text(path), path,
                       slash == path.npos ? "" : path.substr(0, std::max<std::size_t>(slash, 1)));
}

Scene find_scene(const std::string& name_or_path) {
    if (const std::string_view text = builtin_scene_text(name_or_path); !text.empty())
        return parse_scene(text, name_or_path);
    const bool path_like = name_or_path.ends_with(".json") ||
                           (name_or_path.find('/') != std::string::npos && !in_builtin_folder(name_or_path));
    if (path_like || is_file(name_or_path)) return read_scene(name_or_path);
    const std::string meant = scenes_meant(name_or_path);
    throw InputError(name_or_path, "", "is neither a built-in scene nor a file",
                     meant.empty() ? "built-in scenes: " + listed(builtin_scene_names()) : meant);
}

}  // namespace polhode
