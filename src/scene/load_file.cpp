// Reader and writer of the member "loads" of scene files, with one function per load type. The permitted keys of each
// type are in scene_keys.h; values are checked by validate().

#include "scene/load_file.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "scene/initial_file.h"
#include "scene/json_values.h"
#include "scene/scene_keys.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

const JointType* type_of(const std::vector<Joint>& joints, const std::string& name) {
    for (const Joint& joint : joints)
        if (joint.name == name) return &joint.type;
    return nullptr;
}

Window load_window(const JsonNode& node) {
    Window w;
    if (const JsonNode* from = node.find("from")) w.from = from->number();
    if (const JsonNode* until = node.find("until")) w.until = until->number();
    return w;
}

Frame point_frame(const JsonNode& node) {
    const JsonNode* given = node.find("point_frame");
    return given ? parse_frame(*given) : Frame::body;
}

Load gravity(const JsonNode& node) {
    return Gravity{vector3(node.require_member("acceleration", "[x, y, z] in m/s^2, world axes")), load_window(node)};
}

// A formula, or a list of three formulas.
std::string formula_text(const JsonNode& node) {
    if (!node.is_array()) return node.string();
    const auto& parts = node.elements();
    if (parts.size() != 3) node.fail(node.describe(), "give one formula, or a list of three");
    std::string text;
    for (const JsonNode* part : parts) {
        text += text.empty() ? "[" : ", ";
        text += part->is_number() ? shortest_decimal(part->number()) : part->string();
    }
    return text + "]";
}

// The formula load at `node`; refuses keys of the load with constant values.
FormulaLoad formula_load(const JsonNode& node, FormulaKind kind, std::initializer_list<const char*> constants) {
    FormulaLoad load;
    load.kind = kind;
    load.formula = formula_text(node.require_member("formula", "a formula of time and state"));
    for (const char* key : constants)
        if (const JsonNode* constant = node.find(key))
            constant->fail("is given together with \"formula\"", "give one of the two");
    if (const JsonNode* hold = node.find("hold")) {
        if (kind == FormulaKind::potential) hold->fail("is given for a potential", "remove it, or give a force");
        const double period = hold->number();
        if (!(period > 0)) hold->fail("is " + shortest_decimal(period), "give a period > 0, s");
        load.formula = fmt::format("hold({}, {})", load.formula, shortest_decimal(period));
    }
    if (kind == FormulaKind::torque || kind == FormulaKind::force)
        load.frame = parse_frame(node.require_member("frame", "\"body\" or \"world\""));
    if (const JsonNode* point = node.find("point")) load.point = vector3(*point), load.has_point = true;
    if (const JsonNode* frame = node.find("point_frame")) {
        if (!load.has_point) frame->fail("is given without \"point\"", "give the point of application [x, y, z] in m");
        load.point_frame = parse_frame(*frame);
    }
    load.window = load_window(node);
    return load;
}

Load potential(const JsonNode& node) { return formula_load(node, FormulaKind::potential, {}); }

// Refuses the sampling period of a load that is not a formula.
void refuse_hold(const JsonNode& node) {
    if (const JsonNode* hold = node.find("hold"))
        hold->fail("is given without \"formula\"", "give the load as a formula, or remove it");
}

Load constant_torque(const JsonNode& node) {
    if (node.find("formula")) return formula_load(node, FormulaKind::torque, {"vector"});
    refuse_hold(node);
    return Torque{vector3(node.require_member("vector", "[x, y, z] in N m")),
                  parse_frame(node.require_member("frame", "\"body\" or \"world\"")), load_window(node)};
}

Load force(const JsonNode& node) {
    if (node.find("formula")) return formula_load(node, FormulaKind::force, {"vector"});
    refuse_hold(node);
    return Force{vector3(node.require_member("vector", "[x, y, z] in N")),
                 parse_frame(node.require_member("frame", "\"body\" or \"world\"")),
                 vector3(node.require_member("point", "the point of application [x, y, z] in m")), point_frame(node),
                 load_window(node)};
}

