#include "scene/scene_formulas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "formula/parser.h"
#include "scene/event_expression.h"
#include "scene/scene_check.h"

namespace polhode {
namespace {

using formula::Expression;
using formula::Scope;
using formula::Value;

constexpr std::size_t most_table_points = 2000, most_names = 1000, most_held_values = 100;
constexpr double most_sampling_times = 20'000;

Value vector_of(std::array<int, 3> component) {
    return {formula::Type::vector, {component[0], component[1], component[2], formula::no_node}};
}
Value scalar_of(int node) {
    return {formula::Type::scalar, {node, formula::no_node, formula::no_node, formula::no_node}};
}
Value input_vector(Expression& e, int first) {
    return vector_of({e.input(first), e.input(first + 1), e.input(first + 2)});
}

/// Compiles the formulas of one scene.
class FormulaCompiler {
  public:
    FormulaCompiler(const Scene& scene, const std::string& file) : scene_(scene), file_(file) {}

    std::shared_ptr<const FormulaSet> compile() {
        add_names();
        for (std::size_t i = 0; i < scene_.loads.size(); ++i)
            if (const auto* load = std::get_if<FormulaLoad>(&scene_.loads[i])) add_term(*load, i);
        find_auxiliaries();
        return set_;
    }

    EventExpression compile_events(const std::vector<std::string>& formulas) {
        events_ = formulas;
        add_names();
        EventExpression compiled;
        for (std::size_t i = 0; i < formulas.size(); ++i) compiled.outputs.push_back(add_event(formulas[i], i));
        compiled.expression = std::move(e_);
        return compiled;
    }

  private:
    const Scene& scene_;
    const bool has_bodies_ = is_mechanism(scene_);
    const std::string& file_;
    std::vector<std::string> events_;
    std::shared_ptr<FormulaSet> set_ = std::make_shared<FormulaSet>();
    Expression& e_ = set_->expression;
    Scope scope_;
    /// What formulas read of one of several bodies.
    struct BodyNodes {
        std::map<std::string, Value> names;
        std::vector<int> attitude, inertia;
    };
    std::map<int, BodyNodes> bodies_;

    // Makes the parameters, the state, the tables and the definitions of the scene available to formulas.
    void add_names() {
        add_parameters();
        e_.allow_holds(
            MechanismInputs::count(static_cast<int>(body_count(scene_)), static_cast<int>(scene_.joints.size())));
        if (has_bodies_)
            add_mechanism();
        else
            add_state();
        // definitions may use the quantities of the only body without its name
        if (scene_.bodies.size() == 1 && bodies_.contains(0)) select_body(0);
        for (const FormulaTable& table : scene_.tables)
            scope_.tables[table.name] = {table.x, table.y, table.between == TableInterpolation::cubic};
        for (const FormulaDefinition& definition : scene_.let)
            scope_.names[definition.name] = parse("/let/" + definition.name, definition.formula);
    }

    template <class Named>
    static int index_of(const std::vector<Named>& all, const std::string& name) {
        return static_cast<int>(std::ranges::find(all, name, &Named::name) - all.begin());
    }

