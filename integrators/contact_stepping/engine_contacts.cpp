// Contact loops of game engines for one body and planes, with the default settings of the engines: Bullet, Jolt, Box2D
// v3 with Box3D. Each starts from the free flight of its engine and differs in which contacts act, what the normal
// velocity must reach, how friction is limited, in which order rows are solved, and how penetration is removed.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

/// p_n = max(0, p_n - (u_n - target) / K_nn).
template <class S>
void solve_normal_row(contact_stepping::ContactConstraint<S>& c, const S& target, contact_stepping::Twist<S>& u) {
    c.set_impulse(0, std::max(S(0), c.impulse[0] - (c.velocity(0, u) - target) / c.K[0][0]), u);
}

/// Both tangential impulses, each by its own effective mass, then radially back to the disc |p_t| <= mu p_n.
template <class S>
void solve_friction_disc(contact_stepping::ContactConstraint<S>& c, contact_stepping::Twist<S>& u) {
    const S limit = c.friction * c.impulse[0];
    S p1 = c.impulse[1] - c.velocity(1, u) / c.K[1][1], p2 = c.impulse[2] - c.velocity(2, u) / c.K[2][2];
    const S size = std::hypot(p1, p2);
    if (size > limit) p1 = p1 * (limit / size), p2 = p2 * (limit / size);
    c.set_impulse(1, p1, u);
    c.set_impulse(2, p2, u);
}

/// Bullet: one friction direction per contact, along the slip; all normals are solved before all frictions.
template <class S>
class BulletContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::v_, Base::w_;

  public:
    using Base::Base;
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(this->q_);
        this->find_contacts(R, breaking_distance);
        Velocity u = this->template free_velocity<GyroscopicTerm::one_newton_step>(t, h, R);
        rows_.clear();
        for (Constraint& c : contacts_) set_up(c, h, u);
        this->recall_impulses(S(0.85));
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            Constraint& c = contacts_[k];
            const S lateral = c.impulse[1];
            c.impulse[1] = c.impulse[2] = S(0);
            c.apply(0, c.impulse[0], u);
            add_friction(c, rows_[k], lateral, u);
        }
        Velocity push;
        for (int i = 0; i < iterations; ++i) {
            for (std::size_t k = 0; k < contacts_.size(); ++k) {
                solve_normal_row(contacts_[k], contacts_[k].target, u);
                solve_push(contacts_[k], rows_[k], push);
            }
            for (std::size_t k = 0; k < contacts_.size(); ++k) solve_friction(contacts_[k], rows_[k], u);
        }
        v_ = u.v, w_ = u.w;
        this->move(h, {u.v + push.v, u.w + push.w});
        for (std::size_t k = 0; k < contacts_.size(); ++k) contacts_[k].impulse[1] = rows_[k].lateral;
        this->note_impacts(t, h);
        this->store_impulses();
        this->move_to_pivot();
    }

  private:
    static constexpr int iterations = 10;
    static constexpr S breaking_distance = S(0.02), slowest_bounce = S(0.2), erp = S(0.2), deepest = S(0.04);

    struct Row {
        S direction[2];  ///< of friction, along t1 and t2
        S lateral;       ///< impulse along it
        S push, pushed;  ///< target velocity and impulse of the split impulse
    };

    void set_up(Constraint& c, const S& h, const Velocity& u) {
        Row row{{S(1), S(0)}, S(0), S(0), S(0)};
        if (c.approach < -slowest_bounce) c.target = -c.restitution * c.approach;
        if (c.gap > S(0))
            c.target -= c.gap / h;
        else if (c.gap > -deepest)
            c.target -= erp * c.gap / h;
        else
            row.push = -erp * c.gap / h;
        const S u1 = c.velocity(1, u), u2 = c.velocity(2, u), squared = u1 * u1 + u2 * u2;
        if (squared > S(std::numeric_limits<float>::epsilon())) {
            const S size = std::sqrt(squared);
            row.direction[0] = u1 / size, row.direction[1] = u2 / size;
        }
        rows_.push_back(row);
    }
    static void add_friction(Constraint& c, Row& row, const S& impulse, Velocity& u) {
        row.lateral += impulse;
        for (std::size_t i = 0; i < 2; ++i) c.apply(i + 1, impulse * row.direction[i], u);
    }
    static void solve_friction(Constraint& c, Row& row, Velocity& u) {
        if (!(c.impulse[0] > S(0))) return;
        const S d1 = row.direction[0], d2 = row.direction[1], limit = c.friction * c.impulse[0];
        const S mass = d1 * d1 * c.K[1][1] + S(2) * d1 * d2 * c.K[1][2] + d2 * d2 * c.K[2][2];
        const S slip = d1 * c.velocity(1, u) + d2 * c.velocity(2, u);
        add_friction(c, row, std::clamp(row.lateral - slip / mass, -limit, limit) - row.lateral, u);
    }
    static void solve_push(const Constraint& c, Row& row, Velocity& push) {
        if (!(row.push > S(0))) return;
        const S next = std::max(S(0), row.pushed - (c.velocity(0, push) - row.push) / c.K[0][0]);
        c.apply(0, next - row.pushed, push);
        row.pushed = next;
    }

    std::vector<Row> rows_;
};

