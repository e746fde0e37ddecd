// Penalty contact: Hunt and Crossley's normal force or a linear spring and damper, and regularised Coulomb friction, in
// fixed steps.
//
// For each contact with the depth s = -gap > 0, the approach speed -u_n and the slip u_t:
//   Hunt and Crossley    N = max(0, k s^(3/2) (1 - (3/2) (1 - e) u_n / u_0)),  k = m (9.81 m/s^2) / (1e-4 m)^(3/2)
//   spring and damper    N = max(0, k s - c u_n),  k = m (9.81 m/s^2) / (1e-4 m),  c = 2 zeta (k / K_nn)^(1/2),
//                        zeta = -ln e / (pi^2 + (ln e)^2)^(1/2), and 1 for e = 0; K_nn from the contact matrix
//   F = -mu N u_t / max(|u_t|, v_s + h mu N K_tt),  v_s = 0.01 m/s
// u_0 is the approach speed at first touch, at least 0.05 m/s. The second term of the denominator makes the friction of
// a sticking point implicit, so that it is stable at any step.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

enum class PenaltyForce { hunt_crossley, spring_damper };

template <class S, PenaltyForce force>
class PenaltyContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::v_, Base::w_;

  public:
    using Base::Base;
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(this->q_);
        this->find_contacts(R, S(0));
        // the stored "impulse" of a contact is its approach speed at first touch
        this->recall_impulses(S(1));
        Velocity u = this->template free_velocity<GyroscopicTerm::explicit_euler>(t, h, R);
        const Velocity before = this->twist();
        for (Constraint& c : contacts_) {
            if (c.impulse[0] == S(0)) c.impulse[0] = std::max(slowest_impact, -c.approach);
            apply_forces(c, h, before, u);
        }
        this->note_impacts(t, h);
        this->store_impulses();
        v_ = u.v, w_ = u.w;
        this->move(h, u);
        this->move_to_pivot();
    }

  private:
    static constexpr S slowest_impact = S(0.05), slowest_slip = S(0.01), static_depth = S(1e-4), gravity = S(9.81);

    /// zeta of a linear oscillator whose speed after half a period is e times that before.
    static S damping_ratio(const S& e) {
        if (!(e > S(0))) return S(1);
        const S log_e = std::log(e), pi = std::numbers::pi_v<S>;
        return -log_e / std::sqrt(pi * pi + log_e * log_e);
    }

    static void apply_forces(const Constraint& c, const S& h, const Velocity& before, Velocity& u) {
        const S depth = -c.gap, relative = depth / static_depth;
        S N = S(0);
        if constexpr (force == PenaltyForce::hunt_crossley) {
            const S damping = S(1.5) * (S(1) - c.restitution) / c.impulse[0];
            N = std::max(S(0),
                         gravity / c.inverse_mass * relative * std::sqrt(relative) * (S(1) - damping * c.approach));
        } else {
            const S k = gravity / (c.inverse_mass * static_depth);
            const S damping = S(2) * damping_ratio(c.restitution) * std::sqrt(k / c.K[0][0]);
            N = std::max(S(0), -k * c.gap - damping * c.approach);
        }
        const S u1 = c.velocity(1, before), u2 = c.velocity(2, before), limit = h * c.friction * N;
        const S sticking = slowest_slip + limit * std::max(c.K[1][1], c.K[2][2]);
        const S factor = -limit / std::max(std::hypot(u1, u2), sticking);
        c.apply({h * N, factor * u1, factor * u2}, u);
    }
};

template <class S, PenaltyForce force>
Trajectory solve_penalty_contacts(const Problem& problem, const Settings& settings) {
    return march<PenaltyContacts<S, force>>(problem, settings);
}

constexpr Method penalty_contacts_variants[] = {
    {.name = "penalty_contacts",
     .documentation =
         "Contact as a force: Hunt and Crossley's spring with damping, stiff enough that the weight of the body "
         "presses "
         "one contact point 1e-4 m deep, and Coulomb friction regularised below a slip of 0.01 m/s, in semi-implicit "
         "Euler with an explicit gyroscopic term. It converges with order 1 to the motion of this model: a body at "
         "rest "
         "penetrates, a body that should stick creeps by up to 0.01 m/s, and an impact with e near 0 rebounds. The "
         "spring needs steps below about 1 ms; longer ones gain energy.",
     .source =
         "K. H. Hunt & F. R. E. Crossley 1975, Coefficient of restitution interpreted as damping in vibroimpact, J. "
         "Appl. Mech. 42, 440",
     .conserves = "|q|",
     .control = Control::fixed_step,
     .planes = true,
     .order = 1,
     .solve = solve_penalty_contacts<double, PenaltyForce::hunt_crossley>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
     .family = Family::published_update,
     .formulation = Formulation::full,
     .refusal = contact_stepping::contact_refusal},
    {.name = "penalty_contacts_linear",
     .documentation =
         "`penalty_contacts` with a linear spring and a damper: the damping ratio is that of an oscillator whose speed "
         "after half a period is e times that before, and 1 for e = 0. The contact never pulls, so that an impact "
         "rebounds with more than e (0.550 for e = 0.5, exp(-2) = 0.135 for e = 0). The damper acts at first touch: "
         "the force jumps there. With e near 0 and several points it needs steps below about 0.4 ms.",
     .source = "P. A. Cundall & O. D. L. Strack 1979, A discrete numerical model for granular assemblies, Geotechnique "
               "29, 47",
     .conserves = "|q|",
     .control = Control::fixed_step,
     .planes = true,
     .order = 1,
     .solve = solve_penalty_contacts<double, PenaltyForce::spring_damper>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
     .family = Family::published_update,
     .formulation = Formulation::full,
     .refusal = contact_stepping::contact_refusal},
};

constexpr auto penalty_contacts_family = with_binary32<penalty_contacts_variants, binary32_refusal,
                                                       solve_penalty_contacts<float, PenaltyForce::hunt_crossley>,
                                                       solve_penalty_contacts<float, PenaltyForce::spring_damper>>();

}  // namespace

extern const std::span<const Method> penalty_contacts_methods{penalty_contacts_family};

}  // namespace polhode
