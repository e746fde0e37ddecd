// Reader and writer of the members "bodies", "joints" and "loops" of scene files. The type of a joint or loop
// determines its permitted keys (scene_keys.h). A body that is the child of a joint must not have an initial state.

#include "scene/joint_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "scene/body_file.h"
#include "scene/initial_file.h"
#include "scene/joint_chains.h"
#include "scene/json_values.h"
#include "scene/locked_body.h"
#include "scene/robot_import.h"
#include "scene/scene_keys.h"
#include "scene/scene_limits.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::pair<const char*, JointType> joint_types[] = {{"revolute", JointType::revolute},
                                                             {"prismatic", JointType::prismatic},
                                                             {"spherical", JointType::spherical},
                                                             {"universal", JointType::universal},
                                                             {"fixed", JointType::fixed}};
constexpr std::pair<const char*, LoopType> loop_types[] = {
    {"spherical", LoopType::spherical}, {"revolute", LoopType::revolute}, {"distance", LoopType::distance}};

// Parses the type of the object, which determines its permitted keys.
template <class Type, std::size_t n>
Type parse_type(const JsonNode& node, const std::pair<const char*, Type> (&types)[n], const char* object) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"name\": .., \"type\": .., ..}");
    std::vector<std::string> names;
    for (const auto& [name, type] : types) names.emplace_back(name);
    const JsonNode& given = node.require_member("type", "one of " + join_with_commas(names));
    for (const auto& [name, type] : types)
        if (given.string() == name) {
            node.require_known_keys(keys_of(scene_keys(), fmt::format("{} {}", object, name)));
            return type;
        }
    if (std::string_view(object) == "joint")
        for (const char* chain : {"compound", "cylindrical", "screw", "planar", "free"}) names.emplace_back(chain);
    const std::string meant = did_you_mean(given.string(), names);
    given.fail(given.describe(),
               fmt::format("{}{}give one of {}", meant, meant.empty() ? "" : " ", join_with_commas(names)));
}

Vector3<double> point_at(const JsonNode& node, const char* key) {
    const JsonNode* point = node.find(key);
    return point ? vector3(*point) : Vector3<double>();
}

std::array<double, 2> numbers_at(const JsonNode& node, const char* key, bool two) {
    const JsonNode* value = node.find(key);
    if (!value) return {};
    return two ? two_numbers(*value) : std::array<double, 2>{value->number(), 0};
}

JointLimits parse_limits(const JsonNode& node) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"lower\": .., \"upper\": ..}");
    node.require_known_keys(keys_of(scene_keys(), "limits"));
    JointLimits limits;
    const JsonNode *lower = node.find("lower"), *upper = node.find("upper"), *restitution = node.find("restitution");
    if (!lower && !upper) node.fail("has neither \"lower\" nor \"upper\"", "give one of them, or both");
    if (lower) limits.lower = lower->number();
    if (upper) limits.upper = upper->number();
    if (restitution) limits.restitution = restitution->number();
    return limits;
}

Coupling parse_coupling(const JsonNode& node) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"first\": .., \"second\": .., \"ratio\": ..}");
    node.require_known_keys(keys_of(scene_keys(), "coupling"));
    Coupling coupling;
    coupling.first = node.require_member("first", "a joint's name").string();
    coupling.second = node.require_member("second", "a joint's name").string();
    if (const JsonNode* ratio = node.find("ratio")) coupling.ratio = ratio->number();
    if (const JsonNode* offset = node.find("offset")) coupling.offset = offset->number();
    return coupling;
}

std::string write_limits(const JointLimits& limits) {
    const JointLimits none;
    std::string text;
    if (limits.lower > none.lower) text += "\"lower\": " + shortest_decimal(limits.lower) + ", ";
    if (limits.upper < none.upper) text += "\"upper\": " + shortest_decimal(limits.upper) + ", ";
    return "{" + text + "\"restitution\": " + shortest_decimal(limits.restitution) + "}";
}

}  // namespace

void parse_coordinate(const JsonNode& node, Joint& j) {
    const bool universal = j.type == JointType::universal;
    if (const JsonNode* motion = node.find("motion")) j.motion = motion->string();
    if (const JsonNode* start = node.find("initial")) {
        if (!j.motion.empty())
            start->fail("is given for a joint with a prescribed motion", "remove it: the motion defines the start");
        parse_joint_start(*start, j);
    }
    j.stiffness = numbers_at(node, "stiffness", universal), j.damping = numbers_at(node, "damping", universal);
    j.armature = numbers_at(node, "armature", universal);
    if (const JsonNode* friction = node.find("friction")) j.friction = friction->number();
    if (const JsonNode* limits = node.find("limits")) j.limits = parse_limits(*limits);
    if (j.type != JointType::spherical)
        j.rest = numbers_at(node, "rest", universal);
    else if (const JsonNode* rest = node.find("rest"))
        j.rest_orientation = quaternion(*rest);
}

