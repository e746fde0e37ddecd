// A mechanism in maximal coordinates as a differential-algebraic system, for DAE solvers. The multipliers are
// separate unknowns.
//
//   index 1:  y' = f(y, lambda),                 0 = d2g/dt2
//   index 2:  y' = f(y, lambda) + position terms in mu and nu,  0 = g(y),  0 = dg/dt,  0 = |q|^2 - 1 of each body
//
// Index 2 is the stabilised form of C. W. Gear, B. Leimkuhler & G. K. Gupta 1985 (J. Comput. Appl. Math. 12-13,
// 77-90): mu changes positions as lambda changes momenta, and nu changes the norms of quaternions. Both vanish except
// for integration errors.
//
// Index 2 is not available where a body has no mass or a zero moment: the force of an added inertia
// (Kind::added_inertia) has no counterpart among positions.
#pragma once

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "integrators/maximal/system.h"

namespace polhode::maximal {

/// Index of the differential-algebraic system.
enum class Index { one, two };

/// Unknowns or equations that are treated together: y and nu of a body, or the multipliers and angles of a link.
struct Group {
    std::vector<int> unknowns;
    std::vector<int> coupled_groups;  ///< groups whose equations may contain these unknowns
    int color = 0;                    ///< no equation contains unknowns of two groups of one colour
};

/// Evaluates the equations and groups unknowns for a sparse Jacobian.
template <class P>
class ConstrainedEquations {
  public:
    static constexpr int most_in_group = 14;  ///< q, p, L, P and nu; or 6 lambda, 6 mu, 2 angles

    /// `system` must outlive this object.
    ConstrainedEquations(const System<P>& system, Index index) : system_(&system), index_(index) {
        lambda_ = system.dimension();
        mu_ = lambda_ + system.dynamics().rows();
        nu_ = index == Index::two ? mu_ + system.dynamics().rows() : mu_;
        count_ = nu_ + (index == Index::two ? system.angles() / System<P>::body_size : 0);
        find_groups();
    }

    /// Number of unknowns: y, lambda and, with index 2, mu and nu.
    int unknowns() const { return count_; }
    /// Number of differential unknowns, those of y.
    int differential() const { return lambda_; }
    int lambda() const { return lambda_; }
    int mu() const { return mu_; }
    int nu() const { return nu_; }
    const std::vector<Group>& groups() const { return groups_; }
    int colors() const { return colors_; }

    /// Computes y' for the differential equations and the residuals of the others.
    template <class S>
    void evaluate(const S* z, S* result) const {
        const Mechanism<P>& mechanism = system_->mechanism();
        const Dynamics<P>& dynamics = system_->dynamics();
        const std::vector<Placement<S>> at = system_->placements(z);
        const Rows<S> rows = dynamics.constraints(at);
        std::vector<Wrench<S>> on(at.size()), moved(at.size());
        add_forces(mechanism, system_->loads(), at, z + system_->angles(), on);
        dynamics.add_constraint_forces(rows, std::vector<S>(z + lambda_, z + mu_), on);
        if (index_ == Index::two) dynamics.add_constraint_forces(rows, std::vector<S>(z + mu_, z + nu_), moved);
        system_->put_rates(at, on, result);
        if (index_ == Index::one) {
            std::vector<S> still = dynamics.decelerations(at, rows, on);
            dynamics.add_compliance(z + lambda_, still);
            std::copy(still.begin(), still.end(), result + lambda_);
            return;
        }
        for (int b = 0; b < mechanism.world(); ++b) {
            const int first = system_->place(b);
            if (first < 0) continue;
            const MaximalBody<P>& body = mechanism.bodies[b];
            const Vector3<S> half = (P(1) / P(2)) * (body.inverse_inertia * moved[b].torque_B);
            const Quaternion<S>& q = at[b].q;
            const Quaternion<S> turned = q * Quaternion<S>{S(P(0)), half[0], half[1], half[2]};
            const int own = nu_ + first / System<P>::body_size;
            const S& nu = z[own];
            S* rate = result + first;
            rate[0] = rate[0] + turned.w - nu * q.w, rate[1] = rate[1] + turned.x - nu * q.x;
            rate[2] = rate[2] + turned.y - nu * q.y, rate[3] = rate[3] + turned.z - nu * q.z;
            const Vector3<S> shift = (P(1) / body.mass) * moved[b].force_W;
            for (int i = 0; i < 3; ++i) rate[4 + i] = rate[4 + i] + shift[i];
            result[own] = (P(1) / P(2)) * (squared_norm(q) - S(P(1)));
        }
        const std::vector<S> gaps = dynamics.gaps(at), velocity_errors = dynamics.velocity_errors(at, rows);
        std::copy(gaps.begin(), gaps.end(), result + lambda_);
        std::copy(velocity_errors.begin(), velocity_errors.end(), result + mu_);
    }

