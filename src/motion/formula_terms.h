// The formula loads of a scene over any scalar: forces and torques from time and state.
//
// FormulaValues<P> contains the constants in the scalar P, FormulaTerms<P> also the points of application on one body
// (several bodies: formula_tree.h). A system that uses them has, after its own state, the time and
// the values that are held (formula/expression.h), which change only when they are sampled, and one variable per
// auxiliary node (formula/evaluate.h). Numbers compute transcendental functions directly and give the auxiliaries the
// rate zero; only recorded equations read them. update_auxiliaries() sets them to their values: at the start, at
// events, and after each step of methods that use recorded equations.
//
// Recorded equations have the branches of the current signs of all switches. A method that locates the time at which
// the argument of a switch passes its threshold changes the sign there (set_sign()) and records the equations again.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "body/mass_properties.h"
#include "formula/evaluate.h"
#include "motion/exact_body.h"
#include "scene/scene_formulas.h"

namespace polhode {

/// Force (world axes, N) and torque (body axes, N m, about the pivot or the centre of mass).
template <class S>
struct FormulaWrench {
    Vector3<S> force_W;
    Vector3<S> torque_B;
};

/// Time and state of the body as inputs of formulas.
template <class S>
struct FormulaState {
    std::vector<S> input;

    /// `held`: the values that are held.
    FormulaState(const S& t, const Vector3<S>& w_B, const Quaternion<S>& q, const Vector3<S>& p_W,
                 const Vector3<S>& v_W, std::span<const S> held = {})
        : input{t, w_B[0], w_B[1], w_B[2], q.w, q.x, q.y, q.z, p_W[0], p_W[1], p_W[2], v_W[0], v_W[1], v_W[2]} {
        input.insert(input.end(), held.begin(), held.end());
    }
    Quaternion<S> q() const {
        constexpr int q = FormulaInputs::attitude;
        return {input[q], input[q + 1], input[q + 2], input[q + 3]};
    }
    Vector3<S> position() const {
        constexpr int p = FormulaInputs::position;
        return {input[p], input[p + 1], input[p + 2]};
    }
};

/// The constants of a scene's expression. `center_inertia`: about the centre of mass.
template <class P>
std::vector<P> formula_constants(const Scene& scene, const ExactBody<P>& body, const Matrix3<P>& center_inertia) {
    std::vector<P> constants;
    for (const FormulaParameter& parameter : scene.parameters) constants.push_back(P(parameter.value));
    constants.push_back(body.mass);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) constants.push_back(center_inertia[i][j]);
    for (int i = 0; i < 3; ++i) constants.push_back(body.arm[i]);
    return constants;
}

/// The values of a scene's formulas, the loads that act, and the signs of the switches. A state is any type whose
/// member `input` lists the inputs of the expression.
template <class P>
class FormulaValues {
  public:
    /// `constants`: those of the expression, in order.
    FormulaValues(std::shared_ptr<const FormulaSet> set, const std::vector<P>& constants)
        : set_(std::move(set)),
          uniform_(formula::compute_uniform_values<P>(set_->expression, constants)),
          signs_(set_->expression.switches().size(), 0) {}
    /// The same values with constants rounded to P.
    template <class From>
    explicit FormulaValues(const FormulaValues<From>& other)
        : set_(other.set_),
          acting_(other.acting_),
          needed_(other.needed_),
          signs_(other.signs_),
          needed_by_signs_(other.needed_by_signs_),
          active_(other.active_),
          roots_(other.roots_) {
        for (const From& x : other.uniform_) uniform_.push_back(P(x));
    }

