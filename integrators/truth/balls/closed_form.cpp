#include <optional>

#include "integrators/truth/allowance.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/balls/free.h"
#include "motion/body_equations.h"

namespace polhode::truth {
namespace {

// Advances p and v by t under a constant acceleration a and linear drag k (1/s):
// v = v0 e^-kt + a (1 - e^-kt)/k,  p = p0 + v0 (1 - e^-kt)/k + a (kt - 1 + e^-kt)/k^2
void translate(const Forcing<Ball>& f, const Ball& t, Vector3<Ball>& p, Vector3<Ball>& v) {
    Ball decayed = t, twice = t * t / Ball(2), remaining(1);
    if (f.has_translational_drag) {
        const Ball k = f.specific_drag, x = k * t;
        Ball loss;  // e^-kt - 1
        arb_neg(loss.raw(), x.raw());
        arb_expm1(loss.raw(), loss.raw(), Ball::precision());
        remaining = Ball(1) + loss, decayed = -loss / k, twice = (x + loss) / (k * k);
    }
    p = p + (decayed * v + twice * f.acceleration_W);
    v = remaining * v + decayed * f.acceleration_W;
}

}  // namespace

Enclosure enclose_by_closed_form(const Piece& piece, const std::vector<Ball>& start) {
    Enclosure result;
    const EulerForm<Ball>& form = *piece.body;
    const Forcing<Ball>& forcing = form.forcing();
    const std::optional<FreeRotation> rotation =
        free_rotation(form.body().inertia_B, BodyState::angular_velocity(start.data()));
    if (!rotation) {
        result.fault = "the precision does not resolve the order of the moments or the side of the separatrix";
        return result;
    }
    const Quaternion<Ball> q0 = BodyState::attitude(start.data());
    const auto state = [&](double time) {
        Ball t;
        arb_sub(t.raw(), Ball(time).raw(), Ball(piece.begin).raw(), ARF_PREC_EXACT);
        std::vector<Ball> y(start);
        const FreeMotion motion = std::visit([&](const auto& kind) { return kind.after(t); }, *rotation);
        BodyState::set_rotation(y.data(), motion.angular_velocity_B, q0 * motion.q);
        if (!form.body().pivoted) {
            Vector3<Ball> p = BodyState::position(start.data()), v = BodyState::velocity(start.data());
            translate(forcing, t, p, v);
            BodyState::set_translation(y.data(), p, v);
        }
        for (const Ball& component : y)
            if (!component.is_finite()) result.fault = "the closed form is not finite at this precision";
        return y;
    };
    for (const double time : piece.sample_times) {
        if (Allowance::is_spent()) {
            result.fault = Allowance::fault;
            return result;
        }
        result.samples.push_back(state(time));
    }
    result.end = state(piece.end);
    return result;
}

}  // namespace polhode::truth
