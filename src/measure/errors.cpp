#include "measure/errors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "measure/scene_measure.h"

namespace polhode {
namespace {

// Converts a reaction; components that the motion does not determine become zero.
Vector3<Wide> wide(const Vector3<Pair>& v) {
    const auto value = [](const Pair& p) { return std::isnan(p.high) ? Wide(0) : Wide(p.high) + Wide(p.low); };
    return {value(v[0]), value(v[1]), value(v[2])};
}
// Error of a method's reaction in the determined components.
Wide distance(const Vector3<double>& computed, const Vector3<Pair>& right) {
    Vector3<Wide> off = cast<Wide>(computed) - wide(right);
    for (std::size_t i = 0; i < 3; ++i)
        if (std::isnan(right[i].high)) off[i] = 0;
    return length(off);
}

// Errors of reactions, relative to the run's largest force and torque.
class ReactionErrors {
  public:
    ReactionErrors(const Trajectory& trajectory, const Reference& reference, const std::vector<Wide>& arms)
        : trajectory_(trajectory), reference_(reference), joints_(arms.size()) {
        for (std::size_t i = 0; i < reference.reactions.size(); ++i) {
            const Wide force = length(wide(reference.reactions[i].force_W));
            largest_force_ = std::max(largest_force_, force);
            largest_torque_ = std::max(
                {largest_torque_, length(wide(reference.reactions[i].torque_W)), Wide(force * arms[i % arms.size()])});
        }
    }
    // Error of the worst joint at the k-th time.
    Wide at(std::size_t k) const {
        Wide force = 0, torque = 0;
        for (std::size_t i = k * joints_; i < (k + 1) * joints_; ++i) {
            const Reaction<double>& computed = trajectory_.reactions[i];
            const Reaction<Pair>& right = reference_.reactions[i];
            const Wide force_off = distance(computed.force_W, right.force_W);
            const Wide torque_off = distance(computed.torque_W, right.torque_W);
            if (is_larger(force_off, force)) force = force_off;
            if (is_larger(torque_off, torque)) torque = torque_off;
        }
        if (largest_force_ > 0) force /= largest_force_;
        if (largest_torque_ > 0) torque /= largest_torque_;
        return is_larger(force, torque) ? force : torque;
    }

  private:
    const Trajectory& trajectory_;
    const Reference& reference_;
    std::size_t joints_;
    Wide largest_force_ = 0, largest_torque_ = 0;  // N and N m
};

// The reference's motion, and the scale of each measure for relative errors.
struct ScaledTruth {
    std::vector<BodyMotion<Wide>> states;  // by time, then by body
    std::vector<SystemInvariants<Wide>> wholes;
    PerMeasure<Wide> scale;
};

ScaledTruth scaled_truth(const Scene& scene, const SceneMeasure<Wide>& measure, const Reference& reference) {
    const std::span<const Measure> all = measures();
    const std::size_t n = measure.bodies(), true_moments = reference.available ? reference.moments() : 0;
    ScaledTruth result;
    auto& [states, wholes, scale] = result;
    JointCoordinates true_coordinates(scene);
    for (std::size_t k = 0; k < true_moments; ++k) {
        const std::span<const ReferenceSample> samples = std::span(reference.samples).subspan(k * n, n);
        for (const ReferenceSample& sample : samples) states.push_back(true_motion<Wide>(sample));
        const std::span<const BodyMotion<Wide>> bodies = std::span(states).subspan(k * n, n);
        wholes.push_back(measure.true_invariants(samples, bodies, true_coordinates));
        for (std::size_t m = 0; m < all.size(); ++m)
            scale[m] = std::max(scale[m], scale_in(all[m], bodies, wholes.back()));
    }
    // several bodies at rest rotate at most by the reference's round-off
    if (Wide& omega = scale["omega"]; measure.is_of_several() && omega * Wide(scene.duration) < Wide(vanishing))
        omega = 0;
    return result;
}

}  // namespace

ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference) {
    const std::span<const Measure> all = measures();
    const SceneMeasure<Wide> measure(scene);
    const std::vector<Wide> arms = measure.arms();
    const std::size_t n = measure.bodies(), joints = arms.size();
    if (!trajectory.samples.empty() && static_cast<std::size_t>(trajectory.bodies) != n)
        throw std::invalid_argument("the trajectory has a different number of bodies than the scene");
    if (reference.available && static_cast<std::size_t>(reference.bodies) != n)
        throw std::invalid_argument("the truth has a different number of bodies than the scene");
    const std::size_t moments = trajectory.samples.size() / n,
                      true_moments = reference.available ? reference.moments() : 0,
                      compared = std::min(moments, true_moments);
    const bool reacts = joints > 0 && reference.reactions.size() == reference.moments() * joints &&
                        trajectory.reactions.size() == moments * joints;
    const ReactionErrors reactions(trajectory, reference, arms);

    const ScaledTruth truth = scaled_truth(scene, measure, reference);
    const auto& [states, wholes, scale] = truth;
    const auto known = [&](const Measure& m, std::size_t k) {
        return measure.has(m) && (k < compared || (m.needs & known_truth) == 0) &&
               (reacts || (m.needs & known_reactions) == 0);
    };

    ErrorSeries series;
    const std::size_t attitude = measure_index("attitude");
    Wide worst_attitude = -1;
    JointCoordinates coordinates(scene);
    ComparedMotion<Wide> c;
    c.bodies.resize(n);
    std::vector<BodyMotion<Wide>> motions(n);
    for (std::size_t k = 0; k < moments; ++k) {
        const Bodies samples = trajectory.at(k);
        const double t = samples[0].t;
        series.t.push_back(t);
        if (k < compared && t != reference.samples[k * n].t)
            throw std::invalid_argument("trajectory and truth are sampled at different times");
        for (std::size_t b = 0; b < n; ++b) {
            ComparedBody<Wide>& body = c.bodies[b];
            body.computed = cast<Wide>(samples[b]);
            if (!trajectory.orthogonality_defect.empty())
                body.orthogonality_defect = trajectory.orthogonality_defect[k * n + b];
            if (k < compared) body.truth = states[k * n + b];
            motions[b] = body.computed;
            motions[b].q = normalized(body.computed.q);
        }
        c.joints = measure.violations(motions);
        if (k < compared) {
            c.computed = measure.invariants(t, motions, coordinates), c.truth = wholes[k];
            if (reacts) c.reaction_error = reactions.at(k);
        }
        for (std::size_t m = 0; m < all.size(); ++m) {
            if (!known(all[m], k)) continue;
            const auto [error, body] = error_in(all[m], c);
            series[m].push_back(double(scale[m] > 0 ? error / scale[m] : error));
            if (m == attitude && is_larger(error, worst_attitude))
                worst_attitude = error, series.worst_body = scene_body(scene, body).name;
        }
    }
    return series;
}

Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference) {
    Errors result;
    if (trajectory.status != Status::ok || trajectory.samples.empty()) return result;
    result.worst_body = series.worst_body;
    for (std::size_t m = 0; m < measures().size(); ++m) {
        const std::vector<double>& values = series[m];
        const bool by_truth = (measures()[m].needs & known_truth) != 0;
        if (values.empty() || (by_truth && (!reference.available || values.size() != reference.moments()))) continue;
        result[m].final = values.back();
        // a series that contains NaN has no maximum
        const double most = *std::max_element(values.begin(), values.end());
        if (std::isfinite(most) && std::ranges::none_of(values, [](double x) { return std::isnan(x); }))
            result[m].max = most;
    }
    return result;
}

}  // namespace polhode
