// Dynamics of a mechanism in maximal coordinates. Momenta change by loads and by the links' constraint forces,
//   dP/dt = F + sum f lambda,   dL/dt = tau + sum (arm x f + g) lambda,
// and the multipliers follow from the constraint accelerations, which must vanish: (G M^-1 G^T) lambda = -(G M^-1
// load + bias). Two links are coupled in this matrix if they hold the same body. Eliminated from the leaves to the
// roots, with loops last, the links of a tree produce no fill-in.
//
// A body without mass or with a zero moment of inertia has additional rows (Kind::added_inertia), ordered after those
// of all joints that hold it. Where the mass matrix of the joint coordinates is regular, the remaining block of the
// constraints is positive definite and that of the added inertias negative definite, so no pivot vanishes in this
// order either.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "integrators/maximal/loads.h"
#include "integrators/maximal/redundancy.h"
#include "integrators/maximal/sparse_ldl.h"

namespace polhode::maximal {

/// All rows of a mechanism at one state: for each link its kept constraints.
template <class S>
using Rows = std::vector<std::vector<Row<S>>>;

/// Computes constraint rows, multipliers and constraint errors of a mechanism.
template <class P>
class Dynamics {
  public:
    /// `mechanism` must outlive this object.
    explicit Dynamics(const Mechanism<P>& mechanism) : mechanism_(&mechanism), kept_(mechanism.links.size()) {
        for (std::size_t k = 0; k < mechanism.links.size(); ++k) {
            const Link<P>& link = mechanism.links[k];
            if (mechanism.movable(link.from.body) || mechanism.movable(link.to.body)) {
                kept_[k] = link.rows;
                order_.push_back(static_cast<int>(k));
            }
        }
        std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return rank_of(a) > rank_of(b); });
        arrange();
    }

    /// Number of multipliers.
    int rows() const { return pattern_.size(); }
    /// For a link: the constraints that are kept, and the index of its first multiplier.
    const std::vector<int>& kept(std::size_t link) const { return kept_[link]; }
    int first_row(std::size_t link) const { return first_row_[link]; }

    /// The constraints at a state. The last placement is the world's.
    template <class S>
    Rows<S> constraints(const std::vector<Placement<S>>& at) const {
        Rows<S> all(mechanism_->links.size());
        for (const int k : order_) {
            std::vector<Row<S>> rows = view(k, at).constraints();
            for (const int i : kept_[k]) all[k].push_back(std::move(rows[i]));
        }
        return all;
    }

    /// Negative accelerations along the rows, under all that acts on the bodies, without constraint forces.
    template <class S>
    std::vector<S> decelerations(const std::vector<Placement<S>>& at, const Rows<S>& rows,
                                 const std::vector<Wrench<S>>& on) const {
        std::vector<S> result(static_cast<std::size_t>(rows_count_), S(P(0)));
        for (const int k : order_)
            for (std::size_t i = 0; i < rows[k].size(); ++i) {
                S& sum = result[first_row_[k] + i];
                sum = mechanism_->links[k].partner < 0 ? S(-rows[k][i].bias) : S(sum - rows[k][i].bias);
            }
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (!mechanism_->movable(b)) continue;
            const MaximalBody<P>& body = mechanism_->bodies[b];
            const Vector3<S>& w = at[b].angular_velocity_B;
            const Vector3<S> a = (P(1) / body.mass) * on[b].force_W;
            const Vector3<S> gyroscopic = cross(w, body.inertia * w);
            const Vector3<S> w_rate = body.inverse_inertia * (on[b].torque_B + at[b].body(on[b].torque_W) - gyroscopic);
            subtract_motion(b, rows, a, w_rate, result);
        }
        return result;
    }
    /// The vector x with (G M^-1 G^T) x = right.
    template <class S>
    std::vector<S> solve(const Rows<S>& rows, std::vector<S> right) const {
        return solved(rows, std::move(right));
    }
    /// The multipliers for which the acceleration along every row vanishes, under all that acts on the bodies.
    template <class S>
    std::vector<S> multipliers(const std::vector<Placement<S>>& at, const Rows<S>& rows,
                               const std::vector<Wrench<S>>& on) const {
        return solved(rows, decelerations(at, rows, on));
    }

    /// The impulses along the rows that restore the velocity constraints after momenta `on` have been added to the
    /// bodies.
    std::vector<P> impulses(const std::vector<Placement<P>>& at, const Rows<P>& rows,
                            const std::vector<Wrench<P>>& on) const {
        std::vector<P> right(static_cast<std::size_t>(rows_count_), P(0));
        for (int b = 0; b < mechanism_->world(); ++b) {
            if (!mechanism_->movable(b)) continue;
            const MaximalBody<P>& body = mechanism_->bodies[b];
            const Vector3<P> v = at[b].velocity_W + (P(1) / body.mass) * on[b].force_W;
            const Vector3<P> w =
                at[b].angular_velocity_B + body.inverse_inertia * (on[b].torque_B + at[b].body(on[b].torque_W));
            subtract_motion(b, rows, v, w, right);
        }
        // The force of an added inertia or an armature changes its momentum only by the change of velocity due to the
        // impulses.
        for_added([&](int b, std::size_t k, std::size_t i) {
            const Row<P>& row = rows[k][i];
            P& sum = right[first_row_[k] + i];
            sum = sum + dot(row.force_W, at[b].velocity_W) + dot(row.to_B, at[b].angular_velocity_B);
            const int a = mechanism_->links[k].from.body;
            if (mechanism_->movable(a))
                sum = sum + (dot(row.from_B, at[a].angular_velocity_B) - dot(row.force_W, at[a].velocity_W));
        });
        return solved(rows, std::move(right));
    }

    /// The rows of added inertias and armatures.
    std::vector<int> added_rows() const {
        std::vector<int> all;
        for_added([&](int, std::size_t k, std::size_t i) { all.push_back(first_row_[k] + static_cast<int>(i)); });
        return all;
    }
    /// Adds lambda / m' and lambda / j' to the rows of added inertias and -lambda / d to those of armatures, see Kind.
    template <class S>
    void add_compliance(const S* lambda, std::vector<S>& rows) const {
        for_added([&](int, std::size_t k, std::size_t i) {
            const std::size_t row = static_cast<std::size_t>(first_row_[k]) + i;
            rows[row] = rows[row] + compliance(k, i) * lambda[row];
        });
    }

    /// Adds the constraint forces of the links.
    template <class S>
    void add_constraint_forces(const Rows<S>& rows, const std::vector<S>& lambda, std::vector<Wrench<S>>& on) const {
        for (const int k : order_)
            for (std::size_t i = 0; i < rows[k].size(); ++i) {
                on[mechanism_->links[k].to.body].add_to(rows[k][i], lambda[first_row_[k] + i]);
                on[mechanism_->links[k].from.body].add_from(rows[k][i], lambda[first_row_[k] + i]);
            }
    }

    /// Negative velocity errors, one per row.
    template <class S>
    std::vector<S> velocity_errors(const std::vector<Placement<S>>& at, const Rows<S>& rows) const {
        std::vector<S> result(static_cast<std::size_t>(rows_count_), S(P(0)));
        for (int b = 0; b < mechanism_->world(); ++b)
            if (mechanism_->movable(b)) subtract_motion(b, rows, at[b].velocity_W, at[b].angular_velocity_B, result);
        for_added([&](int, std::size_t k, std::size_t i) { result[first_row_[k] + i] = S(P(0)); });
        return result;
    }
    /// Position errors, one per row.
    template <class S>
    std::vector<S> gaps(const std::vector<Placement<S>>& at) const {
        std::vector<S> result(static_cast<std::size_t>(rows_count_), S(P(0)));
        for (const int k : order_) {
            const std::vector<S> all = view(k, at).gaps();
            for (std::size_t i = 0; i < kept_[k].size(); ++i) result[first_row_[k] + i] = all[kept_[k][i]];
        }
        return result;
    }

    /// The Schur complement of the loops' block of the matrix, after elimination of the joints, and the block's
    /// diagonal before the elimination.
    std::pair<Dense<P>, std::vector<P>> loops(const std::vector<Placement<P>>& at) const {
        std::vector<P> A = assembled(constraints(at));
        std::vector<P> begin(A.begin() + trees_, A.begin() + rows_count_);
        pattern_.factorize(A, trees_);
        return {loop_part(A), std::move(begin)};
    }
    /// Keeps the marked rows of the loops, in the order of loops(). `rank` of them are independent. If more are kept,
    /// the multipliers are those of minimum norm, weighted by `scales`.
    void keep(const std::vector<char>& marks, int rank, std::vector<P> scales) {
        for (const int k : order_) {
            if (!mechanism_->links[k].closes) continue;
            std::vector<int> left;
            for (std::size_t i = 0; i < kept_[k].size(); ++i)
                if (marks[first_row_[k] + i - trees_]) left.push_back(kept_[k][i]);
            kept_[k] = std::move(left);
        }
        arrange();
        rank_ = rank;
        scales_ = std::move(scales);
    }
    /// Number of independent rows.
    int independent_rows() const { return trees_ + rank_; }

  private:
    struct Attached {
        int link;
        bool to;  ///< whether the body is the link's second body
    };
    const Mechanism<P>* mechanism_;
    std::vector<std::vector<int>> kept_;           // by link
    std::vector<int> order_, first_row_;           // elimination order of the links; by link
    int rows_count_ = 0, trees_ = 0;               // all rows; rows of joints, which come first
    int rank_ = 0;                                 // rank of the loops' rows
    std::vector<P> scales_;                        // scales of the loops' rows, if they are redundant
    std::vector<std::vector<Attached>> attached_;  // by movable body
    SparsePattern pattern_;
    std::vector<int> targets_;  // by product of two rows, in the order of for_pairs()

    // Links of the deepest bodies come first, loops last.
    int rank_of(int k) const {
        const Link<P>& link = mechanism_->links[k];
        return link.closes ? -1 : mechanism_->depth[link.to.body];
    }
    template <class S>
    LinkView<P, S> view(std::size_t k, const std::vector<Placement<S>>& at) const {
        const Link<P>& link = mechanism_->links[k];
        return {link, at[link.from.body], at[link.to.body]};
    }

    void arrange() {
        first_row_.assign(mechanism_->links.size(), 0);
        attached_.assign(mechanism_->bodies.size(), {});
        rows_count_ = trees_ = 0;
        for (const int k : order_) {
            if (const int partner = mechanism_->links[k].partner; partner >= 0)
                first_row_[k] = first_row_[partner];
            else
                first_row_[k] = rows_count_, rows_count_ += static_cast<int>(kept_[k].size());
            const Link<P>& link = mechanism_->links[k];
            if (!link.closes) trees_ = rows_count_;
            if (mechanism_->movable(link.to.body)) attached_[link.to.body].push_back({k, true});
            if (mechanism_->movable(link.from.body)) attached_[link.from.body].push_back({k, false});
        }
        rank_ = rows_count_ - trees_;
        std::vector<std::set<int>> entries(rows_count_);
        for_pairs([&](int, const Attached&, std::size_t, int i, const Attached&, std::size_t, int j) {
            if (i != j) entries[std::min(i, j)].insert(std::max(i, j));
        });
        pattern_ = SparsePattern(std::move(entries));
        targets_.clear();
        for_pairs([&](int, const Attached&, std::size_t, int i, const Attached&, std::size_t, int j) {
            targets_.push_back(pattern_.place(i, j));
        });
    }
    const P& compliance(std::size_t k, std::size_t i) const {
        return mechanism_->links[k].compliance[static_cast<std::size_t>(kept_[k][i])];
    }
    // Visits each row of an added inertia or an armature: second body, link and row index.
    template <class Do>
    void for_added(Do&& act) const {
        for (const int k : order_)
            for (std::size_t i = 0; mechanism_->links[k].has_compliance() && i < kept_[k].size(); ++i)
                act(mechanism_->links[k].to.body, static_cast<std::size_t>(k), i);
    }
    // Visits each pair of rows that share a body, in a fixed order.
    template <class Do>
    void for_pairs(Do&& act) const {
        for (int b = 0; b < mechanism_->world(); ++b)
            for (std::size_t x = 0; x < attached_[b].size(); ++x)
                for (std::size_t y = x; y < attached_[b].size(); ++y) {
                    const Attached &one = attached_[b][x], &other = attached_[b][y];
                    for (std::size_t i = 0; i < kept_[one.link].size(); ++i)
                        for (std::size_t j = x == y ? i : 0; j < kept_[other.link].size(); ++j)
                            act(b, one, i, first_row_[one.link] + static_cast<int>(i), other, j,
                                first_row_[other.link] + static_cast<int>(j));
                }
    }

    template <class S>
    static const Vector3<S>& side(const Row<S>& row, bool to) {
        return to ? row.to_B : row.from_B;
    }
    // right -= G_b (a, w) for a body that moves with (a, w).
    template <class S>
    void subtract_motion(int b, const Rows<S>& rows, const Vector3<S>& a, const Vector3<S>& w,
                         std::vector<S>& right) const {
        for (const Attached& by : attached_[b])
            for (std::size_t i = 0; i < rows[by.link].size(); ++i) {
                const Row<S>& row = rows[by.link][i];
                const S along = dot(row.force_W, a), turning = dot(side(row, by.to), w);
                S& sum = right[first_row_[by.link] + i];
                sum = sum - (by.to ? along + turning : turning - along);
            }
    }
    template <class S>
    std::vector<S> assembled(const Rows<S>& rows) const {
        std::vector<S> A(static_cast<std::size_t>(pattern_.entries()), S(P(0)));
        std::size_t next = 0;
        // I^-1 times a row's torque is reused for all its pairs.
        const Row<S>* seen = nullptr;
        Vector3<S> turned;
        for_pairs([&](int b, const Attached& x, std::size_t i, int row, const Attached& y, std::size_t j, int column) {
            const MaximalBody<P>& body = mechanism_->bodies[b];
            const Row<S>&one = rows[x.link][i], &other = rows[y.link][j];
            if (seen != &one || (&one == &other)) turned = body.inverse_inertia * side(one, x.to), seen = &one;
            const P inverse_mass = (x.to == y.to ? P(1) : P(-1)) / body.mass;
            S& entry = A[targets_[next++]];
            const S product = inverse_mass * dot(one.force_W, other.force_W) + dot(turned, side(other, y.to));
            entry = entry + product;
            // two links of a coupling share the row
            if (row == column && x.link != y.link) entry = entry + product;
        });
        for_added([&](int, std::size_t k, std::size_t i) {
            S& entry = A[first_row_[k] + i];
            entry = entry - S(compliance(k, i));
        });
        return A;
    }
    template <class S>
    std::vector<S> solved(const Rows<S>& rows, std::vector<S> right) const {
        std::vector<S> A = assembled(rows);
        const bool all = rank_ == rows_count_ - trees_;
        const int count = all ? rows_count_ : trees_;
        pattern_.factorize(A, count);
        pattern_.descend(A, right, count);
        if (!all) {
            Dense<S> part = loop_part(A);
            std::vector<S> rest(right.begin() + trees_, right.end());
            for (std::size_t i = 0; i < rest.size(); ++i) {
                rest[i] = scales_[i] * rest[i];
                for (std::size_t j = 0; j < rest.size(); ++j) part[i][j] = P(scales_[i] * scales_[j]) * part[i][j];
            }
            rest = shortest_solution(part, rest, rank_);
            for (std::size_t i = 0; i < rest.size(); ++i) right[trees_ + i] = scales_[i] * rest[i];
        }
        pattern_.ascend(A, right, count);
        return right;
    }
    template <class S>
    Dense<S> loop_part(const std::vector<S>& A) const {
        const int n = rows_count_ - trees_;
        Dense<S> part(n, std::vector<S>(n, S(P(0))));
        for (int i = 0; i < n; ++i)
            for (int j = 0; j <= i; ++j)
                if (pattern_.has(trees_ + i, trees_ + j))
                    part[i][j] = part[j][i] = A[pattern_.place(trees_ + i, trees_ + j)];
        return part;
    }
};

}  // namespace polhode::maximal
