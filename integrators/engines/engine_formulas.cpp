// Formulas of a scene in the form that is sent to engines.
//
// convert_expression() keeps the operations on which a load or a held value depends, replaces those that depend on
// neither time nor state by their values in binary64, and renumbers the rest. read_formulas() and write_formulas()
// are the JSON form of README.md.
#include "integrators/engines/engine_formulas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formula/evaluate.h"
#include "integrators/engines/engine_json.h"
#include "integrators/engines/engine_mechanism.h"
#include "motion/formula_terms.h"
#include "motion/formula_tree.h"
#include "motion/itinerary.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

using engine_json::array, engine_json::json, engine_json::quaternion_at, engine_json::vector_at;
using formula::Expression, formula::Node, formula::no_node, formula::Operation, formula::Test;

struct OperationName {
    Operation operation;
    std::string_view name;
    int operands;
};
constexpr OperationName operation_names[] = {{Operation::add, "add", 2},
                                             {Operation::subtract, "subtract", 2},
                                             {Operation::multiply, "multiply", 2},
                                             {Operation::divide, "divide", 2},
                                             {Operation::negate, "negate", 1},
                                             {Operation::square_root, "sqrt", 1},
                                             {Operation::sine, "sin", 1},
                                             {Operation::cosine, "cos", 1},
                                             {Operation::exponential, "exp", 1},
                                             {Operation::logarithm, "log", 1},
                                             {Operation::arctangent, "atan2", 2},
                                             {Operation::arcsine, "asin", 1},
                                             {Operation::arccosine, "acos", 1},
                                             {Operation::hyperbolic_tangent, "tanh", 1},
                                             {Operation::hyperbolic_sine, "sinh", 1},
                                             {Operation::cube_root, "cbrt", 1},
                                             {Operation::power, "power", 2}};
constexpr std::string_view test_names[] = {"positive", "not_negative", "negative", "not_positive"};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// The operations on which `outputs` and the held values depend. Operands of uniform nodes do not count.
std::vector<char> find_used(const FormulaSet& set, const std::vector<int>& outputs) {
    const Expression& e = set.expression;
    std::vector<char> used(e.nodes().size(), 0);
    const auto mark = [&](int node) {
        if (node != no_node) used[index(node)] = 1;
    };
    for (const int node : outputs) mark(node);
    for (const formula::Hold& hold : e.holds()) mark(hold.argument);
    for (std::size_t i = used.size(); i-- > 0;) {
        const Node& node = e.nodes()[i];
        if (!used[i] || e.is_uniform(static_cast<int>(i)) || node.operation == Operation::input) continue;
        if (node.operation == Operation::choose) {
            const formula::Switch& one = e.switches()[index(node.a)];
            mark(one.argument), mark(one.threshold), mark(node.b), mark(node.c);
        } else {
            mark(node.a), mark(node.b);
        }
    }
    return used;
}

/// Converts the expression and the loads of a set of formulas.
class Converter {
  public:
    Converter(const FormulaSet& set, const std::vector<double>& constants) : set_(set) {
        convert_expression(constants);
    }

    // Appends a load. `components`: its nodes in the set's expression.
    void add(EngineFormulaLoad load, const std::array<int, 3>& components) {
        for (std::size_t i = 0; i < index(load.components()); ++i) load.value[i] = place_[index(components[i])];
        result.loads.push_back(load);
    }
    EngineFormulas result;

  private:
    const FormulaSet& set_;
    std::vector<int> place_;  ///< by node of the set's expression: its index in the result

