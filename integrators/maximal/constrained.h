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
// The forces of added inertias and armatures (Kind) constrain nothing: with index 2, too, they follow from their rows
// of accelerations, and their mu are zero.
//
// Rows of joint coordinates (Kind::coordinate) require sum factor x = value(t), with its rate and acceleration. For
// couplings the value is the offset. The angle x of a revolute joint follows from the attitudes of the two bodies, and
// its revolutions from an integrated angle in the state.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "integrators/maximal/formulas.h"
#include "integrators/maximal/system.h"
#include "motion/dual.h"

namespace polhode::maximal {

/// Index of the differential-algebraic system.
enum class Index { one, two };

/// Unknowns or equations that are treated together: y and nu of a body, or the multipliers and angles of a link.
struct Group {
    std::vector<int> unknowns;
    std::vector<int> coupled_groups;  ///< groups whose equations may contain these unknowns
    int color = 0;                    ///< no equation contains unknowns of two groups of one colour
};

/// The value that the coordinate of a locked joint, or the difference of coupled coordinates, must have.
template <class P>
struct CoordinateTarget {
    P value{0}, rate{0}, acceleration{0};
};

/// The joints whose coordinates the equations need in the state of the system: with index 2, coupled and locked ones.
inline std::vector<int> joints_to_count(const Scene& scene, Index index, std::span<const int> locked = {}) {
    std::set<int> all;
    if (index == Index::one) return {};
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
        for (const Coupling& coupling : scene.couplings)
            if (coupling.first == scene.joints[j].name || coupling.second == scene.joints[j].name)
                all.insert(static_cast<int>(j));
    all.insert(locked.begin(), locked.end());
    return {all.begin(), all.end()};
}

/// Evaluates the equations and groups unknowns for a sparse Jacobian.
template <class P>
class ConstrainedEquations {
  public:
    static constexpr int most_in_group = 14;  ///< q, p, L, P and nu; or 6 lambda, 6 mu, 2 coordinates

    /// `system` must outlive this object. With index 2, its state must have the coordinates of joints_to_count().
    ConstrainedEquations(const System<P>& system, Index index)
        : system_(&system), index_(index), added_rows_(system.dynamics().added_rows()) {
        lambda_ = system.dimension();
        mu_ = lambda_ + system.dynamics().rows();
        nu_ = index == Index::two ? mu_ + system.dynamics().rows() : mu_;
        count_ = nu_ + (index == Index::two ? system.angles() / System<P>::body_size : 0);
        find_coordinate_rows();
        find_groups();
    }

    /// The values of the rows of coordinates: couplings in the scene's order, then locked joints. Constants, until they
    /// are changed.
    std::vector<CoordinateTarget<P>>& targets() { return targets_; }
    /// The coordinate of a joint of one coordinate, from the positions of the bodies in a state z.
    P coordinate(std::size_t joint, const P* z) const {
        return coordinate_at(static_cast<int>(joint), system_->placements(z), z);
    }
    /// Moves y onto the constraints: positions by Newton's method, with changes that are smallest in the norm of the
    /// masses, then velocities. Requires index 2.
    void project(P* y) const {
        constexpr int most_rounds = 5;
        const Dynamics<P>& dynamics = system_->dynamics();
        for (int round = 0;; ++round) {
            const std::vector<Placement<P>> at = system_->placements(y);
            const Rows<P> rows = dynamics.constraints(at);
            std::vector<P> gaps = dynamics.gaps(at), rates = dynamics.velocity_errors(at, rows);
            for (std::size_t i = 0; i < coordinate_rows_.size(); ++i)
                if (const int row = coordinate_rows_[i].row; row >= 0) {
                    gaps[static_cast<std::size_t>(row)] = coordinate_gap(i, at, y);
                    rates[static_cast<std::size_t>(row)] = rates[static_cast<std::size_t>(row)] + targets_[i].rate;
                }
            for (const int row : added_rows_)
                gaps[static_cast<std::size_t>(row)] = rates[static_cast<std::size_t>(row)] = P(0);
            P largest(0);
            for (P& gap : gaps) {
                largest = std::max(largest, P(std::abs(gap)));
                gap = -gap;
            }
            std::vector<Wrench<P>> moved(at.size());
            if (largest > P(1e-14) && round < most_rounds) {
                dynamics.add_constraint_forces(rows, dynamics.solve(rows, std::move(gaps)), moved);
                move(at, moved, y);
                continue;
            }
            dynamics.add_constraint_forces(rows, dynamics.solve(rows, std::move(rates)), moved);
            for (int b = 0; b < system_->mechanism().world(); ++b) {
                const int first = system_->place(b);
                if (first < 0) continue;
                const Wrench<P>& by = moved[static_cast<std::size_t>(b)];
                const Placement<P>& body = at[static_cast<std::size_t>(b)];
                put(y, first + 7, vector_at(y, first + 7) + by.torque_W + body.world(by.torque_B));
                put(y, first + 10, vector_at(y, first + 10) + by.force_W);
            }
            return;
        }
    }
    /// Sets z and its rates to consistent values for the given y: lambda from the accelerations, mu and nu zero.
    void make_consistent(P* z, P* rate) const {
        std::fill(z + lambda_, z + count_, P(0));
        std::fill(rate, rate + count_, P(0));
        const std::vector<Placement<P>> at = system_->placements(z);
        Rows<P> rows = system_->dynamics().constraints(at);
        for (std::size_t i = 0; i < coordinate_rows_.size(); ++i)
            if (const CoordinateRow& one = coordinate_rows_[i]; one.row >= 0) {
                Row<P>& row = rows[one.link].front();
                row.bias = row.bias - targets_[i].acceleration;
            }
        std::vector<Wrench<P>> on(at.size());
        add_forces(system_->mechanism(), system_->loads(), at, z + system_->angles(), on);
        add_formulas(at, z, on);
        const std::vector<P> lambda = system_->dynamics().multipliers(at, rows, on);
        system_->dynamics().add_constraint_forces(rows, lambda, on);
        system_->put_rates(at, on, rate);
        std::copy(lambda.begin(), lambda.end(), z + lambda_);
    }

