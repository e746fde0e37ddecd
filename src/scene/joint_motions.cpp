#include "scene/joint_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "formula/evaluate.h"
#include "formula/parser.h"
#include "scene/coupled_joints.h"
#include "scene/scene_check.h"
#include "scene/scene_formulas.h"

namespace polhode {
namespace {

std::string motion_place(std::size_t joint) { return fmt::format("/joints/{}/motion", joint); }

formula::Scope make_scope(const Scene& scene, formula::Expression& expression) {
    const auto scalar = [](int node) {
        return formula::Value{formula::Type::scalar, {node, formula::no_node, formula::no_node, formula::no_node}};
    };
    formula::Scope scope;
    for (std::size_t i = 0; i < scene.parameters.size(); ++i)
        scope.names[scene.parameters[i].name] = scalar(expression.constant(static_cast<int>(i)));
    scope.names["t"] = scalar(expression.input(0));
    return scope;
}

// The second derivative must be continuous, which is not known where a formula switches.
void require_smooth(const formula::Expression& expression, const JointMotions::Motion& motion, const std::string& file,
                    const std::string& place) {
    const std::vector<char> needed =
        formula::find_needed(expression, {motion.coordinate, motion.rate, motion.acceleration});
    for (std::size_t i = 0; i < needed.size(); ++i) {
        if (!needed[i] || expression.is_uniform(static_cast<int>(i))) continue;
        const formula::Operation operation = expression.nodes()[i].operation;
        if (operation == formula::Operation::choose)
            throw InputError(file, place, "switches between branches", "give a smooth function of t");
    }
}

struct Start {
    double coordinate, rate;
};

void require_finite(const Start& start, const std::string& place, const std::string& file) {
    if (!std::isfinite(start.coordinate) || !std::isfinite(start.rate))
        throw InputError(file, place, "is not finite at t = 0", "give a function that is finite from t = 0 on");
}

// Coordinates and rates at t = 0, computed in 113 bits.
std::vector<Start> compute_starts(const JointMotions& motions, const Scene& scene) {
    std::vector<Wide> constants;
    for (const FormulaParameter& parameter : scene.parameters) constants.emplace_back(parameter.value);
    const std::vector<Wide> uniform = formula::compute_uniform_values<Wide>(motions.expression, constants);
    std::vector<int> outputs;
    for (const JointMotions::Motion& one : motions.motions)
        outputs.insert(outputs.end(), {one.coordinate, one.rate, one.acceleration});
    const std::vector<char> needed = formula::find_needed(motions.expression, outputs);
    formula::Evaluation<Wide, Wide> values(motions.expression, uniform, needed, nullptr);
    const Wide start(0);
    values.compute(&start);
    std::vector<Start> all;
    for (const JointMotions::Motion& one : motions.motions)
        all.push_back({static_cast<double>(values.value(one.coordinate)), static_cast<double>(values.value(one.rate))});
    return all;
}

}  // namespace

bool has_joint_motions(const Scene& scene) {
    return std::ranges::any_of(scene.joints, [](const Joint& joint) { return !joint.motion.empty(); });
}

JointMotions compile_joint_motions(const Scene& scene, const std::string& file) {
    JointMotions result;
    const formula::Scope scope = make_scope(scene, result.expression);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        if (scene.joints[j].motion.empty()) continue;
        const std::string place = motion_place(j);
        try {
            const formula::Value value = formula::parse_formula(scene.joints[j].motion, scope, result.expression);
            if (value.type != formula::Type::scalar)
                throw InputError(file, place, fmt::format("the formula is {}", formula::name_of(value.type)),
                                 "give a scalar");
            JointMotions::Motion motion{j, value.component[0], formula::no_node, formula::no_node};
            motion.rate = result.expression.differentiate(motion.coordinate, {0}).front();
            motion.acceleration = result.expression.differentiate(motion.rate, {0}).front();
            require_smooth(result.expression, motion, file, place);
            result.motions.push_back(motion);
        } catch (const formula::FormulaError& error) {
            throw InputError(file, place, fmt::format("column {}: {}", error.column(), error.what()), error.remedy());
        } catch (const formula::LimitError& error) {
            throw InputError(file, place, error.what(), "simplify the formula");
        }
    }
    return result;
}

void start_joint_motions(Scene& scene, const std::string& file) {
    if (!has_joint_motions(scene)) return;
    const JointMotions motions = compile_joint_motions(scene, file);
    const std::vector<Start> starts = compute_starts(motions, scene);
    for (std::size_t k = 0; k < starts.size(); ++k) {
        const std::size_t j = motions.motions[k].joint;
        require_finite(starts[k], motion_place(j), file);
        Joint& joint = scene.joints[j];
        joint.coordinate[0] = starts[k].coordinate, joint.rate[0] = starts[k].rate;
    }
}

void check_joint_motions(const Scene& scene, const std::string& file) {
    if (!has_joint_motions(scene)) return;
    const SceneCheck check(file);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const Joint& joint = scene.joints[j];
        if (joint.motion.empty()) continue;
        const std::string place = motion_place(j);
        if (joint.type != JointType::revolute && joint.type != JointType::prismatic)
            check.fail(place, "is given for a joint that is neither revolute nor prismatic",
                       "only revolute and prismatic joints can have a prescribed motion");
        if (joint.friction != 0 || joint.limits.any())
            check.fail(place, "is given together with friction or limits", "remove them, or the motion");
        if (joint.dependent) check.fail(place, "is given for a dependent joint", "remove \"dependent\", or the motion");
    }
    const JointMotions motions = compile_joint_motions(scene, file);
    const std::string first = motion_place(motions.motions.front().joint);
    if ((!scene.loops.empty() || !scene.couplings.empty()) &&
        std::ranges::none_of(scene.joints, [](const Joint& joint) { return joint.dependent; }))
        check.fail(first, "is given in a scene with loops or couplings and without dependent joints",
                   "mark the joints that follow the others as \"dependent\": true in \"initial\"");
    for (const JointMotions::Motion& one : motions.motions)
        for (const CoupledJoint<double>& other : coupled_joints<double>(scene, one.joint)) {
            const Joint& joint = scene.joints[other.joint];
            if (other.joint == one.joint || (joint.motion.empty() && joint.friction == 0 && !joint.limits.any()))
                continue;
            check.fail(motion_place(one.joint),
                       fmt::format("also moves the coupled joint \"{}\", which has a motion, friction or limits",
                                   one_line(joint.name, 60)),
                       "remove these, or the motion");
        }
    const std::vector<Start> starts = compute_starts(motions, scene);
    for (std::size_t k = 0; k < starts.size(); ++k) {
        const std::size_t j = motions.motions[k].joint;
        const Joint& joint = scene.joints[j];
        require_finite(starts[k], motion_place(j), file);
        if (joint.coordinate[0] != starts[k].coordinate || joint.rate[0] != starts[k].rate)
            check.fail(motion_place(j),
                       fmt::format("has the coordinate {} and the rate {} at t = 0, but the joint starts at {} and {}",
                                   shortest_decimal(starts[k].coordinate), shortest_decimal(starts[k].rate),
                                   shortest_decimal(joint.coordinate[0]), shortest_decimal(joint.rate[0])),
                       "start where the motion starts");
    }
}

}  // namespace polhode
