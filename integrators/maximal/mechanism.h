// A scene of several bodies in maximal coordinates: every body has all six degrees of freedom, and every joint or
// loop is a link that constrains two bodies. All numbers are exact functions of the scene's numbers, in the scalar P.
//
// MaximalBody holds mass properties, Link a joint or loop with its constraints, Mechanism all of them. Bodies with zero
// mass or moments get an added inertia (Kind::added_inertia).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "body/elementary.h"
#include "body/mass_properties.h"
#include "scene/body_source.h"
#include "scene/scene.h"
#include "scene/scene_formulas.h"

namespace polhode::maximal {

/// A body's mass properties, in body axes.
template <class P>
struct MaximalBody {
    P mass = P(1);               ///< kg, including added_mass
    Vector3<P> center;           ///< centre of mass, from the body's origin, m
    Matrix3<P> inertia;          ///< about the centre of mass, kg m^2, including added_moment about each axis
    Matrix3<P> inverse_inertia;  ///< its inverse
    bool movable = true;         ///< false if fixed joints attach it to the world
    P added_mass = P(0);         ///< kg, for a body without mass; see Kind::added_inertia
    P added_moment = P(0);       ///< kg m^2, for a body with a zero principal moment

    /// 1 / |I^-1|: between 3/5 of the smallest principal moment and this moment.
    P least_moment() const {
        P square(0);
        for (int i = 0; i < 3; ++i) square += dot(inverse_inertia[i], inverse_inertia[i]);
        return P(1) / square_root(square);
    }
    /// Root mean square distance of the mass from its centre, m: sqrt(tr I / (2 m)).
    P reach() const { return square_root(P((inertia[0][0] + inertia[1][1] + inertia[2][2]) / (P(2) * mass))); }
};

/// Attachment point of a joint or loop on a body.
template <class P>
struct Attachment {
    int body = 0;      ///< index in the scene; the number of bodies stands for the world
    Vector3<P> arm_B;  ///< from the centre of mass (for the world: from its origin) to the point, body axes, m
};

/// What a joint or loop constrains.
///
/// `added_inertia` constrains nothing. A body without mass, a point mass or a rod has no inverse mass or inverse
/// tensor. It therefore gets an added mass m' and moments j' about each axis, and the force m' a and the torque j' w'
/// act on it in addition to all else. This leaves its motion unchanged: (m + m') a = F + m' a. These forces are
/// unknowns like the multipliers of constraints, with additional rows a - lambda / m' = 0 and w' - lambda / j' = 0.
///
/// `armature` constrains nothing either. The torque -d x'' of an inertia d on a joint coordinate x depends on the
/// acceleration; it is the unknown lambda of the row x'' + lambda / d = 0.
///
/// `coordinate` constrains the acceleration of a joint's coordinate: it locks the joint, or is one of the two links of
/// a coupling, which share a row: that of the second joint, minus the ratio times that of the first.
enum class Kind { revolute, prismatic, spherical, universal, fixed, distance, added_inertia, armature, coordinate };

/// A joint (from the parent to the child) or a loop (from the first body to the second).
template <class P>
struct Link {
    std::string name;                         ///< as in the scene
    Kind kind = Kind::revolute;               ///< type of constraint
    bool closes = false;                      ///< a loop rather than a joint of the tree
    Attachment<P> from, to;                   ///< first and second body
    Quaternion<P> orientation;                ///< q0: `to` axes at coordinate zero to `from` axes
    std::array<Vector3<P>, 2> axes_to;        ///< unit, fixed in `to`; universal joint: only the second axis
    Vector3<P> axis_from;                     ///< unit, fixed in `from`: the first axis
    std::array<Vector3<P>, 2> across_from;    ///< perpendicular to it and to each other, fixed in `from`
    P between = P(0);                         ///< universal joint: cosine of the angle between the axes
    P length = P(0);                          ///< distance link: m
    std::array<P, 2> stiffness{P(0), P(0)};   ///< joint spring
    std::array<P, 2> rest{P(0), P(0)};        ///< rest position of the spring, rad or m
    Quaternion<P> rest_orientation;           ///< rest orientation of a spherical joint's spring
    std::array<P, 2> damping{P(0), P(0)};     ///< joint damper
    std::array<P, 2> coordinate{P(0), P(0)};  ///< at t = 0
    int angles = -1;                          ///< index of its first coordinate in the state, or -1
    bool counted = false;                     ///< its coordinates are in the state by request
    std::vector<int> rows;                    ///< indices of its constraints that are kept
    /// By row; added_inertia: 1 / m' and 1 / j'; armature: -1 / d.
    std::array<P, 6> compliance{P(0), P(0), P(0), P(0), P(0), P(0)};
    int joint = -1;            ///< armature, coordinate: index of the joint
    Kind of = Kind::revolute;  ///< armature, coordinate: kind of the joint
    P factor = P(1);           ///< coordinate: of the joint's row
    int partner = -1;          ///< coordinate: the link before this one that has the shared row, or -1

