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

#include "integrators/maximal/formulas.h"
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
        MechanismMoment<P> moment{this->tree().motions(y), this->reactions(*scene_, y, true), {}};
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
        : scene_(&scene), system_(scene, start, coordinates), formulas_(scene, system_) {}

    int time_index() const { return system_.dimension(); }
    int dimension() const { return time_index() + 1 + terms().auxiliaries(); }
    FormulaValues<P>& terms() { return formulas_.terms(); }
    const FormulaValues<P>& terms() const { return formulas_.terms(); }

    std::vector<Block> blocks(const Scales& scales) const {
        std::vector<Block> all = maximal_blocks(system_, scales);
        append_auxiliary_blocks(terms(), time_index() + 1, all);
        return all;
    }
    void initial(P* y) const {
        system_.initial(y);
        for (int i = time_index(); i < dimension(); ++i) y[i] = P(0);
    }
    void enter(double begin, P* y) {
        system_.enter(begin, y);
        terms().enter(begin);
        y[time_index()] = P(begin);
        terms().sample(
            begin, [&] { return formula_state(y); }, y + time_index() + 1);
        FormulaSwitches<FormulaMaximalForm>(*this, scene_->duration).resolve_signs(y);
        refresh(y);
    }
    void refresh(P* y) const { terms().update_auxiliaries(formula_state(y), y + time_index() + 1); }
    std::vector<SwitchOf<P>> switching_points() const { return switches_of(terms(), time_index() + 1); }
    std::string cross_switch(std::size_t which, P* y) {
        std::string fault = FormulaSwitches<FormulaMaximalForm>(*this, 0).cross(terms().active_switches().at(which), y);
        refresh(y);
        return fault;
    }
    P switch_rate(int which, const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()), P(0));
        derivative_by(y, dy.data(), true);
        const std::vector<maximal::Placement<P>> at = system_.placements(y);
        const formula::Evaluation<P, P> values = terms().template evaluate<P>(formula_state(y), nullptr, true);
        const std::vector<P> all =
            values.compute_rates(formulas_.state_rates(system_, at, dy.data(), time_index() + 1).input.data());
        return all[static_cast<std::size_t>(
            terms().set().auxiliaries[static_cast<std::size_t>(terms().switch_auxiliary(which))])];
    }
    MechanismMoment<P> motion(const P* y) const {
        MechanismMoment<P> moment{system_.motions(y), reactions(y), {}};
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
        const formula::Evaluation<S, P> values = terms().template evaluate<S>(state, y + time + 1, by_signs);
        const maximal::Rows<S> rows = system_.dynamics().constraints(at);
        std::vector<maximal::Wrench<S>> on(at.size());
        maximal::add_forces(system_.mechanism(), system_.loads(), at, y + system_.angles(), on);
        formulas_.add(system_, values, at, on);
        system_.dynamics().add_constraint_forces(rows, system_.dynamics().multipliers(at, rows, on), on);
        system_.put_rates(at, on, dy);
        dy[time] = S(1);
        for (int k = 0; k < terms().holds(); ++k) dy[time + 1 + k] = S(0);
        if (formula::TracedScalar<S> && terms().auxiliaries() > 0)
            terms().auxiliary_rates(formulas_.state_rates(system_, at, dy, time + 1), values, dy + time + 1);
        else
            for (int k = 0; k < terms().auxiliaries(); ++k) dy[time + 1 + k] = S(0);
    }

  private:
    const Scene* scene_;
    System system_;
    maximal::Formulas<P> formulas_;

    std::vector<Reaction<P>> reactions(const P* y) const {
        const std::vector<maximal::Placement<P>> at = system_.placements(y);
        const formula::Evaluation<P, P> values = terms().template evaluate<P>(formula_state(y, at), nullptr, true);
        const maximal::Rows<P> rows = system_.dynamics().constraints(at);
        std::vector<maximal::Wrench<P>> on(at.size());
        maximal::add_forces(system_.mechanism(), system_.loads(), at, y + system_.angles(), on);
        formulas_.add(system_, values, at, on);
        const std::vector<P> lambda = system_.dynamics().multipliers(at, rows, on);
        return formulas_.reactions(system_, values, y, lambda.data());
    }
    template <class S>
    MechanismState<S> formula_state(const S* y, const std::vector<maximal::Placement<S>>& at) const {
        return formulas_.state(system_, y, at, time_index(), time_index() + 1);
    }
};

}  // namespace polhode::truth
