// The two formulations of the reference for a mechanism with formula loads.
//
// FormulaTreeForm: joint coordinates, from the right-hand side that all methods share (motion/formula_tree.h).
// FormulaMaximalForm: every body in maximal coordinates, with joints as constraints (integrators/maximal); the inputs
// of the formulas and their forces are computed separately. Both share the operations of the formulas. State: that of
// the formulation without formulas, then the time, then the auxiliaries (motion/formula_terms.h).
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "integrators/truth/attempt_mechanism.h"
#include "integrators/truth/formula_form.h"
#include "motion/formula_tree.h"

namespace polhode::truth {

template <class P>
class FormulaTreeForm : public FormulaTree<P> {
    using Base = FormulaTree<P>;

  public:
    static constexpr const char* name = "joint coordinates";

    /// The scene must outlive this object.
    explicit FormulaTreeForm(const Scene& scene)
        : Base(scene, compile_formulas(scene, scene.name), bodies_mass_properties<P>(scene)), scene_(&scene) {}

    /// `scales`: one per component of the tree's state.
    std::vector<Block> blocks(const std::vector<double>& scales) const {
        std::vector<Block> all = tree_blocks(this->tree(), scales);
        append_auxiliary_blocks(this->terms(), this->time_index() + 1, all);
        return all;
    }
    void enter(double begin, P* y) {
        this->enter_loads(*scene_, begin);
        this->apply_event(*scene_, begin, y);
    }
    std::string cross_switch(std::size_t which, P* y) {
        return Base::cross_switch(this->terms().active_switches().at(which), y);
    }
    MechanismMoment<P> motion(const P* y) const {
        MechanismMoment<P> moment{this->tree().motions(y), {}, {}};
        for (Motion<P>& body : moment.motions) body.q = normalized(body.q);
        for (const std::array<P, 2>& x : this->tree().joint_coordinates(y))
            moment.coordinates.push_back({static_cast<double>(x[0]), static_cast<double>(x[1])});
        return moment;
    }

  private:
    const Scene* scene_;
};

template <class P>
class FormulaMaximalForm {
    using System = maximal::System<P>;

  public:
    static constexpr const char* name = "maximal coordinates";

    /// `start`: motions of the bodies at t = 0; `coordinates`: of the joints. The scene must outlive this object.
    FormulaMaximalForm(const Scene& scene, const Motions<P>& start, std::span<const std::array<P, 2>> coordinates)
        : scene_(&scene),
          system_(scene, start, coordinates),
          terms_(compile_formulas(scene, scene.name),
                 mechanism_formula_constants<P>(scene, bodies_mass_properties<P>(scene))),
          reads_(terms_.set(), scene.bodies.size(), scene.joints.size()) {
        for (const int j : reads_.joints) {
            maximal::Link<P> link = joint(j);
            link.of = link.kind, link.kind = maximal::Kind::armature;
            accelerations_.push_back(link);
        }
    }

    int time_index() const { return system_.dimension(); }
    int dimension() const { return time_index() + 1 + terms_.auxiliaries(); }
    FormulaValues<P>& terms() { return terms_; }

