// The equations of a mechanism with formula loads over any scalar, in joint coordinates (motion/tree.h).
//
// State: that of the tree, then the time, then held values and auxiliaries (formula_terms.h). Formulas read the motions
// of bodies and the coordinates of joints (MechanismInputs in scene/scene_formulas.h). Their loads are added to the
// links of the articulated-body recursion. Main types: MechanismState (inputs of formulas), FormulaTree.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motion/formula_switches.h"
#include "motion/formula_terms.h"
#include "motion/mechanism_motion.h"
#include "motion/tree.h"

namespace polhode {

/// Inputs of the formulas of a mechanism. Inputs that no formula reads are zero.
template <class S>
struct MechanismState {
    std::vector<S> input;

    MechanismState(std::size_t bodies, std::size_t joints)
        : input(static_cast<std::size_t>(MechanismInputs::count(static_cast<int>(bodies), static_cast<int>(joints))),
                S(0)) {}
    void set_body(int body, const Vector3<S>& w, const Quaternion<S>& q, const Vector3<S>& p, const Vector3<S>& v) {
        const auto put_vector = [&](int which, const Vector3<S>& value) {
            for (int k = 0; k < 3; ++k) at(body, which + k) = value[static_cast<std::size_t>(k)];
        };
        put_vector(FormulaInputs::angular_velocity, w);
        put_vector(FormulaInputs::position, p), put_vector(FormulaInputs::velocity, v);
        at(body, FormulaInputs::attitude) = q.w, at(body, FormulaInputs::attitude + 1) = q.x;
        at(body, FormulaInputs::attitude + 2) = q.y, at(body, FormulaInputs::attitude + 3) = q.z;
    }
    void set_joint(std::size_t bodies, std::size_t joint, const S& coordinate, const S& rate) {
        const std::size_t first =
            static_cast<std::size_t>(MechanismInputs::of_joint(static_cast<int>(bodies), static_cast<int>(joint)));
        input[first] = coordinate, input[first + 1] = rate;
    }
    /// The values that are held, which follow all other inputs.
    void set_held(std::span<const S> held) { input.insert(input.end(), held.begin(), held.end()); }
    Vector3<S> vector(int body, int which) const {
        const std::size_t i = static_cast<std::size_t>(MechanismInputs::of_body(body, which));
        return {input[i], input[i + 1], input[i + 2]};
    }
    Quaternion<S> attitude(int body) const {
        const std::size_t i = static_cast<std::size_t>(MechanismInputs::of_body(body, FormulaInputs::attitude));
        return {input[i], input[i + 1], input[i + 2], input[i + 3]};
    }

  private:
    S& at(int body, int which) { return input[static_cast<std::size_t>(MechanismInputs::of_body(body, which))]; }
};

/// The constants of the expression of a mechanism: parameters, then mass, inertia and centre of mass of each body.
template <class P>
std::vector<P> mechanism_formula_constants(const Scene& scene, const std::vector<MassProperties<P>>& properties) {
    std::vector<P> constants;
    for (const FormulaParameter& parameter : scene.parameters) constants.push_back(P(parameter.value));
    for (const MassProperties<P>& body : properties) {
        constants.push_back(body.mass);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) constants.push_back(body.inertia[i][j]);
        for (std::size_t i = 0; i < 3; ++i) constants.push_back(body.center[i]);
    }
    return constants;
}

/// The bodies and joints whose quantities the formulas read.
struct FormulaReads {
    std::vector<int> bodies;
    std::vector<int> joints;

