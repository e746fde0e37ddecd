// Computes a scene's body and initial state from its binary64 numbers, for every scalar.
#pragma once

#include "body/mass_properties.h"
#include "motion/exact_body.h"
#include "scene/body_source.h"

namespace polhode {

template <class P>
ExactBody<P> exact_body(const Scene& scene) {
    ExactBody<P> b;
    const MassProperties<P> body = mass_properties<P>(scene.body);
    b.mass = body.mass;
    b.center = body.center;
    b.pivoted = scene.pivot.has_value();
    b.origin = b.pivoted ? cast<P>(*scene.pivot) : body.center;
    b.arm = body.center - b.origin;
    b.inertia_B = body.inertia + parallel_axis(b.mass, b.arm);
    b.q = normalized(cast<P>(scene.initial.orientation));
    b.angular_velocity_B = cast<P>(scene.initial.angular_velocity);
    if (scene.initial.angular_velocity_frame == Frame::world)
        b.angular_velocity_B = rotate_back(b.q, b.angular_velocity_B);
    if (b.pivoted) {
        pivoted_center(b.q, b.angular_velocity_B, b.arm, b.position_W, b.velocity_W);
    } else {
        b.position_W = cast<P>(scene.initial.position_W);
        b.velocity_W = cast<P>(scene.initial.velocity_W);
    }
    return b;
}

}  // namespace polhode