    void add_parameters() {
        for (std::size_t i = 0; i < scene_.parameters.size(); ++i)
            scope_.names[scene_.parameters[i].name] = scalar_of(e_.constant(static_cast<int>(i)));
    }
    void add_state() {
        const int first = static_cast<int>(scene_.parameters.size());
        const auto constant = [&](int which) { return e_.constant(first + which); };
        scope_.names["t"] = scalar_of(e_.input(FormulaInputs::time));
        scope_.names["mass"] = scalar_of(constant(FormulaConstants::mass));
        for (int i = 0; i < 4; ++i) scope_.attitude.push_back(e_.input(FormulaInputs::attitude + i));
        for (int i = 0; i < 9; ++i) scope_.inertia.push_back(constant(FormulaConstants::inertia + i));
        Value q{formula::Type::quaternion, {}};
        std::copy(scope_.attitude.begin(), scope_.attitude.end(), q.component.begin());
        scope_.names["q"] = q;
        const Value w = input_vector(e_, FormulaInputs::angular_velocity);
        const std::array<int, 9> axes = rotation_matrix_nodes(e_, scope_.attitude);
        const auto in_world = [&](const Value& v) { return multiply_matrix(e_, axes, v, false); };
        scope_.names["w"] = w;
        scope_.names["w_W"] = in_world(w);
        if (scene_.pivot) {
            const Value arm = vector_of({constant(FormulaConstants::arm), constant(FormulaConstants::arm + 1),
                                         constant(FormulaConstants::arm + 2)});
            scope_.names["p"] = in_world(arm);
            scope_.names["v"] = in_world(cross_product(e_, w, arm));
        } else {
            scope_.names["p"] = input_vector(e_, FormulaInputs::position);
            scope_.names["v"] = input_vector(e_, FormulaInputs::velocity);
        }
    }

    // Adds the quantities of all bodies and joints that formulas mention.
    void add_mechanism() {
        scope_.names["t"] = scalar_of(e_.input(FormulaInputs::time));
        const int bodies = static_cast<int>(scene_.bodies.size());
        try {
            for (int b = 0; b < bodies; ++b) {
                const std::string& name = scene_.bodies[static_cast<std::size_t>(b)].name;
                if (is_mentioned(name)) add_body(name, b);
            }
        } catch (const formula::LimitError& error) {
            fail("/loads", 1, error.what(), "name fewer bodies in formulas");
        }
        for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
            const Joint& joint = scene_.joints[j];
            const bool turns = joint.type == JointType::revolute;
            if ((!turns && joint.type != JointType::prismatic) || !is_mentioned(joint.name)) continue;
            const int input = MechanismInputs::of_joint(bodies, static_cast<int>(j));
            scope_.names[joint.name + (turns ? ".angle" : ".displacement")] = scalar_of(e_.input(input));
            scope_.names[joint.name + (turns ? ".rate" : ".speed")] = scalar_of(e_.input(input + 1));
        }
    }
    bool is_mentioned(const std::string& name) const {
        for (const FormulaDefinition& definition : scene_.let)
            if (definition.formula.find(name) != std::string::npos) return true;
        for (const std::string& event : events_)
            if (event.find(name) != std::string::npos) return true;
        return std::ranges::any_of(scene_.loads, [&](const Load& load) {
            const auto* one = std::get_if<FormulaLoad>(&load);
            return one && (one->body == name || one->formula.find(name) != std::string::npos);
        });
    }
    void add_body(const std::string& name, int body) {
        const int first = static_cast<int>(scene_.parameters.size()) + FormulaConstants::count * body;
        const auto constant = [&](int which) { return e_.constant(first + which); };
        const auto input = [&](int which) { return e_.input(MechanismInputs::of_body(body, which)); };
        const auto vector = [&](int which) { return vector_of({input(which), input(which + 1), input(which + 2)}); };
        BodyNodes nodes;
        for (int i = 0; i < 4; ++i) nodes.attitude.push_back(input(FormulaInputs::attitude + i));
        for (int i = 0; i < 9; ++i) nodes.inertia.push_back(constant(FormulaConstants::inertia + i));
        formula::BodyScope& scope = scope_.bodies[name];
        scope.position = vector(FormulaInputs::position), scope.velocity = vector(FormulaInputs::velocity);
        scope.angular_velocity = vector(FormulaInputs::angular_velocity);
        scope.axes = rotation_matrix_nodes(e_, nodes.attitude);
        scope.center = vector_of({constant(FormulaConstants::arm), constant(FormulaConstants::arm + 1),
                                  constant(FormulaConstants::arm + 2)});
        Value q{formula::Type::quaternion, {}};
        std::copy(nodes.attitude.begin(), nodes.attitude.end(), q.component.begin());
        nodes.names = {{"mass", scalar_of(constant(FormulaConstants::mass))},
                       {"p", scope.position},
                       {"q", q},
                       {"v", scope.velocity},
                       {"w", scope.angular_velocity},
                       {"w_W", multiply_matrix(e_, scope.axes, scope.angular_velocity, false)}};
        for (const auto& [member, value] : nodes.names) scope_.names[fmt::format("{}.{}", name, member)] = value;
        bodies_[body] = std::move(nodes);
    }
    // In a load on a body, its quantities can be written without its name.
    void select_body(int body) {
        scope_.attitude.clear(), scope_.inertia.clear();
        for (const char* member : {"mass", "p", "q", "v", "w", "w_W"}) scope_.names.erase(member);
        if (body < 0) return;
        const BodyNodes& nodes = bodies_.at(body);
        scope_.attitude = nodes.attitude, scope_.inertia = nodes.inertia;
        for (const auto& [member, value] : nodes.names) scope_.names[member] = value;
    }