    const FormulaSet& set() const { return *set_; }
    /// The values that depend on no input, by node, as constants of the equations.
    std::vector<P>& uniform_values() { return uniform_; }
    /// The number of values that are held.
    int holds() const { return static_cast<int>(set_->periods.size()); }
    /// The number of variables of a system after the time: the values that are held, then one per auxiliary node.
    int auxiliaries() const { return holds() + static_cast<int>(set_->auxiliaries.size()); }
    /// The values that are held, at the start of these variables.
    template <class S>
    std::span<const S> held(const S* variables) const {
        return {variables, static_cast<std::size_t>(holds())};
    }
    /// Samples the values that are held at time t (s). `state_of()`: the state with the values held so far.
    template <class StateOf>
    void sample(double t, const StateOf& state_of, P* variables) const {
        for (int i = 0; i < holds(); ++i) {
            if (!is_sampling_time(t, set_->periods[static_cast<std::size_t>(i)])) continue;
            const int argument = set_->expression.holds()[static_cast<std::size_t>(i)].argument;
            const std::vector<char> needed = formula::find_needed(set_->expression, {argument});
            formula::Evaluation<P, P> values(set_->expression, uniform_, needed, nullptr);
            const auto state = state_of();
            values.compute(state.input.data());
            variables[i] = values.value(argument);
        }
    }
    /// Whether a load that acts depends on a switch.
    bool has_switches() const {
        for (std::size_t i = 0; i < needed_.size(); ++i)
            if (needed_[i] && set_->expression.nodes()[i].operation == formula::Operation::choose &&
                !set_->expression.is_uniform(static_cast<int>(i)))
                return true;
        return false;
    }

    /// The loads that act, as indices of set().terms.
    const std::vector<std::size_t>& acting() const { return acting_; }
    /// Sets the loads that act from `begin` (s) on. Keeps the signs of the switches.
    void enter(double begin) {
        acting_.clear();
        for (std::size_t i = 0; i < set_->terms.size(); ++i)
            if (acts(set_->terms[i].load.window, begin)) acting_.push_back(i);
        needed_ = formula::find_needed(set_->expression, outputs());
        find_active();
    }

    /// Whether a load that acts has a square root whose argument depends on time or state.
    bool has_roots() const { return !roots_.empty(); }
    /// The arguments of these square roots at a state.
    template <class State>
    std::vector<P> root_arguments(const State& state) const {
        const formula::Evaluation<P, P> values = evaluate<P>(state, nullptr, true);
        std::vector<P> arguments;
        for (const int node : roots_) arguments.push_back(values.value(node));
        return arguments;
    }

    /// The switches on which the loads that act depend under the current signs, as indices of the expression's.
    const std::vector<int>& active_switches() const { return active_; }
    /// The current sign of a switch.
    int sign(int which) const { return signs_[static_cast<std::size_t>(which)]; }
    void set_sign(int which, int sign) {
        signs_[static_cast<std::size_t>(which)] = static_cast<signed char>(sign);
        find_active();
    }
    /// Sets the signs of all switches to those of the values at a state.
    template <class State>
    void set_signs(const State& state) {
        const formula::Evaluation<P, P> values = evaluate<P>(state, nullptr);
        for (std::size_t i = 0; i < signs_.size(); ++i) {
            const formula::Switch& one = set_->expression.switches()[i];
            const auto is_known = [&](int node) {
                return node == formula::no_node || set_->expression.is_uniform(node) ||
                       needed_[static_cast<std::size_t>(node)];
            };
            if (is_known(one.argument) && is_known(one.threshold))
                signs_[i] = static_cast<signed char>(values.sign_of_value(static_cast<int>(i)));
        }
        find_active();
    }
    /// The text of a switch.
    const std::string& switch_text(int which) const {
        return set_->expression.switches()[static_cast<std::size_t>(which)].text;
    }
    /// The index of the auxiliary that is the argument of a switch.
    int switch_auxiliary(int which) const {
        const int argument = set_->expression.switches()[static_cast<std::size_t>(which)].argument;
        const auto found = std::ranges::lower_bound(set_->auxiliaries, argument);
        return static_cast<int>(found - set_->auxiliaries.begin());
    }
    /// The threshold of a switch.
    P switch_threshold(int which) const {
        const int threshold = set_->expression.switches()[static_cast<std::size_t>(which)].threshold;
        return threshold == formula::no_node ? P(0) : uniform_[static_cast<std::size_t>(threshold)];
    }

