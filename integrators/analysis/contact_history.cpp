// The motion is followed twice: first for its intervals, then with samples within them. Steps do not depend on the
// samples, so both runs have the same intervals.
#include "integrators/analysis/contact_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrators/contact/solve_contacts.h"
#include "integrators/contact/solve_spheres.h"
#include "motion/contact.h"
#include "scene/sphere_contacts.h"

namespace polhode {
namespace {

constexpr double contact_run_seconds = 2, contact_run_tolerance = 1e-12;
constexpr std::size_t least_interval_samples = 4;
// distance between the ends of an interval and its first and last sample, relative to its length
constexpr double interval_margin = 1e-6;
// points of a face touch a plane up to this distance, relative to the body's size
constexpr double touching_gap = 1e-6;

// A run of one body or of several spheres.
struct FollowedContacts {
    std::string fault;
    contact::Record<double> record;
    std::vector<std::vector<BodyMotion<double>>> motions;             // by sample and body
    std::vector<std::vector<std::vector<Vector3<double>>>> forces_W;  // by sample, body and plane
};

FollowedContacts follow_contacts(const Problem& problem, std::vector<double> times) {
    Settings settings;
    settings.times = std::move(times), settings.tolerance = contact_run_tolerance,
    settings.seconds_limit = contact_run_seconds;
    if (has_sphere_contacts(problem.scene)) {
        contact::SphereRun<double> run = contact::follow_spheres_in_binary64(problem, settings);
        return {std::move(run.fault), contact::merge_records(run.records), std::move(run.motions),
                std::move(run.forces_W)};
    }
    contact::Run<double> run = contact::follow_in_binary64(problem, settings);
    FollowedContacts followed{std::move(run.fault), std::move(run.record), {}, {}};
    for (const BodyMotion<double>& motion : run.motions) followed.motions.push_back({motion});
    for (std::vector<Vector3<double>>& forces : run.forces_W) followed.forces_W.push_back({std::move(forces)});
    return followed;
}

// Times within the interval, evenly spaced.
std::vector<double> times_within(const contact::Interval<double>& interval, std::size_t count) {
    const double margin = interval_margin * (interval.to - interval.from), first = interval.from + margin;
    const double span = interval.to - margin - first;
    std::vector<double> times;
    for (std::size_t i = 0; i < count; ++i)
        times.push_back(first + span * (static_cast<double>(i) / static_cast<double>(count - 1)));
    return times;
}

bool is_contact(const contact::Interval<double>& interval) {
    return interval.mode != contact::Mode::flight && interval.to > interval.from;
}

// Whether the body slips in this mode. Without slip, its computed value is rounding.
bool slips(contact::Mode mode) {
    return mode == contact::Mode::sliding || mode == contact::Mode::sliding_without_spin ||
           mode == contact::Mode::sliding_without_rolling || mode == contact::Mode::sliding_without_rotation;
}

// The sample times of each interval.
std::vector<std::vector<double>> times_of_intervals(const std::vector<contact::Interval<double>>& intervals,
                                                    std::size_t samples) {
    double whole = 0;
    for (const auto& interval : intervals)
        if (is_contact(interval)) whole += interval.to - interval.from;
    std::vector<std::vector<double>> all;
    std::size_t sampled = 0;
    for (const auto& interval : intervals) {
        all.emplace_back();
        if (!is_contact(interval) || ++sampled * least_interval_samples > samples) continue;
        const double share = static_cast<double>(samples) * (interval.to - interval.from) / whole;
        all.back() =
            times_within(interval, std::max(least_interval_samples, static_cast<std::size_t>(std::lround(share))));
    }
    return all;
}

// The hull of a body and the planes of its scene.
class ContactView {
  public:
    ContactView(const Scene& scene, std::size_t body) {
        const Scene alone = scene_of_sphere(scene, body);
        geometry_ = contact_geometry<double>(alone, mass_properties<double>(alone.body).center, Quaternion<double>{});
        only_gravity_ =
            std::ranges::all_of(alone.loads, [](const Load& load) { return std::holds_alternative<Gravity>(load); });
    }