    [[noreturn]] void fail(const std::string& place, std::size_t column, const std::string& fault,
                           const std::string& remedy) const {
        throw InputError(file_, place, fmt::format("column {}: {}", column, fault), remedy);
    }
    Value parse(const std::string& place, const std::string& text) {
        try {
            const Value value = formula::parse_formula(text, scope_, e_);
            for (std::size_t i = set_->periods.size(); i < e_.holds().size(); ++i)
                set_->periods.push_back(period_of(e_.holds()[i], place));
            return value;
        } catch (const formula::FormulaError& error) {
            fail(place, error.column(), error.what(), error.remedy());
        }
    }

    double period_of(const formula::Hold& hold, const std::string& place) const {
        const formula::Node& node = e_.nodes()[static_cast<std::size_t>(hold.period)];
        double period = 0;
        if (node.operation == formula::Operation::number)
            period = node.value;
        else if (node.operation == formula::Operation::constant &&
                 static_cast<std::size_t>(node.a) < scene_.parameters.size())
            period = scene_.parameters[static_cast<std::size_t>(node.a)].value;
        else
            fail(place, 1, "the period of \"hold\" is not a number or a parameter", "give a number or a parameter");
        if (!(period > 0) || scene_.duration / period > most_sampling_times)
            fail(place, 1, fmt::format("the period of \"hold\" is {} s", shortest_decimal(period)),
                 fmt::format("give a period > 0 with at most {} samples in the run", most_sampling_times));
        if (e_.holds().size() > most_held_values)
            fail(place, 1, fmt::format("more than {} values are held", most_held_values), "hold fewer values");
        return period;
    }

    // Returns the node of an event. Errors name the event as Python's argument `events` does.
    int add_event(const std::string& text, std::size_t index) {
        const auto fail_at = [&](std::size_t column, const std::string& fault, const std::string& remedy) {
            throw InputError(fmt::format("events[{}]", index), fmt::format("\"{}\"", one_line(text, 100)),
                             fmt::format("column {}: {}", column, fault), remedy);
        };
        Value value;
        try {
            value = formula::parse_formula(text, scope_, e_);
        } catch (const formula::FormulaError& error) {
            fail_at(error.column(), error.what(), error.remedy());
        }
        if (value.type != formula::Type::scalar)
            fail_at(1, fmt::format("the formula is {}, but an event is a scalar", formula::name_of(value.type)),
                    "give a component such as w.x, or norm(v)");
        const std::vector<char> needed = formula::find_needed(e_, {value.component[0]});
        for (const formula::Hold& hold : e_.holds())
            for (std::size_t i = 0; i < needed.size(); ++i)
                if (needed[i] && e_.nodes()[i].operation == formula::Operation::input && e_.nodes()[i].a == hold.input)
                    fail_at(1, "the event depends on a held value, which is not supported",
                            "write it without \"hold\"");
        return value.component[0];
    }

