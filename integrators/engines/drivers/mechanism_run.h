// The loop over the steps of several bodies.
//
// A driver provides a MechanismWorld: the engine with all bodies and joints, created for each run.
#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <vector>

#include "integrators/engines/drivers/formula_loads.h"
#include "integrators/run/watch.h"

namespace polhode::engines {

/// An engine with several bodies.
template <class World>
concept MechanismWorld = std::constructible_from<World, const Mechanism&> && requires(World world, double h) {
    { world.motions() } -> std::same_as<std::vector<Motion>>;  // motions of all bodies, in their order
    world.apply(0, Vector3<double>(), Vector3<double>());  // force at a body's centre of mass and torque, for one step
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

/// Takes the step from t to `stop`, s, with the loads given by formulas. Returns the number of parts into which it is
/// split.
template <MechanismWorld World>
long step_with_formulas(World& world, FormulaLoads& formulas, double t, double stop) {
    const std::vector<double> ends = formulas.split(t, stop);
    for (const double end : ends) {
        const std::vector<BodyLoad>& loads = formulas.evaluate(t, end - t, world.motions());
        for (std::size_t b = 0; b < loads.size(); ++b)
            world.apply(static_cast<int>(b), loads[b].force, loads[b].torque);
        world.step(end - t);
        t = end;
    }
    return static_cast<long>(ends.size());
}

/// Runs a world through a request.
template <MechanismWorld World>
MechanismRun march_mechanism(const MechanismRequest& request) {
    MechanismRun run;
    for (long repetition = 0; repetition < request.repetitions; ++repetition) {
        const auto world = std::make_unique<World>(request.mechanism);
        std::optional<FormulaLoads> formulas;
        if (request.mechanism.formulas) formulas.emplace(*request.mechanism.formulas, request.mechanism);
        run.moments.assign(1, world->motions());
        run.steps = 0;
        const Stopwatch stopwatch;
        for (long k = 1; k <= request.samples; ++k) {
            const double begin = sample_time(request.duration, k - 1, request.samples),
                         end = sample_time(request.duration, k, request.samples);
            const double h = (end - begin) / static_cast<double>(request.steps_per_sample);
            for (long i = 0; i < request.steps_per_sample; ++i) {
                const double t = begin + static_cast<double>(i) * h;
                const double stop = i + 1 == request.steps_per_sample ? end : begin + static_cast<double>(i + 1) * h;
                if (formulas)
                    run.steps += step_with_formulas(*world, *formulas, t, stop);
                else
                    world->step(h), ++run.steps;
            }
            run.moments.push_back(world->motions());
        }
        run.seconds += stopwatch.seconds() / static_cast<double>(request.repetitions);
    }
    return run;
}

}  // namespace polhode::engines
