// State and common parts of the time-stepping contact methods: a body, its loads, its contacts in the current step.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "integrators/contact_stepping/contact_points.h"
#include "integrators/contact_stepping/coulomb_cone.h"
#include "integrators/game/engine_state.h"

namespace polhode::contact_stepping {

/// Everything of a stepper (integrators/run/march.h) except its step, in the scalar S. Without planes it is the update
/// of a game engine.
template <class S>
class ContactState : public EngineState<S> {
    using Base = EngineState<S>;

  public:
    explicit ContactState(const Problem& problem) : Base(problem), detector_(*problem.body.geometry) {}
    void restart() {
        Base::restart();
        contacts_.clear(), stored_.clear();
        touching_.clear(), impact_times_.clear();
        evaluations_ = unconverged_ = 0;
    }
    long rhs_evaluations() const { return evaluations_; }
    /// Reports the times of impacts, and steps in which an iteration over the contacts ended before it converged.
    void report(Trajectory& trajectory) const {
        trajectory.impact_times = impact_times_;
        if (trajectory.status == Status::ok && unconverged_ > 0)
            trajectory.message = "the iteration over the contacts reached its limit in " +
                                 std::to_string(unconverged_) + " of its calls";
    }

  protected:
    using Base::inertia_;
    using Base::q_;
    using Base::v_;
    using Base::w_;
    using Base::x_;

    Twist<S> twist() const { return {v_, w_}; }

    /// The velocities after the loads of a step alone, at the old state: w += h I_W^-1 tau, the gyroscopic term, and
    /// v += h a.
    template <GyroscopicTerm term>
    Twist<S> free_velocity(double t, const S& h, const Matrix3<S>& R) {
        const Matrix3<S> back = transposed(R);
        const Vector3<S> w = w_ + h * (R * (inertia_.inverse * (back * this->torque_W(t, R))));
        ++evaluations_;
        Twist<S> free{v_ + h * this->acceleration_W(R), w};
        if constexpr (term != GyroscopicTerm::none)
            free.w = R * inertia_.template apply_gyroscopic_term<term>(back * w, h);
        return free;
    }
    /// Moves the body for a time h by a velocity: q = exp(h w) q, x += h v.
    void move(const S& h, const Twist<S>& u) {
        q_ = normalized(quaternion_from_rotation_vector(h * u.w) * q_);
        x_ = x_ + h * u.v;
    }

    /// Fills contacts_ with the contacts whose gap is at most `margin` (m), at the current state.
    void find_contacts(const Matrix3<S>& R, const S& margin) {
        contacts_.clear();
        if (!detector_.any()) return;
        const Matrix3<S> inverse_inertia_W = R * (inertia_.inverse * transposed(R));
        const Twist<S> now = twist();
        const S inverse_mass = S(1 / this->problem_->body.mass);
        detector_.find(q_, x_, margin,
                       [&](std::size_t feature, const ContactPlane<S>& plane, const std::array<Vector3<S>, 3>& axes,
                           const Vector3<S>& arm, const S& gap) {
                           ContactConstraint<S> c;
                           c.feature = feature, c.arm_W = arm, c.axis_W = axes;
                           c.inverse_mass = inverse_mass, c.gap = gap;
                           c.restitution = plane.restitution, c.friction = plane.friction;
                           c.set_rows(inverse_inertia_W);
                           c.approach = c.velocity(0, now);
                           contacts_.push_back(c);
                       });
    }
    /// Contacts that touch or penetrate.
    void find_closed_contacts(const Matrix3<S>& R) { find_contacts(R, detector_.rounding(x_)); }

    /// Sets each contact's impulse to that of the same point in the last step, times `factor`.
    void recall_impulses(const S& factor) {
        for (ContactConstraint<S>& c : contacts_)
            for (const StoredImpulse& old : stored_)
                if (old.feature == c.feature) c.impulse = factor * old.impulse;
    }
    /// recall_impulses(), and applies them.
    void warm_start(const S& factor, Twist<S>& u) {
        recall_impulses(factor);
        for (const ContactConstraint<S>& c : contacts_) c.apply(c.impulse, u);
    }
    void store_impulses() {
        stored_.clear();
        for (const ContactConstraint<S>& c : contacts_) stored_.push_back({c.feature, c.impulse});
    }