namespace {

Joint joint(const JsonNode& node) {
    Joint j;
    j.type = parse_type(node, joint_types, "joint");
    j.name = node.require_member("name", "the joint's name").string();
    j.parent = node.require_member("parent", "a body's name or \"world\"").string();
    j.child = node.require_member("child", "a body's name").string();
    j.parent_point = point_at(node, "parent_point"), j.child_point = point_at(node, "child_point");
    if (const JsonNode* q = node.find("parent_orientation")) j.parent_orientation = quaternion(*q);
    parse_coordinate(node, j);
    if (j.type == JointType::revolute || j.type == JointType::prismatic)
        j.axes[0] = vector3(node.require_member("axis", "[x, y, z], in the child's axes"));
    if (j.type == JointType::universal) {
        const JsonNode& axes = node.require_member("axes", "two vectors [x, y, z]");
        if (axes.elements().size() != 2) axes.fail(axes.describe(), "give two axes [[x, y, z], [x, y, z]]");
        for (std::size_t i = 0; i < 2; ++i) j.axes[i] = vector3(*axes.elements()[i]);
    }
    return j;
}

Loop loop(const JsonNode& node) {
    Loop l;
    l.type = parse_type(node, loop_types, "loop");
    l.name = node.require_member("name", "the loop's name").string();
    l.first = node.require_member("first", "a body's name or \"world\"").string();
    l.second = node.require_member("second", "a body's name or \"world\"").string();
    l.first_point = point_at(node, "first_point"), l.second_point = point_at(node, "second_point");
    if (l.type == LoopType::revolute) {
        l.first_axis = vector3(node.require_member("first_axis", "[x, y, z], in the first body's axes"));
        l.second_axis = vector3(node.require_member("second_axis", "[x, y, z], in the second body's axes"));
    }
    if (l.type == LoopType::distance) l.length = node.require_member("length", "the distance in m, > 0").number();
    return l;
}

NamedBody parse_named_body(const JsonNode& node, const std::string& directory,
                           const std::set<std::string, std::less<>>& carried) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"name\": .., \"body\": ..}");
    node.require_known_keys(keys_of(scene_keys(), "one of bodies"));
    NamedBody one;
    one.name = node.require_member("name", "the body's name").string();
    one.body =
        parse_body(node.require_member("body", "the mass properties {\"mass\": .., \"inertia\": ..}"), directory);
    const JsonNode* start = node.find("initial");
    if (start && carried.contains(one.name))
        start->fail("is given for a body that is the child of a joint",
                    "remove it: the \"initial\" of the joint defines the start");
    if (start) one.initial = parse_initial(*start, false);
    return one;
}

template <class Members>
std::string write_list(const Members& members, auto&& write) {
    std::string text;
    for (const auto& one : members) text += (text.empty() ? "[\n    {" : ",\n    {") + write(one) + "}";
    return text.empty() ? text : text + "\n  ]";
}

std::string vectors(const std::array<Vector3<double>, 2>& v) {
    return fmt::format("[{}, {}]", write_json(v[0]), write_json(v[1]));
}

std::string write_joint_start(const Joint& j) {
    const std::string x = shortest_decimal(j.coordinate[0]), rate = shortest_decimal(j.rate[0]);
    const char* dependent = j.dependent ? ", \"dependent\": true" : "";
    switch (j.type) {
        case JointType::revolute:
            return fmt::format(R"("angle": {}, "rate": {}{})", x, rate, dependent);
        case JointType::prismatic:
            return fmt::format(R"("displacement": {}, "speed": {}{})", x, rate, dependent);
        case JointType::spherical:
            return fmt::format(R"("orientation": {}, "angular_velocity": {})", write_json(j.orientation),
                               write_json(j.angular_velocity));
        case JointType::universal:
            return fmt::format(R"("angles": {}, "rates": {})", write_json(j.coordinate), write_json(j.rate));
        case JointType::fixed:
            break;
    }
    return "";
}

