// Position-based contact: extended position based dynamics of M. Mueller and others (2020), section 3.5.
//
// A step has 10 substeps of length h. In each substep, from (q, x, w, v):
//   1. v += h F/m,  x += h v,  w += h I^-1 (tau - w x I w),  q += (h/2) (0, w) q
//   2. each contact with a gap g < 0 at the predicted pose:
//        move by the impulse-like p = lambda_n n, lambda_n = -g / K_nn;
//        displacement d of the body's contact point over the substep; if the correction lambda_t = |d_t| / K_tt is
//        below mu lambda_n, move by it against d_t (static friction)
//   3. v = (x - x0) / h,  w from q q0*
//   4. each contact with lambda_n > 0:
//        dynamic friction: reduce the slip by at most mu (lambda_n / h) K_tt
//        restitution: normal velocity max(0, -e u_n0), with e = 0 if |u_n| <= 2 |a| h; u_n0 before the substep
// The article prints the limit of dynamic friction as h mu |f_n|, an impulse, for a change of velocity; here it is
// multiplied by the inverse mass K_tt of the contact.
#include <algorithm>
#include <cmath>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

template <class S>
class PositionContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::q_, Base::v_, Base::w_, Base::x_;

  public:
    using Base::Base;
    void step(double t, double step) {
        const double h = step / substeps;
        for (int i = 0; i < substeps; ++i) substep(t + i * h, S(h));
    }

  private:
    static constexpr int substeps = 10;

    void substep(double t, const S& h) {
        const Quaternion<S> q0 = q_;
        const Vector3<S> x0 = x_, v0 = v_;
        const Matrix3<S> R0 = rotation_matrix(q0);
        const Velocity before = this->twist(),
                       u = this->template free_velocity<GyroscopicTerm::explicit_euler>(t, h, R0);
        w_ = u.w;
        this->rotate_first_order(h);
        x_ = x_ + h * u.v;
        this->find_contacts(rotation_matrix(q_), S(0));
        found_x_ = x_, found_q_ = q_;
        for (Constraint& c : contacts_) correct(c, x0, q0);
        if (contacts_.empty()) {
            // the differences of positions in closed form: 2/h times the vector part of (1, h w/2) / |(1, h w/2)|
            v_ = u.v;
            w_ = (S(1) / std::sqrt(S(1) + h * h * dot(u.w, u.w) / S(4))) * u.w;
        } else {
            v_ = (S(1) / h) * (x_ - x0);
            const Quaternion<S> turn = q_ * conjugate(q0);
            w_ = (turn.w < S(0) ? S(-2) / h : S(2) / h) * vector_part(turn);
            solve_velocities(h, before, length(u.v - v0));
        }
        this->note_impacts(t, h);
        this->move_to_pivot();
    }
    void correct(Constraint& c, const Vector3<S>& x0, const Quaternion<S>& q0) {
        // the gap after the corrections of other contacts; the point is fixed in the body
        const Vector3<S> arm_B = rotate_back(found_q_, c.arm_W), arm = rotate(q_, arm_B);
        const S gap = c.gap + dot(c.axis_W[0], x_ - found_x_ + arm - c.arm_W);
        if (gap < S(0)) move_body(c, 0, -gap / c.K[0][0]);
        const Vector3<S> d = x_ - x0 + rotate(q_, arm_B) - rotate(q0, arm_B);
        const S d1 = dot(c.axis_W[1], d), d2 = dot(c.axis_W[2], d), size = std::hypot(d1, d2);
        if (!(size > S(0))) return;
        const S inverse = tangential_inverse_mass(c, d1 / size, d2 / size);
        if (!(size / inverse < c.friction * c.impulse[0])) return;
        move_body(c, 1, -d1 / inverse);
        move_body(c, 2, -d2 / inverse);
    }
    static S tangential_inverse_mass(const Constraint& c, const S& t1, const S& t2) {
        return t1 * t1 * c.K[1][1] + S(2) * t1 * t2 * c.K[1][2] + t2 * t2 * c.K[2][2];
    }
    /// x += p axis / m and a rotation by I^-1 (r x p axis), to first order.
    void move_body(Constraint& c, std::size_t i, const S& p) {
        c.impulse[i] += p;
        x_ = x_ + (p * c.inverse_mass) * c.axis_W[i];
        const Vector3<S> half = (p / S(2)) * c.turn_W[i];
        const Quaternion<S> change = Quaternion<S>{S(0), half[0], half[1], half[2]} * q_;
        q_ = normalized(Quaternion<S>{q_.w + change.w, q_.x + change.x, q_.y + change.y, q_.z + change.z});
    }
    /// `gained`: the speed that loads change in the substep, |a| h.
    void solve_velocities(const S& h, const Velocity& before, const S& gained) {
        Velocity u = this->twist();
        for (const Constraint& c : contacts_) {
            if (!(c.impulse[0] > S(0))) continue;
            const S u1 = c.velocity(1, u), u2 = c.velocity(2, u), slip = std::hypot(u1, u2);
            if (slip > S(0)) {
                const S inverse = tangential_inverse_mass(c, u1 / slip, u2 / slip);
                const S change = std::min(c.friction * c.impulse[0] / h * inverse, slip);
                c.apply(1, -change * (u1 / slip) / inverse, u);
                c.apply(2, -change * (u2 / slip) / inverse, u);
            }
            const S normal = c.velocity(0, u), e = std::abs(normal) > S(2) * gained ? c.restitution : S(0);
            const S target = std::max(S(0), -e * c.velocity(0, before));
            c.apply(0, (target - normal) / c.K[0][0], u);
        }
        v_ = u.v, w_ = u.w;
    }

    Vector3<S> found_x_;
    Quaternion<S> found_q_;
};

template <class S>
Trajectory solve_position_contacts(const Problem& problem, const Settings& settings) {
    return march<PositionContacts<S>>(problem, settings);
}

constexpr Method position_contacts_variants[] = {
    {.name = "xpbd_contacts",
     .documentation =
         "Extended position based dynamics with 10 substeps per step: a body that penetrates at the end of a substep "
         "is moved out at once (no compliance), static friction cancels the displacement of the contact point if this "
         "needs less than mu times the normal correction, and velocities are the change of positions. Then dynamic "
         "friction reduces the remaining slip, and restitution sets the normal velocity, for impacts faster than 2 |a| "
         "h. One pass over the contacts: friction between several points is low (measured 2.3 % for a block on a ramp, "
         "which slides at 0.99 of the angle of friction, at any step). The explicit gyroscopic term and the "
         "first-order quaternion update. The limit of dynamic friction, an impulse in the article, is used as an "
         "impulse. Order 1.",
     .source = "M. Mueller, M. Macklin, N. Chentanez, S. Jeschke & T.-Y. Kim 2020, Detailed rigid body simulation with "
               "extended position based dynamics, Comput. Graph. Forum 39, 101",
     .conserves = "|q|",
     .control = Control::fixed_step,
     .planes = true,
     .order = 1,
     .solve = solve_position_contacts<double>,
     .family = Family::published_update,
     .formulation = Formulation::full,
     .refusal = contact_stepping::contact_refusal},
};

constexpr auto position_contacts_family =
    with_binary32<position_contacts_variants, binary32_refusal, solve_position_contacts<float>>();

}  // namespace

extern const std::span<const Method> position_contacts_methods{position_contacts_family};

}  // namespace polhode
