// Follows several free spheres from event to event: planes by the modes of each sphere, impacts between pairs.
//
// SphereDriver holds a ContactDriver for each sphere (follow_contacts.h). Each driver plans its next step, up to the
// first event of its sphere. Up to the earliest end of all planned steps the gaps of the pairs are searched for a first
// zero (ContactSearch of motion/contact.h, on the steps' polynomials). If there is one, the two spheres move there, the
// impulse (sphere_impact.h) changes their velocities, and each selects its mode again. Otherwise the sphere whose step
// ends first takes it. The other spheres keep their planned steps.
//
// Simultaneous impacts are resolved one after another in the order of the pairs, repeated until no pair approaches. A
// pair that touches and neither approaches nor separates ends the run: lasting contact of spheres is not supported.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/follow_contacts.h"
#include "integrators/contact/sphere_impact.h"
#include "motion/contact.h"
#include "scene/sphere_contacts.h"

namespace polhode::contact {

/// Result of a run of several spheres. `plane` in events and intervals is the number of the contact (see
/// contact_with_plane()); in flight it belongs to the body and any plane.
template <class P>
struct SphereRun {
    std::string fault;                                ///< why the run stopped early; empty if it did not
    std::vector<std::vector<BodyMotion<P>>> motions;  ///< one per sample
    /// Per sample and body: the force of each plane on the body, N.
    std::vector<std::vector<std::vector<Vector3<P>>>> forces_W;
    std::vector<Record<P>> records;  ///< one per body, then that of the pairs
    long steps = 0;
    long evaluations = 0;  ///< number of right-hand sides, or of series if the steps are Taylor series
};

/// All events and intervals in the order of time.
template <class P>
Record<P> merge_records(const std::vector<Record<P>>& records) {
    Record<P> all;
    for (auto record = records.rbegin(); record != records.rend(); ++record)
        all.events.insert(all.events.end(), record->events.begin(), record->events.end());
    for (const Record<P>& record : records)
        all.intervals.insert(all.intervals.end(), record.intervals.begin(), record.intervals.end());
    std::ranges::stable_sort(all.events, [](const auto& a, const auto& b) { return a.t < b.t; });
    std::ranges::stable_sort(all.intervals, [](const auto& a, const auto& b) { return a.from < b.from; });
    return all;
}

/// Gaps of pairs of spheres, for ContactSearch.
template <class P>
class SphereGaps {
  public:
    struct Centers {
        std::vector<Vector3<P>> position_W, velocity_W;
    };
    SphereGaps(std::vector<SpherePair> pairs, std::vector<P> radii)
        : pairs_(std::move(pairs)), radii_(std::move(radii)) {}

    std::size_t size() const { return pairs_.size(); }
    Vector3<P> normal(std::size_t k, const Centers& at) const {
        const Vector3<P> away = at.position_W[pairs_[k].first] - at.position_W[pairs_[k].second];
        return (P(1) / length(away)) * away;
    }
    P size_of(std::size_t k) const { return radii_[pairs_[k].first] + radii_[pairs_[k].second]; }
    Gap<P> gap(std::size_t k, const Centers& at) const {
        const auto& [i, j, restitution, friction] = pairs_[k];
        const Vector3<P> away = at.position_W[i] - at.position_W[j];
        const P distance = length(away);
        return {distance - size_of(k), dot(away, Vector3<P>(at.velocity_W[i] - at.velocity_W[j])) / distance};
    }
    std::vector<P> distances(const Centers& at) const {
        std::vector<P> all;
        for (std::size_t k = 0; k < size(); ++k) all.push_back(gap(k, at).distance);
        return all;
    }