    void add_term(const FormulaLoad& load, std::size_t index) {
        const std::string place = fmt::format("/loads/{}/formula", index);
        FormulaTerm term;
        term.load = load, term.index = index;
        if (has_bodies_) {
            const bool has_body = load.kind != FormulaKind::motor && !load.body.empty();
            term.body = has_body ? index_of(scene_.bodies, load.body) : -1;
            term.joint = load.kind == FormulaKind::motor ? index_of(scene_.joints, load.joint) : -1;
            select_body(term.body);
        }
        const Value value = parse(place, load.formula);
        const bool is_scalar = load.kind == FormulaKind::potential || load.kind == FormulaKind::motor;
        if (value.type != (is_scalar ? formula::Type::scalar : formula::Type::vector))
            fail(place, 1,
                 fmt::format("the formula is {}, but a {} is {}", formula::name_of(value.type),
                             load.kind == FormulaKind::torque      ? "torque"
                             : load.kind == FormulaKind::force     ? "force"
                             : load.kind == FormulaKind::potential ? "potential"
                                                                   : "motor's force",
                             is_scalar ? "a scalar" : "a vector"),
                 is_scalar ? "give a scalar" : "give a vector such as [0, 0, x]");
        if (load.kind == FormulaKind::potential) {
            if (has_bodies_)
                add_potential_of_bodies(value.component[0], place, term);
            else
                add_potential(value.component[0], place, term);
            return;
        }
        std::copy_n(value.component.begin(), static_cast<std::size_t>(term.components()), term.value.begin());
        set_->terms.push_back(term);
    }

    // The bodies whose position or attitude a potential depends on.
    std::set<int> bodies_of_potential(int potential, const std::string& place) const {
        const int bodies = static_cast<int>(body_count(scene_)), first_joint = MechanismInputs::of_joint(bodies, 0);
        const std::vector<char> needed = formula::find_needed(e_, {potential});
        std::set<int> found;
        for (std::size_t i = 0; i < needed.size(); ++i) {
            const formula::Node& node = e_.nodes()[i];
            if (!needed[i] || node.operation != formula::Operation::input || node.a == FormulaInputs::time) continue;
            if (node.a >= first_joint &&
                node.a < MechanismInputs::count(bodies, static_cast<int>(scene_.joints.size())))
                fail(place, 1, "the potential depends on the coordinate of a joint",
                     "give a motor with the derivative of the potential as its formula");
            const int body = (node.a - 1) / MechanismInputs::per_body;
            const int which = node.a - MechanismInputs::per_body * body;
            if (node.a >= first_joint || which < FormulaInputs::attitude || which >= FormulaInputs::velocity)
                fail(place, 1, "the potential depends on a velocity or a held value",
                     "use t, p, to_body, to_world and the rotation functions only, or give a force or a torque");
            found.insert(body);
        }
        return found;
    }