    /// Adds loads given by formulas, with the signs of their switches. `variables`: those of the formulas, which must
    /// not change. `formulas` must outlive this object.
    void set_formulas(const Formulas<P>& formulas, std::vector<P> variables) {
        formulas_ = &formulas, formula_variables_ = std::move(variables);
        // formulas may read the motion of any body
        std::vector<int> all;
        for (std::size_t g = 0; g < groups_.size(); ++g)
            if (!groups_[g].unknowns.empty()) all.push_back(static_cast<int>(g));
        for (Group& group : groups_)
            if (!group.unknowns.empty()) group.coupled_groups = all, group.color = 0;
        color_groups();
    }
    /// Sets the time that formulas read, s.
    void set_time(const P& t) { time_ = t; }

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
        add_formulas(at, z, on);
        dynamics.add_constraint_forces(rows, std::vector<S>(z + lambda_, z + mu_), on);
        if (index_ == Index::two) dynamics.add_constraint_forces(rows, std::vector<S>(z + mu_, z + nu_), moved);
        system_->put_rates(at, on, result);
        if (index_ == Index::one) {
            std::vector<S> still = dynamics.decelerations(at, rows, on);
            dynamics.add_compliance(z + lambda_, still);
            for (std::size_t i = 0; i < coordinate_rows_.size(); ++i)
                if (const int row = coordinate_rows_[i].row; row >= 0)
                    still[static_cast<std::size_t>(row)] =
                        still[static_cast<std::size_t>(row)] + targets_[i].acceleration;
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
        add_corrections(at, moved, result);
        for (std::size_t i = 0; i < coordinate_rows_.size(); ++i) {
            const CoordinateRow& one = coordinate_rows_[i];
            if (one.row < 0) continue;
            result[lambda_ + one.row] = coordinate_gap(i, at, z);
            result[mu_ + one.row] = result[mu_ + one.row] + targets_[i].rate;
        }
        if (added_rows_.empty()) return;
        std::vector<S> still = dynamics.decelerations(at, rows, on);
        dynamics.add_compliance(z + lambda_, still);
        for (const int row : added_rows_)
            result[lambda_ + row] = still[static_cast<std::size_t>(row)], result[mu_ + row] = z[mu_ + row];
    }

  private:
    // A row of one or several coordinates; -1 if it is redundant.
    struct CoordinateRow {
        int row = -1;
        std::size_t link = 0;                     // the link that has the row
        std::vector<std::pair<int, P>> summands;  // joints, and the factors of their coordinates
    };

    const System<P>* system_;
    Index index_;
    std::vector<int> added_rows_;
    std::vector<CoordinateRow> coordinate_rows_;
    std::vector<CoordinateTarget<P>> targets_;
    const Formulas<P>* formulas_ = nullptr;
    std::vector<P> formula_variables_;
    P time_{0};
    int lambda_ = 0, mu_ = 0, nu_ = 0, count_ = 0;
    std::vector<Group> groups_;
    int colors_ = 0;

