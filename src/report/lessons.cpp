// Reads lessons. The page computes the motion of a body that is free, has a fixed point under gravity, or slides and
// rolls on a plane (page/source/lesson), so the scene is checked against this and reduced to numbers: mass, inertia,
// arm, gravity, contact, start.
#include "report/lessons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>

#include "report/body_shape.h"
#include "report/lesson_contact.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_lesson = std::size_t{1} << 20;  // bytes
constexpr std::size_t longest_text = 2000, most_paragraphs = 20;
constexpr double most_lesson_steps = 200'000;
// all digits of binary64: the page computes with these numbers
constexpr int exact_digits = 17;

// the kernels of page/source/lesson/kernels.ts
const std::vector<std::string> lesson_updates = {
    "gyroscopic_none",          "gyroscopic_explicit",          "gyroscopic_implicit",   "gyroscopic_linearly_implicit",
    "midpoint_gyroscopic",      "gyroscopic_rescaled_momentum", "gyroscopic_substepped", "first_order_quaternion",
    "momentum_exponential_map", "baraff_witkin_euler",          "baraff_witkin_rk4"};
// those of page/source/lesson/contact_kernels.ts
const std::vector<std::string> contact_lesson_updates = {"contact_impulses_cone", "contact_impulses_cone_cold",
                                                         "contact_impulses_cone_baumgarte", "contact_impulses_pyramid",
                                                         "moreau_jean"};
const std::vector<std::string> lesson_quantities = {"angular_velocity_x",
                                                    "angular_velocity_y",
                                                    "angular_velocity_z",
                                                    "moment_x",
                                                    "moment_y",
                                                    "moment_z",
                                                    "velocity_x",
                                                    "velocity_y",
                                                    "tilt",
                                                    "friction",
                                                    "gravity",
                                                    "step",
                                                    "duration"};
const std::vector<std::string> lesson_graphs = {"angular_velocity", "energy", "height", "momentum", "slip", "spin",
                                                "step_error",       "tilt"};
const std::vector<std::string> lesson_marks = {"angular_velocity", "axes", "ellipsoid", "momentum", "path", "trail"};

// Returns the string of a node, which must be one of `known`.
std::string read_choice(const JsonNode& node, const std::vector<std::string>& known) {
    const std::string& word = node.string();
    if (std::ranges::find(known, word) == known.end()) {
        const std::string near = did_you_mean(word, known);
        node.fail("is " + one_line(word, 80), near.empty() ? "give one of " + join_with_commas(known) : near);
    }
    return word;
}

std::string read_line(const JsonNode& node, std::size_t longest) {
    const std::string& text = node.string();
    if (text.empty() || text.size() > longest)
        node.fail(fmt::format("has {} bytes", text.size()), fmt::format("give a text of 1 to {} bytes", longest));
    return text;
}

// Returns a name that can be part of an address.
std::string read_name(const JsonNode& node) {
    const std::string& name = node.string();
    const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
    if (name.empty() || name.size() > 100 || !std::ranges::all_of(name, is_plain))
        node.fail("is " + (name.empty() ? "empty" : one_line(name, 80)), "give at most 100 letters, digits, _ and -");
    return name;
}

double read_positive(const JsonNode& node) {
    if (!(node.number() > 0)) node.fail(node.describe(), "give a number > 0");
    return node.number();
}

Json read_choices(const JsonNode* node, const std::vector<std::string>& known) {
    Json list = Json::array();
    if (node != nullptr)
        for (const JsonNode* one : node->elements()) list.push_back(read_choice(*one, known));
    return list;
}

Json read_paragraphs(const JsonNode& node) {
    Json list = Json::array();
    if (node.is_string()) {
        list.push_back(read_line(node, longest_text));
        return list;
    }
    if (node.elements().empty() || node.elements().size() > most_paragraphs)
        node.fail(node.describe(), fmt::format("give 1 to {} paragraphs", most_paragraphs));
    for (const JsonNode* one : node.elements()) list.push_back(read_line(*one, longest_text));
    return list;
}

// The numbers of one value, with all digits.
template <class Values>
Json exact_json(const Values& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number_json(value, exact_digits));
    return list;
}

