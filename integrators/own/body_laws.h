// Equations of one body with its parameters as constant state variables. A recording of them serves all bodies that
// have nonzero values for the same parameters.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "motion/body_equations.h"
#include "motion/traced.h"

namespace polhode {

using TracedNumber = Traced<double>;

/// Inertia and forcing of a body, in principal axes.
template <class P>
struct BodyLaw {
    PrincipalInertia<P> inertia;
    Forcing<P> forcing;
    bool has_translation = false;  // p and v are variables too

    int variables() const { return has_translation ? BodyState::motion : BodyState::rotation; }
    template <class S>
    void derivative(const S* y, S* dy) const {
        if (has_translation)
            LoadedEquations<P, PrincipalInertia<P>, true>{inertia, &forcing}.derivative(0, y, dy);
        else
            LoadedEquations<P, PrincipalInertia<P>, false>{inertia, &forcing}.derivative(0, y, dy);
    }
    // Visits all parameters, always in the same order.
    template <class Visit>
    void visit_parameters(Visit&& visit) {
        const auto each = [&](auto&... triple) { (visit(triple[0], triple[1], triple[2]), ...); };
        each(inertia.gyroscopic, inertia.inverse_moments);
        if (forcing.has_torque) each(forcing.torque);
        if (forcing.has_world_torque) each(forcing.torque_W);
        if (forcing.has_damping) each(forcing.damping[0], forcing.damping[1], forcing.damping[2]);
        for (int b = 0; b < 3; ++b)
            if (forcing.field.present[b]) each(forcing.field.moment[b]);
        for (auto& point : forcing.world_points) each(point.point_W, point.force);
        for (auto& spring : forcing.springs)
            visit(spring.stiffness, spring.rest.w, spring.rest.x), visit(spring.rest.y, spring.rest.z);
        if (!has_translation) return;
        each(forcing.acceleration_W);
        if (forcing.has_body_force) each(forcing.specific_force);
        if (forcing.has_translational_drag) visit(forcing.specific_drag);
    }
    std::vector<P> parameters() {
        std::vector<P> all;
        visit_parameters([&](const auto&... parameters) { (all.push_back(parameters), ...); });
        return all;
    }
};

/// A law whose nonzero parameters are constant state variables. One recording serves all bodies with such a law.
struct ParametrizedBody {
    BodyLaw<double> reference_law;

    void derivative(const TracedNumber* y, TracedNumber* dy) const {
        BodyLaw<TracedNumber> law;
        Forcing<TracedNumber>& f = law.forcing;
        const Forcing<double>& g = reference_law.forcing;
        law.has_translation = reference_law.has_translation;
        f.has_torque = g.has_torque, f.has_world_torque = g.has_world_torque, f.has_damping = g.has_damping;
        f.has_translational_drag = g.has_translational_drag, f.has_body_force = g.has_body_force;
        f.pivoted = g.pivoted, f.field.present = g.field.present;
        for (const auto& point : g.world_points) f.world_points.push_back({{}, {}, point.frame});
        f.springs.resize(g.springs.size());
        const std::vector<double> parameters = BodyLaw<double>(reference_law).parameters();
        int k = 0, at = law.variables();
        const auto put = [&](TracedNumber& number) {
            if (parameters[k++] != 0) number = y[at++];
        };
        law.visit_parameters([&](auto&... each) { (put(each), ...); });
        law.derivative(y, dy);
        std::fill(dy + law.variables(), dy + at, TracedNumber());
    }
};

// A body with equal moments transverse to an axis s, in fields whose moments m_b are along s. The axes i, j, s do not
// spin with the body; they and the world axes are numbered 1, 2, 3.
//
//   u_1' = -c u_2 - sum_b mu_b e_b,2,  u_2' = c u_1 + sum_b mu_b e_b,1,  q' = 1/2 q (0, u),  u_3 = 0
//
// Here c = I_s w_s/I_i, mu_b = m_b,s/I_i, w_s is constant, and e_b are the world axes in these axes. The body has
// rotated by w_s t relative to them. Step sizes follow the precession and nutation, not the spin.
struct SymmetricBody {
    // y: u_1, u_2, q, then c, mu_1, mu_2, mu_3
    void derivative(const TracedNumber* y, TracedNumber* dy) const {
        const Quaternion<TracedNumber> q = quaternion_at(y, 2);
        dy[0] = -(y[6] * y[1]), dy[1] = y[6] * y[0];
        for (int b = 0; b < 3; ++b) {
            const Vector3<TracedNumber> e = world_axis(q, b);
            if (present[b]) dy[0] -= y[7 + b] * e[1], dy[1] += y[7 + b] * e[0];
        }
        put(dy, 2, attitude_rate(TracedNumber(0.5), q, Vector3<TracedNumber>(y[0], y[1], TracedNumber())));
    }
    // Returns the axis s, or -1 if there is none.
    static int axis(const BodyLaw<double>& law, const Vector3<double>& moments) {
        if (law.has_translation || law.forcing.any_torque_beside_field()) return -1;
        for (int s = 0; s < 3; ++s) {
            const int i = (s + 1) % 3, j = (s + 2) % 3;
            bool is_along = moments[i] == moments[j];
            for (const Vector3<double>& m : law.forcing.field.moment) is_along = is_along && m[i] == 0 && m[j] == 0;
            if (is_along) return s;
        }
        return -1;
    }

    std::array<bool, 3> present;
};

}  // namespace polhode
