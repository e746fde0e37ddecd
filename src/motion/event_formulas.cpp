#include "motion/event_formulas.h"

#include <utility>

#include "body/wide.h"
#include "motion/formula_tree.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

// The constants of a scene's expression, exact to Wide.
std::vector<Wide> event_constants(const Scene& scene) {
    if (!is_mechanism(scene))
        return formula_constants<Wide>(scene, exact_body<Wide>(scene), mass_properties<Wide>(scene.body).inertia);
    std::vector<MassProperties<Wide>> properties;
    for (const NamedBody& body : scene.bodies) properties.push_back(mass_properties<Wide>(body.body));
    return mechanism_formula_constants<Wide>(scene, properties);
}

}  // namespace

EventFormulas::EventFormulas(const Scene& scene, const std::vector<std::string>& formulas)
    : compiled_(compile_event_formulas(scene, formulas)), joint_count_(scene.joints.size()) {
    const formula::Expression& expression = compiled_.expression;
    for (const Wide& value : formula::compute_uniform_values<Wide>(expression, event_constants(scene)))
        uniform_.push_back(static_cast<double>(value));
    needed_ = formula::find_needed(expression, compiled_.outputs);
    const int first_joint = MechanismInputs::of_joint(static_cast<int>(body_count(scene)), 0);
    for (std::size_t i = 0; i < needed_.size(); ++i) {
        const formula::Node& node = expression.nodes()[i];
        if (needed_[i] && node.operation == formula::Operation::input && node.a >= first_joint) reads_joints_ = true;
    }
}

std::vector<double> EventFormulas::inputs(const Bodies& bodies, std::span<const JointMotion<double>> joints) const {
    const std::size_t count = bodies.size();
    MechanismState<double> state(count, joint_count_);
    state.input[FormulaInputs::time] = bodies[0].t;
    for (std::size_t b = 0; b < count; ++b) {
        const Sample& sample = bodies[b];
        state.set_body(static_cast<int>(b), sample.angular_velocity_B, sample.q, sample.position_W, sample.velocity_W);
    }
    for (std::size_t j = 0; j < joints.size(); ++j)
        state.set_joint(count, j, joints[j].coordinate[0], joints[j].rate[0]);
    return std::move(state.input);
}

std::vector<double> EventFormulas::values(const Bodies& bodies, std::span<const JointMotion<double>> joints) const {
    const std::vector<double> input = inputs(bodies, joints);
    formula::Evaluation<double, double> evaluation(compiled_.expression, uniform_, needed_, nullptr);
    evaluation.compute(input.data());
    std::vector<double> values;
    for (const int node : compiled_.outputs) values.push_back(evaluation.value(node));
    return values;
}

}  // namespace polhode
