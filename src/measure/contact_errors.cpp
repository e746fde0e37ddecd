#include "measure/contact_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>
#include <vector>

#include "measure/measures.h"
#include "measure/scene_measure.h"
#include "motion/contact.h"
#include "scene/sphere_contacts.h"

namespace polhode {
namespace {

// Lengths and speeds of the reference below this fraction of the motion's are zero: far above its error (1e-25).
constexpr double rolling_threshold = 1e-20;

// Whether the exact motion never gains energy from its loads.
bool loads_keep_or_lose_energy(const Scene& scene) {
    const auto always = [&](const Window& window) { return window.from <= 0 && window.until > scene.duration; };
    return std::ranges::all_of(scene.loads, [&](const Load& load) {
        if (const auto* force = std::get_if<Force>(&load))
            return force->frame == Frame::world && force->point_frame == Frame::body && always(force->window);
        if (const auto* gravity = std::get_if<Gravity>(&load)) return always(gravity->window);
        if (const auto* spring = std::get_if<Spring>(&load)) return always(spring->window);
        return std::holds_alternative<Drag>(load);
    });
}

Placement<Wide> placement_of(const BodyMotion<Wide>& motion) {
    const Quaternion<Wide> q = normalized(motion.q);
    return {q, motion.position_W, motion.velocity_W, rotate(q, motion.angular_velocity_B)};
}

// Velocity of the lowest point of a piece relative to a plane: along the normal, and in the plane (the slip).
struct PointVelocity {
    Wide normal = 0, slip = 0;  // m/s
};
PointVelocity lowest_point_velocity(const ContactPlane<Wide>& plane, const SupportPiece<Wide>& piece,
                                    const Placement<Wide>& at) {
    const Vector3<Wide> arm_W = rotate(at.q, piece.lowest_point(rotate_back(at.q, plane.normal_W)));
    const Vector3<Wide> u = at.velocity_W + cross(at.angular_velocity_W, arm_W);
    const Wide normal = dot(plane.normal_W, u);
    return {normal, Wide(length(u - normal * plane.normal_W))};
}

// Largest lengths of the reference.
struct RollingThresholds {
    Wide gap = 0, speed = 0;  // m, m/s
};

class ContactMeasure {
  public:
    ContactMeasure(const Scene& scene, const SceneMeasure<Wide>& measure)
        : geometry_(contact_geometry<Wide>(scene, measure.center(0), {})) {}

    bool any() const { return geometry_.any(); }
    Wide depth(const BodyMotion<Wide>& motion) const { return -geometry_.distance(placement_of(motion)); }

    RollingThresholds thresholds(const std::vector<BodyMotion<Wide>>& truth) const {
        RollingThresholds size{geometry_.reach, 0};
        for (const BodyMotion<Wide>& m : truth) {
            size.gap = std::max(size.gap, Wide(length(m.position_W) + geometry_.reach));
            size.speed =
                std::max(size.speed, Wide(length(m.velocity_W) + geometry_.reach * length(m.angular_velocity_B)));
        }
        return {Wide(rolling_threshold) * size.gap, Wide(rolling_threshold) * size.speed};
    }
    // The largest slip of the computed motion at contacts where the true motion touches without slip.
    std::optional<Wide> rolling_slip(const BodyMotion<Wide>& computed, const BodyMotion<Wide>& truth,
                                     const RollingThresholds& thresholds) const {
        std::optional<Wide> most;
        const Placement<Wide> now = placement_of(computed), right = placement_of(truth);
        const std::size_t pieces = geometry_.pieces.size();
        for (std::size_t k = 0; k < geometry_.size(); ++k) {
            const ContactPlane<Wide>& plane = geometry_.planes[k / pieces];
            const SupportPiece<Wide>& piece = geometry_.pieces[k % pieces];
            const Wide gap = geometry_.gap(k, right).distance;
            if (gap > thresholds.gap || gap < -thresholds.gap) continue;
            const PointVelocity u = lowest_point_velocity(plane, piece, right);
            if (u.slip > thresholds.speed || u.normal > thresholds.speed || u.normal < -thresholds.speed) continue;
            most = std::max(most.value_or(Wide(0)), lowest_point_velocity(plane, piece, now).slip);
        }
        return most;
    }