std::string write_joint(const Joint& j) {
    std::string text =
        fmt::format(R"("name": {}, "type": "{}", "parent": {}, "child": {}, "parent_point": {}, "child_point": {}, )",
                    json_string(j.name), name_of(j.type), json_string(j.parent), json_string(j.child),
                    write_json(j.parent_point), write_json(j.child_point)) +
        "\"parent_orientation\": " + write_json(j.parent_orientation);
    if (j.type == JointType::fixed) return text;
    if (j.type == JointType::universal)
        text += ", \"axes\": " + vectors(j.axes);
    else if (j.type != JointType::spherical)
        text += ", \"axis\": " + write_json(j.axes[0]);
    text +=
        j.motion.empty() ? ", \"initial\": {" + write_joint_start(j) + "}" : ", \"motion\": " + json_string(j.motion);
    const bool two = j.type == JointType::universal;
    const auto numbers = [two](const std::array<double, 2>& x) { return two ? write_json(x) : shortest_decimal(x[0]); };
    const std::string rest = j.type == JointType::spherical ? write_json(j.rest_orientation) : numbers(j.rest);
    text +=
        fmt::format(R"(, "stiffness": {}, "rest": {}, "damping": {})", numbers(j.stiffness), rest, numbers(j.damping));
    if (j.friction != 0) text += ", \"friction\": " + shortest_decimal(j.friction);
    if (j.limits.any()) text += ", \"limits\": " + write_limits(j.limits);
    if (j.armature != std::array<double, 2>{}) text += ", \"armature\": " + numbers(j.armature);
    return text;
}

std::string write_loop(const Loop& l) {
    std::string text =
        fmt::format(R"("name": {}, "type": "{}", "first": {}, "first_point": {}, "second": {}, "second_point": {})",
                    json_string(l.name), name_of(l.type), json_string(l.first), write_json(l.first_point),
                    json_string(l.second), write_json(l.second_point));
    if (l.type == LoopType::revolute)
        text += fmt::format(R"(, "first_axis": {}, "second_axis": {})", write_json(l.first_axis),
                            write_json(l.second_axis));
    if (l.type == LoopType::distance) text += ", \"length\": " + shortest_decimal(l.length);
    return text;
}

std::set<std::string_view> children_of(const Scene& scene) {
    std::set<std::string_view> names;
    for (const Joint& j : scene.joints) names.insert(j.child);
    return names;
}

}  // namespace

const char* name_of(JointType type) {
    for (const auto& [name, one] : joint_types)
        if (one == type) return name;
    return "";
}

const char* name_of(LoopType type) {
    for (const auto& [name, one] : loop_types)
        if (one == type) return name;
    return "";
}

void parse_joint_start(const JsonNode& node, Joint& j) {
    if (j.type == JointType::fixed) node.fail("is given for a fixed joint", "remove it: a fixed joint does not move");
    node.require_known_keys(keys_of(scene_keys(), fmt::format("start {}", name_of(j.type))));
    const auto one = [&](const char* key, double& value) {
        if (const JsonNode* given = node.find(key)) value = given->number();
    };
    const auto two = [&](const char* key, std::array<double, 2>& values) {
        if (const JsonNode* given = node.find(key)) values = two_numbers(*given);
    };
    // each key is permitted for one joint type only
    one("angle", j.coordinate[0]), one("displacement", j.coordinate[0]);
    one("rate", j.rate[0]), one("speed", j.rate[0]);
    two("angles", j.coordinate), two("rates", j.rate);
    if (const JsonNode* q = node.find("orientation")) j.orientation = quaternion(*q);
    if (const JsonNode* w = node.find("angular_velocity")) j.angular_velocity = vector3(*w);
    if (const JsonNode* dependent = node.find("dependent")) j.dependent = dependent->boolean();
}

namespace {

bool has_gravity(const JsonNode& root) {
    const JsonNode* loads = root.find("loads");
    if (!loads || !loads->is_array()) return false;
    return std::ranges::any_of(loads->elements(), [](const JsonNode* load) {
        const JsonNode* type = load->is_object() ? load->find("type") : nullptr;
        return type && type->is_string() && type->string() == "gravity";
    });
}

}  // namespace

