// Joints at rest whose coordinates depend on each other by loops.
//
// The matrix of responses A of such joints is singular: the forces that hold them are not unique, but the motion is. If
// each dependent joint moves with one other joint only, at rates in a constant ratio J while they start to move, both
// are one joint with the sum of their bounds: a force f on the dependent coordinate is a force J f on the other one. In
// a linkage of one degree of freedom all joints are of this kind.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "body/elementary.h"
#include "integrators/contact/box_forces.h"

namespace polhode::contact {

/// A joint that moves with another one, at `ratio` times its rate. Indices refer to the matrix.
template <class P>
struct Follower {
    std::size_t joint = 0, leader = 0;
    P ratio{1};
};

/// Independent joints, and those that follow them.
template <class P>
struct Dependence {
    std::vector<std::size_t> leaders;
    std::vector<Follower<P>> followers;
};

/// Selects independent joints of a matrix of responses (n by n, row by row) by symmetric elimination with pivoting.
/// `sizes`: the largest response of each joint so far. Nothing if a joint depends on several others, or if it does not
/// respond at all.
template <class P>
std::optional<Dependence<P>> find_dependence(const std::vector<P>& A, const std::vector<P>& sizes) {
    const std::size_t n = sizes.size();
    const P least(1e-9);
    std::vector<P> left = A;
    std::vector<char> is_leader(n, 0);
    Dependence<P> result;
    for (;;) {
        std::size_t best = n;
        P largest = least;
        // ties go to the first joint
        for (std::size_t i = 0; i < n; ++i)
            if (!is_leader[i] && left[i * n + i] > (P(1) + P(1e-6)) * largest * sizes[i])
                best = i, largest = left[i * n + i] / sizes[i];
        if (best == n) break;
        is_leader[best] = 1;
        result.leaders.push_back(best);
        for (std::size_t i = 0; i < n; ++i) {
            if (is_leader[i]) continue;
            const P factor = left[i * n + best] / left[best * n + best];
            for (std::size_t j = 0; j < n; ++j) left[i * n + j] = left[i * n + j] - factor * left[best * n + j];
        }
    }
    for (std::size_t d = 0; d < n; ++d) {
        if (is_leader[d]) continue;
        // a follower responds to each impulse as its leader, times the ratio
        std::optional<Follower<P>> found;
        for (const std::size_t leader : result.leaders) {
            const P ratio = A[d * n + leader] / A[leader * n + leader];
            const P own = A[d * n + d], explained = ratio * A[leader * n + d];
            if (own > least * sizes[d] && Elementary<P>::magnitude(P(own - explained)) <= P(1e-6) * own)
                found = Follower<P>{d, leader, ratio};
        }
        if (!found) return std::nullopt;
        result.followers.push_back(*found);
    }
    return result;
}

/// The bounds of the force on a leader: those of its own force and of the forces of its followers.
template <class P>
Box<P> add_follower(Box<P> sum, const Box<P>& follower, const P& ratio) {
    const bool rises = ratio > P(0);
    sum.has_low = sum.has_low && (rises ? follower.has_low : follower.has_high);
    sum.has_high = sum.has_high && (rises ? follower.has_high : follower.has_low);
    sum.low = sum.low + ratio * (rises ? follower.low : follower.high);
    sum.high = sum.high + ratio * (rises ? follower.high : follower.low);
    return sum;
}

}  // namespace polhode::contact