    // The force, world axes, and the torque, body axes, on a body.
    struct Slope {
        std::array<int, 3> force_W{}, torque_B{};
    };
    // F = -dU/dp. With dq = q (0, a) / 2 for a rotation by the small vector a in body axes: torque_B = -dU/da.
    Slope slope_of(int potential, int body, const std::string& place) {
        std::vector<int> inputs;
        for (int i = 0; i < 3; ++i) inputs.push_back(MechanismInputs::of_body(body, FormulaInputs::position + i));
        for (int i = 0; i < 4; ++i) inputs.push_back(MechanismInputs::of_body(body, FormulaInputs::attitude + i));
        try {
            const std::vector<int> slope = e_.differentiate(potential, inputs);
            const std::vector<int>& q = has_bodies_ ? bodies_.at(body).attitude : scope_.attitude;
            const int gw = slope[3], gx = slope[4], gy = slope[5], gz = slope[6];
            const int half = e_.number(0.5);
            const auto term_of = [&](int p0, int p1, int m0, int m1) {
                return e_.multiply(half, e_.subtract(e_.add(p0, p1), e_.add(m0, m1)));
            };
            const auto times = [&](int g, std::size_t i) { return e_.multiply(g, q[i]); };
            return {{e_.negate(slope[0]), e_.negate(slope[1]), e_.negate(slope[2])},
                    {term_of(times(gw, 1), times(gz, 2), times(gx, 0), times(gy, 3)),
                     term_of(times(gw, 2), times(gx, 3), times(gy, 0), times(gz, 1)),
                     term_of(times(gw, 3), times(gy, 1), times(gz, 0), times(gx, 2))}};
        } catch (const formula::LimitError& error) {
            fail(place, 1, error.what(), "simplify the formulas");
        }
    }
    void add_potential(int potential, const std::string& place, FormulaTerm& term) {
        bodies_of_potential(potential, place);
        const Slope slope = slope_of(potential, 0, place);
        term.potential = potential, term.value = slope.force_W, term.torque_B = slope.torque_B;
        set_->terms.push_back(term);
    }
    // A potential of several bodies becomes a force and a torque on each of them. The first has its value.
    void add_potential_of_bodies(int potential, const std::string& place, FormulaTerm term) {
        const std::set<int> bodies = bodies_of_potential(potential, place);
        if (bodies.empty())
            fail(place, 1, "the potential does not depend on the position or attitude of a body",
                 "use p or q of a body, such as name.p");
        term.potential = potential;
        for (const int body : bodies) {
            const Slope slope = slope_of(potential, body, place);
            term.body = body, term.load.body = scene_.bodies[static_cast<std::size_t>(body)].name;
            term.load.kind = FormulaKind::force, term.load.frame = Frame::world, term.value = slope.force_W;
            set_->terms.push_back(term);
            term.potential = formula::no_node;
            term.load.kind = FormulaKind::torque, term.load.frame = Frame::body, term.value = slope.torque_B;
            set_->terms.push_back(term);
        }
    }

    void find_auxiliaries() {
        std::vector<int> outputs;
        for (const FormulaTerm& term : set_->terms) {
            outputs.insert(outputs.end(), term.value.begin(), term.value.begin() + term.components());
            if (term.load.kind != FormulaKind::potential) continue;
            outputs.insert(outputs.end(), term.torque_B.begin(), term.torque_B.end());
            outputs.push_back(term.potential);
        }
        const std::vector<char> needed = formula::find_needed(e_, outputs);
        std::set<int> found;
        for (std::size_t i = 0; i < needed.size(); ++i) {
            const int node = static_cast<int>(i);
            if (!needed[i] || e_.is_uniform(node)) continue;
            const formula::Node& one = e_.nodes()[i];
            if (formula::is_transcendental(one.operation)) found.insert(node);
            if (one.operation != formula::Operation::choose) continue;
            const int argument = e_.switches()[static_cast<std::size_t>(one.a)].argument;
            if (!e_.is_uniform(argument)) found.insert(argument);
        }
        set_->auxiliaries.assign(found.begin(), found.end());
    }
};

void check_name(const SceneCheck& check, const std::string& place, const std::string& name,
                std::set<std::string, std::less<>>& known) {
    check.text(place, name);
    const std::string shown = one_line(name, 60);
    if (!formula::is_identifier(name))
        check.fail(place, fmt::format("the name \"{}\" is not an identifier", shown),
                   "begin with a letter or \"_\", and use letters, digits and \"_\"");
    if (formula::is_reserved(name))
        check.fail(place, fmt::format("the name \"{}\" has a meaning in formulas", shown), "choose another name");
    if (!known.insert(name).second)
        check.fail(place, fmt::format("the name \"{}\" is given twice", shown), "choose another name");
}

void check_table(const SceneCheck& check, const std::string& place, const FormulaTable& table) {
    if (table.x.size() != table.y.size())
        check.fail(place + "/y", fmt::format("has {} numbers, but x has {}", table.y.size(), table.x.size()),
                   "give one y for each x");
    if (table.x.size() < 2)
        check.fail(place + "/x", fmt::format("has {} numbers", table.x.size()), "give at least two points");
    check.count(place + "/x", table.x.size(), most_table_points, "points");
    for (std::size_t i = 0; i < table.x.size(); ++i) {
        check.finite(fmt::format("{}/x/{}", place, i), table.x[i]);
        check.finite(fmt::format("{}/y/{}", place, i), table.y[i]);
        if (i > 0 && !(table.x[i] > table.x[i - 1]))
            check.fail(fmt::format("{}/x/{}", place, i),
                       fmt::format("is {}, not above the previous x = {}", shortest_decimal(table.x[i]),
                                   shortest_decimal(table.x[i - 1])),
                       "give x in increasing order");
    }
}

}  // namespace

