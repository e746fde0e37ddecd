#include "scene/robot_import.h"

#include <fmt/format.h>

#include "scene/initial_file.h"
#include "scene/joint_file.h"
#include "scene/robot_files.h"
#include "scene/robot_tree.h"
#include "scene/scene_keys.h"
#include "text/message.h"

namespace polhode {
namespace {

RobotBase robot_base(const JsonNode& node) {
    if (node.string() == "fixed") return RobotBase::fixed;
    if (node.string() == "free") return RobotBase::free;
    node.fail(node.describe(), "give \"fixed\" or \"free\"");
}

NamedBody* free_body(Scene& scene, const std::string& name) {
    for (NamedBody& body : scene.bodies) {
        if (body.name != name) continue;
        for (const Joint& joint : scene.joints)
            if (joint.child == name) return nullptr;
        return &body;
    }
    return nullptr;
}

// Applies an initial state, addressed by the name of a joint or of a free body.
void parse_start(const JsonNode& node, Scene& scene) {
    NamedBody* body = free_body(scene, node.key());
    for (Joint& joint : scene.joints) {
        if (joint.name != node.key()) continue;
        if (body) node.fail("is both a joint and a free body", "rename one of them in the robot's file");
        return parse_joint_start(node, joint);
    }
    if (body) {
        body->initial = parse_initial(node, false, body->initial);
        return;
    }
    std::vector<std::string> names;
    for (const Joint& joint : scene.joints) names.push_back(joint.name);
    for (const NamedBody& one : scene.bodies)
        if (free_body(scene, one.name)) names.push_back(one.name);
    const std::string meant = did_you_mean(node.key(), names);
    node.fail("is neither a joint nor a free body of the robot",
              meant.empty() ? "give one of " + join_with_commas(names) : meant);
}

}  // namespace

void parse_robot_import(const JsonNode& node, bool scene_has_gravity, Scene& scene) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"file\": ..}");
    node.require_known_keys(keys_of(scene_keys(), "import of a robot"));
    const std::string& file = node.require_member("file", "the path of a URDF, MJCF or SDFormat file").string();
    RobotOptions options;
    options.scene_has_gravity = scene_has_gravity;
    if (const JsonNode* base = node.find("base")) options.base = robot_base(*base);
    if (const JsonNode* model = node.find("model")) options.model = model->string();
    if (const JsonNode* balance = node.find("balance_inertia")) options.balance_inertia = balance->boolean();
    if (const JsonNode* laws = node.find("limits_and_friction")) options.limits_and_friction = laws->boolean();
    if (const JsonNode* controls = node.find("controls")) {
        if (!controls->is_object()) controls->fail(controls->describe(), "give an object {\"name\": number}");
        for (const JsonNode* one : controls->members()) options.controls[one->key()] = one->number();
    }
    try {
        const std::string text = robot_text(scene.directory, file);
        add_robot(parse_robot(text, file, options, {scene.directory, file}), options, file, scene);
    } catch (const InputError& error) {
        node.fail(error);
    }
    if (const JsonNode* starts = node.find("initial"))
        for (const JsonNode* one : starts->members()) parse_start(*one, scene);
}

}  // namespace polhode
