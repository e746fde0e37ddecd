// Moreau-Jean time stepping: the theta scheme on velocities and impulses, as in Siconos.
//
// Over a step from (q0, x0, w0, v0), with w in body axes, theta = 1/2, averages F_m = (F_0 + F_1)/2 of both ends:
//   v1 = v0 + h a_m + P/m,   I w1 = I w0 + h (tau_m - (w x I w)_m) + sum of r x P,   q1 = q0 exp(h w_m),  x1 = x0 + h
//   v_m
// For each contact with a predicted gap g + (h/2) u_n0 <= 0 the impulse P obeys
//   0 <= P_n,  0 <= u_n1 + e u_n0,  P_n (u_n1 + e u_n0) = 0,  and Coulomb's law between P_t and u_t1.
// The contact's axes and arm are those of the start of the step. The equations are solved by a fixed-point iteration
// over the averages; inside it, contacts are solved one after another (nonsmooth Gauss-Seidel), each exactly.
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

using contact_stepping::ContactConstraint;
using contact_stepping::ContactState;
using contact_stepping::Twist;

template <class S>
class MoreauJean : public ContactState<S> {
    using Base = ContactState<S>;
    using Base::contacts_, Base::evaluations_, Base::inertia_, Base::q_, Base::v_, Base::w_, Base::x_;

  public:
    explicit MoreauJean(const Problem& problem) : Base(problem) { w_B_ = body_rate(); }
    void restart() {
        Base::restart();
        w_B_ = body_rate();
        failed_at_ = -1;
    }
    void enter(const Segment& segment) {
        Base::enter(segment);
        if (!segment.impulses.empty()) w_B_ = body_rate();
    }
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(q_);
        find_active_contacts(h, R);
        this->recall_impulses(S(1));
        const State before{q_, x_, v_, w_B_};
        const Rate start = rate(t, R);
        Rate end = start;
        bool converged = false;
        S smallest = Elementary<S>::infinity();
        for (int i = 0; i < most_iterations && !converged; ++i) {
            const Vector3<S> v = v_, w = w_B_;
            advance(before, R, h, start, end);
            if (i > 0) {
                const Vector3<S> dv = v_ - v, dw = w_B_ - w;
                const S change = relative_change(dv, dw, h, start);
                // iterates until rounding prevents further decrease
                converged = change == S(0) || (smallest < acceptable && change >= smallest);
                smallest = std::min(smallest, change);
            }
            if (converged) break;
            const Rate next = rate(t + step, rotation_matrix(q_));
            converged = next == end;
            end = next;
        }
        if (!converged && !(smallest < acceptable) && this->finite()) {
            q_ = before.q, x_ = before.x, v_ = before.v, w_B_ = before.w_B;
            w_ = R * w_B_;
            failed_at_ = t;
            return;
        }
        this->move_to_pivot();
        this->note_impacts(t, h);
        this->store_impulses();
    }
    bool failed() const { return failed_at_ >= 0; }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::failed;
        trajectory.message = fmt::format(
            "the iteration of the step at t = {:.10g} s does not converge: the step is too long for the loads",
            failed_at_);
    }

  private:
    static constexpr int most_iterations = 100;
    static constexpr S tiny = std::numeric_limits<S>::min();
    // squared relative change of the velocities at which the iteration may end
    static constexpr S acceptable =
        S(1024) * std::numeric_limits<S>::epsilon() * S(1024) * std::numeric_limits<S>::epsilon();

    struct State {
        Quaternion<S> q;
        Vector3<S> x, v, w_B;
    };
    struct Rate {
        Vector3<S> v, w_B;
        bool operator==(const Rate&) const = default;
    };

    /// Squared changes of v and w, each relative to its size and to its change by loads in the step. With contacts, the
    /// size of either is also that of the other at the body's surface: a body at rest has rounding errors only.
    S relative_change(const Vector3<S>& dv, const Vector3<S>& dw, const S& h, const Rate& load) const {
        const S r = this->detector_.reach();
        const S v = dot(v_, v_) + h * h * dot(load.v, load.v), w = dot(w_B_, w_B_) + h * h * dot(load.w_B, load.w_B);
        return dot(dw, dw) / (tiny + w + (r > S(0) ? v / (r * r) : S(0))) + dot(dv, dv) / (tiny + v + r * r * w);
    }
    Vector3<S> body_rate() const { return rotate_back(q_, w_); }

    /// dv/dt and dw/dt (body axes) without contacts, at the current state.
    Rate rate(double t, const Matrix3<S>& R) {
        const Vector3<S> torque_B = transposed(R) * this->torque_W(t, R);
        ++evaluations_;
        return {this->acceleration_W(R), inertia_.inverse * (torque_B + cross(inertia_.tensor * w_B_, w_B_))};
    }
    void find_active_contacts(const S& h, const Matrix3<S>& R) {
        if (!this->detector_.any()) return;
        const S rounding = this->detector_.rounding(x_);
        const S fastest = length(v_) + this->detector_.reach() * length(w_);
        this->find_contacts(R, rounding + h / S(2) * fastest);
        std::erase_if(contacts_,
                      [&](const ContactConstraint<S>& c) { return c.gap + h / S(2) * c.approach > rounding; });
        for (ContactConstraint<S>& c : contacts_) c.target = -c.restitution * c.approach;
    }
    void advance(const State& from, const Matrix3<S>& R, const S& h, const Rate& start, const Rate& end) {
        const S half = h / S(2);
        v_ = from.v + half * (start.v + end.v);
        w_B_ = from.w_B + half * (start.w_B + end.w_B);
        if (!contacts_.empty()) {
            Twist<S> u{v_, R * w_B_};
            this->solve_cones(u);
            v_ = u.v, w_B_ = transposed(R) * u.w;
        }
        const Vector3<S> angle = half * (from.w_B + w_B_);
        q_ = normalized(from.q * quaternion_from_rotation_vector(angle));
        w_ = rotate(q_, w_B_);
        x_ = from.x + half * (from.v + v_);
        this->move_to_pivot();
    }

    Vector3<S> w_B_;
    double failed_at_ = -1;  // s
};

