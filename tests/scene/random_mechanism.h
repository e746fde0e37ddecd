// Random valid scenes of several bodies for RapidCheck: trees and loops of every type.
#pragma once

#include <algorithm>

#include "scene/random_scene.h"

namespace polhode {

inline Vector3<double> random_direction() {
    const Quaternion<double> q = random_orientation();
    const Vector3<double> v(q.x, q.y, q.z);
    return v == Vector3<double>() ? Vector3<double>(0, 0, 1) : v;
}

inline std::array<double, 2> random_pair() { return {*real_number(), *real_number()}; }

/// "world" or a body before `index`.
inline std::string random_base(const Scene& scene, std::size_t index) {
    const std::size_t chosen = *rc::gen::inRange<std::size_t>(0, index + 1);
    return chosen == index ? "world" : scene.bodies[chosen].name;
}

/// A joint that carries body `index` on the world or on an earlier body. Members unused by its type keep defaults.
inline Joint random_joint(const Scene& scene, std::size_t index) {
    Joint j;
    j.name = "joint " + std::to_string(index);
    j.type = *rc::gen::element(JointType::revolute, JointType::prismatic, JointType::spherical, JointType::universal,
                               JointType::fixed);
    j.parent = random_base(scene, index), j.child = scene.bodies[index].name;
    j.parent_point = random_vector(), j.child_point = random_vector();
    j.parent_orientation = random_orientation();
    if (j.type == JointType::fixed) return j;
    if (j.type == JointType::spherical) {
        j.orientation = random_orientation(), j.rest_orientation = random_orientation();
        j.angular_velocity = random_vector();
        j.stiffness[0] = *real_number(), j.damping[0] = *real_number();
        return j;
    }
    j.axes[0] = random_direction();
    j.coordinate = random_pair(), j.rate = random_pair(), j.rest = random_pair();
    j.stiffness = random_pair(), j.damping = random_pair();
    if (j.type == JointType::universal) {
        // nearly perpendicular to the first axis, so not parallel to it
        const Vector3<double>& a = j.axes[0];
        const Vector3<double> other =
            std::abs(a[0]) < std::abs(a[1]) ? Vector3<double>(1, 0, 0) : Vector3<double>(0, 1, 0);
        j.axes[1] = cross(a, other) + *real_number() * 1e-8 * a;
    } else {
        for (std::array<double, 2>* pair : {&j.coordinate, &j.rate, &j.rest, &j.stiffness, &j.damping}) (*pair)[1] = 0;
    }
    return j;
}

inline Loop random_loop(const Scene& scene, std::size_t index) {
    Loop l;
    l.name = "loop " + std::to_string(index);
    l.type = *rc::gen::element(LoopType::spherical, LoopType::revolute, LoopType::distance);
    const std::size_t body = *rc::gen::inRange<std::size_t>(0, scene.bodies.size());
    l.first = scene.bodies[body].name, l.second = random_base(scene, body);
    l.first_point = random_vector(), l.second_point = random_vector();
    if (l.type == LoopType::revolute) l.first_axis = random_direction(), l.second_axis = random_direction();
    if (l.type == LoopType::distance) l.length = positive_number();
    return l;
}

inline Load random_load_of_several(const Scene& scene) {
    const auto name = [&] { return scene.bodies[*rc::gen::inRange<std::size_t>(0, scene.bodies.size())].name; };
    const int kind = *rc::gen::inRange(0, 4);
    if (kind == 0)
        for (const Joint& j : scene.joints)
            if (j.type == JointType::revolute || j.type == JointType::prismatic)
                return Motor{j.name, *real_number(), random_window()};
    if (kind == 1)
        return PointSpring{name(),         random_vector(),   "world",        random_vector(),
                           *real_number(), positive_number(), random_window()};
    Load load = random_load();
    std::visit(
        [&](auto& one) {
            if constexpr (requires { one.body; }) one.body = name();
        },
        load);
    return load;
}

inline Scene random_mechanism() {
    Scene scene;
    scene.name = "mechanism", scene.duration = positive_number();
    const std::size_t bodies = *rc::gen::inRange<std::size_t>(1, 6);
    for (std::size_t i = 0; i < bodies; ++i) {
        scene.bodies.push_back({*rc::gen::element("arm ", "Glied ä", "x") + std::to_string(i), random_body(), {}});
        if (*rc::gen::inRange(0, 4) != 0) {
            scene.joints.push_back(random_joint(scene, i));
        } else {
            scene.bodies[i].initial = {random_orientation(), random_vector(), random_frame(), random_vector(),
                                       random_vector()};
        }
    }
    // at least one joint must move
    const auto is_fixed = [](const Joint& joint) { return joint.type == JointType::fixed; };
    if (scene.joints.size() == bodies && std::ranges::all_of(scene.joints, is_fixed))
        scene.joints[0].type = JointType::spherical;
    const std::size_t loops = *rc::gen::inRange<std::size_t>(0, 3);
    for (std::size_t i = 0; i < loops; ++i) scene.loops.push_back(random_loop(scene, i));
    for (Joint& j : scene.joints)
        if (!scene.loops.empty() && (j.type == JointType::revolute || j.type == JointType::prismatic))
            j.dependent = *rc::gen::arbitrary<bool>();
    const int loads = *rc::gen::inRange(0, 5);
    for (int i = 0; i < loads; ++i) scene.loads.push_back(random_load_of_several(scene));
    return scene;
}

}  // namespace polhode
