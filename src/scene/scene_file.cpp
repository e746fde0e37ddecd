#include "scene/scene_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "scene/body_file.h"
#include "scene/builtin.h"
#include "scene/formula_file.h"
#include "scene/initial_file.h"
#include "scene/joint_file.h"
#include "scene/joint_motions.h"
#include "scene/json_values.h"
#include "scene/load_file.h"
#include "scene/plane_file.h"
#include "scene/scene_keys.h"
#include "scene/sphere_contacts.h"
#include "text/message.h"

namespace polhode {
namespace {

// Whether the scene has several bodies. Throws if it mixes members of both kinds.
bool has_several(const JsonNode& root) {
    const JsonNode* several = nullptr;
    for (const char* key : {"bodies", "joints", "import", "loops"})
        if (const JsonNode* one = root.find(key); one && !several) several = one;
    for (const char* key : {"body", "initial", "pivot"})
        if (const JsonNode* one = root.find(key); one && several)
            one->fail(fmt::format("is given together with \"{}\"", several->key()),
                      "give \"body\", \"initial\" and \"pivot\" for one body, or \"bodies\", \"joints\" and \"loops\" "
                      "for several");
    if (root.find("import"))
        for (const char* key : {"bodies", "joints"})
            if (const JsonNode* one = root.find(key))
                one->fail("is given together with \"import\"",
                          "remove it: the robot's file defines the bodies and joints");
    return several;
}

Scene scene(const JsonNode& root, const std::string& directory) {
    if (!root.is_object()) root.fail(root.describe(), "give an object {\"name\": .., \"duration\": .., \"body\": ..}");
    root.require_known_keys(keys_of(scene_keys(), "scene"));
    Scene s;
    s.directory = directory;
    s.name = root.require_member("name", "the scene's name").string();
    if (const JsonNode* about = root.find("about")) s.about = about->string();
    if (const JsonNode* source = root.find("source")) s.source = source->string();
    s.duration = root.require_member("duration", "the duration in s, > 0").number();
    if (has_several(root)) {
        parse_mechanism(root, s);
    } else {
        s.body =
            parse_body(root.require_member("body", "the mass properties {\"mass\": .., \"inertia\": ..}"), directory);
        if (const JsonNode* pivot = root.find("pivot")) s.pivot = vector3(*pivot);
        if (const JsonNode* start = root.find("initial")) s.initial = parse_initial(*start, s.pivot.has_value());
    }
    parse_formula_members(root, directory, s);
    if (const JsonNode* loads = root.find("loads"))
        for (const JsonNode* one : loads->elements()) s.loads.push_back(parse_load(*one, s.joints));
    if (const JsonNode* planes = root.find("planes"))
        for (const JsonNode* one : planes->elements()) s.planes.push_back(parse_plane(*one));
    if (const JsonNode* contacts = root.find("contacts"))
        for (const JsonNode* one : contacts->elements()) s.contacts.push_back(parse_sphere_contact(*one));
    if (const JsonNode* tolerated = root.find("tolerated")) {
        tolerated->require_known_keys(keys_of(scene_keys(), "tolerated"));
        for (const JsonNode* error : tolerated->members()) s.tolerated[error->key()] = error->number();
        if (s.tolerated.empty())
            tolerated->fail("is empty", "give limits such as {\"attitude\": 1e-3}, or remove \"tolerated\"");
    }
    return s;
}

// Places of joints that were expanded to chains keep the indices of the file.
std::string place_in_file(const Scene& scene, const std::string& place) {
    constexpr std::string_view prefix = "/joints/";
    if (!place.starts_with(prefix)) return place;
    std::size_t index = 0;
    const auto [end, fault] = std::from_chars(place.data() + prefix.size(), place.data() + place.size(), index);
    if (fault != std::errc() || index >= scene.joints.size() || scene.joints[index].place.empty()) return place;
    return scene.joints[index].place + place.substr(static_cast<std::size_t>(end - place.data()));
}

// Converts a place in the bodies or joints of an imported robot to a place in the robot's file: "/bodies/3/body/mass"
// -> "/import: arm.urdf: line 5, body \"arm\", mass".
std::string place_in_robot(const Scene& scene, const std::string& place) {
    const auto named = [&](const char* list, const char* what, const auto& all) -> std::string {
        const std::string_view prefix = list;
        if (!place.starts_with(prefix)) return "";
        std::size_t index = 0;
        const auto [end, fault] = std::from_chars(place.data() + prefix.size(), place.data() + place.size(), index);
        if (fault != std::errc() || index >= all.size()) return "";
        const std::size_t last = place.rfind('/');
        const std::string detail = last >= std::size_t(end - place.data()) ? ", " + place.substr(last + 1) : "";
        const std::string& stands = all[index].place;
        return fmt::format("/import{}{}, {} \"{}\"{}", stands.empty() ? "" : ": ", stands, what,
                           one_line(all[index].name, 60), detail);
    };
    for (const std::string& by_name :
         {named("/bodies/", "body", scene.bodies), named("/joints/", "joint", scene.joints)})
        if (!by_name.empty()) return by_name;
    return place;
}

bool is_file(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0;
}

// Whether the name begins with a folder of built-in scenes.
bool in_builtin_folder(std::string_view name) {
    const std::size_t slash = name.find('/');
    if (slash == name.npos) return false;
    for (const BuiltinText& scene : builtin_scenes())
        if (scene.name.starts_with(name.substr(0, slash + 1))) return true;
    return false;
}

// The directory for files that a built-in scene names.
std::string builtin_folder_of(const std::string& name) {
    const std::size_t slash = name.rfind('/');
    return std::string(builtin_directory) + (slash == name.npos ? "" : name.substr(0, slash));
}

// Suggestion for an unknown scene name: preferably the built-in scene with this name in a folder.
std::string scenes_meant(const std::string& name) {
    for (const BuiltinText& scene : builtin_scenes())
        if (scene.name.ends_with("/" + name)) return fmt::format("did you mean {}?", scene.name);
    return did_you_mean(name, builtin_scene_names());
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& file, const std::string& directory) {
    const JsonDocument document(text, file);
    Scene parsed = scene(document.root(), directory);
    const bool is_imported = document.root().find("import");
    try {
        start_joint_motions(parsed, file);
        validate(parsed, file);
    } catch (const InputError& error) {
        throw error.relocate(
            file, is_imported ? place_in_robot(parsed, error.place()) : place_in_file(parsed, error.place()));
    }
    return parsed;
}

Scene read_scene(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return parse_scene(read_text(path), path,
                       slash == path.npos ? "" : path.substr(0, std::max<std::size_t>(slash, 1)));
}

Scene find_scene(const std::string& name_or_path) {
    if (const std::string_view text = builtin_scene_text(name_or_path); !text.empty())
        return parse_scene(text, name_or_path, builtin_folder_of(name_or_path));
    const bool path_like = name_or_path.ends_with(".json") ||
                           (name_or_path.find('/') != std::string::npos && !in_builtin_folder(name_or_path));
    if (path_like || is_file(name_or_path)) return read_scene(name_or_path);
    const std::string meant = scenes_meant(name_or_path);
    throw InputError(name_or_path, "", "is neither a built-in scene nor a file",
                     meant.empty() ? "built-in scenes: " + join_with_commas(builtin_scene_names()) : meant);
}

}  // namespace polhode
