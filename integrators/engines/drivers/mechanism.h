// Several bodies and joints as a driver receives them, and the loop over their steps.
//
// A driver provides a MechanismWorld: the engine with all bodies and joints, created for each run.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "body/mass_properties.h"
#include "integrators/run/watch.h"
#include "scene/scene.h"

namespace polhode::engines {

/// Position and velocity of a body; world axes.
struct Motion {
    Quaternion<double> q;
    Vector3<double> w, p, v;
};

/// A body of a mechanism. Its origin is its centre of mass and its axes are its principal axes. It starts at `start`.
struct LinkBody {
    double mass = 0;
    Vector3<double> moments;
    Motion start;
};

/// A joint or the closure of a loop; see EngineJoint. All coordinates are zero at the start.
struct LinkJoint {
    std::string type;
    int parent, child;  ///< indices; -1: the world
    Vector3<double> anchor_W, parent_point, child_point;
    std::vector<Vector3<double>> axes_W, parent_axes, child_axes;  ///< unit
    Vector3<double> angular_velocity_W;  ///< angular velocity of the child relative to the parent
    std::vector<double> rates;           ///< rates of the coordinates

    /// True if a universal joint has perpendicular axes, as most engines require.
    bool has_perpendicular_axes() const { return std::abs(dot(axes_W.at(0), axes_W.at(1))) < 1e-9; }
};

/// Balls that touch each other and planes, instead of joints.
struct Balls {
    std::vector<double> radii;  ///< radius by body, m
    double restitution, friction;
    std::vector<Plane> planes;  ///< unit normals
};

struct Mechanism {
    std::vector<LinkBody> bodies;
    std::vector<LinkJoint> joints;  ///< parents precede children
    std::vector<LinkJoint> loops;
    Vector3<double> gravity;
    std::string setting;
    std::optional<Balls> balls;

    const LinkBody& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }
    /// The attitude of a body, or of the world, at the start.
    Quaternion<double> attitude(int index) const { return index < 0 ? Quaternion<double>() : body(index).start.q; }
    /// The joint that carries a body; nullptr for a free body.
    const LinkJoint* parent_joint(int index) const {
        for (const LinkJoint& joint : joints)
            if (joint.child == index) return &joint;
        return nullptr;
    }
    /// The bodies in an order in which parents precede children; free bodies come first.
    std::vector<int> outward_order() const {
        std::vector<int> order;
        for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
            if (!parent_joint(i)) order.push_back(i);
        for (const LinkJoint& joint : joints) order.push_back(joint.child);
        return order;
    }
};

/// World axes with z along `z`, and x along `x` if given (must be perpendicular to z).
inline Quaternion<double> frame_about(const Vector3<double>& z, Vector3<double> x = {}) {
    if (dot(x, x) == 0) {
        int least = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(z[i]) < std::abs(z[least])) least = i;
        x[least] = 1;
        x = x - dot(x, z) * z;
        x = (1 / std::sqrt(dot(x, x))) * x;
    }
    const Vector3<double> y = cross(z, x);
    // columns x, y, z
    const double m00 = x[0], m11 = y[1], m22 = z[2];
    Quaternion<double> q{1 + m00 + m11 + m22, y[2] - z[1], z[0] - x[2], x[1] - y[0]};
    const Quaternion<double> others[] = {{y[2] - z[1], 1 + m00 - m11 - m22, y[0] + x[1], z[0] + x[2]},
                                         {z[0] - x[2], y[0] + x[1], 1 - m00 + m11 - m22, z[1] + y[2]},
                                         {x[1] - y[0], z[0] + x[2], z[1] + y[2], 1 - m00 - m11 + m22}};
    for (const Quaternion<double>& other : others)
        if (squared_norm(other) > squared_norm(q)) q = other;
    return normalized(q);
}

/// An engine with several bodies.
template <class World>
concept MechanismWorld = std::constructible_from<World, const Mechanism&> && requires(World world, double h) {
    { world.motions() } -> std::same_as<std::vector<Motion>>;  // motions of all bodies, in their order
    world.step(h);
};

/// A request for several bodies.
struct MechanismRequest {
    Mechanism mechanism;
    double duration = 0;
    long samples = 0, steps_per_sample = 0, repetitions = 0;
};

/// The result of a request.
struct MechanismRun {
    std::vector<std::vector<Motion>> moments;
    double seconds = 0;
    long steps = 0;
};

/// Runs a world through a request.
template <MechanismWorld World>
MechanismRun march_mechanism(const MechanismRequest& request) {
    MechanismRun run;
    for (long repetition = 0; repetition < request.repetitions; ++repetition) {
        const auto world = std::make_unique<World>(request.mechanism);
        run.moments.assign(1, world->motions());
        run.steps = 0;
        const Stopwatch stopwatch;
        for (long k = 1; k <= request.samples; ++k) {
            const double begin = sample_time(request.duration, k - 1, request.samples),
                         end = sample_time(request.duration, k, request.samples);
            const double h = (end - begin) / static_cast<double>(request.steps_per_sample);
            for (long i = 0; i < request.steps_per_sample; ++i) world->step(h), ++run.steps;
            run.moments.push_back(world->motions());
        }
        run.seconds += stopwatch.seconds() / static_cast<double>(request.repetitions);
    }
    return run;
}

}  // namespace polhode::engines