    /// Number of coordinates that can have a spring, a damper or a motor.
    int coordinates() const {
        return kind == Kind::universal ? 2 : kind == Kind::revolute || kind == Kind::prismatic ? 1 : 0;
    }
    bool is_joint() const { return !closes && !has_compliance(); }
    /// Whether it is a joint or a loop of the scene.
    bool is_in_scene() const { return !has_compliance() && kind != Kind::coordinate; }
    /// Whether its unknowns are forces of an inertia, and not of a constraint.
    bool has_compliance() const { return kind == Kind::added_inertia || kind == Kind::armature; }
    /// Whether the joint has a spring or a damper.
    bool has_spring() const { return !(stiffness[0] == P(0) && stiffness[1] == P(0)); }
    bool has_damper() const { return !(damping[0] == P(0) && damping[1] == P(0)); }
};

/// v divided by its length.
template <class P>
Vector3<P> unit(const Vector3<P>& v) {
    const P size = length(v);
    return {v[0] / size, v[1] / size, v[2] / size};
}

/// Two unit vectors perpendicular to a and to each other.
template <class P>
std::array<Vector3<P>, 2> across(const Vector3<P>& a) {
    const auto square = [&](int i) { return a[i] * a[i]; };
    const int thin = square(0) <= square(1) ? (square(0) <= square(2) ? 0 : 2) : (square(1) <= square(2) ? 1 : 2);
    Vector3<P> e;
    e[thin] = P(1);
    const Vector3<P> first = unit(cross(a, e));
    return {first, cross(a, first)};
}

/// The bodies and links of a scene.
template <class P>
class Mechanism {
  public:
    /// `scene` must outlive this object. `locked`: indices of joints whose coordinates are locked. `counted`: indices
    /// of joints whose coordinates are components of the state, in addition to the angles that springs need.
    explicit Mechanism(const Scene& scene, std::span<const int> locked = {}, std::span<const int> counted = {})
        : scene_(&scene) {
        for (const NamedBody& named : scene.bodies) {
            const MassProperties<P> m = mass_properties<P>(named.body);
            bodies.push_back({m.mass, m.center, m.inertia, {}, true});
        }
        for (const Joint& joint : scene.joints) links.push_back(link_of(joint));
        for (const int joint : counted) count_coordinates(links[static_cast<std::size_t>(joint)]);
        for (const Loop& loop : scene.loops) links.push_back(link_of(loop));
        find_depths();
        for (const Coupling& coupling : scene.couplings) {
            add_coordinate(joint_of(coupling.second), P(1), -1);
            add_coordinate(joint_of(coupling.first), -P(coupling.ratio), static_cast<int>(links.size()) - 1);
        }
        for (const int joint : locked) add_coordinate(static_cast<std::size_t>(joint), P(1), -1);
        add_inertia();
        add_armature();
        for (MaximalBody<P>& body : bodies) body.inverse_inertia = inverse(body.inertia);
    }

    std::vector<MaximalBody<P>> bodies;  ///< in the scene's order
    std::vector<Link<P>>
        links;               ///< joints in the scene's order, its loops, couplings and locks, added inertias, armatures
    std::vector<int> depth;  ///< by body: number of joints between it and its root
    int turns = 0;           ///< number of joint coordinates in the state

