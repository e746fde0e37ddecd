// The signs of switches at events: at the start of a leg, and where the argument of a switch passes its threshold.
//
// A switch crosses its threshold if the rate of its argument points to the new side under the equations of that side.
// If it points back, the motion would slide along the switching surface, changing the sign at every instant
// (chattering). This ends the run.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace polhode {

/// The name of the fault of a motion that slides along a switching surface.
inline std::string sliding_fault(const std::string& text) {
    return fmt::format("chattering: the motion slides along the switching surface of \"{}\"", text);
}

/// Sets the signs of the switches of a formulation: a FormulaBody, or one with the same functions.
template <class Form>
class FormulaSwitches {
  public:
    /// `duration` (s): of the run.
    FormulaSwitches(Form& form, double duration) : form_(form), duration_(duration) {}

    /// Sets all signs at the start of a leg. A switch whose argument equals its threshold takes the sign of the side to
    /// which it moves. Its sign is 0 if it stays there, or if it moves to neither side.
    template <class P>
    void resolve_signs(P* y) {
        form_.terms().set_signs(form_.formula_state(y));
        const std::vector<int> active = form_.terms().active_switches();
        for (const int which : active) {
            if (form_.terms().sign(which) != 0) continue;
            for (const int sign : {1, -1}) {
                form_.terms().set_sign(which, sign);
                if (sign * direction(which, y) > 0) break;
                form_.terms().set_sign(which, 0);
            }
        }
    }
    /// Changes a sign at a crossing. Returns the fault, or an empty string.
    template <class P>
    std::string cross(int which, P* y) {
        const int sign = -form_.terms().sign(which);
        // switches on the new branch take the signs of their values
        const std::vector<int> active = form_.terms().active_switches();
        std::vector<int> kept;
        for (const int other : active) kept.push_back(form_.terms().sign(other));
        form_.terms().set_signs(form_.formula_state(y));
        for (std::size_t i = 0; i < active.size(); ++i) form_.terms().set_sign(active[i], kept[i]);
        form_.terms().set_sign(which, sign);
        const P rate = form_.switch_rate(which, y);
        const bool moves_back = sign > 0 ? rate < 0 : rate > 0;
        return moves_back || sign == 0 ? sliding_fault(form_.terms().switch_text(which)) : "";
    }

  private:
    Form& form_;
    double duration_;

    // The sign of the rate of the argument; if the rate vanishes, that of the rate a short time later.
    template <class P>
    int direction(int which, const P* y) const {
        const auto sign_of = [](const P& x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
        const int now = sign_of(form_.switch_rate(which, y));
        if (now != 0) return now;
        const std::size_t n = static_cast<std::size_t>(form_.dimension());
        std::vector<P> later(y, y + n), dy(n, P(0));
        form_.derivative_by(y, dy.data(), true);
        const P h = P(duration_) * P(0x1p-30);
        for (std::size_t i = 0; i < n; ++i) later[i] = later[i] + h * dy[i];
        return sign_of(form_.switch_rate(which, later.data()));
    }
};

}  // namespace polhode
