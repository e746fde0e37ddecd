// Switches of formula loads in a mechanism whose joints have limits, friction or prescribed motions (follow_joints.h).
//
// The sign of a switch changes where its argument passes the threshold, which is an event, and where velocities jump. A
// switch whose argument is at the threshold has the sign 0 until the modes of the joints are known; then it takes the
// sign of the side to which it moves, or keeps 0 if it stays there (motion/formula_switches.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "body/elementary.h"
#include "motion/formula_switches.h"

namespace polhode::contact {

/// `Form`: JointTreeForm, or a formulation with the same functions.
template <class P, class Form>
class JointSwitches {
  public:
    /// `duration`: of the run, s. `error`: relative to the largest value of an argument; a smaller distance from the
    /// threshold is zero.
    JointSwitches(double duration, double error) : duration_(duration), error_(error) {}

    /// Sets the signs to those of the values at y, where velocities may have jumped.
    void set_signs(Form& form, P* y) {
        if (!form.has_formulas()) return;
        form.terms().set_signs(form.formula_state(y));
        form.refresh(y);
        const std::vector<int> active = form.terms().active_switches();
        const std::vector<P> values = form.switch_values(y);
        for (std::size_t k = 0; k < active.size(); ++k)
            if (is_zero(active[k], P(values[k] - form.terms().switch_threshold(active[k])), values[k]))
                form.terms().set_sign(active[k], 0);
        form.refresh(y);
    }
    /// The largest argument or threshold of a switch so far.
    double largest(int which) const {
        const std::size_t i = static_cast<std::size_t>(which);
        return i < largest_.size() ? largest_[i] : 0;
    }
    /// Changes the sign of the k-th active switch. Returns the fault, or an empty string.
    std::string cross(Form& form, std::size_t k, P* y) {
        Base base{form};
        std::string fault = FormulaSwitches<Base>(base, duration_).cross(form.terms().active_switches().at(k), y);
        form.refresh(y);
        return fault;
    }
    /// Whether the distance of an argument from its threshold is zero.
    bool is_zero(int which, const P& distance, const P& value) {
        const std::size_t i = static_cast<std::size_t>(which);
        if (largest_.size() <= i) largest_.resize(i + 1, 0.0);
        largest_[i] = std::max(
            {largest_[i], std::abs(static_cast<double>(value)), std::abs(static_cast<double>(P(value - distance)))});
        return !(Elementary<P>::magnitude(distance) > P(error_ * largest_[i]));
    }

  private:
    // the formulation without functions
    struct Base {
        Form& form;
        auto& terms() { return form.terms(); }
        auto formula_state(const P* y) const { return form.formula_state(y); }
        int dimension() const { return form.base_dimension(); }
        void derivative_by(const P* y, P* dy, bool) const { form.base_derivative(y, dy); }
        P switch_rate(int which, const P* y) const { return form.switch_rate(which, y); }
    };
    double duration_, error_;
    std::vector<double> largest_;  // by switch: the largest argument or threshold so far
};

}  // namespace polhode::contact