// Returns the scene that the lesson names: a built-in scene, or a file relative to the lesson's folder.
Scene read_lesson_scene(const JsonNode& node, const std::string& directory) {
    const std::string& name = node.string();
    try {
        return builtin_scene_text(name).empty() ? read_scene(path_inside(directory, name)) : find_scene(name);
    } catch (const InputError& fault) {
        node.fail(fault);
    }
}

// Refuses what the page does not compute. Returns gravity, m/s^2.
std::optional<Vector3<double>> require_lesson_scene(const JsonNode& node, const Scene& scene) {
    if (!scene.bodies.empty()) node.fail("has several bodies", "give a scene of one body");
    if (scene.planes.empty() && !scene.pivot && !(scene.initial.velocity_W == Vector3<double>()))
        node.fail("has a velocity", "give a scene that starts without velocity; a lesson shows the rotation only");
    std::optional<Vector3<double>> gravity;
    for (const Load& load : scene.loads) {
        const Gravity* const one = std::get_if<Gravity>(&load);
        if (!one || gravity || one->window.from != Window().from || one->window.until != Window().until)
            node.fail("has loads other than constant gravity", "give a scene whose only load is gravity, or none");
        gravity = one->acceleration_W;
    }
    if (gravity && !scene.pivot && scene.planes.empty())
        node.fail("has gravity and neither a pivot nor a plane", "remove the gravity, or give the body a pivot");
    return gravity;
}

bool has_slider(const Json& sliders, std::string_view start) {
    return std::ranges::any_of(sliders,
                               [&](const Json& one) { return one["quantity"].get<std::string>().starts_with(start); });
}

// Reads the sliders and their ranges, and refuses those without effect on the scene.
Json read_sliders(const JsonNode& node, const Scene& scene, bool has_gravity) {
    Json list = Json::array();
    for (const JsonNode* one : node.members()) {
        if (std::ranges::find(lesson_quantities, one->key()) == lesson_quantities.end()) {
            const std::string near = did_you_mean(one->key(), lesson_quantities);
            one->fail("is not a slider", near.empty() ? "give one of " + join_with_commas(lesson_quantities) : near);
        }
        const auto& range = one->elements();
        if (range.size() != 2 || !(range[0]->number() < range[1]->number()))
            one->fail(one->describe(), "give the range of the slider as [from, to] with from < to");
        const bool positive = one->key() == "step" || one->key() == "duration" || one->key().starts_with("moment");
        if (positive && !(range[0]->number() > 0)) range[0]->fail(range[0]->describe(), "give a number > 0");
        if (one->key() == "gravity" && !has_gravity)
            one->fail("has no effect without gravity", "remove it, or give a scene with a pivot and gravity");
        if (scene.planes.empty() && (one->key() == "friction" || one->key().starts_with("velocity")))
            one->fail("has no effect without a plane", "remove it, or give a scene with a plane");
        if (one->key() == "friction" && !(range[0]->number() >= 0))
            range[0]->fail(range[0]->describe(), "give a number >= 0");
        if (one->key().starts_with("moment"))
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < i; ++j)
                    if (scene.body.inertia_B[i][j] != 0)
                        one->fail("needs an inertia without products", "remove it, or give the scene three moments");
        list.push_back({{"quantity", one->key()},
                        {"from", number_json(range[0]->number(), exact_digits)},
                        {"to", number_json(range[1]->number(), exact_digits)}});
    }
    return list;
}

// Adds the numbers of the scene that the page computes with.
void add_scene_numbers(const Scene& scene, const std::optional<Vector3<double>>& gravity, Json& json) {
    const Body& body = scene.body;
    json["mass"] = number_json(body.mass, exact_digits);
    json["inertia"] = Json::array();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) json["inertia"].push_back(number_json(body.inertia_B[i][j], exact_digits));
    const auto list = [](const Vector3<double>& v) { return exact_json(std::array{v[0], v[1], v[2]}); };
    json["arm"] = scene.pivot ? list(body.center_of_mass - *scene.pivot) : Json();
    json["gravity"] = gravity ? list(*gravity) : Json();
    const Quaternion<double> q = normalized(scene.initial.orientation);
    json["orientation"] = exact_json(std::array{q.w, q.x, q.y, q.z});
    const Vector3<double>& w = scene.initial.angular_velocity;
    json["angular_velocity"] = list(scene.initial.angular_velocity_frame == Frame::body ? w : rotate(conjugate(q), w));
    json["shape"] = body_shape_json(scene.name, body);
    json["about"] = principal_json(body, scene.pivot);
}

