// Contact of a body with immovable planes: gaps, the time at which the first of them closes, and the contacts there.
//
// ContactGeometry holds the planes and the pieces of the body's convex hull (body/support.h) and computes the gap of
// each pair. ContactSearch finds the first closing time by recursive bisection with a speed bound, then by Newton's
// iteration safeguarded by bisection. The impact itself is in motion/impact.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "motion/impact.h"
#include "scene/body_hull.h"

namespace polhode {

/// Position and velocity of a body in world axes. q, of unit length, maps the axes of the pieces to world axes.
template <class S>
struct Placement {
    Quaternion<S> q;
    Vector3<S> position_W, velocity_W, angular_velocity_W;  ///< centre of mass: p (m), v (m/s); and w (rad/s)
};

/// Distance (m) between a piece of the body's hull and a plane, negative for penetration, and its rate (m/s).
template <class S>
struct Gap {
    S distance = S(0), rate = S(0);
};

/// A plane normal_W . x = offset with its contact coefficients.
template <class S>
struct ContactPlane {
    Vector3<S> normal_W;  ///< unit
    S offset = S(0);      ///< m
    S restitution = S(1), friction = S(0);
};

/// Planes and hull of a body. Empty (`any()` is false) for a scene without planes.
template <class S>
class ContactGeometry {
  public:
    std::vector<ContactPlane<S>> planes;
    std::vector<SupportPiece<S>> pieces;  ///< positions are relative to the centre of mass
    S reach = S(0);                       ///< bound of the distance of all points from the centre of mass, m

    bool any() const { return !planes.empty() && !pieces.empty(); }
    std::size_t size() const { return planes.size() * pieces.size(); }

    /// The gap of the k-th pair of a plane and a piece.
    Gap<S> gap(std::size_t k, const Placement<S>& at) const {
        const ContactPlane<S>& plane = planes[k / pieces.size()];
        const SupportPiece<S>& piece = pieces[k % pieces.size()];
        const Vector3<S> n = rotate_back(at.q, plane.normal_W);
        const Vector3<S> arm_W = rotate(at.q, piece.lowest_point(n));
        return {dot(plane.normal_W, at.position_W) + piece.lowest(n) - plane.offset,
                dot(plane.normal_W, at.velocity_W + cross(at.angular_velocity_W, arm_W))};
    }
    /// The distances of all pairs, m.
    std::vector<S> distances(const Placement<S>& at) const {
        std::vector<S> all;
        all.reserve(size());
        for (const ContactPlane<S>& plane : planes) {
            const Vector3<S> n = rotate_back(at.q, plane.normal_W);
            const S height = dot(plane.normal_W, at.position_W) - plane.offset;
            for (const SupportPiece<S>& piece : pieces) all.push_back(height + piece.lowest(n));
        }
        return all;
    }
    /// The smallest distance to one plane, m.
    S distance(std::size_t plane, const Placement<S>& at) const {
        const Vector3<S> n = rotate_back(at.q, planes[plane].normal_W);
        S least = pieces.front().lowest(n);
        for (std::size_t i = 1; i < pieces.size(); ++i) least = std::min(least, pieces[i].lowest(n));
        return dot(planes[plane].normal_W, at.position_W) + least - planes[plane].offset;
    }
    /// The smallest of all distances, m.
    S distance(const Placement<S>& at) const {
        S least = distance(0, at);
        for (std::size_t i = 1; i < planes.size(); ++i) least = std::min(least, distance(i, at));
        return least;
    }
    /// The contacts whose gap is at most `tolerance` (m).
    std::vector<Contact<S>> contacts(const Placement<S>& at, const S& tolerance) const {
        std::vector<Contact<S>> touching;
        for (const ContactPlane<S>& plane : planes) {
            const Vector3<S> n = rotate_back(at.q, plane.normal_W);
            const S height = dot(plane.normal_W, at.position_W) - plane.offset;
            for (const SupportPiece<S>& piece : pieces)
                if (!(height + piece.lowest(n) > tolerance))
                    touching.push_back({at.position_W + rotate(at.q, piece.lowest_point(n)), plane.normal_W,
                                        plane.restitution, plane.friction});
        }
        return touching;
    }
};

/// The contact geometry of a scene, in the axes that q_BP (of unit length) maps to body axes.
template <class S>
ContactGeometry<S> contact_geometry(const Scene& scene, const Vector3<S>& center, const Quaternion<S>& q_BP) {
    ContactGeometry<S> geometry;
    if (scene.planes.empty() || !scene.body.source) return geometry;
    for (const Plane& plane : scene.planes) {
        const Vector3<S> normal = cast<S>(plane.normal_W);
        const S length = square_root(dot(normal, normal));
        geometry.planes.push_back(
            {(S(1) / length) * normal, S(plane.offset) / length, S(plane.restitution), S(plane.friction)});
    }
    const Quaternion<S> q_PB = conjugate(q_BP);
    for (const SupportPiece<S>& piece : hull<S>(*scene.body.source)) {
        geometry.pieces.push_back(placed(piece, Vector3<S>(-rotate(q_PB, center)), q_PB));
        geometry.reach = std::max(geometry.reach, geometry.pieces.back().reach());
    }
    return geometry;
}

/// Searches for the first time at which a gap closes. At: a function `at(t)` that returns what the functions gap(k, at)
/// and distances(at) of the geometry take, like the Placement of one body. If the geometry has a function rounding(k),
/// a gap that widens at both ends of a short interval and is negative by less than that does not close there.
template <class S, class At, class Geometry = ContactGeometry<S>>
class ContactSearch {
  public:
    /// `speed_bound` (m/s): upper bound of the rates of all gaps.
    ContactSearch(const Geometry& geometry, const At& at, const S& speed_bound)
        : geometry_(geometry), at_(at), speed_bound_(speed_bound) {}