Load impulse(const JsonNode& node) {
    return Impulse{vector3(node.require_member("vector", "[x, y, z] in N s")),
                   parse_frame(node.require_member("frame", "\"body\" or \"world\"")),
                   vector3(node.require_member("point", "the point of application [x, y, z] in m")), point_frame(node),
                   node.require_member("at", "the time in s").number()};
}

Load drag(const JsonNode& node) {
    const JsonNode* rotational = node.find("rotational");
    const JsonNode* translational = node.find("translational");
    if (!rotational && !translational)
        node.fail("has neither \"rotational\" nor \"translational\"", "give at least one of them");
    Drag load;
    if (rotational) load.rotational = vector3(*rotational);
    if (translational) load.translational = translational->number();
    load.window = load_window(node);
    return load;
}

Load spring(const JsonNode& node) {
    Spring load;
    load.stiffness = node.require_member("stiffness", "the stiffness in N m").number();
    if (const JsonNode* rest = node.find("rest_orientation")) load.rest_orientation = quaternion(*rest);
    load.window = load_window(node);
    return load;
}

Load motor(const JsonNode& node, const std::vector<Joint>& joints) {
    if (node.find("formula")) {
        FormulaLoad load = formula_load(node, FormulaKind::motor, {"torque", "force"});
        load.joint = node.require_member("joint", "the name of a revolute or prismatic joint").string();
        return load;
    }
    refuse_hold(node);
    Motor load;
    load.joint = node.require_member("joint", "the name of a revolute or prismatic joint").string();
    const JsonNode *torque = node.find("torque"), *along = node.find("force");
    if (torque && along)
        along->fail("is given together with \"torque\"",
                    "give \"torque\" for a revolute joint or \"force\" for a prismatic joint");
    if (!torque && !along)
        node.require_member("torque", "the torque in N m on a revolute joint, or \"force\" in N on a prismatic one");
    const JointType* type = type_of(joints, load.joint);
    if (type && torque && *type == JointType::prismatic)
        torque->fail("is given for a prismatic joint", "give \"force\" in N");
    if (type && along && *type == JointType::revolute)
        along->fail("is given for a revolute joint", "give \"torque\" in N m");
    load.force = (torque ? torque : along)->number();
    load.window = load_window(node);
    return load;
}

Load point_spring(const JsonNode& node) {
    PointSpring load;
    load.first = node.require_member("first", "a body's name or \"world\"").string();
    load.second = node.require_member("second", "a body's name or \"world\"").string();
    if (const JsonNode* point = node.find("first_point")) load.first_point = vector3(*point);
    if (const JsonNode* point = node.find("second_point")) load.second_point = vector3(*point);
    load.stiffness = node.require_member("stiffness", "the stiffness in N/m").number();
    if (const JsonNode* length = node.find("rest_length")) load.rest_length = length->number();
    load.window = load_window(node);
    return load;
}

struct LoadKind {
    const char* name;
    Load (*read)(const JsonNode&);
};
constexpr LoadKind load_kinds[] = {
    {"gravity", gravity},     {"torque", constant_torque}, {"force", force},   {"impulse", impulse},
    {"drag", drag},           {"spring", spring},          {"motor", nullptr}, {"point_spring", point_spring},
    {"potential", potential},
};

std::string write_window(const Window& window) {
    std::string text;
    if (std::isfinite(window.from)) text += ", \"from\": " + shortest_decimal(window.from);
    if (std::isfinite(window.until)) text += ", \"until\": " + shortest_decimal(window.until);
    return text;
}

struct LoadWriter {
    const std::vector<Joint>& joints;