  private:
    ContactGeometry<Wide> geometry_;
};

// The largest increase of the energy between two samples.
double energy_gain(const SceneMeasure<Wide>& measure, const Scene& scene, const Trajectory& trajectory,
                   const std::vector<BodyMotion<Wide>>& motions) {
    JointCoordinates unused(scene);
    Wide least = 0, gain = 0;
    for (std::size_t k = 0; k < motions.size(); ++k) {
        BodyMotion<Wide> motion = motions[k];
        motion.q = normalized(motion.q);
        const Wide energy = measure.invariants(trajectory.samples[k].t, {&motion, 1}, unused).energy;
        least = k == 0 ? energy : std::min(least, energy);
        gain = std::max(gain, Wide(energy - least));
    }
    return double(gain);
}

std::vector<ContactEvent> impacts_at(const std::vector<Pair>& times) {
    std::vector<ContactEvent> events;
    for (const Pair& t : times) events.push_back({t, "impact", 0});
    return events;
}

std::string describe_event(const ContactEvent& event) {
    return fmt::format("\"{}\" at {:.6g} s", event.kind, event.t.high);
}

}  // namespace

EventComparison compare_events(std::span<const ContactEvent> computed, std::span<const ContactEvent> reference) {
    EventComparison result;
    std::size_t i = 0, j = 0;
    const auto is = [](const ContactEvent& event, const char* kind) { return event.kind == kind; };
    while (i < computed.size() && j < reference.size()) {
        const ContactEvent &x = computed[i], &y = reference[j];
        if (is(x, "impact") && is(y, "accumulates")) {
            ++i;
            continue;
        }
        if (is(x, "accumulates") && is(y, "impact")) {
            ++j;
            continue;
        }
        if (x.kind != y.kind || x.plane != y.plane) break;
        const Wide late = (Wide(x.t.high) - Wide(y.t.high)) + (Wide(x.t.low) - Wide(y.t.low));
        result.time_error = std::max(result.time_error.value_or(0), std::abs(double(late)));
        ++i, ++j;
    }
    if (i < computed.size() && j < reference.size())
        result.message =
            fmt::format("event {}: the reference has {}", describe_event(computed[i]), describe_event(reference[j]));
    else if (i < computed.size())
        result.message = fmt::format("additional event {}; {} events, the reference has {}",
                                     describe_event(computed[i]), computed.size(), reference.size());
    else if (j < reference.size())
        result.message = fmt::format("no event {}; {} events, the reference has {}", describe_event(reference[j]),
                                     computed.size(), reference.size());
    return result;
}

EventComparison compare_impacts(const Trajectory& trajectory, const Reference& reference) {
    if (trajectory.impact_times.empty() || !reference.available) return {};
    const std::vector<Pair> found(trajectory.impact_times.begin(), trajectory.impact_times.end());
    return compare_events(impacts_at(found), impacts_at(reference.impact_times));
}

ContactErrors contact_errors(const Scene& scene, const Trajectory& trajectory, const Reference& reference) {
    ContactErrors result;
    if (scene.planes.empty() || has_sphere_contacts(scene) || trajectory.status != Status::ok ||
        trajectory.samples.empty())
        return result;
    const SceneMeasure<Wide> measure(scene);
    const ContactMeasure contacts(scene, measure);
    if (!contacts.any()) return result;
    std::vector<BodyMotion<Wide>> motions, truth;
    for (const Sample& sample : trajectory.samples) motions.push_back(cast<Wide>(sample));
    Wide depth = 0;
    for (const BodyMotion<Wide>& motion : motions) depth = std::max(depth, contacts.depth(motion));
    result.penetration = double(depth);
    if (loads_keep_or_lose_energy(scene)) result.energy_gain = energy_gain(measure, scene, trajectory, motions);
    if (!reference.available) return result;
    for (const ReferenceSample& sample : reference.samples) truth.push_back(true_motion<Wide>(sample));
    const RollingThresholds thresholds = contacts.thresholds(truth);
    for (std::size_t k = 0; k < std::min(motions.size(), truth.size()); ++k)
        if (const auto slip = contacts.rolling_slip(motions[k], truth[k], thresholds))
            result.slip = std::max(result.slip.value_or(0), double(*slip));
    result.event_time = compare_impacts(trajectory, reference).time_error;
    return result;
}

}  // namespace polhode