    std::optional<S> first(const S& begin, const S& end) const { return run(node(begin), node(end), 0); }

  private:
    static constexpr int most_halvings = 8, most_iterations = 400;

    struct Node {
        S t;
        std::invoke_result_t<const At&, const S&> placement;
        std::vector<S> distances;
    };

    Gap<S> gap(std::size_t k, const S& t) const { return geometry_.gap(k, at_(t)); }
    Node node(const S& t) const {
        Node n{t, at_(t), {}};
        n.distances = geometry_.distances(n.placement);
        return n;
    }

    // the root of the k-th distance between a (open) and b (closed): Newton's iteration safeguarded by bisection
    S closing(std::size_t k, S a, S b) const {
        S t = (a + b) / S(2);
        for (int i = 0; i < most_iterations; ++i) {
            const Gap<S> g = gap(k, t);
            (g.distance > S(0) ? a : b) = t;
            S next = t - g.distance / g.rate;
            if (!(next >= a && next <= b)) next = (a + b) / S(2);
            const S change = next > t ? S(next - t) : S(t - next);
            t = next;
            if (!(change > S(2) * Elementary<S>::epsilon() * b)) break;
        }
        return t;
    }
    // the time at which the k-th distance, falling at a and rising at b, is zero or else smallest
    S lowest(std::size_t k, S a, S b) const {
        for (int i = 0; i < most_iterations && b - a > S(2) * Elementary<S>::epsilon() * b; ++i) {
            S middle = (a + b) / S(2);
            const Gap<S> g = gap(k, middle);
            if (!(g.distance > S(0))) return middle;
            (g.rate < S(0) ? a : b) = middle;
        }
        return b;
    }
    // a time between a and b, where the k-th gap is closed, at which it is open; a if there is none
    S opened(std::size_t k, const S& a, const S& b) const {
        S low = a, high = b;
        for (int i = 0; i < 60; ++i) {
            S middle = (low + high) / S(2);
            const Gap<S> g = gap(k, middle);
            if (g.distance > S(0)) return middle;
            (g.rate > S(0) ? low : high) = middle;
        }
        return a;
    }
    std::optional<S> in_leaf(const Node& a, const Node& b, std::size_t k) const {
        const Gap<S> from = geometry_.gap(k, a.placement), to = geometry_.gap(k, b.placement);
        if (to.distance > S(0)) {
            if (!(from.rate < S(0) && to.rate > S(0))) return {};
            const S low = lowest(k, a.t, b.t);
            if (gap(k, low).distance > S(0)) return {};
            return from.distance > S(0) ? closing(k, a.t, low) : a.t;
        }
        if constexpr (requires { geometry_.rounding(k); })
            if (from.rate > S(0) && to.rate > S(0) && -to.distance <= geometry_.rounding(k)) return {};
        if (from.distance > S(0)) return closing(k, a.t, b.t);
        if (!(to.rate < S(0))) return {};
        if (!(from.rate > S(0))) return a.t;
        const S open = opened(k, a.t, b.t);
        return open > a.t ? closing(k, open, b.t) : a.t;
    }
    std::optional<S> run(const Node& a, const Node& b, int depth) const {
        std::vector<std::size_t> near;
        for (std::size_t k = 0; k < geometry_.size(); ++k)
            if (a.distances[k] + b.distances[k] <= speed_bound_ * (b.t - a.t)) near.push_back(k);
        if (near.empty()) return {};
        if (depth == most_halvings) {
            std::optional<S> first;
            for (std::size_t k : near)
                if (const std::optional<S> t = in_leaf(a, b, k); t && (!first || *t < *first)) first = t;
            return first;
        }
        const Node middle = node((a.t + b.t) / S(2));
        if (std::optional<S> found = run(a, middle, depth + 1)) return found;
        return run(middle, b, depth + 1);
    }

    const Geometry& geometry_;
    const At& at_;
    const S speed_bound_;
};

/// The first time (s) in [begin, end] at which a gap closes, to rounding. `speed_bound` (m/s) is an upper bound of
/// the speed of the body's points: intervals too short for the gaps at their ends to close are skipped. The others
/// are halved down to 2^-8 of the whole; within such a piece a gap is assumed to have at most one minimum. A gap that
/// is zero at `begin` and opens, as after an impact, does not count. A gap that is zero at `begin` and stays closed
/// gives `begin`. Terminates for all inputs; NaN never closes a gap.
template <class S, class At>
std::optional<S> first_contact(const ContactGeometry<S>& geometry, const At& at, const S& begin, const S& end,
                               const S& speed_bound) {
    if (!(end > begin)) return {};
    return ContactSearch<S, At>(geometry, at, speed_bound).first(begin, end);
}

/// A separation speed below this fraction of the motion's speed does not start a flight: resting contact follows, or
/// impacts that accumulate.
template <class S>
double resting_speed(const S& speed) {
    return 4 * std::sqrt(static_cast<double>(Elementary<S>::epsilon())) * static_cast<double>(speed);
}

}  // namespace polhode
