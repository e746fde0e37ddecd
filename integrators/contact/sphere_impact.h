// The impulse of an impact between two spheres with Coulomb friction, in two independent forms.
//
// The normal n points from the second sphere to the first, u = v_1 - v_2 + (w_1 x a_1 - w_2 x a_2) is the relative
// velocity at the contact, with a_1 = -r_1 n and a_2 = r_2 n. An impulse f on the first sphere changes u by K f. For
// spheres with equal moments K = 1/m n n^T + k (1 - n n^T), so the slip keeps its direction and the normal motion is
// independent of friction (R. L. Garwin 1969, Am. J. Phys. 37, 88; D. G. Alciatore, technical proof TP A-14).
#pragma once

#include <array>
#include <cstddef>

#include "body/algebra.h"
#include "body/elementary.h"

namespace polhode::contact {

/// Two spheres at the instant of an impact; moments about their centres.
template <class P>
struct SphereImpact {
    Vector3<P> normal_W;                   ///< unit, from the second sphere to the first
    std::array<Vector3<P>, 2> velocity_W;  ///< velocities at the centres, m/s
    std::array<Vector3<P>, 2> rotation_W;  ///< rad/s
    std::array<P, 2> radius{}, mass{}, moment{};
    P restitution{1}, friction{0};

    Vector3<P> arm(std::size_t i) const { return (i == 0 ? P(-radius[0]) : radius[1]) * normal_W; }
    /// Relative velocity at the contact, m/s.
    Vector3<P> slip_velocity() const {
        return velocity_W[0] + cross(rotation_W[0], arm(0)) - velocity_W[1] - cross(rotation_W[1], arm(1));
    }
};

/// The impulse on the first sphere, N s, in closed form: p = (1 + e) |u_n| m and the smaller of mu p and |u_t| / k.
struct ClosedFormImpact {
    template <class P>
    static Vector3<P> impulse(const SphereImpact<P>& at) {
        const Vector3<P> u = at.slip_velocity();
        const P approach = dot(u, at.normal_W);
        P inverse_mass(0), k(0);
        for (std::size_t i = 0; i < 2; ++i) {
            inverse_mass = inverse_mass + P(1) / at.mass[i];
            k = k + P(1) / at.mass[i] + at.radius[i] * at.radius[i] / at.moment[i];
        }
        const P normal = -(P(1) + at.restitution) * approach / inverse_mass;
        const Vector3<P> tangential = u - approach * at.normal_W;
        const P slip = length(tangential);
        Vector3<P> impulse = normal * at.normal_W;
        if (!(slip > P(0))) return impulse;
        const P limit = at.friction * normal, stops = slip / k;
        return impulse - ((stops < limit ? stops : limit) / slip) * tangential;
    }
};

/// The same impulse by the phases of the impact: compression and restitution, each with sliding and sticking, with the
/// matrix K that unit impulses give.
struct PhasedImpact {
    template <class P>
    static Vector3<P> impulse(const SphereImpact<P>& at) {
        const Matrix3<P> K = response(at);
        Vector3<P> u = at.slip_velocity(), total;
        P compression(0), left = P(0);
        for (const bool compresses : {true, false}) {
            if (!compresses) left = at.restitution * compression;
            // sliding until the slip or the stage ends, then sticking
            for (const bool sticks : {false, true}) {
                const P normal_velocity = dot(u, at.normal_W);
                const Vector3<P> tangential = u - normal_velocity * at.normal_W;
                const P slip = length(tangential);
                const bool slides = !sticks && slip > P(0) && at.friction > P(0);
                if (!sticks && !slides) continue;
                const Vector3<P> f =
                    slides ? Vector3<P>(at.normal_W - (at.friction / slip) * tangential) : sticking_force(K, at);
                const Vector3<P> rate = K * f;
                P stage = compresses ? P(-normal_velocity / dot(rate, at.normal_W)) : left;
                const P stops = slides ? P(-slip * slip / dot(rate, tangential)) : stage;
                const bool stops_first = slides && stops < stage;
                if (stops_first) stage = stops;
                total = total + stage * f;
                u = u + stage * rate;
                if (compresses) compression = compression + stage;
                left = left - stage;
                if (!stops_first) break;
                u = dot(u, at.normal_W) * at.normal_W;
            }
        }
        return total;
    }

  private:
    // the force for a unit normal force that keeps the slip at zero
    template <class P>
    static Vector3<P> sticking_force(const Matrix3<P>& K, const SphereImpact<P>& at) {
        if (!(at.friction > P(0))) return at.normal_W;
        const Vector3<P> f = inverse(K) * at.normal_W;
        return (P(1) / dot(f, at.normal_W)) * f;
    }
    template <class P>
    static Matrix3<P> response(const SphereImpact<P>& at) {
        Matrix3<P> K;
        for (std::size_t j = 0; j < 3; ++j) {
            Vector3<P> unit, u;
            unit[j] = P(1);
            for (std::size_t b = 0; b < 2; ++b)
                u = u + (P(1) / at.mass[b]) * unit +
                    cross(Vector3<P>((P(1) / at.moment[b]) * cross(at.arm(b), unit)), at.arm(b));
            for (std::size_t i = 0; i < 3; ++i) K[i][j] = u[i];
        }
        return K;
    }
};

}  // namespace polhode::contact
