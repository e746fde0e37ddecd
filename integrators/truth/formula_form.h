// The two formulations of the reference for one body with formula loads.
//
// FormulaEulerForm: Euler's equations in body axes, from the right-hand side that all methods share
// (motion/formula_body.h). FormulaMomentumForm: momenta in world axes (momentum_form.h), with forces and torques
// assembled separately from the values of the formulas. Both share the operations of the formulas. State: that of the
// formulation without formulas, then the time, then the auxiliaries (motion/formula_terms.h).
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/momentum_form.h"
#include "integrators/truth/reference.h"
#include "motion/exact_body_of.h"
#include "motion/formula_body.h"
#include "motion/formula_potential.h"

namespace polhode::truth {

/// Appends a block for each held value and auxiliary. Auxiliaries have any unit and size; their scale grows with their
/// size.
template <class P>
void append_auxiliary_blocks(const FormulaValues<P>& terms, int first, std::vector<Block>& blocks) {
    for (int k = 0; k < terms.auxiliaries(); ++k) blocks.push_back({first + k, 1, 1});
}

/// Adds the potentials that are formulas to the energies, which contain those of all other loads.
template <class P>
void add_formula_potentials(Reference& reference, const Scene& scene, const std::vector<double>& times,
                            const std::vector<Motion<P>>& motions) {
    if (!has_formula_potential(scene)) return;
    for (std::size_t i = 0; i < reference.samples.size(); ++i) {
        ReferenceSample& sample = reference.samples[i];
        const P energy = P(sample.energy.high) + P(sample.energy.low) +
                         formula_potential<P>(scene, times[i], motions[i].q, motions[i].position_W);
        sample.energy = pair_of(energy);
    }
}

template <class P>
class FormulaEulerForm : public FormulaBody<P> {
    using Base = FormulaBody<P>;

  public:
    static constexpr const char* name = "Euler form";

    explicit FormulaEulerForm(const Scene& scene)
        : Base(scene, compile_formulas(scene, scene.name), exact_body<P>(scene),
               mass_properties<P>(scene.body).inertia),
          scene_(&scene) {}

    std::vector<Block> blocks(const Scales& scales, const Vector3<double>&) const {
        const double size[] = {scales.angular_velocity, 1, scales.position, scales.velocity};
        std::vector<Block> all;
        for (std::size_t b = 0; b < (this->body().pivoted ? 2 : BodyState::blocks.size()); ++b)
            all.push_back({BodyState::blocks[b].first, BodyState::blocks[b].size, size[b]});
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
    Motion<P> motion(const P* y) const {
        Motion<P> m;
        m.q = normalized(BodyState::attitude(y));
        m.angular_velocity_B = BodyState::angular_velocity(y);
        if (this->body().pivoted)
            pivoted_center(m.q, m.angular_velocity_B, this->body().arm, m.position_W, m.velocity_W);
        else
            m.position_W = BodyState::position(y), m.velocity_W = BodyState::velocity(y);
        return m;
    }

  private:
    const Scene* scene_;
};

template <class P>
class FormulaMomentumForm : public MomentumForm<P> {
    using Base = MomentumForm<P>;

  public:
    explicit FormulaMomentumForm(const Scene& scene)
        : Base(scene),
          scene_(&scene),
          body_(exact_body<P>(scene)),
          inverse_inertia_(inverse(body_.inertia_B)),
          terms_(compile_formulas(scene, scene.name), scene, body_, mass_properties<P>(scene.body).inertia) {}

    int time_index() const { return Base::dimension(); }
    int dimension() const { return time_index() + 1 + terms_.auxiliaries(); }

    std::vector<Block> blocks(const Scales& scales, const Vector3<double>& moments) const {
        std::vector<Block> all = Base::blocks(scales, moments);
        append_auxiliary_blocks(terms_, time_index() + 1, all);
        return all;
    }
    void initial(P* y) const {
        Base::initial(y);
        for (int i = time_index(); i < dimension(); ++i) y[i] = P(0);
    }
    void enter(double begin, P* y) {
        Base::enter(begin, y);
        terms_.enter(begin);
        y[time_index()] = P(begin);
        terms_.sample(
            begin, [&] { return formula_state(y); }, y + time_index() + 1);
        FormulaSwitches<FormulaMomentumForm>(*this, scene_->duration).resolve_signs(y);
        refresh(y);
    }
    void refresh(P* y) const { terms_.update_auxiliaries(formula_state(y), y + time_index() + 1); }

