// Follows several free spheres from event to event: planes by the modes of each sphere, impacts between pairs, and
// lasting contacts between spheres.
//
// SphereDriver holds a ContactDriver for each sphere (follow_contacts.h). Each driver plans its next step, up to the
// first event of its sphere. Up to the earliest end of all planned steps the gaps of the pairs are searched for a first
// zero (ContactSearch of motion/contact.h, on the steps' polynomials). If there is one, the two spheres move there, the
// impulse (sphere_impact.h) changes their velocities, and each selects its mode again. Otherwise the sphere whose step
// ends first takes it. The other spheres keep their planned steps.
//
// Spheres that touch and neither approach nor separate form a cluster, which a ClusterDriver (follow_cluster.h) moves
// until their contacts open.
//
// Impacts of a pair may accumulate, with impacts on planes and ends of slips within each flight. The flights shorten
// geometrically to 10^-d of the motion. Steps are then accurate relative to the speed of the flight (set_digits()), and
// gaps that are comparable with rounding errors are integrated from their rates (Bounce).
//
// Simultaneous impacts are resolved one after another in the order of the pairs, repeated until no pair approaches. An
// impact on a sphere that rests on a third one ends the run: the laws for pairs do not determine it.
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

#include "integrators/contact/follow_cluster.h"
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
    /// `distances`: of the centres of each pair in contact, m.
    SphereGaps(std::vector<SpherePair> pairs, std::vector<P> distances)
        : pairs_(std::move(pairs)), sizes_(std::move(distances)) {}

    std::size_t size() const { return pairs_.size(); }
    Vector3<P> normal(std::size_t k, const Centers& at) const {
        const Vector3<P> away = at.position_W[pairs_[k].first] - at.position_W[pairs_[k].second];
        return (P(1) / length(away)) * away;
    }
    const P& size_of(std::size_t k) const { return sizes_[k]; }
    /// Rounding error of distances, m.
    P rounding(std::size_t k) const { return P(16) * Elementary<P>::epsilon() * size_of(k); }
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
    std::vector<P> sizes_;
};