    void convert_expression(const std::vector<double>& constants) {
        const Expression& e = set_.expression;
        std::vector<int> outputs;
        for (const FormulaTerm& term : set_.terms) {
            outputs.insert(outputs.end(), term.value.begin(), term.value.begin() + term.components());
            if (term.load.kind == FormulaKind::potential)
                outputs.insert(outputs.end(), term.torque_B.begin(), term.torque_B.end());
        }
        const std::vector<char> used = find_used(set_, outputs);
        const std::vector<double> uniform = formula::compute_uniform_values<double>(e, constants);
        place_.assign(used.size(), no_node);
        std::vector<int> switch_place(e.switches().size(), no_node);
        for (std::size_t i = 0; i < used.size(); ++i) {
            if (!used[i]) continue;
            Node node = e.nodes()[i];
            if (e.is_uniform(static_cast<int>(i))) {
                if (!std::isfinite(uniform[i]))
                    throw std::invalid_argument("a constant part of a formula has no finite value");
                node = {Operation::number, {}, no_node, no_node, no_node, uniform[i]};
            } else if (node.operation == Operation::choose) {
                node.a = add_switch(e.switches()[index(node.a)], switch_place[index(node.a)]);
                node.b = place_[index(node.b)], node.c = place_[index(node.c)];
            } else if (node.operation != Operation::input) {
                node.a = place_[index(node.a)];
                if (node.b != no_node) node.b = place_[index(node.b)];
            }
            place_[i] = static_cast<int>(result.operations.size());
            result.operations.push_back(node);
        }
        for (std::size_t i = 0; i < e.holds().size(); ++i)
            result.holds.push_back({place_[index(e.holds()[i].argument)], set_.periods[i], e.holds()[i].input});
    }
    int add_switch(const formula::Switch& one, int& place) {
        if (place == no_node) {
            place = static_cast<int>(result.switches.size());
            result.switches.push_back(
                {place_[index(one.argument)], one.threshold == no_node ? no_node : place_[index(one.threshold)]});
        }
        return place;
    }
};

// Adds a load on a body. `point_of`: a point of the scene's body, from its centre of mass.
template <class PointOf>
void add_body_load(Converter& converter, const FormulaTerm& term, int body, const PointOf& point_of) {
    const FormulaLoad& load = term.load;
    EngineFormulaLoad added;
    added.kind = load.kind, added.body = body, added.frame = load.frame, added.window = load.window;
    if (load.kind == FormulaKind::potential) {
        added.kind = FormulaKind::force, added.frame = Frame::world;
        converter.add(added, term.value);
        added.kind = FormulaKind::torque, added.frame = Frame::body;
        converter.add(added, term.torque_B);
        return;
    }
    if (load.kind == FormulaKind::force && load.has_point) {
        added.point = load.point_frame == Frame::body ? point_of(load.point) : load.point;
        added.point_frame = load.point_frame;
    }
    converter.add(added, term.value);
}

// The times inside the run at which a formula begins, ends or is sampled.
std::vector<double> find_times(Scene scene) {
    std::erase_if(scene.loads, [](const Load& load) { return !std::holds_alternative<FormulaLoad>(load); });
    std::vector<double> times = event_times(scene);
    std::erase_if(times, [&](double t) { return !(t > 0 && t < scene.duration); });
    return times;
}

json write_operation(const Node& node) {
    if (node.operation == Operation::number) return {"number", node.value};
    if (node.operation == Operation::input) return {"input", node.a};
    if (node.operation == Operation::choose)
        return {"choose", node.a, test_names[static_cast<std::size_t>(node.test)], node.b, node.c};
    const auto* named = std::ranges::find(operation_names, node.operation, &OperationName::operation);
    return named->operands == 1 ? json{named->name, node.a} : json{named->name, node.a, node.b};
}

Node read_operation(const json& entry, int before) {
    const std::string name = entry.at(0);
    const auto operand = [&](std::size_t i) {
        const int node = entry.at(i);
        if (node < 0 || node >= before) throw std::invalid_argument("an operation precedes its operand");
        return node;
    };
    if (name == "number") return {Operation::number, {}, no_node, no_node, no_node, entry.at(1)};
    if (name == "input") return {Operation::input, {}, entry.at(1)};
    if (name == "choose") {
        const auto* test = std::ranges::find(test_names, entry.at(2).get<std::string>());
        if (test == std::end(test_names)) throw std::invalid_argument("unknown test of an operation");
        return {Operation::choose, static_cast<Test>(test - test_names), entry.at(1), operand(3), operand(4)};
    }
    const auto* named = std::ranges::find(operation_names, name, &OperationName::name);
    if (named == std::end(operation_names))
        throw std::invalid_argument(fmt::format("unknown operation \"{}\" of a formula", name));
    return {named->operation, {}, operand(1), named->operands == 2 ? operand(2) : no_node};
}

