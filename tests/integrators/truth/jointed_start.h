// Initial motions of the bodies of a tree, directly from the definition of each joint, and random trees.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "body/elementary.h"
#include "integrators/truth/loaded_scene.h"
#include "integrators/truth/motion.h"
#include "scene/body_source.h"
#include "scene/scene.h"

namespace polhode {

/// exp(axis x): a rotation by x about an axis of any non-zero length.
template <class P>
Quaternion<P> turn_about(const Vector3<double>& axis, const P& x) {
    P s(0), c(0);
    sine_cosine(P(x / P(2)), s, c);
    const Vector3<P> a = cast<P>(axis);
    const Vector3<P> v = P(s / length(a)) * a;
    return {c, v[0], v[1], v[2]};
}

/// The initial motions. Joints must come after those that carry their parents.
template <class P>
std::vector<truth::Motion<P>> jointed_start(const Scene& scene) {
    struct Placed {
        Quaternion<P> q;
        Vector3<P> w_W, origin, velocity;  // position and velocity of the body's origin
    };
    const std::size_t n = scene.bodies.size();
    std::vector<Placed> frames(n + 1);
    std::vector<Vector3<P>> centers(n);
    const auto index = [&](const std::string& name) {
        for (std::size_t i = 0; i < n; ++i)
            if (scene.bodies[i].name == name) return i;
        return n;
    };
    for (std::size_t i = 0; i < n; ++i) {
        centers[i] = mass_properties<P>(scene.bodies[i].body).center;
        const Initial& start = scene.bodies[i].initial;
        Placed& f = frames[i];
        f.q = normalized(cast<P>(start.orientation));
        f.w_W = cast<P>(start.angular_velocity);
        if (start.angular_velocity_frame == Frame::body) f.w_W = rotate(f.q, f.w_W);
        const Vector3<P> arm = rotate(f.q, centers[i]);
        f.origin = cast<P>(start.position_W) - arm;
        f.velocity = cast<P>(start.velocity_W) - cross(f.w_W, arm);
    }
    for (const Joint& joint : scene.joints) {
        const Placed& parent = frames[index(joint.parent)];
        Placed& child = frames[index(joint.child)];
        const Quaternion<P> base = parent.q * normalized(cast<P>(joint.parent_orientation));
        const Vector3<P> hinge = rotate(parent.q, cast<P>(joint.parent_point));
        Vector3<P> point = parent.origin + hinge, speed = parent.velocity + cross(parent.w_W, hinge);
        const auto unit = [](const Vector3<double>& v) {
            const Vector3<P> a = cast<P>(v);
            return Vector3<P>(P(P(1) / length(a)) * a);
        };
        const P x(joint.coordinate[0]), y(joint.coordinate[1]), x_rate(joint.rate[0]), y_rate(joint.rate[1]);
        child.q = base, child.w_W = parent.w_W;
        if (joint.type == JointType::revolute) {
            child.q = base * turn_about(joint.axes[0], x);
            child.w_W = parent.w_W + x_rate * rotate(base, unit(joint.axes[0]));
        } else if (joint.type == JointType::prismatic) {
            const Vector3<P> rail = rotate(base, unit(joint.axes[0]));
            point = point + x * rail;
            speed = speed + cross(parent.w_W, x * rail) + x_rate * rail;
        } else if (joint.type == JointType::spherical) {
            child.q = base * normalized(cast<P>(joint.orientation));
            child.w_W = parent.w_W + rotate(child.q, cast<P>(joint.angular_velocity));
        } else if (joint.type == JointType::universal) {
            const Quaternion<P> middle = base * turn_about(joint.axes[0], x);
            child.q = middle * turn_about(joint.axes[1], y);
            child.w_W =
                parent.w_W + x_rate * rotate(base, unit(joint.axes[0])) + y_rate * rotate(middle, unit(joint.axes[1]));
        }
        const Vector3<P> arm = rotate(child.q, cast<P>(joint.child_point));
        child.origin = point - arm;
        child.velocity = speed - cross(child.w_W, arm);
    }
    std::vector<truth::Motion<P>> motions;
    for (std::size_t i = 0; i < n; ++i) {
        const Placed& f = frames[i];
        const Vector3<P> arm = rotate(f.q, centers[i]);
        motions.push_back({f.q, rotate_back(f.q, f.w_W), f.origin + arm, f.velocity + cross(f.w_W, arm)});
    }
    return motions;
}

/// A random body with products of inertia.
inline Body random_body(Dice& dice) {
    Body body;
    body.mass = 1.5 + dice.number();
    Matrix3<double> inertia;
    for (int i = 0; i < 6; ++i) inertia = inertia + parallel_axis(0.5, dice.vector());
    body.inertia_B = inertia;
    body.center_of_mass = 0.5 * dice.vector();
    return body;
}

/// A random joint of this type between two bodies.
inline Joint random_joint(Dice& dice, JointType type, std::string parent, std::string child) {
    Joint joint;
    joint.name = "to " + child;
    joint.type = type;
    joint.parent = std::move(parent), joint.child = std::move(child);
    joint.parent_point = 0.5 * dice.vector(), joint.child_point = 0.5 * dice.vector();
    joint.parent_orientation = dice.orientation();
    joint.axes = {dice.vector(), dice.vector()};
    joint.coordinate = {dice.number(), dice.number()};
    joint.rate = {dice.number(), dice.number()};
    joint.orientation = dice.orientation();
    joint.angular_velocity = dice.vector();
    return joint;
}

/// A tree of bodies b0, b1, ..: the first is free or joined to the world, and each other one is carried by an earlier
/// one. The types of joints alternate.
inline Scene random_tree(unsigned seed, int count, bool free_base) {
    Dice dice(seed);
    Scene scene;
    scene.name = "tree";
    scene.duration = 0.125;
    static constexpr JointType types[] = {JointType::spherical, JointType::revolute, JointType::universal,
                                          JointType::prismatic, JointType::fixed};
    for (int i = 0; i < count; ++i) {
        NamedBody named;
        named.name = "b" + std::to_string(i), named.body = random_body(dice);
        if (i == 0 && free_base) {
            named.initial.orientation = dice.orientation();
            named.initial.angular_velocity = dice.vector();
            named.initial.position_W = dice.vector(), named.initial.velocity_W = dice.vector();
        } else {
            const int carrier = static_cast<int>((dice.number() + 1) / 2 * i);
            const std::string parent = i == 0 ? "world" : "b" + std::to_string(carrier);
            scene.joints.push_back(
                random_joint(dice, types[(static_cast<unsigned>(i) + seed) % 5], parent, named.name));
        }
        scene.bodies.push_back(named);
    }
    return scene;
}

}  // namespace polhode