// The folder of a path, empty for the working directory.
std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

}  // namespace

std::vector<std::string> builtin_lesson_names() {
    std::vector<std::string> names;
    for (const BuiltinText& one : builtin_lessons()) names.emplace_back(one.name);
    return names;
}

Json parse_lesson(std::string_view text, const std::string& file, const std::string& directory) {
    const JsonDocument document(text, file);
    const JsonNode& root = document.root();
    root.require_known_keys(
        {"name", "title", "text", "scene", "duration", "update", "step", "sliders", "graphs", "show"});
    Json json{{"name", read_name(root.require_member("name", "a short name"))},
              {"title", read_line(root.require_member("title", "the heading of the lesson"), 200)},
              {"text", read_paragraphs(root.require_member("text", "one paragraph, or a list of paragraphs"))}};
    const JsonNode& scene_node = root.require_member("scene", "a built-in scene or a scene file");
    const Scene scene = read_lesson_scene(scene_node, directory);
    const std::optional<Vector3<double>> gravity = require_lesson_scene(scene_node, scene);
    const Json contact = lesson_contact_json(scene_node, scene);
    const JsonNode* const duration_node = root.find("duration");
    const double duration = duration_node ? read_positive(*duration_node) : scene.duration;
    const JsonNode& step_node = root.require_member("step", "the step of the update, s");
    const double step = read_positive(step_node);
    if (duration / step > most_lesson_steps)
        step_node.fail(fmt::format("gives {:.3g} steps", duration / step),
                       fmt::format("give at least {:.3g} s, or a shorter duration", duration / most_lesson_steps));
    json["scene"] = scene.name;
    json["duration"] = number_json(duration, exact_digits);
    const bool has_contact = !contact.is_null();
    json["update"] = read_choice(root.require_member("update", "the name of an update"),
                                 has_contact ? contact_lesson_updates : lesson_updates);
    json["step"] = number_json(step, exact_digits);
    const JsonNode* const sliders = root.find("sliders");
    json["sliders"] = sliders ? read_sliders(*sliders, scene, gravity.has_value()) : Json::array();
    json["graphs"] = read_choices(root.find("graphs"), lesson_graphs);
    for (const Json& one : json["graphs"]) {
        const std::string graph = one.get<std::string>();
        const bool needs_plane = graph == "height" || graph == "slip" || graph == "spin";
        if (needs_plane && !has_contact)
            root.find("graphs")->fail("has " + graph + ", which needs a plane", "remove it");
        if (graph == "step_error" && has_contact)
            root.find("graphs")->fail("has step_error, which is not available with a plane", "remove it");
    }
    std::string show;
    for (const Json& one : read_choices(root.find("show"), lesson_marks))
        show += (show.empty() ? "" : ",") + one.get<std::string>();
    json["show"] = show;
    add_scene_numbers(scene, gravity, json);
    json["contact"] = contact;
    if (has_slider(json["sliders"], "tilt") && !scene.pivot && !has_contact)
        sliders->fail("has a slider for the tilt, which needs a pivot or a plane", "remove it, or give another scene");
    return json;
}

Json find_lesson(const std::string& name_or_path) {
    for (const BuiltinText& one : builtin_lessons())
        if (one.name == name_or_path) return parse_lesson(one.text, fmt::format("lesson {}", one.name));
    std::error_code none;
    if (!fs::exists(name_or_path, none)) {
        const std::vector<std::string> names = builtin_lesson_names();
        const std::string near = did_you_mean(name_or_path, names);
        throw InputError(one_line(name_or_path, 300), "", "is neither a built-in lesson nor a file",
                         near.empty() ? "give a lesson file or one of " + join_with_commas(names) : near);
    }
    return parse_lesson(read_text(name_or_path, largest_lesson, "a readable lesson file"), name_or_path,
                        folder_of(name_or_path));
}

Json builtin_lessons_json() {
    Json list = Json::array();
    for (const std::string& name : builtin_lesson_names()) list.push_back(find_lesson(name));
    return list;
}

}  // namespace polhode