/// Jolt: friction of all points of the contact, then their normals; penetration beyond a slop is removed from
/// positions.
template <class S>
class JoltContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Base::contacts_, Base::q_, Base::v_, Base::w_, Base::x_;

  public:
    using Base::Base;
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(q_);
        this->find_contacts(R, speculative_distance);
        contact_stepping::Twist<S> u = this->template free_velocity<GyroscopicTerm::rescaled_momentum>(t, h, R);
        for (Constraint& c : contacts_) {
            const S speculative = std::max(S(0), c.gap / h), now = c.velocity(0, u);
            c.target = -speculative;
            if (now < -slowest_bounce && now < -speculative && c.restitution > S(0))
                c.target = -c.restitution * c.approach;
        }
        this->warm_start(S(1), u);
        for (int i = 0; i < velocity_steps; ++i) {
            for (Constraint& c : contacts_) solve_friction_disc(c, u);
            for (Constraint& c : contacts_) solve_normal_row(c, c.target, u);
        }
        v_ = u.v, w_ = u.w;
        const Vector3<S> x0 = x_;
        const Quaternion<S> q0 = q_;
        this->move(h, u);
        for (int i = 0; i < position_steps; ++i)
            for (const Constraint& c : contacts_) correct_position(c, x0, q0);
        this->note_impacts(t, h);
        this->store_impulses();
        this->move_to_pivot();
    }

  private:
    static constexpr int velocity_steps = 10, position_steps = 2;
    static constexpr S speculative_distance = S(0.02), slowest_bounce = S(1), slop = S(0.02), baumgarte = S(0.2),
                       deepest = S(0.2);

    void correct_position(const Constraint& c, const Vector3<S>& x0, const Quaternion<S>& q0) {
        // the body's point of the contact, carried along since the start of the step
        const Vector3<S> arm = rotate(q_, rotate_back(q0, c.arm_W));
        const S separation = c.gap + dot(c.axis_W[0], x_ - x0 + arm - c.arm_W) + slop;
        if (!(separation < S(0))) return;
        const S p = -baumgarte * std::max(separation, -deepest) / c.K[0][0];
        x_ = x_ + (p * c.inverse_mass) * c.axis_W[0];
        q_ = normalized(quaternion_from_rotation_vector(p * c.turn_W[0]) * q_);
    }
};