    /// Notes an impact at the time t (s), the start of the step, if a plane acts on a point that it did not act on in
    /// the last step, and this point approached faster than the loads explain: by more than 2 |a| h. `acts(contact)`:
    /// whether the plane acts on the body there.
    template <class Acts>
    void note_impacts(double t, const S& h, const Acts& acts) {
        last_touching_.swap(touching_);
        touching_.clear();
        for (const ContactConstraint<S>& c : contacts_)
            if (acts(c)) touching_.push_back(c.feature);
        const auto is_new = [&](const ContactConstraint<S>& c) { return acts(c) && !has_touched(c.feature); };
        if (std::none_of(contacts_.begin(), contacts_.end(), is_new)) return;
        const S gained = S(2) * h * length(this->acceleration_W(rotation_matrix(q_)));
        for (std::size_t plane = 0; plane < detector_.plane_count(); ++plane)
            if (std::any_of(contacts_.begin(), contacts_.end(), [&](const ContactConstraint<S>& c) {
                    return detector_.plane_of(c.feature) == plane && is_new(c) && -c.approach > gained;
                }))
                impact_times_.push_back(t);
    }
    /// note_impacts() for planes that act by impulses.
    void note_impacts(double t, const S& h) {
        note_impacts(t, h, [](const ContactConstraint<S>& c) { return c.impulse[0] > S(0); });
    }

    /// Solves for the impulses of all contacts, each in Coulomb's cone with u_n >= target, one after another until no
    /// impulse changes any more (nonsmooth Gauss-Seidel). `u` is the velocity without impulses, then with them. Starts
    /// from the contacts' impulses.
    void solve_cones(Twist<S>& u) {
        constexpr int most_sweeps = 1000;
        if (contacts_.size() == 1) {
            ContactConstraint<S>& c = contacts_.front();
            Vector3<S> b = c.velocity(u);
            b[0] = b[0] - c.target;
            c.impulse = solve_coulomb_contact(c.K, b, c.friction);
            c.apply(c.impulse, u);
            return;
        }
        for (const ContactConstraint<S>& c : contacts_) c.apply(c.impulse, u);
        for (int sweep = 0; sweep < most_sweeps && !contacts_.empty(); ++sweep) {
            S change = S(0), size = S(0);
            for (ContactConstraint<S>& c : contacts_) {
                Vector3<S> b = c.velocity(u) - c.K * c.impulse;
                b[0] = b[0] - c.target;
                const Vector3<S> p = solve_coulomb_contact(c.K, b, c.friction), d = p - c.impulse;
                change = change + dot(d, d), size = size + dot(p, p);
                c.apply(d, u);
                c.impulse = p;
            }
            if (!(change > S(16) * Elementary<S>::epsilon() * Elementary<S>::epsilon() * size)) return;
        }
        if (!contacts_.empty()) ++unconverged_;
    }

    ContactDetector<S> detector_;
    std::vector<ContactConstraint<S>> contacts_;
    long evaluations_ = 0;
    long unconverged_ = 0;

  private:
    struct StoredImpulse {
        std::size_t feature;
        Vector3<S> impulse;
    };
    bool has_touched(std::size_t feature) const {
        return std::find(last_touching_.begin(), last_touching_.end(), feature) != last_touching_.end();
    }

    std::vector<StoredImpulse> stored_;
    std::vector<std::size_t> touching_, last_touching_;  // features with an impulse in this step and the one before
    std::vector<double> impact_times_;                   // s
};

/// Value of Method::refusal: why the contacts of a scene are not supported.
std::string contact_refusal(const Problem& problem);

}  // namespace polhode::contact_stepping
