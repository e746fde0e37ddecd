// Sequential impulses at contacts, as in game engines: projected Gauss-Seidel on velocities.
//
// A step from (q, x, w, v) of length h:
//   1. contacts whose gap g is closed, with their normal velocities u_n0
//   2. w += h I_W^-1 tau, one Newton step of the gyroscopic term, v += h a; impulses of the last step (warm start)
//   3. `iterations` sweeps; each contact in turn:
//        friction  p_t -= u_t / K_tt (its largest eigenvalue or its diagonal), limited by mu p_n: to the disc |p_t| <=
//        mu p_n (cone) or each of its two
//                  components to [-mu p_n, mu p_n] (pyramid with four sides along t1 and t2)
//        normal    p_n = max(0, p_n - (u_n - b) / K_nn),  b = -e u_n0 if approaching, or if larger the velocity that
//                  corrects the penetration, -beta g / h (Baumgarte)
//   4. q = exp(h w) q,  x += h v.  With split impulses, the correction has a velocity of its own, which moves the body
//      here and is then discarded.
#include <algorithm>
#include <cmath>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

enum class PenetrationCorrection { baumgarte, split_impulse };

/// The choices that distinguish the variants.
struct ContactImpulseOptions {
    bool cone = true;  ///< friction in a circular cone instead of a pyramid
    PenetrationCorrection correction = PenetrationCorrection::split_impulse;
    bool warm_start = true;
    int iterations = 10;
};

template <class S>
class ContactImpulses : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Base::contacts_, Base::v_, Base::w_;

  public:
    ContactImpulses(const Problem& problem, const ContactImpulseOptions& options) : Base(problem), options_(options) {}

    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(this->q_);
        this->find_closed_contacts(R);
        contact_stepping::Twist<S> u = this->template free_velocity<GyroscopicTerm::one_newton_step>(t, h, R);
        if (contacts_.empty()) {
            v_ = u.v, w_ = u.w;
            this->move(h, u);
        } else {
            if (options_.warm_start) this->warm_start(S(1), u);
            for (int i = 0; i < options_.iterations; ++i)
                for (Constraint& c : contacts_) {
                    solve_friction(c, u);
                    solve_normal(c, h, u);
                }
            v_ = u.v, w_ = u.w;
            if (options_.correction == PenetrationCorrection::split_impulse) add_correction(h, u);
            this->move(h, u);
        }
        this->note_impacts(t, h);
        this->store_impulses();
        this->move_to_pivot();
    }

  private:
    static constexpr S beta = S(0.2);  // share of the penetration that a step removes

    void solve_friction(Constraint& c, contact_stepping::Twist<S>& u) const {
        if (!(c.friction > S(0))) return;
        const S limit = c.friction * c.impulse[0];
        if (!options_.cone) {
            for (std::size_t i = 1; i < 3; ++i)
                c.set_impulse(i, std::clamp(c.impulse[i] - c.velocity(i, u) / c.K[i][i], -limit, limit), u);
            return;
        }
        // along the slip, by the largest eigenvalue of K_tt, then radially back to the disc. Separate masses for the
        // two components would build up impulses of opposite directions at several contacts, which use up the cone.
        const S half_difference = (c.K[1][1] - c.K[2][2]) / S(2);
        const S largest = (c.K[1][1] + c.K[2][2]) / S(2) + std::hypot(half_difference, c.K[1][2]);
        S p1 = c.impulse[1] - c.velocity(1, u) / largest, p2 = c.impulse[2] - c.velocity(2, u) / largest;
        const S size = std::hypot(p1, p2);
        if (size > limit) p1 = p1 * (limit / size), p2 = p2 * (limit / size);
        c.set_impulse(1, p1, u);
        c.set_impulse(2, p2, u);
    }
    void solve_normal(Constraint& c, const S& h, contact_stepping::Twist<S>& u) const {
        S target = std::max(S(0), -c.restitution * c.approach);
        if (options_.correction == PenetrationCorrection::baumgarte) target = std::max(target, -beta * c.gap / h);
        c.set_impulse(0, std::max(S(0), c.impulse[0] - (c.velocity(0, u) - target) / c.K[0][0]), u);
    }
    /// Adds the velocity that corrects penetrations, solved by separate impulses.
    void add_correction(const S& h, contact_stepping::Twist<S>& u) {
        contact_stepping::Twist<S> correction;
        push_.assign(contacts_.size(), S(0));
        for (int i = 0; i < options_.iterations; ++i)
            for (std::size_t k = 0; k < contacts_.size(); ++k) {
                const Constraint& c = contacts_[k];
                const S target = -beta * c.gap / h;
                const S next = std::max(S(0), push_[k] - (c.velocity(0, correction) - target) / c.K[0][0]);
                c.apply(0, next - push_[k], correction);
                push_[k] = next;
            }
        u.v = u.v + correction.v, u.w = u.w + correction.w;
    }

    const ContactImpulseOptions options_;
    std::vector<S> push_;
};