  private:
    const System<P>* system_;
    Index index_;
    int lambda_ = 0, mu_ = 0, nu_ = 0, count_ = 0;
    std::vector<Group> groups_;
    int colors_ = 0;

    void find_groups() {
        const Mechanism<P>& mechanism = system_->mechanism();
        const int bodies = mechanism.world(), links = static_cast<int>(mechanism.links.size());
        groups_.resize(bodies + links);
        // bodies that interact with each body, and links attached to it
        std::vector<std::set<int>> near(bodies), links_of(bodies);
        const auto join = [&](int a, int b) {
            if (mechanism.movable(a) && mechanism.movable(b)) near[a].insert(b), near[b].insert(a);
        };
        for (int b = 0; b < bodies; ++b) join(b, b);
        for (int k = 0; k < links; ++k) {
            const Link<P>& link = mechanism.links[k];
            join(link.from.body, link.to.body);
            for (const int b : {link.from.body, link.to.body})
                if (mechanism.movable(b)) links_of[b].insert(k);
        }
        for (const Load& load : mechanism.scene().loads)
            if (const auto* tie = std::get_if<PointSpring>(&load))
                join(mechanism.number_of(tie->first), mechanism.number_of(tie->second));

        const auto fill = [](Group& group, int first, int count) {
            for (int i = 0; i < count; ++i) group.unknowns.push_back(first + i);
        };
        for (int b = 0; b < bodies; ++b) {
            const int first = system_->place(b);
            if (first < 0) continue;
            Group& group = groups_[b];
            fill(group, first, System<P>::body_size);
            if (index_ == Index::two) group.unknowns.push_back(nu_ + first / System<P>::body_size);
            std::set<int> met;
            for (const int other : near[b]) {
                met.insert(other);
                for (const int k : links_of[other]) met.insert(bodies + k);
            }
            group.coupled_groups.assign(met.begin(), met.end());
        }
        for (int k = 0; k < links; ++k) {
            const Link<P>& link = mechanism.links[k];
            Group& group = groups_[bodies + k];
            const int row = system_->dynamics().first_row(k);
            const int count = static_cast<int>(system_->dynamics().kept(k).size());
            fill(group, lambda_ + row, count);
            if (index_ == Index::two) fill(group, mu_ + row, count);
            if (link.angles >= 0) fill(group, system_->angles() + link.angles, link.coordinates());
            std::set<int> met{bodies + k};
            for (const int b : {link.from.body, link.to.body}) {
                if (!mechanism.movable(b)) continue;
                met.insert(b);
                for (const int other : links_of[b]) met.insert(bodies + other);
            }
            group.coupled_groups.assign(met.begin(), met.end());
        }
        color_groups();
    }

    // Greedy colouring: each group takes the first colour not used by any group that shares an equation with it.
    void color_groups() {
        std::vector<std::set<int>> taken(groups_.size());
        for (Group& group : groups_) {
            if (group.unknowns.empty()) continue;
            const auto meets = [&](int color) {
                return std::any_of(group.coupled_groups.begin(), group.coupled_groups.end(),
                                   [&](int other) { return taken[other].contains(color); });
            };
            while (meets(group.color)) ++group.color;
            for (const int other : group.coupled_groups) taken[other].insert(group.color);
            colors_ = std::max(colors_, group.color + 1);
        }
    }
};

}  // namespace polhode::maximal
