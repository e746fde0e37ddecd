// Scenes of one body with formula loads, for tests.
#pragma once

#include <cmath>
#include <string>

#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode::test {

/// A body of mass 2 kg with moments (0.3, 0.4, 0.5) kg m^2 and these further members of the scene, such as
/// "\"loads\": [..]". `initial`: members of the initial state.
inline Scene formula_scene(const std::string& members, const std::string& initial = "", double duration = 2,
                           const std::string& body = R"json({"mass": 2, "inertia": [0.3, 0.4, 0.5]})json") {
    const std::string text = R"json({"name": "formulas", "duration": )json" + std::to_string(duration) +
                             R"json(, "body": )json" + body + R"json(, "initial": {)json" + initial + "}, " + members +
                             "}";
    return parse_scene(text, "formulas.json", "");
}

/// a - b, from both parts.
inline double difference(const Pair& a, const Pair& b) { return (a.high - b.high) + (a.low - b.low); }
inline double difference(const Vector3<Pair>& a, const Vector3<Pair>& b) {
    return std::hypot(difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2]));
}

/// The largest difference of all samples of two references, with or without the energy.
inline double difference(const Reference& a, const Reference& b, bool energy = true) {
    double worst = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        const ReferenceSample &x = a.samples[i], &y = b.samples[i];
        worst =
            std::max({worst, std::abs(difference(x.q.w, y.q.w)), std::abs(difference(x.q.x, y.q.x)),
                      std::abs(difference(x.q.y, y.q.y)), std::abs(difference(x.q.z, y.q.z)),
                      difference(x.angular_velocity_B, y.angular_velocity_B), difference(x.position_W, y.position_W),
                      difference(x.velocity_W, y.velocity_W), energy ? std::abs(difference(x.energy, y.energy)) : 0});
    }
    return worst;
}

/// The solution of a method at a tolerance.
inline Trajectory solve_with(const Scene& scene, const char* method, double tolerance, long samples = 20) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = samples;
    return solve(pose(scene), *find_method(method), settings);
}

}  // namespace polhode::test