/// `Form`: of a single sphere, `Cluster`: of touching spheres, `Impact`: ClosedFormImpact or PhasedImpact.
template <class P, class Form, class Cluster, class Impact>
class SphereDriver {
  public:
    SphereDriver(const Scene& scene, const std::vector<double>& sample_times, const ContactSettings& settings)
        : scene_(&scene), settings_(settings), pairs_(sphere_pairs(scene)) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            scenes_.push_back(std::make_unique<Scene>(scene_of_sphere(scene, i)));
        for (const auto& alone : scenes_) {
            bodies_.push_back(std::make_unique<Driver>(*alone, sample_times, settings));
            spheres_.push_back(bodies_.back()->sphere());
        }
        for (const SpherePair& pair : pairs_) {
            PairState<P> state;
            state.distance = spheres_[pair.first].radius + spheres_[pair.second].radius;
            state.contact = contact_with_body(scene, pair.first, pair.second);
            state.restitution = P(pair.restitution);
            states_.push_back(state);
        }
    }

    SphereRun<P> run() {
        for (const auto& body : bodies_) body->start();
        while (!fails()) {
            set_digits();
            for (std::size_t i = 0; i < bodies_.size(); ++i)
                if (!cluster_of(i) && !bodies_[i]->has_planned_step()) bodies_[i]->plan();
            for (const auto& cluster : clusters_)
                if (!cluster->has_planned_step()) cluster->plan();
            if (find_fault()) break;
            if (!has_started_) {
                touch_exactly();
                resolve({});
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
    using Touching = ClusterDriver<P, Cluster, Driver>;
    using Centers = typename SphereGaps<P>::Centers;

    const Scene* scene_;
    ContactSettings settings_;
    std::vector<SpherePair> pairs_;
    std::vector<std::unique_ptr<Scene>> scenes_;
    std::vector<std::unique_ptr<Driver>> bodies_;
    std::vector<SphereBody<P>> spheres_;
    std::vector<PairState<P>> states_;
    std::vector<std::unique_ptr<Touching>> clusters_;
    P t_{0};
    bool has_started_ = false;
    std::string fault_;
    Record<P> pairs_record_;
    long stalled_ = 0;  // impacts without progress in time
    P stalled_at_{-1};
    // A pair after an impact, while its gap is comparable with a rounding error.
    struct Bounce {
        std::size_t pair = 0;
        P gap{0};               // the integral of its rate, m
        bool is_known = false;  // whether the end of its flight is found from that integral
    };
    std::vector<Bounce> bounced_;
    long cluster_steps_ = 0, cluster_evaluations_ = 0;  // of clusters that have ended

    bool fails() const { return !fault_.empty(); }
    std::string at_time() const { return fmt::format("at t = {:.10g} s", static_cast<double>(t_)); }
    const std::string& name(std::size_t body) const { return scene_->bodies[body].name; }
    static bool is_limit(const std::string& why) {
        return why.starts_with("the time limit") || why.starts_with("the step limit");
    }
    bool find_fault() {
        for (std::size_t i = 0; i < bodies_.size() && fault_.empty(); ++i)
            if (const std::string& why = bodies_[i]->fault(); !why.empty())
                fault_ = is_limit(why) ? why : name(i) + ": " + why;
        for (const auto& cluster : clusters_)
            if (fault_.empty()) fault_ = cluster->fault();
        return fails();
    }
    double speed() const {
        double largest = 0;
        for (const auto& body : bodies_) largest = std::max(largest, body->largest_speed());
        return largest;
    }
    Touching* cluster_of(std::size_t body) const {
        for (const auto& cluster : clusters_)
            if (cluster->has(body)) return cluster.get();
        return nullptr;
    }

    Centers centers(const P& t) const {
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < bodies_.size(); ++i) all.push_back(i);
        return centers_of(all, t);
    }
    // of some bodies only; the others have no values
    Centers centers_of(const std::vector<std::size_t>& which, const P& t) const {
        Centers all;
        all.position_W.resize(bodies_.size()), all.velocity_W.resize(bodies_.size());
        const auto set = [&](std::size_t i, const BodyMotion<P>& m) {
            all.position_W[i] = m.position_W, all.velocity_W[i] = m.velocity_W;
        };
        for (const std::size_t i : which) {
            Touching* cluster = cluster_of(i);
            if (!cluster) {
                set(i, bodies_[i]->motion_at(t));
                continue;
            }
            const std::vector<BodyMotion<P>> motions = cluster->motions_at(t);
            for (std::size_t k = 0; k < motions.size(); ++k) set(cluster->members()[k], motions[k]);
        }
        return all;
    }
    // the centres of the spheres of one pair
    Centers centers_of_pair(std::size_t k, const P& t) const {
        return centers_of({pairs_[k].first, pairs_[k].second}, t);
    }
    // the gaps of some pairs
    SphereGaps<P> gaps_of(const std::vector<std::size_t>& which) const {
        std::vector<SpherePair> pairs;
        std::vector<P> distances;
        for (const std::size_t k : which) pairs.push_back(pairs_[k]), distances.push_back(states_[k].distance);
        return {std::move(pairs), std::move(distances)};
    }
    std::vector<std::size_t> all_pairs() const {
        std::vector<std::size_t> all;
        for (std::size_t k = 0; k < pairs_.size(); ++k) all.push_back(k);
        return all;
    }
    /// Adds digits to the steps of spheres in short flights between impacts. A flight with the speed u lasts 2 u / c,
    /// and an error d of its gap changes that by d / u, so d must decrease with u.
    void set_digits() {
        std::vector<double> further(bodies_.size(), 0);
        for (std::size_t k = 0; k < pairs_.size(); ++k) {
            std::optional<double>& flight = states_[k].flight_speed;
            if (!flight) continue;
            if (states_[k].closed) {
                flight.reset();
                continue;
            }
            flight = std::max(*flight, std::abs(static_cast<double>(rate(k))));
            const double digits = further_digits(*flight);
            for (const std::size_t i : {pairs_[k].first, pairs_[k].second}) further[i] = std::max(further[i], digits);
        }
        for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i]->set_further_digits(further[i]);
        for (const auto& cluster : clusters_) {
            double most = 0;
            for (const std::size_t i : cluster->members()) most = std::max(most, further[i]);
            cluster->set_further_digits(most);
        }
    }
    /// Digits of the steps for flights with a speed, beyond those of the motion.
    double further_digits(double flight_speed) const {
        // fewer are not worth shorter steps; more than the arithmetic has are useless
        constexpr double least = 3, spare = 2;
        const double wanted = std::log10(speed() / flight_speed),
                     most = -std::log10(static_cast<double>(Elementary<P>::epsilon())) - spare - settings_.digits;
        return wanted < least ? 0 : std::max(0.0, std::min(wanted, most));
    }
    // spheres that touch to 10^-12 at the start touch exactly
    void touch_exactly() {
        const Centers start = centers(t_);
        for (std::size_t k = 0; k < pairs_.size(); ++k) {
            const Vector3<P> away = start.position_W[pairs_[k].first] - start.position_W[pairs_[k].second];
            const P distance = length(away);
            if (Elementary<P>::magnitude(P(distance - states_[k].distance)) <= P(1e-12) * states_[k].distance)
                states_[k].distance = distance;
        }
    }

    // Moves to the next event of a pair or to the end of the first planned step. Returns false at the end.
    bool advance() {
        std::optional<P> end;
        const auto note = [&](const auto& one) {
            if (one->has_planned_step() && (!end || one->planned_end() < *end)) end = one->planned_end();
        };
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            if (!cluster_of(i)) note(bodies_[i]);
        for (const auto& cluster : clusters_) note(cluster);
        if (!end) return false;
        // a cluster observes the gaps between its members
        std::vector<std::size_t> apart;
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            if (const Touching* cluster = cluster_of(pairs_[k].first); !cluster || !cluster->has(pairs_[k].second))
                apart.push_back(k);
        if (const std::optional<Approach> found = first_approach(apart, *end)) {
            move_bounces(found->t);
            if (found->bounce)
                bounced_.erase(bounced_.begin() + static_cast<std::ptrdiff_t>(*found->bounce));
            else
                std::erase_if(bounced_, [](const Bounce& one) { return !one.is_known; });
            t_ = found->t;
            resolve({}, false, true);
            return true;
        }
        move_bounces(*end);
        t_ = std::max(t_, *end);
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            if (!cluster_of(i) && bodies_[i]->has_planned_step() && bodies_[i]->planned_end() == *end)
                bodies_[i]->take_planned_step();
        std::vector<std::pair<std::vector<std::size_t>, ClusterEvent>> unsettled;
        for (const auto& cluster : clusters_)
            if (cluster->has_planned_step() && cluster->planned_end() == *end)
                if (const ClusterEvent event = cluster->take_planned_step(); event != ClusterEvent::none)
                    unsettled.emplace_back(cluster->members(), event);
        for (const auto& [members, event] : unsettled)
            if (!find_fault()) resolve(members, event == ClusterEvent::splits);
        return true;
    }

    // A time at which a gap closes, and the index in bounced_ if the pair is one of them.
    struct Approach {
        P t;
        std::optional<std::size_t> bounce;
    };
    // The first time up to `end` at which a gap of some pairs closes.
    std::optional<Approach> first_approach(const std::vector<std::size_t>& pairs, P end) {
        if (!(end > t_)) return {};
        const std::array<Centers, 3> step{centers(t_), centers((t_ + end) / P(2)), centers(end)};
        std::optional<Approach> first;
        const SphereGaps<P> gaps = gaps_of(pairs);
        std::vector<std::size_t> may_close;
        for (std::size_t k = 0; k < pairs.size(); ++k)
            if (!stays_apart(gaps, k, step, P(end - t_))) may_close.push_back(pairs[k]);
        for (std::size_t i = 0; i < bounced_.size(); ++i) {
            bounced_[i].is_known = true;
            if (std::ranges::find(may_close, bounced_[i].pair) == may_close.end()) continue;
            const BounceEnd found = end_of_bounce(bounced_[i], end);
            bounced_[i].is_known = found.is_known;
            if (found.is_known) std::erase(may_close, bounced_[i].pair);
            if (found.t && *found.t < end) first = Approach{*found.t, i}, end = *found.t;
        }
        if (may_close.empty()) return first;
        // the start, middle and end of a step bound the rates within it up to the curvature of the motion
        P bound(0);
        const SphereGaps<P> close = gaps_of(may_close);
        for (std::size_t k = 0; k < may_close.size(); ++k)
            for (const Centers& at : step) bound = std::max(bound, Elementary<P>::magnitude(close.gap(k, at).rate));
        if (const std::optional<P> t = search(may_close, t_, end, P(P(4) * bound))) return Approach{*t, {}};
        return first;
    }
    // Whether a pair certainly stays apart in a step of this length, given at its start, middle and end: the gap is
    // large compared with its rate, or it widens at a rate that hardly changes. In short steps after an impact, such as
    // bounces on a plane, the gap is a rounding error.
    static bool stays_apart(const SphereGaps<P>& gaps, std::size_t k, const std::array<Centers, 3>& step,
                            const P& length) {
        const Gap<P> start = gaps.gap(k, step[0]), end = gaps.gap(k, step[2]);
        const P middle = gaps.gap(k, step[1]).rate;
        const P least = std::min({start.rate, middle, end.rate}), most = std::max({start.rate, middle, end.rate});
        if (std::min(start.distance, end.distance) > P(4) * length * std::max(most, P(-least))) return true;
        return least > P(0) && most <= P(1.5) * least && start.distance >= -gaps.rounding(k);
    }
    std::optional<P> search(const std::vector<std::size_t>& pairs, const P& begin, const P& end, const P& bound) const {
        const auto at = [&](const P& t) { return centers(t); };
        const SphereGaps<P> gaps = gaps_of(pairs);
        return ContactSearch<P, decltype(at), SphereGaps<P>>(gaps, at, bound).first(begin, end);
    }
    // whether a distance exceeds the rounding errors of gaps by far
    static bool is_clear(const P& distance, const SphereGaps<P>& gaps) {
        return Elementary<P>::magnitude(distance) > P(1e10) * gaps.rounding(0);
    }
    struct BounceEnd {
        bool is_known = false;  // whether the search on gaps is unnecessary
        std::optional<P> t;     // the gap closes
    };
    /// The end of the flight after an impact up to `end`, if the flight is short compared with the steps or its gap is
    /// comparable with a rounding error. Impacts that accumulate have such flights. Simpson's rule integrates the rate
    /// of the gap from the impact on.
    BounceEnd end_of_bounce(const Bounce& bounce, const P& end) const {
        const SphereGaps<P> gaps = gaps_of({bounce.pair});
        const auto rate_after = [&](const P& time) {
            return gaps.gap(0, centers_of_pair(bounce.pair, t_ + time)).rate;
        };
        const auto change_of_gap = [&](const P& from, const P& to) {
            return P((to - from) * (rate_after(from) + P(4) * rate_after((from + to) / P(2)) + rate_after(to)) / P(6));
        };
        const P length = end - t_;
        const auto close = [&](const P& from, const P& gap, P flight) {
            const bool is_measured = is_clear(P(flight * rate_after(flight)), gaps);
            for (int i = 0; i < 12; ++i) {
                const P left = is_measured ? gaps.gap(0, centers_of_pair(bounce.pair, t_ + flight)).distance
                                           : P(gap + change_of_gap(from, flight));
                const P change = left / rate_after(flight);
                flight = flight - change;
                if (!(Elementary<P>::magnitude(change) > P(4) * Elementary<P>::epsilon() * flight)) break;
            }
            return P(t_ + std::clamp(flight, from, length));
        };
        if (const std::optional<P> flight = short_flight(bounce.gap, length, rate_after))
            return {true, close(P(0), bounce.gap, *flight)};
        constexpr int panels = 16;
        P largest(0);
        for (const P& part : {P(0), P(0.5), P(1)})
            largest = std::max(largest, Elementary<P>::magnitude(rate_after(part * length)));
        if (largest * length > P(1e6) * gaps.rounding(0)) return {};
        P gap = bounce.gap;
        for (int i = 0; i < panels; ++i) {
            const P from = length * P(i) / P(panels), to = length * P(i + 1) / P(panels);
            const P next = gap + change_of_gap(from, to);
            if (!(next > P(0)) && rate_after(to) < P(0)) return {true, close(from, gap, to)};
            gap = next;
        }
        return {true, {}};
    }
    /// An estimate of a flight that is short compared with a step, from the present gap and a function of its rate.
    template <class Rate>
    std::optional<P> short_flight(const P& gap, const P& length, const Rate& rate_after) const {
        const P u = rate_after(P(0));
        if (!(gap > P(0)) && !(u > P(0))) return {};
        // with the mean acceleration -c up to `flight`, the gap g + u t - c t^2 / 2 closes there; later the spheres may
        // have passed through each other
        P flight = length / P(1000);
        for (int i = 0; i < 12; ++i) {
            const P c = (u - rate_after(flight)) / flight;
            if (!(c > P(0))) return {};
            const P next = (u + square_root(P(u * u + P(2) * c * gap))) / c;
            if (i == 0 && next > flight) return {};
            if (next > flight) break;
            flight = next;
        }
        // the error of Simpson's rule
        const double share = static_cast<double>(P(flight / length));
        if (!(std::pow(share, 4) < std::pow(10.0, -4 - settings_.event_digits))) return {};
        return flight;
    }
    // Integrates the rates of gaps after impacts up to a time in the planned steps. A gap that exceeds its rounding
    // error by far needs no integral.
    void move_bounces(const P& t) {
        if (!(t > t_)) return;
        const double most = std::sqrt(static_cast<double>(Elementary<P>::epsilon()));
        std::erase_if(bounced_, [&](Bounce& bounce) {
            const SphereGaps<P> gaps = gaps_of({bounce.pair});
            const auto rate_at = [&](const P& time) { return gaps.gap(0, centers_of_pair(bounce.pair, time)).rate; };
            bounce.gap = bounce.gap + (t - t_) * (rate_at(t_) + P(4) * rate_at((t_ + t) / P(2)) + rate_at(t)) / P(6);
            // the difference of the positions is more accurate unless it is a rounding error
            const P measured = gaps.gap(0, centers_of_pair(bounce.pair, t)).distance;
            if (is_clear(measured, gaps)) bounce.gap = measured;
            return !(bounce.gap < P(most) * gaps.size_of(0));
        });
    }

    /// What happens at one time.
    struct Resolution {
        std::vector<std::size_t> touching;  // pairs
        std::vector<bool> rested;           // whether each of them had no normal velocity
        std::vector<bool> affected;         // bodies that leave their steps
        std::vector<bool> pushed;           // bodies on which impulses act
        std::vector<bool> collided;         // pairs
        double resting = 0;                 // speeds below it are zero
        bool closes = false;                // a gap has closed
        bool keeps_modes = false;           // no force changes unless impulses act
        bool changes = false;
    };

    /// Applies the impacts at the present time, then selects the modes of all spheres that take part. `bodies`: spheres
    /// that do in any case. `keeps_modes`: their modes only change by impulses. `closes`: a gap has closed.
    void resolve(const std::vector<std::size_t>& bodies, bool keeps_modes = false, bool closes = false) {
        if (!(t_ > stalled_at_)) {
            if (++stalled_ > 1000) {
                fault_ = "too many impacts " + at_time();
                return;
            }
        } else {
            stalled_ = 0, stalled_at_ = t_;
        }
        Resolution now;
        now.keeps_modes = keeps_modes, now.closes = closes;
        now.affected.assign(bodies_.size(), false), now.pushed = now.affected;
        now.collided.assign(pairs_.size(), false);
        now.resting =
            speed() *
            (has_started_ ? std::max(std::pow(10.0, 1 - settings_.event_digits), settings_.step_error) : 1e-12);
        // A change of mode may change a velocity by more than this. Impacts that repeat at one time for this reason
        // end.
        constexpr long few = 4, most_doublings = 20;
        if (stalled_ > few)
            now.resting = std::ldexp(now.resting, static_cast<int>(std::min(stalled_ - few, most_doublings)));
        find_touching(now);
        for (const std::size_t i : bodies) take_part(i, now);
        // a light sphere between a heavy one and a plane collides with them many times before all velocities decrease
        constexpr int most_rounds = 20'000;
        for (int round = 0;; ++round) {
            if (round == most_rounds) fault_ = "simultaneous impacts do not end " + at_time();
            now.changes = false;
            for (std::size_t j = 0; j < now.touching.size() && !fails(); ++j)
                if (rate(now.touching[j]) < P(-now.resting)) collide(j, now);
            for (std::size_t i = 0; i < bodies_.size() && !find_fault(); ++i)
                if (now.affected[i] && bodies_[i]->apply_plane_impacts()) now.changes = now.pushed[i] = true;
            if (fails() || !now.changes) break;
        }
        if (!fails()) form_clusters(now);
        if (!fails()) note_flights(now);
    }
    // The gaps of pairs that touch and separate are rounding errors, also if the impact was earlier.
    void note_flights(const Resolution& now) {
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            if (now.collided[k]) states_[k].flight_speed = static_cast<double>(rate(k));
        for (const std::size_t k : now.touching) {
            const bool is_noted = std::ranges::any_of(bounced_, [&](const Bounce& one) { return one.pair == k; });
            const Touching* cluster = cluster_of(pairs_[k].first);
            if (!is_noted && !(cluster && cluster->has(pairs_[k].second)) && rate(k) > P(0)) bounced_.push_back({k});
        }
    }
    P rate(std::size_t k) const { return gaps_of({k}).gap(0, centers_of_pair(k, t_)).rate; }
    void find_touching(Resolution& now) const {
        const double tolerance = has_started_ ? std::pow(10.0, 4 - settings_.event_digits) : 1e-12;
        const SphereGaps<P> gaps = gaps_of(all_pairs());
        const Centers at = centers(t_);
        for (std::size_t k = 0; k < pairs_.size(); ++k) {
            if (is_in_flight(k)) continue;
            const Gap<P> gap = gaps.gap(k, at);
            if (!states_[k].closed && gap.distance > P(tolerance) * gaps.size_of(k)) continue;
            now.touching.push_back(k);
            now.rested.push_back(states_[k].closed || Elementary<P>::magnitude(gap.rate) <= P(now.resting));
        }
    }
    bool is_in_flight(std::size_t k) const {
        return std::ranges::any_of(bounced_, [&](const Bounce& one) { return one.pair == k && one.gap > P(0); });
    }
    // Stops the step of a body, or of the cluster that it is in.
    void take_part(std::size_t body, Resolution& now) {
        if (now.affected[body]) return;
        Touching* cluster = cluster_of(body);
        if (!cluster) {
            bodies_[body]->interrupt(t_);
            now.affected[body] = true;
            return;
        }
        cluster->interrupt(t_);
        cluster->release();
        for (const std::size_t member : cluster->members()) now.affected[member] = true;
        cluster_steps_ += cluster->steps(), cluster_evaluations_ += cluster->evaluations();
        std::erase_if(clusters_, [&](const auto& one) { return one.get() == cluster; });
    }
    // Applies the impact of a touching pair.
    void collide(std::size_t touching, Resolution& now) {
        const std::size_t k = now.touching[touching];
        const SpherePair& pair = pairs_[k];
        const std::array<std::size_t, 2> index{pair.first, pair.second};
        for (const std::size_t i : index) take_part(i, now);
        if (!is_determined(touching, now)) return;
        SphereImpact<P> at;
        at.normal_W = gaps_of({k}).normal(0, centers(t_));
        at.restitution = P(pair.restitution), at.friction = P(pair.friction);
        for (std::size_t i = 0; i < 2; ++i) {
            const BodyMotion<P>& m = bodies_[index[i]]->motion();
            const SphereBody<P>& sphere = spheres_[index[i]];
            at.velocity_W[i] = m.velocity_W, at.rotation_W[i] = rotate(m.q, m.angular_velocity_B);
            at.radius[i] = sphere.radius, at.mass[i] = sphere.mass, at.moment[i] = sphere.moment;
        }
        const Vector3<P> impulse = Impact::impulse(at);
        for (std::size_t i = 0; i < 2; ++i) {
            const Vector3<P> on_body = i == 0 ? impulse : Vector3<P>(-impulse);
            bodies_[index[i]]->add_velocity((P(1) / at.mass[i]) * on_body,
                                            (P(1) / at.moment[i]) * cross(at.arm(i), on_body));
            now.pushed[index[i]] = true;
        }
        now.changes = now.collided[k] = true;
        now.keeps_modes = false;
        std::erase_if(bounced_, [&](const Bounce& one) { return one.pair == k; });
        bounced_.push_back({k});
        note_impact(k, impulse, at.normal_W, now.resting);
    }
    // Whether the laws for pairs determine an impact: not if another one at the same time acts through a sphere that
    // rests on both.
    bool is_determined(std::size_t touching, const Resolution& now) {
        const SpherePair& pair = pairs_[now.touching[touching]];
        for (std::size_t j = 0; j < now.touching.size(); ++j) {
            const SpherePair& other = pairs_[now.touching[j]];
            const bool share = other.first == pair.first || other.first == pair.second || other.second == pair.first ||
                               other.second == pair.second;
            if (j == touching || !share || !(now.rested[j] || now.rested[touching])) continue;
            if (now.rested[touching] && !now.collided[now.touching[j]]) continue;
            fault_ = fmt::format(
                "the impact of {} and {} {} acts through touching spheres on {} and {}: the laws for pairs do not "
                "determine it",
                name(pair.first), name(pair.second), at_time(), name(other.first), name(other.second));
            return false;
        }
        return true;
    }
    void note_impact(std::size_t k, const Vector3<P>& impulse_W, const Vector3<P>& normal_W, double resting) {
        const P normal = dot(impulse_W, normal_W), separation = rate(k);
        const bool separates = separation > P(resting), has_limit = pairs_[k].restitution > 0;
        states_[k].has_landed = !separates;
        states_[k].separation.reset();
        if (!separates && has_limit) states_[k].separation = separation;
        pairs_record_.events.push_back({t_, states_[k].contact,
                                        separates || has_limit ? EventKind::impact : EventKind::lands, normal,
                                        impulse_W - normal * normal_W});
    }
    /// Forms clusters of the bodies that take part and touch without normal velocity. The others go on alone.
    void form_clusters(Resolution& now) {
        std::vector<std::size_t> lasting;
        for (const std::size_t k : now.touching) {
            // spheres that touch at the start, or whose gap closes without speed, may not have collided
            const bool takes_part = !has_started_ || now.affected[pairs_[k].first] || now.affected[pairs_[k].second] ||
                                    (now.closes && !states_[k].closed);
            if (!takes_part || rate(k) > P((states_[k].closed ? 1e4 : 1) * now.resting)) continue;
            lasting.push_back(k);
        }
        // a cluster that touches one of them joins
        for (const std::size_t k : lasting) take_part(pairs_[k].first, now), take_part(pairs_[k].second, now);
        std::vector<std::size_t> root;
        for (std::size_t i = 0; i < bodies_.size(); ++i) root.push_back(i);
        for (const std::size_t k : lasting) {
            const std::size_t from = root[pairs_[k].second], to = root[pairs_[k].first];
            std::ranges::replace(root, from, to);
        }
        end_separated(now, root);
        for (std::size_t i = 0; i < bodies_.size() && !find_fault(); ++i) {
            if (root[i] != i || !now.affected[i]) continue;
            std::vector<std::size_t> members;
            for (std::size_t j = 0; j < bodies_.size(); ++j)
                if (root[j] == i) members.push_back(j);
            if (members.size() > 1)
                start_cluster(std::move(members), now);
            else if (!now.keeps_modes || now.pushed[i])
                bodies_[i]->select_mode();
        }
        find_fault();
    }
    void start_cluster(std::vector<std::size_t> members, const Resolution& now) {
        auto cluster =
            std::make_unique<Touching>(*scene_, std::move(members), bodies_, pairs_, states_, pairs_record_, settings_);
        for (const std::size_t i : cluster->members())
            if (now.pushed[i]) cluster->note_push(i);
        cluster->start(t_, !has_started_, now.resting);
        clusters_.push_back(std::move(cluster));
    }
    // ends the contacts of pairs that are in no cluster together
    void end_separated(const Resolution& now, const std::vector<std::size_t>& root) {
        for (const std::size_t k : now.touching) {
            PairState<P>& state = states_[k];
            if (root[pairs_[k].first] == root[pairs_[k].second] || !now.affected[pairs_[k].first]) continue;
            const bool landed = std::exchange(state.has_landed, false);
            state.separation.reset();
            if (!std::exchange(state.closed, false)) continue;
            if (!now.collided[k] && !landed)
                pairs_record_.events.push_back({t_, state.contact, EventKind::lifts_off, P(0), {}});
            Touching::close_interval(state, pairs_record_, t_);
        }
    }

    SphereRun<P> collect() {
        SphereRun<P> result;
        result.fault = fault_;
        for (PairState<P>& state : states_) Touching::close_interval(state, pairs_record_, t_);
        // a mode that ends when it starts is no interval
        std::erase_if(pairs_record_.intervals,
                      [](const Interval<P>& interval) { return !(interval.to > interval.from); });
        for (const auto& cluster : clusters_)
            cluster_steps_ += cluster->steps(), cluster_evaluations_ += cluster->evaluations();
        result.steps = cluster_steps_, result.evaluations = cluster_evaluations_;
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