template <class S, ContactImpulseOptions options>
Trajectory solve_contact_impulses(const Problem& problem, const Settings& settings) {
    return march<ContactImpulses<S>>(problem, settings, options);
}

constexpr ContactImpulseOptions cone_split{}, pyramid_split{.cone = false}, cone_cold{.warm_start = false},
    cone_baumgarte{.correction = PenetrationCorrection::baumgarte},
    pyramid_baumgarte{.cone = false, .correction = PenetrationCorrection::baumgarte};

constexpr Method contact_impulses_variants[] = {
    {.name = "contact_impulses_cone",
     .documentation =
         "Sequential impulses at contacts with a circular friction cone: semi-implicit Euler with the gyroscopic term "
         "in one Newton step, then 10 sweeps of projected Gauss-Seidel over the contacts, from the impulses of the "
         "last step (warm start). The normal velocity after a step is at least -e times the one before it, without a "
         "threshold. A contact acts once its gap is closed, so an impact is up to one step late. A fifth of the "
         "penetration is removed in each step by split impulses, which do not change the velocity.",
     .solve = solve_contact_impulses<double, cone_split>},
    {.name = "contact_impulses_cone_cold",
     .documentation = "`contact_impulses_cone` without warm start: each step starts from zero impulses.",
     .solve = solve_contact_impulses<double, cone_cold>},
    {.name = "contact_impulses_cone_baumgarte",
     .documentation =
         "`contact_impulses_cone` with the penetration corrected by the velocity 0.2 depth / h itself (Baumgarte). The "
         "body keeps this velocity: a landing with speed u rebounds with up to 0.2 u at every step size, so the method "
         "gains energy and does not converge across impacts with e < 0.2.",
     .solve = solve_contact_impulses<double, cone_baumgarte>},
    {.name = "contact_impulses_pyramid",
     .documentation =
         "`contact_impulses_cone` with a friction pyramid: each of two tangential impulses, along fixed axes t1 and "
         "t2, is limited to mu times the normal impulse, as in Bullet with two friction directions and in most game "
         "engines. Friction depends on direction: it is up to sqrt(2) times Coulomb's between the axes, and does not "
         "oppose the slip there. It converges to a different motion than Coulomb's unless slip stays along an axis.",
     .solve = solve_contact_impulses<double, pyramid_split>},
    {.name = "contact_impulses_pyramid_baumgarte",
     .documentation = "`contact_impulses_pyramid` with the penetration corrected by the velocity itself, as in "
                      "`contact_impulses_cone_baumgarte`.",
     .solve = solve_contact_impulses<double, pyramid_baumgarte>},
};

constexpr auto contact_impulses_binary64_family = apply_defaults(
    {.source = "E. Catto 2005, Iterative Dynamics with Temporal Coherence, Game Developers Conference; split impulses: "
               "E. Coumans, Bullet, btSequentialImpulseConstraintSolver",
     .conserves = "|q|",
     .control = Control::fixed_step,
     .planes = true,
     .order = 1,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
     .family = Family::engine_update,
     .formulation = Formulation::full,
     .refusal = contact_stepping::contact_refusal},
    contact_impulses_variants);

constexpr auto contact_impulses_family =
    with_binary32<contact_impulses_binary64_family, binary32_refusal, solve_contact_impulses<float, cone_split>,
                  solve_contact_impulses<float, cone_cold>, solve_contact_impulses<float, cone_baumgarte>,
                  solve_contact_impulses<float, pyramid_split>, solve_contact_impulses<float, pyramid_baumgarte>>();

}  // namespace

extern const std::span<const Method> contact_impulses_methods{contact_impulses_family};

}  // namespace polhode
