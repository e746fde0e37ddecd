// Impulses between rigid bodies at contacts: Newton's law of restitution, Coulomb friction with a clamped impulse.
//
// contact_impulse() resolves one contact; resolve_impact() resolves simultaneous contacts of one body with immovable
// bodies. All vectors are in world axes. An immovable body has zero inverse mass and inertia, so that its terms
// vanish.
#pragma once

#include <cstddef>
#include <vector>

#include "body/algebra.h"
#include "body/elementary.h"

namespace polhode {

/// A body that impulses act on. The default is immovable and at rest.
template <class S>
struct ImpactBody {
    S inverse_mass = S(0);          ///< 1/kg
    Matrix3<S> inverse_inertia_W;   ///< 1/(kg m^2), about the centre of mass, world axes
    Vector3<S> position_W;          ///< centre of mass, m
    Vector3<S> velocity_W;          ///< centre of mass, m/s
    Vector3<S> angular_velocity_W;  ///< rad/s

    /// Velocity (m/s) of the body's point at `point_W` (m).
    Vector3<S> velocity_at(const Vector3<S>& point_W) const {
        return velocity_W + cross(angular_velocity_W, point_W - position_W);
    }
    /// Applies an impulse (N s) at a point: m dv = J, I dw = r x J.
    void apply_impulse(const Vector3<S>& point_W, const Vector3<S>& impulse_W) {
        velocity_W = velocity_W + inverse_mass * impulse_W;
        angular_velocity_W = angular_velocity_W + inverse_inertia_W * cross(point_W - position_W, impulse_W);
    }
};
/// The former name of ImpactBody.
template <class S>
using StruckBody [[deprecated("renamed to ImpactBody")]] = ImpactBody<S>;

/// A contact of two bodies. The normal is a unit vector from the second body to the first.
template <class S>
struct Contact {
    Vector3<S> point_W;
    Vector3<S> normal_W;
    S restitution = S(1);  ///< e, 0..1
    S friction = S(0);     ///< mu >= 0
};

/// The contact matrix K: an impulse J on a (and -J on b) at the point changes the relative velocity there by K J.
/// Symmetric; 1/kg.
template <class S>
Matrix3<S> contact_matrix(const ImpactBody<S>& a, const ImpactBody<S>& b, const Vector3<S>& point_W) {
    Matrix3<S> K;
    for (int column = 0; column < 3; ++column) {
        Vector3<S> unit;
        unit[column] = S(1);
        Vector3<S> change = (a.inverse_mass + b.inverse_mass) * unit;
        for (const ImpactBody<S>* body : {&a, &b}) {
            const Vector3<S> r = point_W - body->position_W;
            change = change + cross(body->inverse_inertia_W * cross(r, unit), r);
        }
        for (int row = 0; row < 3; ++row) K[row][column] = change[row];
    }
    return K;
}

/// The rounding error of n . v_rel at the contact for a speed of size `scale`.
template <class S>
S contact_rounding(const S& scale) {
    return S(64) * Elementary<S>::epsilon() * scale;
}

/// The impulse on `a` (N s, world axes; `b` receives the opposite) at an approaching contact; zero at any other.
///
/// Without friction the impulse is j n with
///   j = -(1 + e) v_rel.n / (1/m_a + 1/m_b + n.[(I_a^-1 (r_a x n)) x r_a + (I_b^-1 (r_b x n)) x r_b])
/// (C. Hecker 1997, Game Developer, "Physics, Part 4"). With friction, after E. Guendelman, R. Bridson and R. Fedkiw
/// 2003, ACM Trans. Graph. 22, 871: the sticking impulse, K J = -v_t - (1 + e) v_n, if it lies in Coulomb's cone
/// |J_t| <= mu J_n; otherwise J = j (n - mu t), where t is the slip's direction before the impact and j reverses the
/// normal speed e-fold. These two rules can gain energy where K couples normal and tangential motion (T. R. Kane
/// 1984's puzzle). Therefore sticking is used only if it gains no energy, and sliding friction is limited to the
/// impulse that stops the slip along t. Then 2 dE = J.(v_rel + v_rel') <= 0 in each case.
template <class S>
Vector3<S> contact_impulse(const ImpactBody<S>& a, const ImpactBody<S>& b, const Contact<S>& contact) {
    const Vector3<S>& n = contact.normal_W;
    const Vector3<S> v = a.velocity_at(contact.point_W) - b.velocity_at(contact.point_W);
    const S normal_speed = dot(n, v);
    if (!(normal_speed < S(0))) return {};
    const Matrix3<S> K = contact_matrix(a, b, contact.point_W);
    const Vector3<S> Kn = K * n;
    const S K_nn = dot(n, Kn);
    if (!(K_nn > S(0))) return {};  // both are immovable
    const S gained = -(S(1) + contact.restitution) * normal_speed;
    const S plain = gained / K_nn;
    if (contact.friction == S(0)) return plain * n;

    const Vector3<S> slip = v - normal_speed * n;
    Vector3<S> stick = inverse(K) * (gained * n - slip);
    const S stick_normal = dot(n, stick);
    const Vector3<S> stick_tangential = stick - stick_normal * n;
    const bool in_cone =
        dot(stick_tangential, stick_tangential) <= contact.friction * contact.friction * stick_normal * stick_normal;
    if (stick_normal > S(0) && in_cone && !(dot(stick, v + v + K * stick) > S(0))) return stick;

    // without slip before the impact: oppose the slip that the normal impulse alone would cause
    const S rounding = contact_rounding(S(square_root(dot(v, v))));
    Vector3<S> along = slip;
    if (!(dot(slip, slip) > rounding * rounding)) along = Kn - K_nn * n;
    const S length = square_root(dot(along, along));
    if (!(length > S(0))) return plain * n;
    const Vector3<S> t = (S(1) / length) * along;
    const S before = dot(t, slip), K_nt = dot(t, Kn), K_tt = dot(t, K * t);
    // J = j (n - m t), j = gained / (K_nn - m K_nt); slip along t afterwards: before + j (K_nt - m K_tt)
    const S stopping_over = before * K_nt + gained * K_tt, stopping = before * K_nn + gained * K_nt;
    if (!(stopping > S(0))) return plain * n;  // the normal impulse alone reverses the slip
    S m = contact.friction;
    if (stopping_over > S(0) && m * stopping_over > stopping) m = stopping / stopping_over;
    const S denominator = K_nn - m * K_nt;
    if (!(denominator > S(0))) return plain * n;
    return (gained / denominator) * (n - m * t);
}

/// The result of an impact at several simultaneous contacts.
struct ImpactOutcome {
    bool has_impact = false;  ///< a contact was approaching
    bool resolved = true;     ///< no contact approaches any more
    double separation = 0;    ///< the largest separation speed (m/s) after the impact
};

/// Resolves simultaneous contacts of one body with immovable bodies. A single approaching contact uses
/// contact_impulse(). Several contacts without friction follow Moreau's law (J. J. Moreau 1988; equal to Newton's law
/// with complementarity): with e the smallest restitution, v' = (1 + e) w - e v, where w is the motion nearest to v
/// in the kinetic-energy metric that approaches no contact. The result does not depend on the order of contacts and
/// conserves energy at e = 1. w is computed to rounding by projected Gauss-Seidel iteration on the impulses. With
/// friction, contacts are resolved one at a time, the fastest approaching first. Both are repeated until no contact
/// approaches.
template <class S>
ImpactOutcome resolve_impact(ImpactBody<S>& body, const std::vector<Contact<S>>& contacts) {
    constexpr int most_rounds = 1000, most_sweeps = 100'000;
    ImpactOutcome outcome;
    const ImpactBody<S> ground;
    S scale = square_root(dot(body.velocity_W, body.velocity_W));
    bool friction = false;
    for (const Contact<S>& contact : contacts) {
        const Vector3<S> v = body.velocity_at(contact.point_W);
        const S speed = square_root(dot(v, v));
        if (speed > scale) scale = speed;
        friction = friction || contact.friction > S(0);
    }
    const S rounding = contact_rounding(scale);
    const auto speed_at = [&](const Contact<S>& contact) {
        return dot(contact.normal_W, body.velocity_at(contact.point_W));
    };
    for (int round = 0;; ++round) {
        const Contact<S>* fastest = nullptr;
        S least = -rounding;
        std::size_t approaching = 0;
        for (const Contact<S>& contact : contacts) {
            const S speed = speed_at(contact);
            if (!(speed < -rounding)) continue;
            ++approaching;
            if (speed < least) least = speed, fastest = &contact;
        }
        if (!fastest) break;
        if (round == most_rounds) {
            outcome.resolved = false;
            break;
        }
        outcome.has_impact = true;
        if (friction || contacts.size() == 1) {
            body.apply_impulse(fastest->point_W, contact_impulse(body, ground, *fastest));
            continue;
        }
        // impulses p >= 0 with n.v >= 0 and p (n.v) = 0
        const ImpactBody<S> before = body;
        std::vector<S> p(contacts.size(), S(0)), inverse_K;
        for (const Contact<S>& contact : contacts)
            inverse_K.push_back(
                S(1) / dot(contact.normal_W, contact_matrix(body, ground, contact.point_W) * contact.normal_W));
        S moved = scale;
        int sweeps = 0;
        while (moved > rounding / S(16) && sweeps++ < most_sweeps) {
            moved = S(0);
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                const S speed = speed_at(contacts[i]);
                S next = p[i] - inverse_K[i] * speed;
                if (next < S(0)) next = S(0);
                const S change = next - p[i];
                if (change == S(0)) continue;
                body.apply_impulse(contacts[i].point_W, change * contacts[i].normal_W);
                p[i] = next;
                const S effect = change / inverse_K[i], size = effect < S(0) ? S(-effect) : effect;
                if (size > moved) moved = size;
            }
        }
        if (sweeps > most_sweeps) outcome.resolved = false;
        S e = contacts.front().restitution;
        for (const Contact<S>& contact : contacts)
            if (contact.restitution < e) e = contact.restitution;
        body = before;
        for (std::size_t i = 0; i < contacts.size(); ++i)
            if (p[i] > S(0)) body.apply_impulse(contacts[i].point_W, (S(1) + e) * p[i] * contacts[i].normal_W);
    }
    for (const Contact<S>& contact : contacts) {
        const double speed = static_cast<double>(speed_at(contact));
        if (speed > outcome.separation) outcome.separation = speed;
    }
    return outcome;
}

}  // namespace polhode