    std::string operator()(const Gravity& load) const {
        return fmt::format(R"({{"type": "gravity", "acceleration": {}{}}})", write_json(load.acceleration_W),
                           write_window(load.window));
    }
    std::string operator()(const Torque& load) const {
        return fmt::format(R"({{"type": "torque"{}, "vector": {}, "frame": {}{}}})", on_body(load.body),
                           write_json(load.vector), write_frame(load.frame), write_window(load.window));
    }
    std::string operator()(const Force& load) const {
        return fmt::format(R"({{"type": "force"{}, "vector": {}, "frame": {}, "point": {}, "point_frame": {}{}}})",
                           on_body(load.body), write_json(load.vector), write_frame(load.frame), write_json(load.point),
                           write_frame(load.point_frame), write_window(load.window));
    }
    std::string operator()(const Impulse& load) const {
        return fmt::format(
            R"({{"type": "impulse"{}, "vector": {}, "frame": {}, "point": {}, "point_frame": {}, "at": {}}})",
            on_body(load.body), write_json(load.vector), write_frame(load.frame), write_json(load.point),
            write_frame(load.point_frame), shortest_decimal(load.at));
    }
    std::string operator()(const Drag& load) const {
        return fmt::format(R"({{"type": "drag"{}, "rotational": {}, "translational": {}{}}})", on_body(load.body),
                           write_json(load.rotational), shortest_decimal(load.translational),
                           write_window(load.window));
    }
    std::string operator()(const Spring& load) const {
        return fmt::format(R"({{"type": "spring"{}, "stiffness": {}, "rest_orientation": {}{}}})", on_body(load.body),
                           shortest_decimal(load.stiffness), write_json(load.rest_orientation),
                           write_window(load.window));
    }
    std::string operator()(const UserTorque& load) const {
        throw std::invalid_argument(
            fmt::format("the user-defined torque \"{}\" cannot be written to a file", load.name));
    }
    std::string operator()(const Motor& load) const {
        const JointType* type = type_of(joints, load.joint);
        return fmt::format(R"({{"type": "motor", "joint": {}, "{}": {}{}}})", json_string(load.joint),
                           type && *type == JointType::prismatic ? "force" : "torque", shortest_decimal(load.force),
                           write_window(load.window));
    }
    std::string operator()(const FormulaLoad& load) const {
        const char* kind = load.kind == FormulaKind::torque      ? "torque"
                           : load.kind == FormulaKind::force     ? "force"
                           : load.kind == FormulaKind::potential ? "potential"
                                                                 : "motor";
        std::string text = fmt::format(R"({{"type": "{}"{})", kind, on_body(load.body));
        if (load.kind == FormulaKind::motor) text += fmt::format(R"(, "joint": {})", json_string(load.joint));
        if (load.kind == FormulaKind::torque || load.kind == FormulaKind::force)
            text += fmt::format(R"(, "frame": {})", write_frame(load.frame));
        text += fmt::format(R"(, "formula": {})", json_string(load.formula));
        if (load.has_point)
            text += fmt::format(R"(, "point": {}, "point_frame": {})", write_json(load.point),
                                write_frame(load.point_frame));
        return text + write_window(load.window) + "}";
    }
    std::string operator()(const PointSpring& load) const {
        return fmt::format(
            R"({{"type": "point_spring", "first": {}, "first_point": {}, "second": {}, "second_point": {}, "stiffness": {}, "rest_length": {}{}}})",
            json_string(load.first), write_json(load.first_point), json_string(load.second),
            write_json(load.second_point), shortest_decimal(load.stiffness), shortest_decimal(load.rest_length),
            write_window(load.window));
    }

  private:
    static std::string on_body(const std::string& name) {
        return name.empty() ? "" : ", \"body\": " + json_string(name);
    }
};

}  // namespace

Load parse_load(const JsonNode& node, const std::vector<Joint>& joints) {
    std::vector<std::string> names;
    for (const LoadKind& kind : load_kinds) names.emplace_back(kind.name);
    const JsonNode& type = node.require_member("type", "one of " + join_with_commas(names));
    for (const LoadKind& kind : load_kinds) {
        if (type.string() != kind.name) continue;
        node.require_known_keys(keys_of(scene_keys(), fmt::format("load {}", kind.name)));
        Load load = kind.read ? kind.read(node) : motor(node, joints);
        if (const JsonNode* body = node.find("body")) {
            if (body->string().empty()) body->fail("is empty", "give a body's name");
            std::visit(
                [&](auto& one) {
                    if constexpr (requires { one.body; }) one.body = body->string();
                },
                load);
        }
        return load;
    }
    const std::string meant = did_you_mean(type.string(), names);
    type.fail(type.describe(),
              fmt::format("{}{}give one of {}", meant, meant.empty() ? "" : " ", join_with_commas(names)));
}

std::string write_load(const Load& load, const std::vector<Joint>& joints) {
    return std::visit(LoadWriter{joints}, load);
}

}  // namespace polhode
