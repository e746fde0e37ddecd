// Spheres that touch each other: the contacts of a cluster and their modes.
//
// A cluster is a set of spheres that are connected by touching pairs. Each of them may also touch a plane. Contacts are
// closed (a force may act) or open (the gap is observed). A closed contact is smooth (no friction), slides, starts to
// slide in a direction that is known as a function of time, or sticks (no slip: it rolls).
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "integrators/contact/contact_state.h"

namespace polhode::contact {

/// How the surfaces of a closed contact move on each other.
enum class Grip { smooth, sliding, starting, sticking };

/// Mass properties of a sphere.
template <class P>
struct SphereBody {
    P mass{1}, moment{1}, radius{1};
};

/// A contact of a sphere with a plane or with another sphere. Its normal points to the first sphere.
template <class P>
struct ClusterContact {
    std::size_t first = 0;              ///< index of the sphere in the cluster
    std::optional<std::size_t> second;  ///< index of the other sphere; none for a plane
    std::size_t number = 0;             ///< index of the plane or of the pair
    Vector3<P> normal_W;                ///< unit normal of the plane
    P offset{0};                        ///< plane: n . x, m; pair: distance of the centres in contact, m
    P friction{0};
    Grip grip = Grip::smooth;
    SlipPath<P> path;  ///< while the slip starts

    bool is_pair() const { return second.has_value(); }
    bool has(std::size_t sphere) const { return first == sphere || second == sphere; }
    bool is_same(const ClusterContact& other) const {
        return is_pair() == other.is_pair() && first == other.first && number == other.number;
    }
};

/// The mode of a cluster.
template <class P>
struct ClusterMode {
    std::vector<ClusterContact<P>> closed, open;

    bool starts_slip() const {
        return std::ranges::any_of(closed, [](const auto& c) { return c.grip == Grip::starting; });
    }
    /// Whether the independent variable s is stretched: dt/ds is the product of all slips with friction.
    bool is_stretched() const {
        return !starts_slip() && std::ranges::any_of(closed, [](const auto& c) { return c.grip == Grip::sliding; });
    }
};

/// Number of observed functions of a closed contact: the normal force; (mu N)^2 - T^2 while it sticks, slip^2 while it
/// slides, the acceleration across the path while the slip starts; the acceleration along the path; the force (3) on
/// the first sphere.
inline constexpr int cluster_functions = 6;

/// Acceleration and angular acceleration of a sphere, world axes.
template <class P>
struct SphereRates {
    Vector3<P> acceleration, angular;
};

/// The direction of a slip that starts, in the tangent plane of a normal that moves: `direction_W` of the path is
/// projected to this plane and rotated by the path's angle.
template <class S>
struct SlipHeading {
    Vector3<S> direction, across;
    S frame_rate{0};  ///< rate at which the projected direction rotates about the normal, rad/s
};
template <class P, class S>
SlipHeading<S> slip_heading(const SlipPath<P>& path, const S& t, const Vector3<S>& normal, const Vector3<S>& rate) {
    const S height = dot(path.direction_W, normal);
    const Vector3<S> projected = path.direction_W - height * normal;
    const S inverse_length = P(1) / square_root(dot(projected, projected));
    const Vector3<S> e1 = inverse_length * projected, e2 = cross(normal, e1);
    S sine(0), cosine(1);
    sine_cosine(path.angle_at(t), sine, cosine);
    SlipHeading<S> heading;
    heading.direction = cosine * e1 + sine * e2;
    heading.across = cosine * e2 - sine * e1;
    heading.frame_rate = P(-1) * (inverse_length * height * dot(rate, e2));
    return heading;
}

}  // namespace polhode::contact
