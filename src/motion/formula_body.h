// The equations of one body with formula loads over any scalar, in body axes with the full inertia tensor.
//
// State: w (body axes), q, without a pivot also p and v; then the time; then held values and auxiliaries
// (formula_terms.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motion/body_equations.h"
#include "motion/formula_switches.h"
#include "motion/formula_terms.h"
#include "motion/rounded.h"

namespace polhode {

template <class P>
class FormulaBody : public BodyState {
  public:
    FormulaBody(const Scene& scene, std::shared_ptr<const FormulaSet> formulas, const ExactBody<P>& body,
                const Matrix3<P>& center_inertia)
        : body_(body),
          inertia_{body_.inertia_B, inverse(body_.inertia_B)},
          principal_(principal_inertia(body_.inertia_B)),
          terms_(std::move(formulas), scene, body_, center_inertia) {}
    /// The same equations with constants rounded to P.
    template <class From>
    explicit FormulaBody(const FormulaBody<From>& other)
        : inertia_(rounded<P>(other.inertia_)), forcing_(rounded<P>(other.forcing_)), terms_(other.terms_) {
        if (other.principal_) principal_ = rounded<P>(*other.principal_);
        const ExactBody<From>& b = other.body_;
        body_.mass = P(b.mass), body_.inertia_B = cast<P>(b.inertia_B), body_.pivoted = b.pivoted;
        body_.center = cast<P>(b.center), body_.origin = cast<P>(b.origin), body_.arm = cast<P>(b.arm);
        body_.q = cast<P>(b.q), body_.angular_velocity_B = cast<P>(b.angular_velocity_B);
        body_.position_W = cast<P>(b.position_W), body_.velocity_W = cast<P>(b.velocity_W);
    }

    const ExactBody<P>& body() const { return body_; }
    const FormulaTerms<P>& terms() const { return terms_; }
    /// Index of the time in the state.
    int time_index() const { return body_.pivoted ? BodyState::rotation : BodyState::motion; }
    int dimension() const { return time_index() + 1 + terms_.auxiliaries(); }

    /// The state at t = 0 before any event. Auxiliaries are zero until enter().
    void initial(P* y) const {
        set_rotation(y, body_.angular_velocity_B, body_.q);
        if (!body_.pivoted) set_translation(y, body_.position_W, body_.velocity_W);
        for (int i = time_index(); i < dimension(); ++i) y[i] = P(0);
    }

    /// Sets the loads that act from `begin` (s) on.
    void enter_loads(const Scene& scene, double begin) {
        forcing_ = forcing_at<P>(scene, body_, begin, Quaternion<P>{});
        terms_.enter(begin);
    }
    /// Applies the impulses at `at` (s) to y, and sets the time, the signs of all switches, and the auxiliaries.
    void apply_event(const Scene& scene, double at, P* y) {
        for (const PosedImpulse<P>& impulse : impulses_at<P>(scene, body_, at, Quaternion<P>{})) {
            Vector3<P> w = angular_velocity(y), p, v;
            const Quaternion<P> q = attitude(y);
            if (!body_.pivoted) p = position(y), v = velocity(y);
            apply(impulse, inertia_, body_.mass, body_.pivoted, w, q, p, v);
            set_rotation(y, w, q);
            if (!body_.pivoted) set_translation(y, p, v);
        }
        y[time_index()] = P(at);
        terms_.sample(
            at, [&] { return formula_state(y); }, y + time_index() + 1);
        FormulaSwitches<FormulaBody>(*this, scene.duration).resolve_signs(y);
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
        const FormulaState<S> state = formula_state(y);
        const int time = time_index();
        const formula::Evaluation<S, P> values = terms_.template evaluate<S>(state, y + time + 1, by_signs);
        const FormulaWrench<S> wrench = terms_.wrench(state, values);
        if (principal_)
            body_rates(*principal_, y, dy, wrench.torque_B);
        else
            body_rates(inertia_, y, dy, wrench.torque_B);
        if (!body_.pivoted) put(dy, 10, vector_at(dy, 10) + (P(1) / body_.mass) * wrench.force_W);
        dy[time] = S(1);
        for (int k = 0; k < terms_.holds(); ++k) dy[time + 1 + k] = S(0);
        terms_.auxiliary_rates(formula_state(dy), values, dy + time + 1);
    }
    /// The rate of change of the argument of a switch, with the branches of the current signs.
    P switch_rate(int which, const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()), P(0));
        derivative_by(y, dy.data(), true);
        const formula::Evaluation<P, P> values = terms_.template evaluate<P>(formula_state(y), nullptr, true);
        const std::vector<P> rates = values.compute_rates(formula_state(dy.data()).input.data());
        return rates[static_cast<std::size_t>(
            terms_.set().auxiliaries[static_cast<std::size_t>(terms_.switch_auxiliary(which))])];
    }
    /// Changes the sign of a switch at the state y at which its argument equals its threshold. Returns why the motion
    /// cannot be continued, or an empty string.
    std::string cross_switch(int which, P* y) {
        std::string fault = FormulaSwitches<FormulaBody>(*this, 0).cross(which, y);
        refresh(y);
        return fault;
    }
    /// The switches on which the equations depend under the current signs.
    std::vector<SwitchOf<P>> switching_points() const { return switches_of(terms_, time_index() + 1); }
    /// The formulas' inputs at a state. Formulas of a body with a pivot read p and v as functions of q and w, so these
    /// inputs are zero.
    template <class S>
    FormulaState<S> formula_state(const S* y) const {
        Vector3<S> p, v;
        if (!body_.pivoted) p = position(y), v = velocity(y);
        return {y[time_index()], angular_velocity(y), attitude(y), p, v, terms_.held(y + time_index() + 1)};
    }
    FormulaTerms<P>& terms() { return terms_; }

    /// Position (m) and velocity (m/s) of the centre of mass, world axes.
    void center(const P* y, Vector3<P>& p, Vector3<P>& v) const {
        if (body_.pivoted)
            pivoted_center(attitude(y), angular_velocity(y), body_.arm, p, v);
        else
            p = position(y), v = velocity(y);
    }

  private:
    template <class Other>
    friend class FormulaBody;

    ExactBody<P> body_;
    FullInertia<P> inertia_;
    std::optional<PrincipalInertia<P>> principal_;  ///< if the axes are principal axes
    Forcing<P> forcing_;
    FormulaTerms<P> terms_;

    template <class S, class Inertia>
    void body_rates(const Inertia& inertia, const S* y, S* dy, const Vector3<S>& torque_B) const {
        if (body_.pivoted)
            LoadedEquations<P, Inertia, false>{inertia, &forcing_}.derivative(0, y, dy);
        else
            LoadedEquations<P, Inertia, true>{inertia, &forcing_}.derivative(0, y, dy);
        put(dy, 0, vector_at(dy, 0) + inertia.response(torque_B));
    }
    static std::optional<PrincipalInertia<P>> principal_inertia(const Matrix3<P>& tensor) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (i != j && !(tensor[i][j] == P(0))) return {};
        const P &a = tensor[0][0], &b = tensor[1][1], &c = tensor[2][2];
        return PrincipalInertia<P>{
            {(b - c) / a, (c - a) / b, (a - b) / c}, {P(1) / a, P(1) / b, P(1) / c}, a == b && b == c};
    }
};

}  // namespace polhode
