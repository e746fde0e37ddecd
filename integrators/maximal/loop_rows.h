// Selects the loop constraint rows that are kept. Rows that are redundant at the start and remain redundant as the
// mechanism moves (in a planar mechanism, or with parallel axes) are removed permanently. If the set of redundant
// rows depends on the state (Bricard's mechanisms), all are kept, and the multipliers are those of minimum norm.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "integrators/maximal/dynamics.h"

namespace polhode::maximal {

/// Returns placements slightly later on a motion that the constraints allow: at most 1e-5 rad.
template <class P>
std::vector<Placement<P>> displace_along_constraints(const Mechanism<P>& mechanism, const Dynamics<P>& dynamics,
                                                     std::vector<Placement<P>> at) {
    // Arbitrary velocities, without a preferred direction.
    std::vector<Wrench<P>> given(at.size());
    double seed = 1;
    const auto any = [&] {
        seed = std::fmod(seed * 1.618033988749895 + 0.3, 2);
        return P(seed - 1);
    };
    for (int b = 0; b < mechanism.world(); ++b) {
        at[b].velocity_W = at[b].angular_velocity_B = Vector3<P>();
        if (!mechanism.movable(b)) continue;
        given[b].force_W = mechanism.bodies[b].mass * Vector3<P>(any(), any(), any());
        given[b].torque_B = mechanism.bodies[b].inertia * Vector3<P>(any(), any(), any());
    }
    const Rows<P> rows = dynamics.constraints(at);
    dynamics.add_constraint_forces(rows, dynamics.impulses(at, rows, given), given);
    P fastest(1e-6);
    for (int b = 0; b < mechanism.world(); ++b) {
        if (!mechanism.movable(b)) continue;
        at[b].velocity_W = (P(1) / mechanism.bodies[b].mass) * given[b].force_W;
        at[b].angular_velocity_B = mechanism.bodies[b].inverse_inertia * given[b].torque_B;
        const P speed = length(at[b].angular_velocity_B);
        if (fastest < speed) fastest = speed;
    }
    const P time = P(1e-5) / fastest;
    for (int b = 0; b < mechanism.world(); ++b) {
        if (!mechanism.movable(b)) continue;
        const Vector3<P> half = P(time / P(2)) * at[b].angular_velocity_B;
        at[b].q = normalized(at[b].q * Quaternion<P>{P(1), half[0], half[1], half[2]});
        at[b].axes = rotation_matrix(at[b].q);
        at[b].position_W = at[b].position_W + time * at[b].velocity_W;
    }
    return at;
}

/// Treatment of rows whose redundancy changes as the mechanism moves.
enum class LoopRows {
    shortest,     ///< keep all rows and use multipliers of minimum norm
    independent,  ///< remove the rows that are redundant at the start; L D L^T then works while the others stay
                  ///< independent
};

/// Selects the loops' rows at the start.
template <class P>
void choose_loop_rows(const Mechanism<P>& mechanism, Dynamics<P>& dynamics, const std::vector<Placement<P>>& start,
                      LoopRows loops = LoopRows::shortest) {
    const std::pair<Dense<P>, std::vector<P>> found = dynamics.loops(start);
    const Dense<P>& now = found.first;
    const std::vector<P>& size = found.second;
    const std::size_t n = now.size();
    const RowChoice<P> choice = independent_rows(now, size);
    if (choice.rank == static_cast<int>(n)) return;
    Dynamics<P> all = dynamics;
    dynamics.keep(choice.taken, choice.rank, {});
    if (loops == LoopRows::independent) return;

    // Relative size of A x for a vector x that A should map to zero.
    const auto rest = [&](const Dense<P>& A, const std::vector<P>& x) {
        P largest(0), whole(0);
        for (std::size_t i = 0; i < n; ++i) {
            P sum(0);
            for (std::size_t j = 0; j < n; ++j) sum += A[i][j] * x[j];
            const P part = sum * sum / size[i], own = x[i] * x[i] * size[i];
            if (largest < part) largest = part;
            if (whole < own) whole = own;
        }
        return P(square_root(P(largest / whole)));
    };
    const Dense<P> later = all.loops(displace_along_constraints(mechanism, dynamics, start)).first;
    std::vector<char> marks = choice.taken;
    bool changes = false;
    for (std::size_t j = 0; j < n; ++j)
        if (!choice.taken[j] && rest(later, choice.null[j]) > P(1e-7) + P(10) * rest(now, choice.null[j]))
            marks[j] = 1, changes = true;
    if (!changes) return;
    std::vector<P> scales;
    for (std::size_t j = 0; j < n; ++j)
        if (marks[j]) scales.push_back(P(1) / square_root(size[j]));
    all.keep(marks, choice.rank, std::move(scales));
    dynamics = std::move(all);
}

}  // namespace polhode::maximal