    FormulaTerms<P>& terms() { return terms_; }
    const FormulaTerms<P>& terms() const { return terms_; }
    /// The formulas' inputs at a state.
    template <class S>
    FormulaState<S> formula_state(const S* y) const {
        return formula_state(y, y + time_index() + 1);
    }
    template <class S>
    FormulaState<S> formula_state(const S* y, const S* variables) const {
        Vector3<S> p, v;
        if (!scene_->pivot) p = vector_at(y, 7), v = (P(1) / body_.mass) * vector_at(y, 10);
        return {y[time_index()], angular_velocity_B(y), quaternion_at(y, 3), p, v, terms_.held(variables)};
    }
    std::vector<SwitchOf<P>> switching_points() const { return switches_of(terms_, time_index() + 1); }
    std::string cross_switch(std::size_t which, P* y) {
        std::string fault = FormulaSwitches<FormulaMomentumForm>(*this, 0).cross(terms_.active_switches().at(which), y);
        refresh(y);
        return fault;
    }
    P switch_rate(int which, const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()), P(0));
        derivative_by(y, dy.data(), true);
        const FormulaState<P> now = formula_state(y);
        const Matrix3<P> axes = rotation_matrix(quaternion_at(y, 3));
        const formula::Evaluation<P, P> values = terms_.template evaluate<P>(now, nullptr, true);
        const std::vector<P> all =
            values.compute_rates(rates(now, axes, dy.data(), dy.data() + time_index() + 1).input.data());
        return all[static_cast<std::size_t>(
            terms_.set().auxiliaries[static_cast<std::size_t>(terms_.switch_auxiliary(which))])];
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        derivative_by(y, dy, formula::TracedScalar<S>);
    }
    template <class S>
    void derivative_by(const S* y, S* dy, bool by_signs) const {
        const int time = time_index();
        const formula::Evaluation<S, P> values = load_rates(y, y + time + 1, dy, by_signs);
        dy[time] = S(1);
        variable_rates(y, y + time + 1, values, dy, dy + time + 1);
    }
    /// The rates of the base's state by all loads. `variables`: held values and auxiliaries, wherever they are.
    template <class S>
    formula::Evaluation<S, P> load_rates(const S* y, const S* variables, S* dy,
                                         bool by_signs = formula::TracedScalar<S>) const {
        Base::derivative(y, dy);
        const FormulaState<S> now = formula_state(y, variables);
        formula::Evaluation<S, P> values = terms_.template evaluate<S>(now, variables, by_signs);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Matrix3<S> axes = rotation_matrix(q);
        Vector3<S> torque_W = vector_at(dy, 0), force_W;
        for (const std::size_t i : terms_.acting()) {
            const FormulaTerm& term = terms_.set().terms[i];
            const FormulaLoad& load = term.load;
            const Vector3<S> value = vector_of(values, term.value);
            if (load.kind == FormulaKind::potential) {
                force_W = force_W + value;
                torque_W = torque_W + axes * vector_of(values, term.torque_B);
                continue;
            }
            const Vector3<S> value_W = load.frame == Frame::world ? value : axes * value;
            if (load.kind == FormulaKind::torque) {
                torque_W = torque_W + value_W;
                continue;
            }
            force_W = force_W + value_W;
            if (load.has_point || scene_->pivot) torque_W = torque_W + cross(arm_W(load, axes, now), value_W);
        }
        put(dy, 0, torque_W);
        if (!scene_->pivot) put(dy, 10, vector_at(dy, 10) + force_W);
        return values;
    }
    /// The rates of the variables, given those of the base's state in `dy`.
    template <class S>
    void variable_rates(const S* y, const S* variables, const formula::Evaluation<S, P>& values, const S* dy,
                        S* to) const {
        for (int k = 0; k < terms_.auxiliaries(); ++k) to[k] = S(0);
        if (!formula::TracedScalar<S> || terms_.auxiliaries() == 0) return;
        const Matrix3<S> axes = rotation_matrix(quaternion_at(y, 3));
        terms_.auxiliary_rates(rates(formula_state(y, variables), axes, dy, to), values, to);
    }

  private:
    const Scene* scene_;
    ExactBody<P> body_;
    Matrix3<P> inverse_inertia_;
    FormulaTerms<P> terms_;

    template <class S>
    static Vector3<S> vector_of(const formula::Evaluation<S, P>& values, const std::array<int, 3>& node) {
        return {values.value(node[0]), values.value(node[1]), values.value(node[2])};
    }
    // from the point that L refers to, to the point of application
    template <class S>
    Vector3<S> arm_W(const FormulaLoad& load, const Matrix3<S>& axes, const FormulaState<S>& now) const {
        if (!load.has_point) return axes * body_.arm;
        if (load.point_frame == Frame::world) return cast<P>(load.point) - now.position();
        return axes * (cast<P>(load.point) - body_.origin);
    }
    template <class S>
    Vector3<S> angular_velocity_B(const S* y) const {
        return inverse_inertia_ * (transposed(rotation_matrix(quaternion_at(y, 3))) * vector_at(y, 0));
    }
    // I dw/dt = R^T dL/dt - w x I w
    template <class S>
    FormulaState<S> rates(const FormulaState<S>& now, const Matrix3<S>& axes, const S* dy,
                          const S* variable_rates) const {
        constexpr int w = FormulaInputs::angular_velocity;
        const Vector3<S> w_B(now.input[w], now.input[w + 1], now.input[w + 2]);
        const Vector3<S> torque_B = transposed(axes) * vector_at(dy, 0) - cross(w_B, body_.inertia_B * w_B);
        Vector3<S> p, v;
        if (!scene_->pivot) p = vector_at(dy, 7), v = (P(1) / body_.mass) * vector_at(dy, 10);
        return {S(1), inverse_inertia_ * torque_B, quaternion_at(dy, 3), p, v, terms_.held(variable_rates)};
    }
};

}  // namespace polhode::truth
