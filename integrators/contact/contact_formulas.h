// Formula loads of one body in contact with planes.
//
// The state of some contact modes (reduced_form.h) lacks the velocity, so the caller passes the inputs of the formulas.
// Recorded equations have one variable for each transcendental function of the formulas (motion/formula_terms.h). These
// variables are the last ones of the state. Formulas with switching points are not supported.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "motion/formula_terms.h"

namespace polhode::contact {

/// The formula loads of a body: their forces and torques at a state, and the variables of recorded equations.
template <class P>
class ContactFormulas {
  public:
    /// Without formula loads, act() is false.
    ContactFormulas(const Scene& scene, const ExactBody<P>& body) : inverse_mass_(P(1) / body.mass) {
        if (!has_formula_loads(scene)) return;
        terms_.emplace(compile_formulas(scene, scene.name), scene, body, mass_properties<P>(scene.body).inertia);
        held_.assign(static_cast<std::size_t>(terms_->holds()), P(0));
    }

    /// Whether there are formula loads.
    bool act() const { return terms_.has_value(); }
    /// The number of variables of recorded equations.
    int auxiliaries() const { return terms_ ? terms_->auxiliaries() - terms_->holds() : 0; }

    /// Sets the loads that act from `begin` (s) on, and samples the values that are held.
    void enter(double begin, const Vector3<P>& w_B, const Quaternion<P>& q, const Vector3<P>& p_W,
               const Vector3<P>& v_W) {
        if (!terms_) return;
        terms_->enter(begin);
        terms_->sample(
            begin, [&] { return state(P(begin), w_B, q, p_W, v_W); }, held_.data());
    }
    /// Time and state as inputs.
    template <class S>
    FormulaState<S> state(const S& t, const Vector3<S>& w_B, const Quaternion<S>& q, const Vector3<S>& p_W,
                          const Vector3<S>& v_W) const {
        FormulaState<S> result(t, w_B, q, p_W, v_W);
        for (const P& held : held_) result.input.push_back(S(0) * t + held);
        return result;
    }
    /// The rates of the inputs, given the rates of the state.
    template <class S>
    FormulaState<S> rates(const Vector3<S>& w_B, const Quaternion<S>& q, const Vector3<S>& p_W,
                          const Vector3<S>& v_W) const {
        FormulaState<S> result(S(1), w_B, q, p_W, v_W);
        result.input.resize(result.input.size() + held_.size(), S(0));
        return result;
    }
    /// All values of the formulas at a state.
    template <class S>
    using Values = std::optional<formula::Evaluation<S, P>>;
    /// Adds the loads at a state. `variables`: those of recorded equations.
    template <class S>
    void add(const FormulaState<S>& now, const S* variables, Values<S>& values, Vector3<S>& torque_B,
             Vector3<S>& acceleration_W) const {
        values.emplace(terms_->template evaluate<S>(now, first(variables)));
        const FormulaWrench<S> wrench = terms_->wrench(now, *values);
        torque_B = torque_B + wrench.torque_B;
        acceleration_W = acceleration_W + inverse_mass_ * wrench.force_W;
    }
    /// The rates of the variables of recorded equations, times `pace`; zero for numbers.
    template <class S>
    void variable_rates(const FormulaState<S>& rates, const Values<S>& values, const S& pace, S* to) const {
        const int count = auxiliaries();
        std::vector<S> all(static_cast<std::size_t>(terms_->auxiliaries()), S(0));
        terms_->auxiliary_rates(rates, *values, all.data());
        for (int k = 0; k < count; ++k)
            to[k] = pace * all[static_cast<std::size_t>(terms_->holds()) + static_cast<std::size_t>(k)];
    }
    /// Sets the variables of recorded equations to their values.
    void update(const FormulaState<P>& now, P* variables) const {
        if (auxiliaries() == 0) return;
        std::vector<P> all(static_cast<std::size_t>(terms_->auxiliaries()));
        terms_->update_auxiliaries(now, all.data());
        std::copy(all.begin() + terms_->holds(), all.end(), variables);
    }

  private:
    P inverse_mass_;
    std::optional<FormulaTerms<P>> terms_;
    std::vector<P> held_;  // the values that are held

    // evaluate() expects the values that are held before the variables, but reads them from the state. Numbers have no
    // variables.
    template <class S>
    const S* first(const S* variables) const {
        return variables ? variables - terms_->holds() : nullptr;
    }
};

}  // namespace polhode::contact