    FormulaReads() = default;
    FormulaReads(const FormulaSet& set, std::size_t body_count, std::size_t joint_count) {
        const int joints_from = MechanismInputs::of_joint(static_cast<int>(body_count), 0);
        std::vector<char> reads_body(body_count, 0), reads_joint(joint_count, 0);
        const int joints_to = MechanismInputs::count(static_cast<int>(body_count), static_cast<int>(joint_count));
        std::vector<int> outputs = set.auxiliaries;
        for (const formula::Hold& hold : set.expression.holds()) outputs.push_back(hold.argument);
        for (const FormulaTerm& term : set.terms)
            outputs.insert(outputs.end(), term.value.begin(), term.value.begin() + term.components());
        const std::vector<char> needed = formula::find_needed(set.expression, outputs);
        for (std::size_t i = 0; i < needed.size(); ++i) {
            const formula::Node& node = set.expression.nodes()[i];
            if (!needed[i] || node.operation != formula::Operation::input || node.a == FormulaInputs::time) continue;
            if (node.a >= joints_to) continue;
            if (node.a >= joints_from)
                reads_joint[static_cast<std::size_t>((node.a - joints_from) / 2)] = 1;
            else
                reads_body[static_cast<std::size_t>((node.a - 1) / MechanismInputs::per_body)] = 1;
        }
        for (std::size_t b = 0; b < body_count; ++b)
            if (reads_body[b]) bodies.push_back(static_cast<int>(b));
        for (std::size_t j = 0; j < joint_count; ++j)
            if (reads_joint[j]) joints.push_back(static_cast<int>(j));
    }
};

template <class P>
class FormulaTree {
  public:
    /// From a valid scene of several bodies and its mass properties. Throws InputError as Tree does.
    FormulaTree(const Scene& scene, std::shared_ptr<const FormulaSet> formulas,
                const std::vector<MassProperties<P>>& properties)
        : tree_(scene, properties),
          terms_(std::move(formulas), mechanism_formula_constants<P>(scene, properties)),
          reads_(terms_.set(), scene.bodies.size(), scene.joints.size()),
          joints_(scene.joints.size()) {
        for (const FormulaTerm& term : terms_.set().terms) {
            const bool at_body_point = term.load.has_point && term.load.point_frame == Frame::body;
            const Vector3<P> point = cast<P>(term.load.point);
            if (term.body < 0 || !term.load.has_point) {
                points_.push_back(term.body < 0 ? Vector3<P>() : body_of(term).center);
            } else {
                const LinkBody<P>& body = body_of(term);
                points_.push_back(at_body_point ? Vector3<P>(body.origin + body.turn * point) : point);
            }
        }
    }
    /// The same equations with constants rounded to P.
    template <class From>
    explicit FormulaTree(const FormulaTree<From>& other)
        : tree_(other.tree_), terms_(other.terms_), reads_(other.reads_), joints_(other.joints_) {
        for (const Vector3<From>& point : other.points_) points_.push_back(cast<P>(point));
    }

    const Tree<P>& tree() const { return tree_; }
    Tree<P>& tree() { return tree_; }
    const FormulaValues<P>& terms() const { return terms_; }
    FormulaValues<P>& terms() { return terms_; }
    /// By term: the point of application, from the link's origin in its axes, or a world point, m.
    std::vector<Vector3<P>>& points() { return points_; }
    /// Index of the time in the state.
    int time_index() const { return tree_.dimension(); }
    int dimension() const { return time_index() + 1 + terms_.auxiliaries(); }

    /// The state at t = 0 before any event. Auxiliaries are zero until apply_event().
    void initial(P* y) const {
        tree_.initial(y);
        for (int i = time_index(); i < dimension(); ++i) y[i] = P(0);
    }
    /// Sets the loads that act from `begin` (s) on.
    void enter_loads(const Scene& scene, double begin) {
        tree_.set_loads(scene, begin);
        terms_.enter(begin);
    }
    /// Applies the impulses at `at` (s) to y, and sets the time, the signs of all switches, and the auxiliaries.
    void apply_event(const Scene& scene, double at, P* y) {
        tree_.apply_impulses(scene, at, y);
        y[time_index()] = P(at);
        terms_.sample(
            at, [&] { return formula_state(y); }, y + time_index() + 1);
        FormulaSwitches<FormulaTree>(*this, scene.duration).resolve_signs(y);
        refresh(y);
    }
    /// Sets the auxiliaries to their values.
    void refresh(P* y) const { terms_.update_auxiliaries(formula_state(y), y + time_index() + 1); }