/// Box2D v3 and Box3D: substeps with soft contacts, each followed by a pass without the spring, in which friction acts
/// at the centre of the points on a plane; restitution at the end.
template <class S>
class SoftContacts : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::q_, Base::v_, Base::w_, Base::x_;

  public:
    explicit SoftContacts(const Problem& problem) : Base(problem), patches_(this->detector_.plane_count()) {}
    void restart() {
        Base::restart();
        patches_.assign(patches_.size(), {});
    }
    void step(double t, double step) {
        const S h = S(step) / substeps;
        const Matrix3<S> R = rotation_matrix(q_);
        const S fastest = length(v_) + this->detector_.reach() * length(w_);
        this->find_contacts(R, speculative_distance + S(step) * fastest);
        this->recall_impulses(S(1));
        set_patches(R);
        x0_ = x_, q0_ = q_;
        const Softness soft(h);
        for (int i = 0; i < substeps; ++i) {
            Velocity u = this->template free_velocity<GyroscopicTerm::one_newton_step>(
                t + i * step / substeps, h, i == 0 ? R : rotation_matrix(q_));
            warm_start_patches(u);
            push(soft, h, u);
            v_ = u.v, w_ = u.w;
            this->move(h, u);
            relax(h, u);
            v_ = u.v, w_ = u.w;
            this->move_to_pivot();
        }
        restitute();
        this->note_impacts(t, S(step));
        this->store_impulses();
    }

  private:
    static constexpr int substeps = 4;
    static constexpr S speculative_distance = S(0.02), slowest_bounce = S(1), fastest_push = S(3);

    /// A spring of 60 Hz, at most 1/2 per substep, with the damping ratio 10.
    struct Softness {
        explicit Softness(const S& h) {
            const S hertz = S(2) * std::min(S(30), S(0.25) / h), omega = S(2) * std::numbers::pi_v<S> * hertz;
            const S a1 = S(20) + h * omega, a2 = h * omega * a1;
            bias_rate = omega / a1, mass = a2 / (S(1) + a2), impulse = S(1) / (S(1) + a2);
        }
        S bias_rate, mass, impulse;
    };
    /// All contacts with one plane.
    struct Patch {
        bool touches = false;
        Constraint centre;      ///< its impulses t1, t2 are the friction
        S spin_inverse = S(0);  ///< n . I_W^-1 n
        Vector3<S> spin_W;      ///< I_W^-1 n
        S torsion = S(0);       ///< angular impulse about n
    };

    void set_patches(const Matrix3<S>& R) {
        const Matrix3<S> inverse_inertia_W = R * (this->inertia_.inverse * transposed(R));
        total_.assign(contacts_.size(), S(0));
        for (std::size_t plane = 0; plane < patches_.size(); ++plane) {
            Patch& patch = patches_[plane];
            const Vector3<S> friction = patch.centre.impulse;
            Vector3<S> sum;
            S weights = S(0);
            patch.touches = false;
            for (const Constraint& c : contacts_) {
                if (this->detector_.plane_of(c.feature) != plane) continue;
                if (!patch.touches) patch.centre = c;
                patch.touches = true;
                const S weight = std::clamp(S(2) - c.gap / speculative_distance, S(1e-4), S(1));
                sum = sum + weight * c.arm_W, weights = weights + weight;
            }
            if (!patch.touches) {
                patch.centre.impulse = {}, patch.torsion = S(0);
                continue;
            }
            patch.centre.arm_W = (S(1) / weights) * sum;
            patch.centre.set_rows(inverse_inertia_W);
            patch.centre.impulse = {S(0), friction[1], friction[2]};
            patch.spin_W = inverse_inertia_W * patch.centre.axis_W[0];
            patch.spin_inverse = dot(patch.centre.axis_W[0], patch.spin_W);
        }
    }
    void warm_start_patches(Velocity& u) const {
        for (const Constraint& c : contacts_) c.apply(0, c.impulse[0], u);
        for (const Patch& patch : patches_) {
            if (!patch.touches) continue;
            patch.centre.apply(patch.centre.impulse, u);
            u.w = u.w + patch.torsion * patch.spin_W;
        }
    }
    S separation(const Constraint& c) const {
        const Vector3<S> arm = rotate(q_, rotate_back(q0_, c.arm_W));
        return c.gap + dot(c.axis_W[0], x_ - x0_ + arm - c.arm_W);
    }
    void push(const Softness& soft, const S& h, Velocity& u) {
        for (Constraint& c : contacts_) {
            const S gap = separation(c);
            S bias = gap / h, mass = S(1), impulse = S(0);
            if (!(gap > S(0))) {
                mass = soft.mass, impulse = soft.impulse;
                bias = std::max(mass * soft.bias_rate * gap, -fastest_push);
            }
            const S change = -(mass * c.velocity(0, u) + bias) / c.K[0][0] - impulse * c.impulse[0];
            c.set_impulse(0, std::max(S(0), c.impulse[0] + change), u);
        }
    }
    void relax(const S& h, Velocity& u) {
        for (std::size_t plane = 0; plane < patches_.size(); ++plane) {
            Patch& patch = patches_[plane];
            if (!patch.touches) continue;
            S normal = S(0), moment = S(0);
            for (std::size_t k = 0; k < contacts_.size(); ++k) {
                Constraint& c = contacts_[k];
                if (this->detector_.plane_of(c.feature) != plane) continue;
                solve_normal_row(c, -std::max(S(0), separation(c) / h), u);
                normal = normal + c.impulse[0], total_[k] = total_[k] + c.impulse[0];
                moment = moment + length(c.arm_W - patch.centre.arm_W) * c.impulse[0];
            }
            solve_torsion(patch, moment, u);
            solve_central_friction(patch.centre, normal, u);
        }
    }
    static void solve_torsion(Patch& patch, const S& moment, Velocity& u) {
        const S limit = patch.centre.friction * moment, spin = dot(patch.centre.axis_W[0], u.w);
        const S next = std::clamp(patch.torsion - spin / patch.spin_inverse, -limit, limit);
        u.w = u.w + (next - patch.torsion) * patch.spin_W;
        patch.torsion = next;
    }
    static void solve_central_friction(Constraint& c, const S& normal, Velocity& u) {
        const S limit = c.friction * normal, u1 = c.velocity(1, u), u2 = c.velocity(2, u);
        const S det = c.K[1][1] * c.K[2][2] - c.K[1][2] * c.K[2][1];
        S p1 = c.impulse[1] - (c.K[2][2] * u1 - c.K[1][2] * u2) / det;
        S p2 = c.impulse[2] - (c.K[1][1] * u2 - c.K[2][1] * u1) / det;
        const S size = std::hypot(p1, p2);
        if (size > limit) p1 = p1 * (limit / size), p2 = p2 * (limit / size);
        c.set_impulse(1, p1, u);
        c.set_impulse(2, p2, u);
    }
    void restitute() {
        Velocity u = this->twist();
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            Constraint& c = contacts_[k];
            if (c.restitution > S(0) && c.approach < -slowest_bounce && total_[k] > S(0))
                solve_normal_row(c, -c.restitution * c.approach, u);
        }
        v_ = u.v, w_ = u.w;
    }

    std::vector<Patch> patches_;
    std::vector<S> total_;  // normal impulses of all substeps
    Vector3<S> x0_;
    Quaternion<S> q0_;
};

