// The errors of several bodies.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "measure/errors.h"

namespace polhode {
namespace {

using WideSystem = SystemInvariants<Wide>;

BodyMotion<Wide> motion_of(const TrueState<Wide>& state) {
    return {state.q, state.angular_velocity_B, state.position_W, state.velocity_W};
}

// The truth of all bodies, time by time.
struct TrueRun {
    std::vector<TrueState<Wide>> states;  // by time, then by body
    std::vector<WideSystem> systems;
    Wide largest_force = 0, largest_torque = 0;  // of reactions, N and N m
};

// of a reaction; zero for what the motion does not determine
Vector3<Wide> wide(const Vector3<Pair>& v) {
    const auto value = [](const Pair& p) { return std::isnan(p.high) ? Wide(0) : Wide(p.high) + Wide(p.low); };
    return {value(v[0]), value(v[1]), value(v[2])};
}
// what a method's reaction is off where it is determined
Wide distance(const Vector3<double>& own, const Vector3<Pair>& right) {
    Vector3<Wide> off = cast<Wide>(own) - wide(right);
    for (std::size_t i = 0; i < 3; ++i)
        if (std::isnan(right[i].high)) off[i] = 0;
    return length(off);
}

TrueRun true_run(const Scene& scene, const MechanismMeasure<Wide>& measure, const Reference& reference) {
    TrueRun run;
    for (const ReferenceSample& sample : reference.samples) run.states.push_back(true_motion<Wide>(sample));
    JointCoordinates coordinates(scene);
    std::vector<BodyMotion<Wide>> motions(measure.bodies());
    for (std::size_t k = 0; k < reference.moments(); ++k) {
        for (std::size_t b = 0; b < motions.size(); ++b) motions[b] = motion_of(run.states[k * motions.size() + b]);
        // from the samples, as a trajectory's are: where an angle turns too far between samples for its turns to be
        // counted, both are counted alike
        run.systems.push_back(measure.invariants(reference.samples[k * motions.size()].t, motions, coordinates));
    }
    const std::vector<Wide> arms = measure.arms();
    for (std::size_t i = 0; i < reference.reactions.size(); ++i) {
        const Wide force = length(wide(reference.reactions[i].force_W));
        run.largest_force = std::max(run.largest_force, force);
        run.largest_torque = std::max(
            {run.largest_torque, length(wide(reference.reactions[i].torque_W)), Wide(force * arms[i % arms.size()])});
    }
    return run;
}

}  // namespace

ErrorSeries system_error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference) {
    const std::span<const Measure> all = measures();
    const MechanismMeasure<Wide> measure(scene);
    const std::size_t n = measure.bodies(), joints = measure.arms().size();
    if (!trajectory.samples.empty() && static_cast<std::size_t>(trajectory.bodies) != n)
        throw std::invalid_argument("the trajectory is of another number of bodies");
    if (reference.available && static_cast<std::size_t>(reference.bodies) != n)
        throw std::invalid_argument("the truth is of another number of bodies");
    const std::size_t moments = trajectory.samples.size() / n,
                      compared = reference.available ? std::min(moments, reference.moments()) : 0;
    const TrueRun truth = reference.available ? true_run(scene, measure, reference) : TrueRun{};
    const bool reacts = joints > 0 && reference.reactions.size() == reference.moments() * joints &&
                        trajectory.reactions.size() == moments * joints;
    // what is not a number is the largest of all
    const auto larger = [](const Wide& error, const Wide& worst) {
        return !(error <= worst) && !std::isnan(double(worst));
    };

    PerMeasure<Wide> scale;
    for (std::size_t m = 0; m < all.size(); ++m) {
        if (all[m].system_scale)
            for (const WideSystem& system : truth.systems) scale[m] = std::max(scale[m], all[m].system_scale(system));
        else if (all[m].scale)
            for (const TrueState<Wide>& state : truth.states) scale[m] = std::max(scale[m], all[m].scale(state));
    }
    // bodies at rest turn by the truth's round-off at most
    if (Wide& omega = scale["omega"]; omega * Wide(scene.duration) < Wide(vanishing)) omega = 0;
    const auto known = [&](const Measure& m, std::size_t k) {
        return (k < compared || (m.needs & known_truth) == 0) && (reacts || (m.needs & known_reactions) == 0) &&
               (!measure.tied() || (m.needs & known_free_system) == 0);
    };
    const auto reaction_error = [&](std::size_t k) {
        Wide force = 0, torque = 0;
        for (std::size_t i = k * joints; i < (k + 1) * joints; ++i) {
            const Reaction<double>& own = trajectory.reactions[i];
            const Reaction<Pair>& right = reference.reactions[i];
            const Wide force_off = distance(own.force_W, right.force_W);
            const Wide torque_off = distance(own.torque_W, right.torque_W);
            if (larger(force_off, force)) force = force_off;
            if (larger(torque_off, torque)) torque = torque_off;
        }
        if (truth.largest_force > 0) force /= truth.largest_force;
        if (truth.largest_torque > 0) torque /= truth.largest_torque;
        return larger(force, torque) ? force : torque;
    };

    ErrorSeries series;
    const std::size_t attitude = measure_index("attitude");
    Wide worst_attitude = -1;
    JointCoordinates coordinates(scene);
    std::vector<ComparedSample<Wide>> bodies(n);
    std::vector<BodyMotion<Wide>> motions(n);
    for (std::size_t k = 0; k < moments; ++k) {
        const Bodies samples = trajectory.at(k);
        const double t = samples[0].t;
        series.t.push_back(t);
        if (k < compared && t != reference.samples[k * n].t)
            throw std::invalid_argument("trajectory and truth are sampled at different times");
        for (std::size_t b = 0; b < n; ++b) {
            ComparedSample<Wide>& c = bodies[b];
            c.q = cast<Wide>(samples[b].q), c.angular_velocity_B = cast<Wide>(samples[b].angular_velocity_B);
            c.position_W = cast<Wide>(samples[b].position_W), c.velocity_W = cast<Wide>(samples[b].velocity_W);
            if (!trajectory.orthogonality_defect.empty())
                c.orthogonality_defect = trajectory.orthogonality_defect[k * n + b];
            if (k < compared) c.truth = truth.states[k * n + b];
            motions[b] = {normalized(c.q), c.angular_velocity_B, c.position_W, c.velocity_W};
        }
        ComparedSystem<Wide> system;
        system.joints = measure.violations(motions);
        if (k < compared) {
            system.own = measure.invariants(t, motions, coordinates), system.truth = truth.systems[k];
            if (reacts) system.reaction_error = reaction_error(k);
        }
        for (std::size_t m = 0; m < all.size(); ++m) {
            if (!known(all[m], k)) continue;
            Wide error = all[m].system_error ? all[m].system_error(system) : all[m].error(bodies[0]);
            std::size_t worst = 0;
            for (std::size_t b = 1; b < n && !all[m].system_error; ++b)
                if (const Wide other = all[m].error(bodies[b]); larger(other, error)) error = other, worst = b;
            series[m].push_back(double(scale[m] > 0 ? error / scale[m] : error));
            if (m == attitude && larger(error, worst_attitude))
                worst_attitude = error, series.worst_body = scene.bodies[worst].name;
        }
    }
    return series;
}

}  // namespace polhode