namespace {

JointChain lock_body(const JsonNode& locked, std::size_t index, const std::set<std::string, std::less<>>& carried,
                     NamedBody& body) {
    if (carried.contains(body.name))
        locked.fail("is given for a body that is the child of a joint", "remove it, or the joint");
    return lock_free_body(locked, fmt::format("/bodies/{}/locked", index), body);
}

// Gives the child of a free joint its initial state.
void start_free_body(const JsonNode& root, const JointChain& chain, Scene& scene) {
    const JsonNode& joints = *root.find("joints");
    for (const Joint& joint : scene.joints)
        if (joint.child == chain.free_child)
            joints.fail(fmt::format("make \"{}\" the child of two joints", one_line(chain.free_child, 60)),
                        "remove the free joint or the other one");
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        if (scene.bodies[b].name != chain.free_child) continue;
        if (!chain.free_initial) return;
        if (const JsonNode* start = root.find("bodies")->elements()[b]->find("initial"))
            start->fail("is given for a body whose free joint has an initial state", "remove one of them");
        scene.bodies[b].initial = *chain.free_initial;
        return;
    }
    joints.fail(
        fmt::format("have a free joint of \"{}\", which is not the name of a body", one_line(chain.free_child, 60)),
        "give the name of a body as \"child\"");
}

}  // namespace

void parse_mechanism(const JsonNode& root, Scene& scene) {
    const JsonNode* import = root.find("import");
    if (import) parse_robot_import(*import, has_gravity(root), scene);
    std::vector<JointChain> chains;
    if (const JsonNode* joints = root.find("joints")) {
        std::vector<std::size_t> elements;  // by joint: index in the file
        for (std::size_t i = 0; i < joints->elements().size(); ++i) {
            const JsonNode& one = *joints->elements()[i];
            if (std::optional<JointChain> chain = parse_joint_chain(one, i)) {
                scene.joints.insert(scene.joints.end(), chain->joints.begin(), chain->joints.end());
                scene.couplings.insert(scene.couplings.end(), chain->couplings.begin(), chain->couplings.end());
                chains.push_back(*std::move(chain));
            } else {
                scene.joints.push_back(joint(one));
            }
            elements.resize(scene.joints.size(), i);
        }
        for (std::size_t k = 0; !chains.empty() && k < elements.size(); ++k)
            if (scene.joints[k].place.empty()) scene.joints[k].place = fmt::format("/joints/{}", elements[k]);
    }
    if (const JsonNode* loops = root.find("loops"))
        for (const JsonNode* one : loops->elements()) scene.loops.push_back(loop(*one));
    if (const JsonNode* couplings = root.find("couplings"))
        for (const JsonNode* one : couplings->elements()) scene.couplings.push_back(parse_coupling(*one));
    if (import) return;
    const JsonNode& bodies = root.require_member("bodies", "a list of {\"name\": .., \"body\": ..}");
    if (bodies.elements().empty()) bodies.fail("is empty", "give at least one {\"name\": .., \"body\": ..}");
    if (bodies.elements().size() > most_bodies)
        bodies.fail(bodies.describe(), fmt::format("give at most {} bodies", most_bodies));
    std::set<std::string, std::less<>> carried;
    for (const Joint& j : scene.joints) carried.insert(j.child);
    for (std::size_t i = 0; i < bodies.elements().size(); ++i) {
        const JsonNode& one = *bodies.elements()[i];
        scene.bodies.push_back(parse_named_body(one, scene.directory, carried));
        if (const JsonNode* locked = one.find("locked")) {
            chains.push_back(lock_body(*locked, i, carried, scene.bodies.back()));
            const JointChain& chain = chains.back();
            scene.joints.insert(scene.joints.end(), chain.joints.begin(), chain.joints.end());
        }
    }
    for (const JointChain& chain : chains) {
        scene.bodies.insert(scene.bodies.end(), chain.bodies.begin(), chain.bodies.end());
        if (!chain.free_child.empty()) start_free_body(root, chain, scene);
    }
}

std::string write_bodies(const Scene& scene) {
    const std::set<std::string_view> carried = children_of(scene);
    return write_list(scene.bodies, [&](const NamedBody& one) {
        std::string text = fmt::format("\"name\": {}, \"body\": {{{}}}", json_string(one.name), write_body(one.body));
        if (!carried.contains(one.name)) text += ",\n    \"initial\": {" + write_initial(one.initial, false, " ") + "}";
        return text;
    });
}

std::string write_joints(const Scene& scene) { return write_list(scene.joints, write_joint); }

std::string write_couplings(const Scene& scene) {
    return write_list(scene.couplings, [](const Coupling& one) {
        return fmt::format(R"("first": {}, "second": {}, "ratio": {}, "offset": {})", json_string(one.first),
                           json_string(one.second), shortest_decimal(one.ratio), shortest_decimal(one.offset));
    });
}

std::string write_loops(const Scene& scene) { return write_list(scene.loops, write_loop); }

}  // namespace polhode