  private:
    std::vector<SpherePair> pairs_;
    std::vector<P> radii_;
};

/// `Impact`: ClosedFormImpact or PhasedImpact.
template <class P, class Form, class Impact>
class SphereDriver {
  public:
    SphereDriver(const Scene& scene, const std::vector<double>& sample_times, const ContactSettings& settings)
        : scene_(&scene), settings_(settings), pairs_(sphere_pairs(scene)) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            scenes_.push_back(std::make_unique<Scene>(scene_of_sphere(scene, i)));
        std::vector<P> radii;
        for (const auto& alone : scenes_) {
            bodies_.push_back(std::make_unique<Driver>(*alone, sample_times, settings));
            properties_.push_back(mass_properties<P>(alone->body));
            radii.push_back(bodies_.back()->geometry().pieces.front().radius);
        }
        radii_ = radii;
        gaps_ = std::make_unique<SphereGaps<P>>(pairs_, std::move(radii));
    }

    SphereRun<P> run() {
        for (const auto& body : bodies_) body->start();
        while (!fails()) {
            for (const auto& body : bodies_)
                if (!body->has_planned_step()) body->plan();
            if (find_fault()) break;
            if (!has_started_) {
                resolve_impacts();
                has_started_ = true;
                continue;
            }
            if (!advance()) break;
            find_fault();
        }
        return collect();
    }

  private:
    using Driver = ContactDriver<P, Form>;
    using Centers = typename SphereGaps<P>::Centers;

    const Scene* scene_;
    ContactSettings settings_;
    std::vector<SpherePair> pairs_;
    std::vector<std::unique_ptr<Scene>> scenes_;
    std::vector<std::unique_ptr<Driver>> bodies_;
    std::vector<MassProperties<P>> properties_;
    std::vector<P> radii_;
    std::unique_ptr<SphereGaps<P>> gaps_;
    P t_{0};
    bool has_started_ = false;
    std::string fault_;
    Record<P> pairs_record_;
    long stalled_ = 0;  // impacts without progress in time
    P stalled_at_{-1};

    bool fails() const { return !fault_.empty(); }
    std::string at_time() const { return fmt::format("at t = {:.10g} s", static_cast<double>(t_)); }
    bool find_fault() {
        for (std::size_t i = 0; i < bodies_.size() && fault_.empty(); ++i)
            if (const std::string& why = bodies_[i]->fault(); !why.empty())
                fault_ = why.starts_with("the time limit") || why.starts_with("the step limit")
                             ? why
                             : scene_->bodies[i].name + ": " + why;
        return fails();
    }
    double speed() const {
        double largest = 0;
        for (const auto& body : bodies_) largest = std::max(largest, body->largest_speed());
        return largest;
    }

    Centers centers(const P& t) const {
        Centers all;
        for (const auto& body : bodies_) {
            const BodyMotion<P> m = body->motion_at(t);
            all.position_W.push_back(m.position_W), all.velocity_W.push_back(m.velocity_W);
        }
        return all;
    }

    // Moves to the next event of a pair or to the end of the first planned step. Returns false at the end.
    bool advance() {
        std::optional<P> end;
        for (const auto& body : bodies_)
            if (body->has_planned_step() && (!end || body->planned_end() < *end)) end = body->planned_end();
        if (!end) return false;
        if (*end > t_ && !pairs_.empty()) {
            const auto at = [&](const P& t) { return centers(t); };
            // the ends of a step bound the speeds within it up to the curvature of the motion
            const P bound(4 * speed());
            if (const auto t = ContactSearch<P, decltype(at), SphereGaps<P>>(*gaps_, at, bound).first(t_, *end)) {
                t_ = *t;
                resolve_impacts();
                return true;
            }
        }
        if (*end > t_) t_ = *end;
        for (const auto& body : bodies_)
            if (body->has_planned_step() && body->planned_end() == *end) body->take_planned_step();
        return true;
    }