    template <class S>
    void add_formulas(const std::vector<Placement<S>>& at, const S* z, std::vector<Wrench<S>>& on) const {
        if (!formulas_) return;
        // the state of the system, the time, and the variables of the formulas
        std::vector<S> y(z, z + lambda_);
        y.push_back(S(time_));
        for (const P& variable : formula_variables_) y.push_back(S(variable));
        const MechanismState<S> state = formulas_->state(*system_, y.data(), at, lambda_, lambda_ + 1);
        formulas_->add(*system_, formulas_->terms().template evaluate<S>(state, y.data() + lambda_ + 1, true), at, on);
    }
    void find_coordinate_rows() {
        const Mechanism<P>& mechanism = system_->mechanism();
        for (std::size_t k = 0; k < mechanism.links.size(); ++k) {
            const Link<P>& link = mechanism.links[k];
            if (link.kind != Kind::coordinate) continue;
            if (link.partner < 0) {
                const bool is_kept = !system_->dynamics().kept(k).empty();
                coordinate_rows_.push_back({is_kept ? system_->dynamics().first_row(k) : -1, k, {}});
                targets_.emplace_back();
            }
            coordinate_rows_.back().summands.emplace_back(link.joint, link.factor);
        }
        const std::vector<Coupling>& couplings = mechanism.scene().couplings;
        for (std::size_t i = 0; i < couplings.size(); ++i) targets_[i].value = P(couplings[i].offset);
    }
    static const P& number_in(const P& x) { return x; }
    template <int N>
    static const P& number_in(const Dual<N, P>& x) {
        return x.value;
    }
    // The coordinate of a joint, from the positions of its bodies.
    template <class S>
    S coordinate_at(int joint, const std::vector<Placement<S>>& at, const S* z) const {
        const Link<P>& link = system_->mechanism().links[static_cast<std::size_t>(joint)];
        const LinkView<P, S> view = system_->view(link, at);
        if (link.kind == Kind::prismatic) return view.displacement();
        // 2 tan((x - a) / 2) is zero at the number a that equals x, and has the derivatives of x
        const auto [sine, cosine] = view.half_angle();
        P half = std::atan2(number_in(sine), number_in(cosine));
        const P s = std::sin(half), c = std::cos(half);
        const S rest = P(2) * ((c * sine - s * cosine) / (c * cosine + s * sine));
        const P counted = number_in(z[system_->angles() + link.angles]);
        half = half + std::numbers::pi * std::round((counted - P(2) * half) / (2 * std::numbers::pi));
        return P(2) * half + rest;
    }
    // Adds the changes of counted coordinates that belong to changes of positions by M^-1 times momenta.
    template <class S>
    void add_corrections(std::vector<Placement<S>> at, const std::vector<Wrench<S>>& moved, S* result) const {
        const Mechanism<P>& mechanism = system_->mechanism();
        if (std::ranges::none_of(mechanism.links, &Link<P>::counted)) return;
        for (int b = 0; b < mechanism.world(); ++b) {
            if (!mechanism.movable(b)) continue;
            const std::size_t body = static_cast<std::size_t>(b);
            at[body].velocity_W = (P(1) / mechanism.bodies[body].mass) * moved[body].force_W;
            at[body].angular_velocity_B = mechanism.bodies[body].inverse_inertia * moved[body].torque_B;
        }
        for (const Link<P>& link : mechanism.links) {
            if (!link.counted) continue;
            const std::array<S, 2> rates = system_->view(link, at).rates();
            for (int i = 0; i < link.coordinates(); ++i) {
                S& rate = result[system_->angles() + link.angles + i];
                rate = rate + rates[static_cast<std::size_t>(i)];
            }
        }
    }
    // The position error of a row of coordinates.
    template <class S>
    S coordinate_gap(std::size_t i, const std::vector<Placement<S>>& at, const S* z) const {
        S gap(-targets_[i].value);
        for (const std::pair<int, P>& summand : coordinate_rows_[i].summands)
            gap = gap + summand.second * coordinate_at(summand.first, at, z);
        return gap;
    }
    // Moves the positions in y by M^-1 times momenta, with the counted coordinates.
    void move(const std::vector<Placement<P>>& at, const std::vector<Wrench<P>>& moved, P* y) const {
        const Mechanism<P>& mechanism = system_->mechanism();
        for (int b = 0; b < mechanism.world(); ++b) {
            const int first = system_->place(b);
            if (first < 0) continue;
            const MaximalBody<P>& body = mechanism.bodies[static_cast<std::size_t>(b)];
            const Wrench<P>& by = moved[static_cast<std::size_t>(b)];
            const Placement<P>& from = at[static_cast<std::size_t>(b)];
            const Vector3<P> half = (P(1) / P(2)) * (body.inverse_inertia * by.torque_B);
            put(y, first, normalized(from.q * Quaternion<P>{P(1), half[0], half[1], half[2]}));
            put(y, first + 4, from.position_W + (P(1) / body.mass) * by.force_W);
        }
        add_corrections(at, moved, y);
    }

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
        // two links of a coupling share a row and a group
        std::vector<std::set<int>> bodies_of(links);
        const auto owner = [&](int k) { return mechanism.links[k].partner < 0 ? k : mechanism.links[k].partner; };
        for (int k = 0; k < links; ++k) {
            const Link<P>& link = mechanism.links[k];
            join(link.from.body, link.to.body);
            for (const int b : {link.from.body, link.to.body})
                if (mechanism.movable(b)) links_of[b].insert(owner(k)), bodies_of[owner(k)].insert(b);
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
            if (owner(k) != k) continue;
            const Link<P>& link = mechanism.links[k];
            Group& group = groups_[bodies + k];
            const int row = system_->dynamics().first_row(k);
            const int count = static_cast<int>(system_->dynamics().kept(k).size());
            fill(group, lambda_ + row, count);
            if (index_ == Index::two) fill(group, mu_ + row, count);
            if (link.angles >= 0) fill(group, system_->angles() + link.angles, link.coordinates());
            std::set<int> met{bodies + k};
            for (const int b : bodies_of[k]) {
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