    /// All values at a state. `auxiliaries`: their values, read only if S has no value itself. The branches are those
    /// of the current signs if S has no value, or if `by_signs` is set.
    template <class S, class State>
    formula::Evaluation<S, P> evaluate(const State& state, [[maybe_unused]] const S* auxiliaries,
                                       bool by_signs = formula::TracedScalar<S>) const {
        formula::Evaluation<S, P> values(set_->expression, uniform_, by_signs ? needed_by_signs_ : needed_,
                                         by_signs ? signs_.data() : nullptr);
        if constexpr (formula::TracedScalar<S>) {
            std::vector<const S*> by_node(needed_.size(), nullptr);
            for (std::size_t k = 0; k < set_->auxiliaries.size(); ++k)
                by_node[static_cast<std::size_t>(set_->auxiliaries[k])] = auxiliaries + holds() + k;
            values.compute(state.input.data(), by_node.data());
        } else {
            values.compute(state.input.data());
        }
        return values;
    }

    /// The rates of the variables after the time, from the values at a state and the rates of the state. The rates of
    /// values that are held are zero.
    template <class S, class State>
    void auxiliary_rates([[maybe_unused]] const State& rates, [[maybe_unused]] const formula::Evaluation<S, P>& values,
                         S* to) const {
        const std::size_t count = set_->auxiliaries.size();
        for (int k = 0; k < holds(); ++k) to[k] = S(0);
        to += holds();
        if constexpr (formula::TracedScalar<S>) {
            if (count == 0) return;
            const std::vector<S> all = values.compute_rates(rates.input.data());
            for (std::size_t k = 0; k < count; ++k) to[k] = all[static_cast<std::size_t>(set_->auxiliaries[k])];
        } else {
            for (std::size_t k = 0; k < count; ++k) to[k] = S(0);
        }
    }

    /// Sets the auxiliaries, after the values that are held, to their values at a state; zero where no load that acts
    /// depends on them.
    template <class State>
    void update_auxiliaries(const State& state, P* to) const {
        if (set_->auxiliaries.empty()) return;
        const formula::Evaluation<P, P> values = evaluate<P>(state, nullptr, true);
        for (std::size_t k = 0; k < set_->auxiliaries.size(); ++k) {
            const int node = set_->auxiliaries[k];
            to[static_cast<std::size_t>(holds()) + k] =
                needed_by_signs_[static_cast<std::size_t>(node)] ? values.value(node) : P(0);
        }
    }

    /// The sum of the potentials that act, J.
    template <class State>
    P potential(const State& state) const {
        std::vector<int> outputs;
        for (const std::size_t i : acting_)
            if (set_->terms[i].potential != formula::no_node) outputs.push_back(set_->terms[i].potential);
        P sum(0);
        if (outputs.empty()) return sum;
        const std::vector<char> needed = formula::find_needed(set_->expression, outputs);
        formula::Evaluation<P, P> values(set_->expression, uniform_, needed, nullptr);
        values.compute(state.input.data());
        for (const int node : outputs) sum += values.value(node);
        return sum;
    }

    /// By node: whether an acting load depends on it, on any branch.
    const std::vector<char>& needed() const { return needed_; }

  private:
    template <class Other>
    friend class FormulaValues;

    std::shared_ptr<const FormulaSet> set_;
    std::vector<P> uniform_;
    std::vector<std::size_t> acting_;    ///< terms
    std::vector<char> needed_;           ///< by node: whether an acting load depends on it, on any branch
    std::vector<signed char> signs_;     ///< by switch
    std::vector<char> needed_by_signs_;  ///< by node: whether an acting load depends on it, on the current branches
    std::vector<int> active_;            ///< switches of the current branches
    std::vector<int> roots_;             ///< arguments of square roots of the current branches, as nodes

    std::vector<int> outputs() const {
        std::vector<int> all;
        for (const std::size_t i : acting_) {
            const FormulaTerm& term = set_->terms[i];
            all.insert(all.end(), term.value.begin(), term.value.begin() + term.components());
            if (term.load.kind == FormulaKind::potential)
                all.insert(all.end(), term.torque_B.begin(), term.torque_B.end());
        }
        return all;
    }
    void find_active() {
        const formula::Expression& e = set_->expression;
        needed_by_signs_ = formula::find_needed(e, outputs(), signs_.data());
        active_.clear(), roots_.clear();
        for (std::size_t i = 0; i < needed_by_signs_.size(); ++i) {
            const formula::Node& node = e.nodes()[i];
            if (needed_by_signs_[i] && node.operation == formula::Operation::square_root && !e.is_uniform(node.a))
                roots_.push_back(node.a);
            if (!needed_by_signs_[i] || node.operation != formula::Operation::choose) continue;
            if (e.is_uniform(e.switches()[static_cast<std::size_t>(node.a)].argument)) continue;
            if (std::ranges::find(active_, node.a) == active_.end()) active_.push_back(node.a);
        }
        std::ranges::sort(active_);
    }
};

