// Ensembles shared by tests and benchmarks.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "integrators/own/ensemble.h"
#include "scene/scene.h"

namespace polhode::testing {

/// Random numbers that are the same on every machine; the distributions of the standard library may differ.
class Draw {
  public:
    explicit Draw(unsigned seed) : engine_(seed) {}
    double uniform(double from, double to) {
        return from + (to - from) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    Vector3<double> vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Quaternion<double> orientation() {
        for (;;) {
            const Quaternion<double> q{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            const double size = std::sqrt(squared_norm(q));
            if (size > 0.1 && size < 1) return {q.w / size, q.x / size, q.y / size, q.z / size};
        }
    }
    /// Moments that satisfy the triangle inequality.
    Vector3<double> moments() {
        for (;;) {
            const Vector3<double> I(uniform(0, 1), uniform(0, 1), uniform(0, 1));
            if (I[0] < I[1] + I[2] && I[1] < I[2] + I[0] && I[2] < I[0] + I[1]) return I;
        }
    }

  private:
    std::mt19937_64 engine_;
};

inline Scene free_scene(double duration) {
    Scene scene;
    scene.name = "ensemble", scene.duration = duration;
    return scene;
}

inline std::vector<EnsembleBody> free_bodies(std::size_t count, unsigned seed) {
    Draw draw(seed);
    std::vector<EnsembleBody> bodies(count);
    for (EnsembleBody& b : bodies) {
        b.inertia_B = diagonal(draw.moments());
        b.orientation = draw.orientation();
        b.angular_velocity = draw.vector(1.5);
    }
    return bodies;
}

/// Tops with I = (1, 1, 0.5) kg m^2 about the pivot and m g l = 5 N m.
inline Scene top_scene(double duration) {
    Scene scene;
    scene.name = "tops", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(0.75, 0.75, 0.5));
    scene.body.center_of_mass = {0, 0, 0.5};
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.loads = {Gravity{{0, 0, -10}, {}}};
    return scene;
}

/// Tops with masses and moments varied by ~10 %, tilted, spinning at 17 to 23 rad/s; `symmetric`: two equal moments.
inline std::vector<EnsembleBody> tops(std::size_t count, bool symmetric, unsigned seed) {
    Draw draw(seed);
    std::vector<EnsembleBody> bodies(count);
    for (EnsembleBody& b : bodies) {
        const double across = draw.uniform(0.65, 0.85), other = symmetric ? across : draw.uniform(0.65, 0.85);
        b.mass = draw.uniform(0.9, 1.1);
        b.inertia_B = diagonal(Vector3<double>(across, other, draw.uniform(0.45, 0.55)));
        const double half_tilt = draw.uniform(0.1, 0.6), half_turn = draw.uniform(-3, 3);
        b.orientation = Quaternion<double>{std::cos(half_turn), 0, 0, std::sin(half_turn)} *
                        Quaternion<double>{std::cos(half_tilt), std::sin(half_tilt), 0, 0};
        b.angular_velocity = draw.vector(0.3);
        b.angular_velocity[2] = draw.uniform(17, 23);
    }
    return bodies;
}

/// The scene of a single body of the ensemble.
inline Scene scene_of(const Scene& scene, const EnsembleBody& b) {
    Scene one = scene;
    one.body.mass = b.mass, one.body.inertia_B = b.inertia_B, one.body.source = nullptr;
    one.initial.orientation = b.orientation, one.initial.angular_velocity = b.angular_velocity;
    one.initial.position_W = b.position_W, one.initial.velocity_W = b.velocity_W;
    return one;
}

}  // namespace polhode::testing
