// Scenes of several bodies with massless bodies, point masses and rods.
#pragma once

#include <string>
#include <utility>

#include "scene/scene.h"

namespace polhode::massless {

inline NamedBody body_of(std::string name, double mass, const Vector3<double>& moments = {},
                         const Vector3<double>& center = {}) {
    NamedBody body;
    body.name = std::move(name);
    body.body.mass = mass, body.body.inertia_B = diagonal(moments), body.body.center_of_mass = center;
    return body;
}

inline Joint joint_of(std::string name, JointType type, std::string parent, std::string child,
                      const Vector3<double>& axis = {0, 1, 0}, const Vector3<double>& parent_point = {}) {
    Joint joint;
    joint.name = std::move(name), joint.type = type;
    joint.parent = std::move(parent), joint.child = std::move(child);
    joint.axes = {axis, axis[0] == 0 ? Vector3<double>(1, 0, 0) : Vector3<double>(0, 1, 0)};
    joint.parent_point = parent_point;
    return joint;
}

inline Scene scene_of(std::string name, double duration) {
    Scene scene;
    scene.name = std::move(name), scene.duration = duration;
    return scene;
}

/// The textbook double pendulum: two point masses on massless rods, hinges along y.
struct PointMassPendulum {
    double m1 = 1, m2 = 0.75, l1 = 1, l2 = 0.5, g = 9.75, theta1 = 1.25, theta2 = -0.5, w1 = 0.25, w2 = -1;

    Scene scene(double duration) const {
        Scene scene = scene_of("point_mass_double_pendulum", duration);
        scene.bodies = {body_of("upper", m1, {}, {0, 0, -l1}), body_of("lower", m2, {}, {0, 0, -l2})};
        scene.joints = {joint_of("shoulder", JointType::revolute, "world", "upper"),
                        joint_of("elbow", JointType::revolute, "upper", "lower", {0, 1, 0}, {0, 0, -l1})};
        scene.joints[0].coordinate[0] = theta1, scene.joints[0].rate[0] = w1;
        scene.joints[1].coordinate[0] = theta2 - theta1, scene.joints[1].rate[0] = w2 - w1;
        scene.loads = {Gravity{{0, 0, -g}, {}}};
        return scene;
    }
};

}  // namespace polhode::massless