bool has_formula_loads(const Scene& scene) {
    return std::ranges::any_of(scene.loads, [](const Load& load) { return std::holds_alternative<FormulaLoad>(load); });
}

bool is_sampling_time(double t, double period) { return std::nearbyint(t / period) * period == t; }

std::vector<double> sampling_times(const Scene& scene) {
    const auto holds = [](const std::string& formula) { return formula.find("hold") != std::string::npos; };
    const bool any = std::ranges::any_of(scene.let, [&](const FormulaDefinition& one) { return holds(one.formula); }) ||
                     std::ranges::any_of(scene.loads, [&](const Load& load) {
                         const auto* one = std::get_if<FormulaLoad>(&load);
                         return one && holds(one->formula);
                     });
    if (!any || !has_formula_loads(scene)) return {};
    std::vector<double> periods = compile_formulas(scene, scene.name)->periods, times;
    std::ranges::sort(periods);
    periods.erase(std::unique(periods.begin(), periods.end()), periods.end());
    for (const double period : periods)
        for (long k = 1; static_cast<double>(k) * period < scene.duration; ++k)
            times.push_back(static_cast<double>(k) * period);
    return times;
}

bool has_formula_potential(const Scene& scene) {
    return std::ranges::any_of(scene.loads, [](const Load& load) {
        const auto* one = std::get_if<FormulaLoad>(&load);
        return one && one->kind == FormulaKind::potential;
    });
}

std::shared_ptr<const FormulaSet> compile_formulas(const Scene& scene, const std::string& file) {
    return FormulaCompiler(scene, file).compile();
}

EventExpression compile_event_formulas(const Scene& scene, const std::vector<std::string>& formulas) {
    return FormulaCompiler(scene, scene.name).compile_events(formulas);
}

void check_formulas(const Scene& scene, const std::string& file) {
    const SceneCheck check(file);
    std::set<std::string, std::less<>> names;
    check.count("/parameters", scene.parameters.size(), most_names, "parameters");
    check.count("/tables", scene.tables.size(), most_names, "tables");
    check.count("/let", scene.let.size(), most_names, "definitions");
    for (const FormulaParameter& parameter : scene.parameters) {
        check_name(check, "/parameters", parameter.name, names);
        check.finite("/parameters/" + parameter.name, parameter.value);
    }
    for (const FormulaTable& table : scene.tables) {
        check_name(check, "/tables", table.name, names);
        check_table(check, "/tables/" + table.name, table);
    }
    for (const FormulaDefinition& definition : scene.let) check_name(check, "/let", definition.name, names);
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const auto* load = std::get_if<FormulaLoad>(&scene.loads[i]);
        if (!load) continue;
        const std::string place = fmt::format("/loads/{}", i);
        if (!is_mechanism(scene) && load->kind == FormulaKind::motor)
            check.fail(place, "is a motor, but the scene has one body", "give a torque or a force");
        check.finite(place + "/point", load->point);
        for (const Load& other : scene.loads)
            if (std::holds_alternative<UserTorque>(other))
                check.fail(place + "/formula", "is given together with a user-defined torque, which is not supported",
                           "give the torque as a formula, too");
    }
    const std::shared_ptr<const FormulaSet> formulas = compile_formulas(scene, file);
    const std::vector<formula::Switch>& switches = formulas->expression.switches();
    if (!scene.planes.empty() && !switches.empty())
        check.fail(
            "/loads",
            fmt::format("have a formula with the switching point \"{}\", which scenes with planes do not support",
                        switches.front().text),
            "remove the planes, or use a smooth formula");
}

}  // namespace polhode