template <class Contacts>
Trajectory solve_engine_contacts(const Problem& problem, const Settings& settings) {
    return march<Contacts>(problem, settings);
}

constexpr Method engine_contacts_variants[] = {
    {.name = "bullet_contacts",
     .documentation =
         "The contact loop of Bullet with its default settings: contacts within 0.02 m, 10 iterations of sequential "
         "impulses that solve all normals and then all frictions, warm start with 0.85 of the last impulses, and one "
         "friction direction per contact, along the slip at the start of the step (x or y on a floor if the slip is "
         "below 3.5e-4 m/s). Friction therefore opposes the slip of the previous step; slip across that direction is "
         "not opposed within a step. A fifth of a penetration is removed by the velocity itself (Baumgarte) up to a "
         "depth of 0.04 m, beyond it by split impulses. Impacts below 0.2 m/s do not bounce. A contact that acts "
         "before its gap closes loses gap / h of the rebound, so bounces do not converge. Gyroscopic term in one "
         "Newton step. Creates energy when it pushes a body out.",
     .source = "E. Coumans, Bullet 3.24, btSequentialImpulseConstraintSolver, btContactSolverInfo",
     .solve = solve_engine_contacts<BulletContacts<double>>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification},
    {.name = "jolt_contacts",
     .documentation =
         "The contact loop of Jolt Physics with its default settings: contacts within 0.02 m, whose normal velocity "
         "may close the gap but not more; 10 iterations that solve friction of all points (a disc of radius mu p_n), "
         "then their normals; full warm start; both components of friction use separate effective masses before they "
         "are limited, so that friction on a block does not oppose its slip (measured 1.5 % low at 45 degrees to its "
         "axes); 2 iterations that move the body out of penetrations beyond 0.02 m by a fifth, without changing the "
         "velocity. Impacts below 1 m/s do not bounce. The gyroscopic term, off by default in Jolt, is on: by the "
         "rescaled momentum. Damping and sleeping are off.",
     .source = "J. Rouwe, Jolt Physics 5, ContactConstraintManager, PhysicsSettings",
     .solve = solve_engine_contacts<JoltContacts<double>>,
     .pendulum_amplification = semi_implicit_euler_pendulum_amplification},
    {.name = "soft_contacts_4",
     .documentation =
         "Soft contacts with 4 substeps, as in Box2D v3 and Box3D: in each substep a contact is solved once as a "
         "spring of 60 Hz (at most 1/2 per substep) with the damping ratio 10, positions move, and it is solved once "
         "more without the spring (relaxing), so that the velocity of the spring is removed. The spring pushes a body "
         "out with at most 3 m/s. Friction acts at the centre of the points on a plane, in a disc of radius mu times "
         "their normal impulses, and as a torque against the spin. Restitution after the last substep, for impacts "
         "above 1 m/s. Gyroscopic term in one Newton step. A body at rest sinks by g / w_n^2, w_n = 2 pi 60 Hz, at any "
         "step. Within a step the point of a contact is carried along with the rotation, so a rolling ball sinks by up "
         "to r (w h)^2 / 2.",
     .source = "E. Catto, Box2D v3.1 and Box3D, b2MakeSoft, b3PushContacts, b3SolveContacts; contactHertz 30, "
               "contactDampingRatio 10",
     .solve = solve_engine_contacts<SoftContacts<double>>},
};

constexpr auto engine_contacts_binary64_family = apply_defaults({.conserves = "|q|",
                                                                 .control = Control::fixed_step,
                                                                 .planes = true,
                                                                 .order = 1,
                                                                 .family = Family::engine_update,
                                                                 .formulation = Formulation::full,
                                                                 .refusal = contact_stepping::contact_refusal},
                                                                engine_contacts_variants);

constexpr auto engine_contacts_family =
    with_binary32<engine_contacts_binary64_family, binary32_refusal, solve_engine_contacts<BulletContacts<float>>,
                  solve_engine_contacts<JoltContacts<float>>, solve_engine_contacts<SoftContacts<float>>>();

}  // namespace

extern const std::span<const Method> engine_contacts_methods{engine_contacts_family};

}  // namespace polhode