/// The formula loads of one body.
template <class P>
class FormulaTerms : public FormulaValues<P> {
  public:
    FormulaTerms(std::shared_ptr<const FormulaSet> set, const Scene& scene, const ExactBody<P>& body,
                 const Matrix3<P>& center_inertia)
        : FormulaValues<P>(std::move(set), formula_constants<P>(scene, body, center_inertia)), pivoted_(body.pivoted) {
        for (const FormulaTerm& term : this->set().terms) {
            const FormulaLoad& load = term.load;
            const Vector3<P> point = cast<P>(load.point);
            arms_.push_back(!load.has_point                    ? body.arm
                            : load.point_frame == Frame::world ? point
                                                               : point - body.origin);
        }
    }
    /// The same terms with constants rounded to P.
    template <class From>
    explicit FormulaTerms(const FormulaTerms<From>& other) : FormulaValues<P>(other), pivoted_(other.pivoted_) {
        for (const Vector3<From>& arm : other.arms_) arms_.push_back(cast<P>(arm));
    }

    /// The sum of all loads that act.
    template <class S>
    FormulaWrench<S> wrench(const FormulaState<S>& state, const formula::Evaluation<S, P>& values) const {
        FormulaWrench<S> sum;
        const Quaternion<S> q = state.q();
        const auto vector = [&](const std::array<int, 3>& node) {
            return Vector3<S>(values.value(node[0]), values.value(node[1]), values.value(node[2]));
        };
        for (const std::size_t i : this->acting()) {
            const FormulaTerm& term = this->set().terms[i];
            const FormulaLoad& load = term.load;
            const Vector3<S> value = vector(term.value);
            if (load.kind == FormulaKind::torque) {
                sum.torque_B = sum.torque_B + (load.frame == Frame::body ? value : rotate_back(q, value));
            } else if (load.kind == FormulaKind::potential) {
                sum.force_W = sum.force_W + value;
                sum.torque_B = sum.torque_B + vector(term.torque_B);
            } else {
                const Vector3<S> force_W = load.frame == Frame::world ? value : rotate(q, value);
                sum.force_W = sum.force_W + force_W;
                if (load.has_point && load.point_frame == Frame::world) {
                    Vector3<S> arm_W = cast<S>(arms_[i]);
                    if (!pivoted_) arm_W = arm_W - state.position();
                    sum.torque_B = sum.torque_B + rotate_back(q, cross(arm_W, force_W));
                } else if (!(arms_[i] == Vector3<P>())) {
                    const Vector3<S> force_B = load.frame == Frame::body ? value : rotate_back(q, value);
                    sum.torque_B = sum.torque_B + cross(arms_[i], force_B);
                }
            }
        }
        return sum;
    }

  private:
    template <class Other>
    friend class FormulaTerms;

    std::vector<Vector3<P>> arms_;  ///< by term: from the pivot or the centre of mass, body axes, or a world point
    bool pivoted_ = false;
};

/// A component of the state at whose threshold the equations switch, and its side: -1 or 1, or 0 if it stays there.
template <class P>
struct SwitchOf {
    int component;
    P threshold;
    int sign;
};

/// The active switches. `first`: index of the first variable after the time.
template <class P>
std::vector<SwitchOf<P>> switches_of(const FormulaValues<P>& terms, int first) {
    std::vector<SwitchOf<P>> all;
    for (const int which : terms.active_switches())
        all.push_back(
            {first + terms.holds() + terms.switch_auxiliary(which), terms.switch_threshold(which), terms.sign(which)});
    return all;
}

}  // namespace polhode
