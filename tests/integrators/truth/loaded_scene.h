// Random bodies under every load of the scene format.
#pragma once

#include <random>

#include "motion/exact_body.h"
#include "scene/scene.h"

namespace polhode {

class Dice {
  public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double number() { return uniform_(engine_); }
    Vector3<double> vector() { return {number(), number(), number()}; }
    Quaternion<double> orientation() {
        const Quaternion<double> q{number(), number(), number(), number()};
        return normalized(q);
    }

  private:
    std::mt19937 engine_;
    std::uniform_real_distribution<double> uniform_{-1, 1};
};

// A random body with products of inertia, in flight or about a pivot, under every kind of load.
inline Scene loaded_scene(unsigned seed, bool pivoted) {
    Dice dice(seed);
    Scene scene;
    scene.name = "loaded";
    scene.duration = 1;
    scene.body.mass = 1.5 + dice.number();
    // the sum over point masses is a valid inertia
    Matrix3<double> inertia;
    for (int i = 0; i < 6; ++i) inertia = inertia + parallel_axis(1.0, dice.vector());
    scene.body.inertia_B = inertia;
    scene.body.center_of_mass = dice.vector();
    if (pivoted) {
        scene.pivot = dice.vector();
    } else {
        scene.initial.position_W = dice.vector();
        scene.initial.velocity_W = dice.vector();
    }
    scene.initial.orientation = dice.orientation();
    scene.initial.angular_velocity = 2.0 * dice.vector();
    scene.initial.angular_velocity_frame = Frame::world;
    scene.loads.push_back(Gravity{dice.vector(), {}});
    scene.loads.push_back(Drag{{0.1, 0.2, 0.3}, 0.4, {}});
    scene.loads.push_back(Spring{1.7, dice.orientation(), {}});
    for (const Frame frame : {Frame::body, Frame::world}) {
        scene.loads.push_back(Torque{dice.vector(), frame, {0.125, 0.75}});
        for (const Frame point_frame : {Frame::body, Frame::world}) {
            scene.loads.push_back(Force{dice.vector(), frame, dice.vector(), point_frame, {0.25, 2}});
            scene.loads.push_back(Impulse{dice.vector(), frame, dice.vector(), point_frame, 0.5});
        }
    }
    return scene;
}

}  // namespace polhode