constexpr std::string_view name_of(FormulaKind kind) {
    return kind == FormulaKind::force ? "force" : kind == FormulaKind::torque ? "torque" : "motor";
}
constexpr const char* name_of(Frame frame) { return frame == Frame::body ? "body" : "world"; }
Frame read_frame(const json& name) { return name == "body" ? Frame::body : Frame::world; }

json write_load(const EngineFormulaLoad& load) {
    json entry{{"type", name_of(load.kind)}, {"value", json::array()}};
    for (std::size_t i = 0; i < index(load.components()); ++i) entry["value"].push_back(load.value[i]);
    if (load.kind == FormulaKind::motor)
        entry["joint"] = load.joint;
    else
        entry["body"] = load.body, entry["frame"] = name_of(load.frame);
    if (load.point) entry["point"] = array(*load.point), entry["point_frame"] = name_of(load.point_frame);
    if (std::isfinite(load.window.from)) entry["from"] = load.window.from;
    if (std::isfinite(load.window.until)) entry["until"] = load.window.until;
    return entry;
}

EngineFormulaLoad read_load(const json& entry) {
    EngineFormulaLoad load;
    const std::string type = entry.at("type");
    load.kind = type == "force" ? FormulaKind::force : type == "torque" ? FormulaKind::torque : FormulaKind::motor;
    for (std::size_t i = 0; i < index(load.components()); ++i) load.value[i] = entry.at("value").at(i);
    if (load.kind == FormulaKind::motor)
        load.joint = entry.at("joint");
    else
        load.body = entry.at("body"), load.frame = read_frame(entry.at("frame"));
    if (entry.contains("point"))
        load.point = vector_at(entry.at("point"), 0), load.point_frame = read_frame(entry.at("point_frame"));
    load.window.from = entry.value("from", load.window.from);
    load.window.until = entry.value("until", load.window.until);
    return load;
}

}  // namespace

int EngineFormulas::joint_input(std::size_t joint) const {
    return MechanismInputs::of_joint(static_cast<int>(axes.size()), static_cast<int>(joint));
}
int EngineFormulas::count_inputs() const { return joint_input(coordinates.size()) + static_cast<int>(holds.size()); }

std::optional<EngineFormulas> body_formulas(const Scene& scene, const ExactBody<double>& body,
                                            const Quaternion<double>& q_BP, const Vector3<double>& center) {
    if (!has_formula_loads(scene)) return {};
    const auto set = compile_formulas(scene, scene.name);
    Converter converter(*set, formula_constants<double>(scene, body, mass_properties<double>(scene.body).inertia));
    converter.result.axes = {q_BP};
    const auto point_of = [&](const Vector3<double>& point) { return point - center; };
    for (const FormulaTerm& term : set->terms) add_body_load(converter, term, 0, point_of);
    converter.result.times = find_times(scene);
    return std::move(converter.result);
}