    ContactSample at(double t, std::size_t plane, const BodyMotion<double>& motion,
                     const Vector3<double>& force_W) const {
        const Vector3<double>& n = geometry_.planes[plane].normal_W;
        const Vector3<double> arm_W = arm(plane, motion.q, force_W);
        const Vector3<double> speed = motion.velocity_W + cross(rotate(motion.q, motion.angular_velocity_B), arm_W);
        return {t, motion.position_W + arm_W, force_W, speed - dot(speed, n) * n};
    }

  private:
    // The contact point from the centre of mass. A face does not rotate, so the moment of the plane's force about the
    // centre of mass balances that of the loads. If these have none, the force acts along a line through the centre.
    Vector3<double> arm(std::size_t plane, const Quaternion<double>& q, const Vector3<double>& force_W) const {
        const Vector3<double>& n_W = geometry_.planes[plane].normal_W;
        const Vector3<double> n = rotate_back(q, n_W);
        double lowest = geometry_.pieces.front().lowest(n);
        for (const SupportPiece<double>& piece : geometry_.pieces) lowest = std::min(lowest, piece.lowest(n));
        Vector3<double> sum;
        double count = 0;
        for (const SupportPiece<double>& piece : geometry_.pieces)
            if (piece.lowest(n) <= lowest + touching_gap * geometry_.reach)
                sum = sum + piece.lowest_point(n), count += 1;
        const double normal_force = dot(force_W, n_W);
        if (count > 1 && only_gravity_ && normal_force > 0) return (lowest / normal_force) * force_W;
        return rotate(q, (1 / count) * sum);
    }

    ContactGeometry<double> geometry_;
    bool only_gravity_ = false;
};

}  // namespace

ContactParts parts_of_contact(const Scene& scene, std::size_t contact) {
    const std::size_t planes = scene.planes.size(), others = planes + scene.bodies.size(), other = contact % others;
    ContactParts parts{contact / others, {}, {}};
    if (other < planes)
        parts.plane = other;
    else
        parts.other = other - planes;
    return parts;
}

ContactHistory contact_history(const Problem& problem, const std::vector<double>& times, std::size_t samples) {
    ContactHistory history;
    FollowedContacts first = follow_contacts(problem, times);
    history.fault = std::move(first.fault), history.motions = std::move(first.motions);
    history.record = std::move(first.record);
    const std::vector<contact::Interval<double>>& intervals = history.record.intervals;
    history.of_interval.resize(intervals.size());
    const std::vector<std::vector<double>> wanted = times_of_intervals(intervals, samples);
    std::vector<double> all;
    for (const std::vector<double>& some : wanted) all.insert(all.end(), some.begin(), some.end());
    if (all.empty()) return history;
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    const FollowedContacts second = follow_contacts(problem, all);
    std::vector<ContactView> views;
    for (std::size_t b = 0; b < body_count(problem.scene); ++b) views.emplace_back(problem.scene, b);
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        if (wanted[i].empty()) continue;
        const ContactParts parts = parts_of_contact(problem.scene, intervals[i].plane);
        // samples are those of contacts with planes
        if (!parts.plane) continue;
        for (const double t : wanted[i]) {
            const std::size_t k = static_cast<std::size_t>(std::ranges::lower_bound(all, t) - all.begin());
            if (k >= second.motions.size()) break;
            ContactSample sample = views[parts.body].at(t, *parts.plane, second.motions[k][parts.body],
                                                        second.forces_W[k][parts.body][*parts.plane]);
            if (!slips(intervals[i].mode)) sample.slip_W = {};
            history.of_interval[i].push_back(sample);
        }
    }
    return history;
}

}  // namespace polhode