template <class S>
Trajectory solve_moreau_jean(const Problem& problem, const Settings& settings) {
    return march<MoreauJean<S>>(problem, settings);
}

constexpr Method moreau_jean_variants[] = {
    {.name = "moreau_jean",
     .documentation =
         "The theta scheme of Moreau and Jean with theta = 1/2, as in Siconos: velocities and contact impulses are the "
         "unknowns of a step, so impacts need no event. A contact is active if its gap, predicted over half a step, is "
         "closed. Newton's law of restitution (u_n1 >= -e u_n0) and Coulomb's law with a circular cone hold between "
         "impulse and end velocity; contacts are solved exactly one by one, and iterated if there are several. The gap "
         "is not corrected: a body may remain in a plane by the distance of half a step. Loads and the gyroscopic "
         "term are averaged over the step, which is solved to rounding. Order 2 in flight, sliding and rolling, "
         "and where sliding ends; order 1 across impacts.",
     .source =
         "J. J. Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; M. Jean 1999, Comput. "
         "Methods Appl. Mech. Eng. 177, 235; V. Acary, Siconos, MoreauJeanOSI",
     .conserves = "|q|",
     .control = Control::fixed_step,
     .planes = true,
     .order = 2,
     .solve = solve_moreau_jean<double>,
     .family = Family::published_update,
     .formulation = Formulation::full,
     .refusal = contact_stepping::contact_refusal},
};

constexpr auto moreau_jean_family = with_binary32<moreau_jean_variants, binary32_refusal, solve_moreau_jean<float>>();

}  // namespace

extern const std::span<const Method> moreau_jean_methods{moreau_jean_family};

}  // namespace polhode