    std::vector<Block> blocks(const Scales& scales) const {
        std::vector<Block> all = maximal_blocks(system_, scales);
        append_auxiliary_blocks(terms_, time_index() + 1, all);
        return all;
    }
    void initial(P* y) const {
        system_.initial(y);
        for (int i = time_index(); i < dimension(); ++i) y[i] = P(0);
    }
    void enter(double begin, P* y) {
        system_.enter(begin, y);
        terms_.enter(begin);
        y[time_index()] = P(begin);
        terms_.sample(
            begin, [&] { return formula_state(y); }, y + time_index() + 1);
        FormulaSwitches<FormulaMaximalForm>(*this, scene_->duration).resolve_signs(y);
        refresh(y);
    }
    void refresh(P* y) const { terms_.update_auxiliaries(formula_state(y), y + time_index() + 1); }
    std::vector<SwitchOf<P>> switching_points() const { return switches_of(terms_, time_index() + 1); }
    std::string cross_switch(std::size_t which, P* y) {
        std::string fault = FormulaSwitches<FormulaMaximalForm>(*this, 0).cross(terms_.active_switches().at(which), y);
        refresh(y);
        return fault;
    }
    P switch_rate(int which, const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()), P(0));
        derivative_by(y, dy.data(), true);
        const std::vector<maximal::Placement<P>> at = system_.placements(y);
        const formula::Evaluation<P, P> values = terms_.template evaluate<P>(formula_state(y), nullptr, true);
        const std::vector<P> all = values.compute_rates(state_rates(at, dy.data()).input.data());
        return all[static_cast<std::size_t>(
            terms_.set().auxiliaries[static_cast<std::size_t>(terms_.switch_auxiliary(which))])];
    }
    MechanismMoment<P> motion(const P* y) const {
        MechanismMoment<P> moment{system_.motions(y), {}, {}};
        for (Motion<P>& body : moment.motions) body.q = normalized(body.q);
        return moment;
    }

    /// The formulas' inputs at a state.
    template <class S>
    MechanismState<S> formula_state(const S* y) const {
        return formula_state(y, system_.placements(y));
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        derivative_by(y, dy, formula::TracedScalar<S>);
    }
    template <class S>
    void derivative_by(const S* y, S* dy, bool by_signs) const {
        const int time = time_index();
        const std::vector<maximal::Placement<S>> at = system_.placements(y);
        const MechanismState<S> state = formula_state(y, at);
        const formula::Evaluation<S, P> values = terms_.template evaluate<S>(state, y + time + 1, by_signs);
        const maximal::Rows<S> rows = system_.dynamics().constraints(at);
        std::vector<maximal::Wrench<S>> on(at.size());
        maximal::add_forces(system_.mechanism(), system_.loads(), at, y + system_.angles(), on);
        add_formulas(values, at, on);
        system_.dynamics().add_constraint_forces(rows, system_.dynamics().multipliers(at, rows, on), on);
        system_.put_rates(at, on, dy);
        dy[time] = S(1);
        for (int k = 0; k < terms_.holds(); ++k) dy[time + 1 + k] = S(0);
        if (formula::TracedScalar<S> && terms_.auxiliaries() > 0)
            terms_.auxiliary_rates(state_rates(at, dy), values, dy + time + 1);
        else
            for (int k = 0; k < terms_.auxiliaries(); ++k) dy[time + 1 + k] = S(0);
    }

  private:
    const Scene* scene_;
    System system_;
    FormulaValues<P> terms_;
    FormulaReads reads_;
    std::vector<maximal::Link<P>> accelerations_;  // by joint that formulas read: rows of its coordinate's acceleration

    const maximal::Link<P>& joint(int j) const { return system_.mechanism().links[static_cast<std::size_t>(j)]; }

    template <class S>
    MechanismState<S> formula_state(const S* y, const std::vector<maximal::Placement<S>>& at) const {
        MechanismState<S> state(scene_->bodies.size(), scene_->joints.size());
        state.input[0] = y[time_index()];
        for (const int b : reads_.bodies) {
            const maximal::Placement<S>& body = at[static_cast<std::size_t>(b)];
            state.set_body(b, body.angular_velocity_B, body.q, body.position_W, body.velocity_W);
        }
        for (const int j : reads_.joints) {
            const maximal::LinkView<P, S> view = system_.view(joint(j), at);
            const S x = joint(j).angles >= 0 ? y[system_.angles() + joint(j).angles] : view.displacement();
            state.set_joint(scene_->bodies.size(), static_cast<std::size_t>(j), x, view.rates()[0]);
        }
        state.set_held(terms_.held(y + time_index() + 1));
        return state;
    }
    template <class S>
    void add_formulas(const formula::Evaluation<S, P>& values, const std::vector<maximal::Placement<S>>& at,
                      std::vector<maximal::Wrench<S>>& on) const {
        for (const std::size_t i : terms_.acting()) {
            const FormulaTerm& term = terms_.set().terms[i];
            const FormulaLoad& load = term.load;
            if (term.joint >= 0) {
                const maximal::Link<P>& link = joint(term.joint);
                const maximal::Row<S> row = system_.view(link, at).coordinate_rows()[0];
                const S size = values.value(term.value[0]);
                on[static_cast<std::size_t>(link.to.body)].add_to(row, size);
                on[static_cast<std::size_t>(link.from.body)].add_from(row, size);
                continue;
            }
            const maximal::Placement<S>& body = at[static_cast<std::size_t>(term.body)];
            maximal::Wrench<S>& sum = on[static_cast<std::size_t>(term.body)];
            const Vector3<S> value(values.value(term.value[0]), values.value(term.value[1]),
                                   values.value(term.value[2]));
            if (load.kind == FormulaKind::torque) {
                Vector3<S>& torque = load.frame == Frame::body ? sum.torque_B : sum.torque_W;
                torque = torque + value;
                continue;
            }
            const Vector3<S> force_W = load.frame == Frame::body ? body.world(value) : value;
            sum.force_W = sum.force_W + force_W;
            if (!load.has_point) continue;
            const Vector3<S> arm_W = load.point_frame == Frame::world
                                         ? Vector3<S>(cast<P>(load.point) - body.position_W)
                                         : Vector3<S>(body.world(system_.mechanism().arm(term.body, load.point)));
            sum.torque_W = sum.torque_W + cross(arm_W, force_W);
        }
    }
    // Accelerations of a body's centre of mass, world axes, and of its rotation, body axes, from the rates of momenta.
    template <class S>
    struct Acceleration {
        Vector3<S> linear_W, turning_B;
    };
    template <class S>
    Acceleration<S> acceleration_of(int b, const std::vector<maximal::Placement<S>>& at, const S* dy) const {
        const int first = b < system_.mechanism().world() ? system_.place(b) : -1;
        if (first < 0) return {};
        const maximal::MaximalBody<P>& body = system_.mechanism().bodies[static_cast<std::size_t>(b)];
        const maximal::Placement<S>& placement = at[static_cast<std::size_t>(b)];
        const Vector3<S>& w = placement.angular_velocity_B;
        const Vector3<S> torque_B = placement.body(vector_at(dy, first + 7)) - cross(w, body.inertia * w);
        return {(P(1) / body.mass) * vector_at(dy, first + 10), body.inverse_inertia * torque_B};
    }
    template <class S>
    MechanismState<S> state_rates(const std::vector<maximal::Placement<S>>& at, const S* dy) const {
        MechanismState<S> rates(scene_->bodies.size(), scene_->joints.size());
        rates.input[0] = S(1);
        for (const int b : reads_.bodies) {
            if (system_.place(b) < 0) continue;
            const Acceleration<S> a = acceleration_of(b, at, dy);
            rates.set_body(b, a.turning_B, quaternion_at(dy, system_.place(b)),
                           at[static_cast<std::size_t>(b)].velocity_W, a.linear_W);
        }
        for (std::size_t i = 0; i < reads_.joints.size(); ++i) {
            const maximal::Link<P>& link = accelerations_[i];
            const maximal::Row<S> row = system_.view(link, at).constraints()[0];
            const Acceleration<S> to = acceleration_of(link.to.body, at, dy),
                                  from = acceleration_of(link.from.body, at, dy);
            const S along = dot(row.force_W, to.linear_W - from.linear_W) + dot(row.to_B, to.turning_B) +
                            dot(row.from_B, from.turning_B) + row.bias;
            const S rate = system_.view(joint(reads_.joints[i]), at).rates()[0];
            rates.set_joint(scene_->bodies.size(), static_cast<std::size_t>(reads_.joints[i]), rate, along);
        }
        rates.set_held(terms_.held(dy + time_index() + 1));
        return rates;
    }
};

}  // namespace polhode::truth