    const Scene& scene() const { return *scene_; }
    /// The index that stands for the world.
    int world() const { return static_cast<int>(bodies.size()); }
    bool movable(int body) const { return body < world() && bodies[body].movable; }
    /// Index of the named body; world() for the world.
    int number_of(std::string_view name) const {
        for (std::size_t i = 0; i < scene_->bodies.size(); ++i)
            if (scene_->bodies[i].name == name) return static_cast<int>(i);
        return world();
    }
    /// Body point relative to the centre of mass; world points are returned unchanged.
    Vector3<P> arm(int body, const Vector3<double>& point) const {
        return body == world() ? cast<P>(point) : cast<P>(point) - bodies[body].center;
    }

  private:
    const Scene* scene_;

    Link<P> link_of(const Joint& joint) {
        static constexpr Kind kinds[] = {Kind::revolute, Kind::prismatic, Kind::spherical, Kind::universal,
                                         Kind::fixed};
        Link<P> link;
        link.name = joint.name;
        link.kind = kinds[static_cast<int>(joint.type)];
        const int parent = number_of(joint.parent), child = number_of(joint.child);
        link.from = {parent, arm(parent, joint.parent_point)};
        link.to = {child, arm(child, joint.child_point)};
        link.orientation = normalized(cast<P>(joint.parent_orientation));
        if (const int n = link.coordinates(); n > 0) {
            for (int i = 0; i < n; ++i) link.axes_to[i] = unit(cast<P>(joint.axes[i]));
            link.between = dot(link.axes_to[0], link.axes_to[1]);
            link.axis_from = rotate(link.orientation, link.axes_to[0]);
            for (int i = 0; i < 2; ++i) link.across_from[i] = rotate(link.orientation, across(link.axes_to[0])[i]);
        }
        for (int i = 0; i < 2; ++i) {
            link.stiffness[i] = P(joint.stiffness[i]);
            link.rest[i] = P(joint.rest[i]);
            link.damping[i] = P(joint.damping[i]);
            link.coordinate[i] = P(joint.coordinate[i]);
        }
        link.rest_orientation = normalized(cast<P>(joint.rest_orientation));
        // formulas may read any angle
        if ((link.kind == Kind::revolute || link.kind == Kind::universal) &&
            (link.has_spring() || has_formula_loads(*scene_)))
            add_to_state(link);
        static constexpr int counts[] = {5, 5, 3, 4, 6};
        for (int i = 0; i < counts[static_cast<int>(joint.type)]; ++i) link.rows.push_back(i);
        return link;
    }
    Link<P> link_of(const Loop& loop) {
        static constexpr Kind kinds[] = {Kind::spherical, Kind::revolute, Kind::distance};
        Link<P> link;
        link.name = loop.name;
        link.closes = true;
        link.kind = kinds[static_cast<int>(loop.type)];
        const int first = number_of(loop.first), second = number_of(loop.second);
        link.from = {first, arm(first, loop.first_point)};
        link.to = {second, arm(second, loop.second_point)};
        if (loop.type == LoopType::revolute) {
            link.axes_to[0] = unit(cast<P>(loop.second_axis));
            link.axis_from = unit(cast<P>(loop.first_axis));
            link.across_from = across(link.axis_from);
        }
        link.length = P(loop.length);
        static constexpr int counts[] = {3, 5, 1};
        for (int i = 0; i < counts[static_cast<int>(loop.type)]; ++i) link.rows.push_back(i);
        return link;
    }

    // Whether a principal moment is less than 1e-12 of the trace. The inverse of the sum of inverse moments is at
    // least a third of the smallest moment.
    static bool has_vanishing_moment(const Matrix3<P>& J) {
        const P trace = J[0][0] + J[1][1] + J[2][2];
        if (!(trace > P(0))) return true;
        P minors(0), determinant(0);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            minors += (J[j][j] / trace) * (J[k][k] / trace) - (J[j][k] / trace) * (J[k][j] / trace);
            determinant +=
                (J[0][i] / trace) * ((J[1][j] / trace) * (J[2][k] / trace) - (J[1][k] / trace) * (J[2][j] / trace));
        }
        return !(determinant > P(1e-12) * minors);
    }