std::optional<EngineFormulas> mechanism_formulas(const Scene& scene, const EngineMechanism& mechanism) {
    if (!has_formula_loads(scene)) return {};
    const auto set = compile_formulas(scene, scene.name);
    const std::vector<MassProperties<double>> properties = bodies_mass_properties<double>(scene);
    Converter converter(*set, mechanism_formula_constants<double>(scene, properties));
    EngineFormulas& result = converter.result;
    result.times = find_times(scene);
    for (const EngineBody& body : mechanism.bodies) result.axes.push_back(body.q_BP);
    // by joint of the scene: its place among the engines' joints, which are sorted
    std::vector<int> place;
    for (const Joint& joint : scene.joints)
        place.push_back(static_cast<int>(std::ranges::find(mechanism.joints, joint.name, &EngineJoint::name) -
                                         mechanism.joints.begin()));
    result.coordinates.assign(mechanism.joints.size(), 0);
    for (std::size_t j = 0; j < place.size(); ++j) result.coordinates[index(place[j])] = scene.joints[j].coordinate[0];
    const int first = result.joint_input(0), end = result.joint_input(place.size());
    for (Node& node : result.operations)
        if (node.operation == Operation::input && node.a >= first && node.a < end)
            node.a = result.joint_input(index(place[index((node.a - first) / 2)])) + (node.a - first) % 2;
    for (const FormulaTerm& term : set->terms) {
        if (term.joint >= 0) {
            EngineFormulaLoad load;
            load.kind = FormulaKind::motor, load.joint = place[index(term.joint)], load.window = term.load.window;
            converter.add(load, term.value);
            continue;
        }
        const Vector3<double>& center = properties[index(term.body)].center;
        add_body_load(converter, term, term.body, [&](const Vector3<double>& point) { return point - center; });
    }
    return std::move(result);
}

EngineFormulas align_to_steps(EngineFormulas formulas, double duration, long samples, long steps_per_sample) {
    const double interval = duration / static_cast<double>(samples);
    for (double& t : formulas.times) {
        const long k = std::clamp(std::lround(std::floor(t / interval)), 0L, samples - 1);
        const double begin = sample_time(duration, k, samples), end = sample_time(duration, k + 1, samples),
                     h = (end - begin) / static_cast<double>(steps_per_sample);
        const long i = std::clamp(std::lround((t - begin) / h), 0L, steps_per_sample);
        const double boundary = i == steps_per_sample ? end : begin + static_cast<double>(i) * h;
        if (std::abs(boundary - t) < 1e-6 * h) t = boundary;
    }
    formulas.times.erase(std::unique(formulas.times.begin(), formulas.times.end()), formulas.times.end());
    return formulas;
}

json write_formulas(const EngineFormulas& formulas) {
    json written{{"operations", json::array()}, {"switches", json::array()}, {"holds", json::array()},
                 {"loads", json::array()},      {"axes", json::array()},     {"coordinates", formulas.coordinates},
                 {"times", formulas.times}};
    for (const Node& node : formulas.operations) written["operations"].push_back(write_operation(node));
    for (const auto& [argument, threshold] : formulas.switches)
        written["switches"].push_back({argument, threshold == no_node ? json() : json(threshold)});
    for (const EngineHold& hold : formulas.holds)
        written["holds"].push_back({{"value", hold.value}, {"period", hold.period}, {"input", hold.input}});
    for (const EngineFormulaLoad& load : formulas.loads) written["loads"].push_back(write_load(load));
    for (const Quaternion<double>& q : formulas.axes) written["axes"].push_back(array(q));
    return written;
}

EngineFormulas read_formulas(const json& formulas) {
    EngineFormulas result;
    for (const json& q : formulas.at("axes")) result.axes.push_back(quaternion_at(q, 0));
    result.coordinates = formulas.at("coordinates").get<std::vector<double>>();
    result.times = formulas.at("times").get<std::vector<double>>();
    for (const json& entry : formulas.at("operations"))
        result.operations.push_back(read_operation(entry, static_cast<int>(result.operations.size())));
    for (const json& entry : formulas.at("switches"))
        result.switches.push_back({entry.at(0), entry.at(1).is_null() ? no_node : entry.at(1).get<int>()});
    for (const json& hold : formulas.at("holds"))
        result.holds.push_back({hold.at("value"), hold.at("period"), hold.at("input")});
    for (const json& load : formulas.at("loads")) result.loads.push_back(read_load(load));
    return result;
}

}  // namespace polhode
