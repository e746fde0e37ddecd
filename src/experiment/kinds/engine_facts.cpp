// Engines: what they report about themselves, and how they move a free body whose motion is known.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/known_update.h"
#include "experiment/kinds/engines.h"

namespace polhode {
namespace {

/// A free body with three different moments. Choose the duration so long that all known updates differ.
Scene probe_scene(double duration) {
    Scene scene;
    scene.name = "probe", scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 1.1, 0.9};
    return scene;
}

Trajectory probe(const Method& method, const Scene& scene, double step) {
    Settings settings;
    settings.step = step, settings.samples = std::lround(scene.duration / step);
    settings.seconds_limit = 10;
    return solve(scene, method, settings);
}

// The projection of the change of w (body axes, 0.1 s) on the true change, relative to it: 1 if the gyroscopic term
// acts, 0 if not.
std::optional<double> measure_gyroscopic_fraction(const Method& method) {
    const Scene scene = probe_scene(0.1);
    const Trajectory engine_run = probe(method, scene, 1e-3), truth = solve(scene, *find_method("exact"), {});
    if (engine_run.status != Status::ok || truth.status != Status::ok) return {};
    const auto change = [](const Trajectory& run) {
        return run.samples.back().angular_velocity_B - run.samples.front().angular_velocity_B;
    };
    const Vector3<double> expected = change(truth);
    return dot(change(engine_run), expected) / dot(expected, expected);
}

bool is_same_run(const Trajectory& a, const Trajectory& b) {
    if (a.status != b.status || a.samples.size() != b.samples.size()) return false;
    for (std::size_t k = 0; k < a.samples.size(); ++k) {
        const Sample &x = a.samples[k], &y = b.samples[k];
        for (int i = 0; i < 3; ++i)
            if (x.angular_velocity_B[i] != y.angular_velocity_B[i] || x.position_W[i] != y.position_W[i]) return false;
        if (x.q.w != y.q.w || x.q.x != y.q.x || x.q.y != y.q.y || x.q.z != y.q.z) return false;
    }
    return true;
}

TrajectoryFile make_file(const Trajectory& run) {
    TrajectoryFile file;
    for (const Sample& s : run.samples) {
        TrajectoryRow row;
        row.t = s.t, row.q = s.q, row.angular_velocity_W = angular_velocity_W(s);
        file.rows.push_back(row);
    }
    file.has_angular_velocity = true;
    return file;
}

EngineFacts find_facts(const EngineMethod& engine) {
    EngineFacts facts;
    facts.engine = &engine;
    const Scene scene = probe_scene(2);
    const Problem problem = pose(scene);
    facts.report = engine.inspect(&problem);
    if (!facts.is_available()) return facts;
    for (const auto& [name, what] : facts.report.hello.settings)
        if (name == engine.setting) facts.setting_description = what;
    const Trajectory first = probe(*engine.method, scene, default_engine_step),
                     second = probe(*engine.method, scene, default_engine_step);
    if (first.status == Status::unsupported || first.status == Status::failed) {
        facts.report.fault = first.message;
        return facts;
    }
    facts.repeats = first.status == Status::ok && is_same_run(first, second);
    facts.gyroscopic_fraction = measure_gyroscopic_fraction(*engine.method);
    if (first.status != Status::ok) return facts;
    facts.matching_update = no_update;
    if (const auto followed = identify_update(scene, make_file(first), 1, 1.2e-7))
        facts.matching_update = followed->method, facts.update_difference = followed->distance;
    return facts;
}

}  // namespace

std::vector<EngineFacts> engine_facts(const Plan& plan, const std::vector<Result>& rows) {
    std::vector<EngineFacts> all;
    for (const PlannedCurve& curve : plan.curves) {
        const EngineMethod* engine = engine_of(*curve.method);
        const auto is_own = [&](const Result& row) { return row.method == curve.method->name; };
        if (engine && std::ranges::any_of(rows, is_own)) all.push_back(find_facts(*engine));
    }
    return all;
}

}  // namespace polhode