    void resolve_impacts() {
        if (!(t_ > stalled_at_)) {
            if (++stalled_ > 1000) {
                fault_ = "too many impacts " + at_time();
                return;
            }
        } else {
            stalled_ = 0, stalled_at_ = t_;
        }
        const double resting = speed() * std::pow(10.0, 1 - settings_.event_digits);
        // spheres that touch to 10^-12 at the start touch exactly
        const P tolerance(has_started_ ? std::pow(10.0, 4 - settings_.event_digits) : 1e-12);
        std::vector<std::size_t> touching;
        const Centers start = centers(t_);
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            if (!(gaps_->gap(k, start).distance > tolerance * gaps_->size_of(k))) touching.push_back(k);
        for (int round = 0; round < 200 && !fails(); ++round) {
            std::vector<std::size_t> moved;
            for (const std::size_t k : touching)
                if (gaps_->gap(k, centers(t_)).rate < P(-resting)) collide(k, moved);
            if (moved.empty()) return check_separation(touching, resting);
            for (const std::size_t i : moved) bodies_[i]->select_mode();
            find_fault();
        }
        if (!fails()) fault_ = "simultaneous impacts do not end " + at_time();
    }
    void check_separation(const std::vector<std::size_t>& touching, double resting) {
        for (const std::size_t k : touching)
            if (!(gaps_->gap(k, centers(t_)).rate > P(resting))) {
                fault_ = fmt::format(
                    "the spheres {} and {} stay in contact {}: their lasting contact and its impacts "
                    "are not determined by the laws for pairs",
                    scene_->bodies[pairs_[k].first].name, scene_->bodies[pairs_[k].second].name, at_time());
                return;
            }
    }
    // Applies the impact of a pair, and notes its bodies in `moved`.
    void collide(std::size_t k, std::vector<std::size_t>& moved) {
        const SpherePair& pair = pairs_[k];
        const std::array<std::size_t, 2> index{pair.first, pair.second};
        SphereImpact<P> at;
        at.normal_W = gaps_->normal(k, centers(t_));
        at.restitution = P(pair.restitution), at.friction = P(pair.friction);
        for (std::size_t i = 0; i < 2; ++i) {
            Driver& body = *bodies_[index[i]];
            if (std::ranges::find(moved, index[i]) == moved.end()) {
                body.interrupt(t_);
                moved.push_back(index[i]);
            }
            const BodyMotion<P>& m = body.motion();
            at.velocity_W[i] = m.velocity_W, at.rotation_W[i] = rotate(m.q, m.angular_velocity_B);
            at.radius[i] = radii_[index[i]], at.mass[i] = properties_[index[i]].mass;
            at.moment[i] = properties_[index[i]].inertia[0][0];
        }
        const Vector3<P> impulse = Impact::impulse(at);
        for (std::size_t i = 0; i < 2; ++i) {
            const Vector3<P> on_body = i == 0 ? impulse : Vector3<P>(-impulse);
            bodies_[index[i]]->add_velocity((P(1) / at.mass[i]) * on_body,
                                            (P(1) / at.moment[i]) * cross(at.arm(i), on_body));
        }
        const P normal = dot(impulse, at.normal_W);
        pairs_record_.events.push_back({t_, contact_with_body(*scene_, pair.first, pair.second), EventKind::impact,
                                        normal, impulse - normal * at.normal_W});
    }

    SphereRun<P> collect() {
        SphereRun<P> result;
        result.fault = fault_;
        std::vector<Run<P>> runs;
        for (const auto& body : bodies_) runs.push_back(body->finish());
        std::size_t samples = runs.front().motions.size();
        for (const Run<P>& run : runs) samples = std::min(samples, run.motions.size());
        result.motions.resize(samples), result.forces_W.resize(samples);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            for (std::size_t k = 0; k < samples; ++k) {
                result.motions[k].push_back(runs[i].motions[k]);
                result.forces_W[k].push_back(std::move(runs[i].forces_W[k]));
            }
            Record<P>& record = runs[i].record;
            for (Event<P>& event : record.events) event.plane = contact_with_plane(*scene_, i, event.plane);
            for (Interval<P>& interval : record.intervals)
                interval.plane = contact_with_plane(*scene_, i, interval.plane);
            result.records.push_back(std::move(record));
            result.steps += runs[i].steps, result.evaluations += runs[i].evaluations;
        }
        result.records.push_back(std::move(pairs_record_));
        return result;
    }
};

}  // namespace polhode::contact