    /// dy/dt. Numbers take each branch by its value; traced scalars take the branches of the current signs.
    template <class S>
    void derivative(const S* y, S* dy) const {
        derivative_by(y, dy, formula::TracedScalar<S>);
    }
    /// dy/dt with the branches of the current signs if `by_signs` is set.
    template <class S>
    void derivative_by(const S* y, S* dy, bool by_signs) const {
        const int time = time_index();
        const MechanismState<S> state = formula_state(y);
        const formula::Evaluation<S, P> values = terms_.template evaluate<S>(state, y + time + 1, by_signs);
        tree_.derivative_with(y, dy, [&](TreeWork<S>& at) { add_loads(values, at); });
        dy[time] = S(1);
        for (int k = 0; k < terms_.holds(); ++k) dy[time + 1 + k] = S(0);
        if (formula::TracedScalar<S> && terms_.auxiliaries() > 0)
            terms_.auxiliary_rates(state_rates(state, dy), values, dy + time + 1);
        else
            for (int k = 0; k < terms_.auxiliaries(); ++k) dy[time + 1 + k] = S(0);
    }
    /// The reactions of the joints, then of the loops, with the branches of the current signs if `by_signs` is set.
    std::vector<Reaction<P>> reactions(const Scene& scene, const P* y, bool by_signs) const {
        const formula::Evaluation<P, P> values = terms_.template evaluate<P>(formula_state(y), nullptr, by_signs);
        return tree_.reactions_with(scene, y, [&](TreeWork<P>& at) {
            std::vector<BodyLoad<P>> applied;
            add_loads(values, at, &applied);
            return applied;
        });
    }
    /// The values of the arguments of the active switches, with the branches of the current signs.
    template <class S>
    std::vector<S> switch_arguments(const S* y) const {
        std::vector<S> all;
        if constexpr (formula::TracedScalar<S>) {
            for (const SwitchOf<P>& point : switching_points()) all.push_back(y[point.component]);
        } else {
            const formula::Evaluation<S, P> values = terms_.template evaluate<S>(formula_state(y), nullptr, true);
            for (const int which : terms_.active_switches())
                all.push_back(
                    values.value(terms_.set().auxiliaries[static_cast<std::size_t>(terms_.switch_auxiliary(which))]));
        }
        return all;
    }
    /// The rate of change of the argument of a switch, with the branches of the current signs.
    P switch_rate(int which, const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()), P(0));
        const MechanismState<P> state = formula_state(y);
        const formula::Evaluation<P, P> values = terms_.template evaluate<P>(state, nullptr, true);
        derivative_by(y, dy.data(), true);
        const std::vector<P> rates = values.compute_rates(state_rates(state, dy.data()).input.data());
        return rates[static_cast<std::size_t>(
            terms_.set().auxiliaries[static_cast<std::size_t>(terms_.switch_auxiliary(which))])];
    }
    /// Changes the sign of a switch at the state y at which its argument equals its threshold. Returns why the motion
    /// cannot be continued, or an empty string.
    std::string cross_switch(int which, P* y) {
        std::string fault = FormulaSwitches<FormulaTree>(*this, 0).cross(which, y);
        refresh(y);
        return fault;
    }
    /// The switches on which the equations depend under the current signs.
    std::vector<SwitchOf<P>> switching_points() const { return switches_of(terms_, time_index() + 1); }

    /// The formulas' inputs at a state.
    template <class S>
    MechanismState<S> formula_state(const S* y) const {
        MechanismState<S> state(tree_.links().bodies.size(), joints_);
        state.input[0] = y[time_index()];
        if (!reads_.bodies.empty()) {
            const std::vector<BodyMotion<S>> motions = tree_.motions(y);
            for (const int b : reads_.bodies) {
                const BodyMotion<S>& m = motions[static_cast<std::size_t>(b)];
                state.set_body(b, m.angular_velocity_B, m.q, m.position_W, m.velocity_W);
            }
        }
        set_joints(y, y, state);
        state.set_held(terms_.held(y + time_index() + 1));
        return state;
    }

  private:
    template <class Other>
    friend class FormulaTree;

    Tree<P> tree_;
    FormulaValues<P> terms_;
    FormulaReads reads_;
    std::size_t joints_ = 0;
    /// By term: the point of application, from the link's origin in its axes, or a world point.
    std::vector<Vector3<P>> points_;

    const LinkBody<P>& body_of(const FormulaTerm& term) const {
        return tree_.links().bodies[static_cast<std::size_t>(term.body)];
    }
    // Sets the coordinates of joints from `coordinates` and their rates from `rates`.
    template <class S>
    void set_joints(const S* coordinates, const S* rates, MechanismState<S>& state) const {
        const Links<P>& links = tree_.links();
        for (const int j : reads_.joints) {
            const int link = links.link_of_joint[static_cast<std::size_t>(j)];
            if (link < 0) continue;
            const Link<P>& own = links.links[static_cast<std::size_t>(link)];
            state.set_joint(links.bodies.size(), static_cast<std::size_t>(j), coordinates[own.coordinate],
                            rates[own.rate]);
        }
    }
    // The rates of the inputs, after dy was computed by Tree::derivative_with() at the same state.
    template <class S>
    MechanismState<S> state_rates(const MechanismState<S>& state, const S* dy) const {
        const Links<P>& links = tree_.links();
        const TreeWork<S>& at = tree_.template work<S>();
        MechanismState<S> rates(links.bodies.size(), joints_);
        rates.input[0] = S(1);
        for (const int b : reads_.bodies) {
            const LinkBody<P>& body = links.bodies[static_cast<std::size_t>(b)];
            if (body.link < 0) continue;
            const std::size_t i = static_cast<std::size_t>(body.link);
            const Vector3<S>& w = at.links[i].w;
            const Pair6<S>& acceleration = at.links[i].acceleration;
            const Vector3<S> a =
                acceleration.linear + cross(acceleration.turning, body.center) + cross(w, cross(w, body.center));
            const Vector3<S> half = (P(1) / P(2)) * state.vector(b, FormulaInputs::angular_velocity);
            rates.set_body(b, transposed_times(body.turn, acceleration.turning),
                           state.attitude(b) * Quaternion<S>{S(0), half[0], half[1], half[2]},
                           state.vector(b, FormulaInputs::velocity),
                           Vector3<S>(at.frames[i].R * a) + cast<S>(tree_.loads().gravity_W));
        }
        set_joints(dy, dy, rates);
        rates.set_held(terms_.held(dy + time_index() + 1));
        return rates;
    }
    // `applied`: loads on bodies are appended to it, those on bodies at rest included; may be null.
    template <class S>
    void add_loads(const formula::Evaluation<S, P>& values, TreeWork<S>& at,
                   std::vector<BodyLoad<S>>* applied = nullptr) const {
        for (const std::size_t i : terms_.acting()) {
            const FormulaTerm& term = terms_.set().terms[i];
            if (term.joint >= 0) {
                const int link = tree_.links().link_of_joint[static_cast<std::size_t>(term.joint)];
                Vector3<S>& force = at.links[static_cast<std::size_t>(link)].force;
                force[0] = force[0] + values.value(term.value[0]);
            } else if (const int link = body_of(term).link; link >= 0 || applied) {
                const Vector3<S> value(values.value(term.value[0]), values.value(term.value[1]),
                                       values.value(term.value[2]));
                const Pair6<S> load = load_of(term, points_[i], value, at);
                Tree<P>::add_load(at, link, load);
                if (applied) applied->push_back({term.body, link, load});
            }
        }
    }
    // The torque about the link's origin and the force of a term, in link axes.
    template <class S>
    Pair6<S> load_of(const FormulaTerm& term, const Vector3<P>& point, const Vector3<S>& value,
                     const TreeWork<S>& at) const {
        const LinkBody<P>& body = body_of(term);
        // a body at rest has world axes
        const LinkFrame<S> rest{diagonal(Vector3<S>(S(P(1)), S(P(1)), S(P(1)))), Vector3<S>()};
        const LinkFrame<S>& frame = body.link < 0 ? rest : at.frames[static_cast<std::size_t>(body.link)];
        const Vector3<S> in_link = term.load.frame == Frame::body ? Vector3<S>(body.turn * value)
                                                                  : Vector3<S>(transposed_times(frame.R, value));
        if (term.load.kind == FormulaKind::torque) return {in_link, Vector3<S>()};
        if (term.load.has_point && term.load.point_frame == Frame::world) {
            const Vector3<S> arm = transposed_times(frame.R, point - frame.x);
            return {cross(arm, in_link), in_link};
        }
        return {cross(point, in_link), in_link};
    }
};

}  // namespace polhode