    // Adds an inertia of the scale of all bodies to those without mass or with a zero moment.
    void add_inertia() {
        P mass(0), moment(0), square(1);
        for (const MaximalBody<P>& body : bodies) {
            mass += body.mass;
            moment += body.inertia[0][0] + body.inertia[1][1] + body.inertia[2][2];
        }
        for (const Link<P>& link : links)
            for (const Attachment<P>& attachment : {link.from, link.to})
                if (attachment.body != world() && square < dot(attachment.arm_B, attachment.arm_B))
                    square = dot(attachment.arm_B, attachment.arm_B);
        if (!(moment > P(0))) moment = mass * square;
        for (int b = 0; b < world(); ++b) {
            MaximalBody<P>& body = bodies[b];
            const bool is_massless = !(body.mass > P(0)), is_thin = has_vanishing_moment(body.inertia);
            if (!body.movable || (!is_massless && !is_thin)) continue;
            Link<P> link;
            link.name = scene_->bodies[static_cast<std::size_t>(b)].name;
            link.kind = Kind::added_inertia;
            link.from = {world(), {}}, link.to = {b, {}};
            if (is_massless) body.added_mass = mass;
            body.added_moment = moment;
            body.mass += body.added_mass;
            for (int i = 0; i < 3; ++i) {
                if (is_massless) link.compliance[i] = P(1) / body.added_mass, link.rows.push_back(i);
                body.inertia[i][i] += body.added_moment, link.compliance[3 + i] = P(1) / body.added_moment;
            }
            for (int i = 3; i < 6; ++i) link.rows.push_back(i);
            links.push_back(link);
        }
    }

    void add_to_state(Link<P>& link) {
        link.angles = turns;
        turns += link.coordinates();
    }
    void count_coordinates(Link<P>& link) {
        if (link.angles < 0) add_to_state(link);
        link.counted = true;
    }

    std::size_t joint_of(std::string_view name) const {
        std::size_t j = 0;
        while (scene_->joints[j].name != name) ++j;
        return j;
    }
    // Adds a row of a joint's coordinate.
    void add_coordinate(std::size_t joint, const P& factor, int partner) {
        Link<P> link = links[joint];
        link.of = link.kind, link.kind = Kind::coordinate, link.joint = static_cast<int>(joint);
        link.closes = true, link.angles = -1, link.counted = false, link.stiffness = link.damping = {P(0), P(0)};
        link.rows = {0}, link.factor = factor, link.partner = partner;
        links.push_back(link);
    }

    // Adds the armatures of the joints between bodies of which one can move.
    void add_armature() {
        for (std::size_t j = 0; j < scene_->joints.size(); ++j) {
            const Joint& joint = scene_->joints[j];
            if (joint.armature == std::array<double, 2>{}) continue;
            Link<P> link = links[j];
            link.of = link.kind, link.kind = Kind::armature, link.joint = static_cast<int>(j);
            link.angles = -1, link.counted = false, link.stiffness = link.damping = {P(0), P(0)};
            link.rows.clear();
            const bool is_spherical = link.of == Kind::spherical;
            for (int i = 0; i < (is_spherical ? 3 : links[j].coordinates()); ++i) {
                const double d = joint.armature[static_cast<std::size_t>(is_spherical ? 0 : i)];
                if (d == 0) continue;
                link.compliance[static_cast<std::size_t>(i)] = P(-1) / P(d);
                link.rows.push_back(i);
            }
            links.push_back(link);
        }
    }

    // The joints form trees, so the number of sweeps equals the largest depth.
    void find_depths() {
        depth.assign(bodies.size(), 0);
        for (bool changed = true; changed;) {
            changed = false;
            for (const Link<P>& link : links) {
                if (!link.is_joint()) continue;
                const int parent = link.from.body, child = link.to.body;
                const int below = parent == world() ? 1 : depth[parent] + 1;
                const bool is_fixed = link.kind == Kind::fixed && !movable(parent);
                if (depth[child] == below && bodies[child].movable == !is_fixed) continue;
                depth[child] = below, bodies[child].movable = !is_fixed;
                changed = true;
            }
        }
    }
};

}  // namespace polhode::maximal
