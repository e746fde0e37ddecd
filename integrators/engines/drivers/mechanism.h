// Several bodies and joints as a driver is asked for them, and the march through their steps.
//
// A driver gives a mechanism's world: the engine with all bodies and joints in it, made anew for every run.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "body/mass_properties.h"
#include "integrators/run/watch.h"

namespace polhode::engines {

/// Where a body is and how it moves; world axes.
struct Motion {
    Quaternion<double> q;
    Vector3<double> w, p, v;
};

/// A body of several: its origin is its centre of mass, its axes are its principal ones. It starts at `start`.
struct LinkBody {
    double mass;
    Vector3<double> moments;
    Motion start;
};

/// A joint, or what closes a loop; see EngineJoint. All coordinates are zero at the start.
struct LinkJoint {
    std::string type;
    int parent, child;  ///< indices; -1: the world
    Vector3<double> anchor_W, parent_point, child_point;
    std::vector<Vector3<double>> axes_W, parent_axes, child_axes;  ///< unit
    Vector3<double> turning_W;                                     ///< child against parent
    std::vector<double> rates;                                     ///< of the coordinates

    /// Whether a universal joint is a cross, as most engines have it.
    bool is_cross() const { return std::abs(dot(axes_W.at(0), axes_W.at(1))) < 1e-9; }
};

struct Mechanism {
    std::vector<LinkBody> bodies;
    std::vector<LinkJoint> joints;  ///< parents before children
    std::vector<LinkJoint> loops;
    Vector3<double> gravity;
    std::string setting;

    const LinkBody& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }
    /// The attitude of a body or of the world at the start.
    Quaternion<double> attitude(int index) const { return index < 0 ? Quaternion<double>() : body(index).start.q; }
    /// The joint that carries a body; nullptr of a free one.
    const LinkJoint* carrier(int index) const {
        for (const LinkJoint& joint : joints)
            if (joint.child == index) return &joint;
        return nullptr;
    }
    /// The bodies in an order in which parents come before children: free ones first.
    std::vector<int> outwards() const {
        std::vector<int> order;
        for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
            if (!carrier(i)) order.push_back(i);
        for (const LinkJoint& joint : joints) order.push_back(joint.child);
        return order;
    }
};

/// World axes with z along `z`; x along `x` where that is given, which must be perpendicular.
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

/// An engine with several bodies in it.
template <class World>
concept MechanismWorld = std::constructible_from<World, const Mechanism&> && requires(World world, double h) {
    { world.motions() } -> std::same_as<std::vector<Motion>>;  // of all bodies, in their order
    world.step(h);
};

/// A request for several bodies.
struct MechanismRequest {
    Mechanism mechanism;
    double duration;
    long samples, steps_per_sample, repetitions;
};

/// What is written back.
struct MechanismRun {
    std::vector<std::vector<Motion>> moments;
    double seconds = 0;
    long steps = 0;
};

/// A world marched through a request.
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
