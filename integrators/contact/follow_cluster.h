// Follows spheres that touch each other from event to event, as one system, for any formulation and scalar.
//
// ClusterDriver integrates a formulation (cluster_form.h, truth/cluster_multiplier_form.h) by Taylor series or, in
// binary64, by the steps of another method, like ContactDriver (follow_contacts.h) does for one body. It ends a mode
// where a normal force falls to zero (the contact opens), a force leaves its friction cone (slip starts), a slip ends
// (ClusterModes selects the next mode) or a gap closes (the caller resolves the impact). The independent variable is
// stretched by the product of all slips, because the direction of each converges by a power of the time left.
//
// The caller (follow_spheres.h) owns the drivers of the single spheres. While a sphere is in a cluster, its driver only
// records samples, events and intervals of its planes.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/cluster_modes.h"
#include "integrators/contact/follow_contacts.h"
#include "integrators/contact/slip_start.h"
#include "integrators/contact/sphere_cluster.h"
#include "motion/itinerary.h"
#include "scene/sphere_contacts.h"

namespace polhode::contact {

/// A pair of spheres: its contact and what the record needs.
template <class P>
struct PairState {
    P distance{0};                ///< distance of the centres in contact, m
    std::size_t contact = 0;      ///< number of the contact in events
    bool closed = false;          ///< whether contact lasts
    bool sticks = false;          ///< without slip, if it lasts
    bool has_landed = false;      ///< an impact at this time has started the contact
    std::optional<P> separation;  ///< speed after an impact whose followers accumulate, m/s
    P restitution{0};
    std::optional<double> flight_speed;   ///< largest normal speed since the last impact, m/s
    std::optional<std::size_t> interval;  ///< index in the pairs' record while it is open
};

/// What a step of a cluster led to.
enum class ClusterEvent {
    none,
    impact,  ///< a gap closed
    leg,     ///< the loads change
    splits,  ///< pairs have opened, so that the spheres are no longer connected
};

template <class P, class Form, class Member>
class ClusterDriver {
  public:
    /// `members`: indices of the spheres, `drivers`: of all spheres. All references must outlive the driver.
    ClusterDriver(const Scene& scene, std::vector<std::size_t> members,
                  const std::vector<std::unique_ptr<Member>>& drivers, const std::vector<SpherePair>& pairs,
                  std::vector<PairState<P>>& states, Record<P>& record, const ContactSettings& settings)
        : scene_(&scene),
          members_(std::move(members)),
          states_(&states),
          record_(&record),
          settings_(settings),
          legs_(itinerary(scene)),
          form_(scenes_of(drivers), radii_of(drivers)),
          steps_(settings.steps, settings.tolerance, scene.duration) {
        for (const std::size_t i : members_) {
            Member& driver = *drivers[i];
            drivers_.push_back(&driver);
            spheres_.push_back(driver.sphere());
            motions_.push_back(driver.motion());
            reach_ = std::max(reach_, static_cast<double>(spheres_.back().radius));
            const Sizes& sizes = driver.sizes();
            sizes_.position = std::max(sizes_.position, sizes.position);
            sizes_.velocity = std::max(sizes_.velocity, sizes.velocity);
            sizes_.angular_velocity = std::max(sizes_.angular_velocity, sizes.angular_velocity);
        }
        list_contacts(pairs);
        closed_.assign(contacts_.size(), false);
        zeros_.assign(contacts_.size(), 0);
    }

    /// Starts at the time t. `separates`: speeds below it are zero. Returns false on a fault.
    bool start(const P& t, bool is_first, double separates) {
        t_ = t, is_first_ = is_first;
        find_leg();
        form_.enter(legs_[leg_].begin, false, motions_);
        std::vector<std::size_t> candidates;
        std::vector<bool> known(contacts_.size(), false);
        for (std::size_t k = 0; k < contacts_.size() && !fails(); ++k) {
            const ClusterContact<P>& contact = contacts_[k];
            const bool was_closed = contact.is_pair() ? state(k).closed : member(k).lasting_plane() == contact.number;
            const bool sticks = contact.is_pair() ? state(k).sticks : member(k).rolls();
            const double least = (was_closed ? 1e4 : 1) * separates;
            if (!was_closed && !touches(k)) continue;
            if (normal_velocity(k) > P(least)) {
                zeros_[k] = 1;
                continue;
            }
            known[k] = was_closed && sticks && !was_pushed_[k];
            candidates.push_back(k);
        }
        require_one_plane(candidates);
        if (!fails()) choose(candidates, known);
        if (!fails()) show_start();
        return !fails();
    }
    const std::string& fault() const { return fault_; }
    const std::vector<std::size_t>& members() const { return members_; }
    bool has(std::size_t body) const { return std::ranges::find(members_, body) != members_.end(); }
    long steps() const { return step_count_; }
    long evaluations() const { return settings_.steps ? steps_.evaluations() : step_count_; }

    bool has_planned_step() const { return planned_.has_value(); }
    const P& planned_end() const { return planned_->reached; }
    /// Plans the next step. Returns false at the end of the run or on a fault.
    bool plan() {
        while (!fails() && !is_done_) {
            if (!(t_ < P(legs_[leg_].end))) {
                show_rest_of_leg();
                if (leg_ + 1 == legs_.size()) {
                    is_done_ = true;
                    break;
                }
                planned_.emplace(Planned{{}, Found{P(0), Found::What::leg, 0}, t_, false});
                return true;
            }
            if (mode_.starts_slip() && !series_) {
                if (start_slip()) return true;
            } else if (plan_step_of_mode()) {
                return true;
            }
        }
        return false;
    }
    ClusterEvent take_planned_step() {
        const Planned planned = std::move(*planned_);
        planned_.reset();
        if (planned.step) {
            note_length(*planned.step);
            move_to(*planned.step, planned.reached, planned.found.has_value());
        }
        if (!planned.found) {
            if (planned.starts_slip) continue_slips();
            return is_connected() ? ClusterEvent::none : ClusterEvent::splits;
        }
        const Found found = *planned.found;
        switch (found.what) {
            case Found::What::gap:
                return ClusterEvent::impact;
            case Found::What::leg:
                ++leg_;
                form_.enter(legs_[leg_].begin, true, motions_);
                place_members();
                return ClusterEvent::leg;
            case Found::What::normal_force:
                open(found.contact, *planned.step);
                break;
            case Found::What::cone:
                start_to_slide(found.contact, *planned.step);
                break;
            case Found::What::slip: {
                std::vector<bool> known = sticking();
                known[found.contact] = true;
                choose(closed_contacts(), known);
                break;
            }
        }
        return ClusterEvent::none;
    }
    /// Moves to a time within the planned step and cancels the rest of it.
    void interrupt(const P& t) {
        if (planned_ && planned_->step && t > t_) {
            Step step = *planned_->step;
            step.length = step.when(t, t_);
            note_length(step);
            move_to(step, t, true);
        }
        planned_.reset();
        leave_system();
    }
    /// The motions of all members at a time in the planned step. The end of a slip may have moved them ahead of the
    /// caller's time by a time of the size of the errors.
    std::vector<BodyMotion<P>> motions_at(const P& t) {
        if (t < t_) {
            std::vector<BodyMotion<P>> earlier = motions_;
            for (BodyMotion<P>& one : earlier) one.position_W = one.position_W - (t_ - t) * one.velocity_W;
            return earlier;
        }
        if (!planned_ || !planned_->step || !(t > t_)) return motions_;
        return planned_->motions.at(t, [&] {
            std::vector<P> y(static_cast<std::size_t>(form_.dimension()));
            planned_->step->expansion.evaluate(planned_->step->when(t, t_), y.data());
            return form_.motions(y.data());
        });
    }
    /// Returns the members to their drivers, which go on from here.
    void release() {
        for (std::size_t i = 0; i < members_.size(); ++i) drivers_[i]->resume(t_, motions_[i], legs_[leg_].begin);
        leave_system();
    }
    /// Adds digits to the accuracy of the following steps.
    void set_further_digits(double digits) { further_digits_ = digits; }
    /// Notes that an impulse acts on a sphere, so that its slips may change.
    void note_push(std::size_t body) {
        for (std::size_t k = 0; k < contacts_.size(); ++k)
            if (members_[contacts_[k].first] == body ||
                (contacts_[k].is_pair() && members_[*contacts_[k].second] == body))
                was_pushed_[k] = true;
    }

  private:
    using T = typename SeriesScalar<P>::Type;
    using Step = ModeStep<P>;

    struct Found {
        P s{0};
        enum class What { gap, normal_force, cone, slip, leg } what = What::gap;
        std::size_t contact = 0;
    };
    struct Planned {
        std::optional<Step> step;
        std::optional<Found> found;
        P reached{0};
        bool starts_slip = false;
        KnownTimes<P, std::vector<BodyMotion<P>>> motions{};
    };

    const Scene* scene_;
    std::vector<std::size_t> members_;
    std::vector<PairState<P>>* states_;
    Record<P>* record_;
    ContactSettings settings_;
    std::vector<Leg> legs_;
    Form form_;
    ModeSteps<P, Form> steps_;
    std::vector<Member*> drivers_;
    std::vector<SphereBody<P>> spheres_;
    std::vector<BodyMotion<P>> motions_;
    Sizes sizes_;
    double reach_ = 0, acceleration_ = 0;
    double further_digits_ = 0;                // for the accuracy of steps
    double allowed_ = 0;                       // length of the planned step without events
    std::vector<ClusterContact<P>> contacts_;  // all pairs and planes of the members
    std::vector<bool> closed_, was_pushed_;
    std::vector<std::size_t> zeros_;  // known order of the zero of each gap at the start of the mode
    ClusterMode<P> mode_;
    std::vector<std::size_t> closed_index_, open_index_;  // indices of the mode's contacts in contacts_
    P t_{0};
    std::size_t leg_ = 0;
    bool is_first_ = false, is_done_ = false;
    std::optional<Series<T>> series_;
    std::vector<P> y_;
    std::optional<Planned> planned_;
    std::vector<SlipStart<P>> starts_;  // slips that start in the planned step
    std::string fault_;
    long step_count_ = 0, stalled_ = 0;
    P stalled_at_{-1};

    std::vector<const Scene*> scenes_of(const std::vector<std::unique_ptr<Member>>& drivers) const {
        std::vector<const Scene*> scenes;
        for (const std::size_t i : members_) scenes.push_back(&drivers[i]->scene());
        return scenes;
    }
    std::vector<P> radii_of(const std::vector<std::unique_ptr<Member>>& drivers) const {
        std::vector<P> radii;
        for (const std::size_t i : members_) radii.push_back(drivers[i]->sphere().radius);
        return radii;
    }
    void list_contacts(const std::vector<SpherePair>& pairs) {
        const auto local = [&](std::size_t body) -> std::optional<std::size_t> {
            const auto found = std::ranges::find(members_, body);
            if (found == members_.end()) return {};
            return static_cast<std::size_t>(found - members_.begin());
        };
        for (std::size_t i = 0; i < members_.size(); ++i) {
            const ContactGeometry<P>& geometry = drivers_[i]->geometry();
            for (std::size_t plane = 0; plane < geometry.planes.size(); ++plane) {
                ClusterContact<P> contact;
                contact.first = i, contact.number = plane;
                contact.normal_W = geometry.planes[plane].normal_W, contact.offset = geometry.planes[plane].offset;
                contact.friction = geometry.planes[plane].friction;
                contacts_.push_back(contact);
            }
        }
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const std::optional<std::size_t> first = local(pairs[k].first), second = local(pairs[k].second);
            if (!first || !second) continue;
            ClusterContact<P> contact;
            contact.first = *first, contact.second = second, contact.number = k;
            contact.offset = (*states_)[k].distance, contact.friction = P(pairs[k].friction);
            contacts_.push_back(contact);
        }
        was_pushed_.assign(contacts_.size(), false);
    }

    bool fails() const { return !fault_.empty(); }
    void fail(const std::string& why) {
        if (fault_.empty()) fault_ = why;
    }
    std::string at_time() const { return fmt::format("at t = {:.10g} s", static_cast<double>(t_)); }
    const std::string& name(std::size_t i) const { return scene_->bodies[members_[i]].name; }
    std::string names() const {
        std::string all;
        for (std::size_t i = 0; i < members_.size(); ++i)
            all += (i == 0 ? "" : i + 1 == members_.size() ? " and " : ", ") + name(i);
        return all;
    }
    double error(double further = 0) const { return std::pow(10.0, further - settings_.event_digits); }
    double step_digits() const { return settings_.digits + further_digits_; }
    int step_order() const {
        int highest = 0;
        for (Member* driver : drivers_) highest = std::max(highest, driver->step_order().next());
        return highest;
    }
    void note_length(const Step& step) {
        for (Member* driver : drivers_)
            driver->step_order().note(step.order(), step_digits(), allowed_, static_cast<double>(step.length));
    }
    // relative error of velocities and forces
    double rounding() const { return std::max(error(2), 30 * settings_.step_error); }
    double speed() const { return sizes_.velocity + reach_ * sizes_.angular_velocity; }
    double zero_slip() const { return rounding() * speed(); }
    PairState<P>& state(std::size_t k) const { return (*states_)[contacts_[k].number]; }
    Member& member(std::size_t k) const { return *drivers_[contacts_[k].first]; }

    void find_leg() {
        // the last leg whose loads all members have
        leg_ = 0;
        for (std::size_t i = 1; i < legs_.size(); ++i) {
            const bool all = std::ranges::all_of(
                drivers_, [&](const Member* driver) { return driver->has_entered(legs_[i].begin); });
            if (!(P(legs_[i].begin) > t_) && all) leg_ = i;
        }
    }
    Vector3<P> away(std::size_t k) const {
        const ClusterContact<P>& c = contacts_[k];
        return motions_[c.first].position_W - motions_[*c.second].position_W;
    }
    bool touches(std::size_t k) const {
        const ClusterContact<P>& c = contacts_[k];
        if (!c.is_pair()) return member(k).touches_plane(c.number);
        const double tolerance = is_first_ ? 1e-12 : error(4 - further_digits_);
        return !(length(away(k)) - c.offset > P(tolerance) * c.offset);
    }
    Vector3<P> normal(std::size_t k) const {
        const ClusterContact<P>& c = contacts_[k];
        return c.is_pair() ? Vector3<P>((P(1) / length(away(k))) * away(k)) : c.normal_W;
    }
    P normal_velocity(std::size_t k) const {
        const ClusterContact<P>& c = contacts_[k];
        Vector3<P> v = motions_[c.first].velocity_W;
        if (c.is_pair()) v = v - motions_[*c.second].velocity_W;
        return dot(normal(k), v);
    }
    void require_one_plane(const std::vector<std::size_t>& candidates) {
        std::vector<int> planes(members_.size(), 0);
        for (const std::size_t k : candidates)
            if (const ClusterContact<P>& contact = contacts_[k]; contact.is_pair()) {
                continue;
            } else if (const Plane& plane = scene_->planes[contact.number];
                       plane.rolling_friction > 0 || plane.torsional_friction > 0) {
                fail(
                    fmt::format("{} touches another sphere {}: torsional and rolling friction are not supported for "
                                "spheres in contact with each other",
                                name(contact.first), at_time()));
            } else if (++planes[contact.first] > 1) {
                fail(
                    fmt::format("{} touches another sphere and two planes {}: lasting contacts of a sphere with a "
                                "sphere and several planes are not supported",
                                name(contact.first), at_time()));
            }
    }
    std::vector<std::size_t> closed_contacts() const {
        std::vector<std::size_t> all;
        for (std::size_t k = 0; k < contacts_.size(); ++k)
            if (closed_[k]) all.push_back(k);
        return all;
    }
    // contacts without slip: their computed slip is rounding
    std::vector<bool> sticking() const {
        std::vector<bool> all;
        for (std::size_t k = 0; k < contacts_.size(); ++k)
            all.push_back(closed_[k] && contacts_[k].grip == Grip::sticking);
        return all;
    }

    ClusterResponse<P> response(const std::vector<ClusterContact<P>>& contacts) const {
        std::vector<SphereRates<P>> rates;
        for (std::size_t i = 0; i < members_.size(); ++i) rates.push_back(form_.free_rates(i, motions_[i]));
        return cluster_response(contacts, spheres_, motions_, rates);
    }
    static double tangential(const Vector3<P>& v) {
        return static_cast<double>(square_root(P(v[0] * v[0] + v[1] * v[1])));
    }
    /// Selects the mode of the contacts in `candidates`, which have no normal velocity. Slips of those that are `known`
    /// are zero.
    void choose(const std::vector<std::size_t>& candidates, const std::vector<bool>& known) {
        leave_system();
        if (t_ == stalled_at_) {
            if (++stalled_ > 1000) return fail("too many events " + at_time());
        } else {
            stalled_ = 0, stalled_at_ = t_;
        }
        std::vector<ClusterContact<P>> contacts;
        std::vector<P> friction;
        for (const std::size_t k : candidates)
            contacts.push_back(contacts_[k]), friction.push_back(contacts_[k].friction);
        ClusterResponse<P> at = response(contacts);
        std::vector<bool> slips;
        for (std::size_t c = 0; c < candidates.size(); ++c)
            slips.push_back(friction[c] > P(0) && !known[candidates[c]] && tangential(at.velocity[c]) > zero_slip());
        remove_velocities(contacts, at, slips);
        at = response(contacts);
        acceleration_ = 0;
        for (std::size_t i = 0; i < members_.size(); ++i) {
            const SphereRates<P> rates = form_.free_rates(i, motions_[i]);
            acceleration_ = std::max({acceleration_, static_cast<double>(length(rates.acceleration)),
                                      reach_ * static_cast<double>(length(rates.angular))});
        }
        for (const Vector3<P>& c : at.acceleration)
            acceleration_ = std::max(acceleration_, static_cast<double>(length(c)));
        ClusterModes<P> modes(at, friction, slips, rounding(), acceleration_);
        const std::optional<ClusterSolution<P>> found = modes.choose();
        if (!found) return fail(fmt::format("{}, {}: {}", names(), at_time(), modes.fault()));
        find_accumulations(candidates, modes, *found);
        std::vector<bool> closed(contacts_.size(), false);
        for (std::size_t c = 0; c < candidates.size(); ++c) {
            const std::size_t k = candidates[c];
            ClusterContact<P>& contact = contacts_[k];
            zeros_[k] = 2;
            if (found->choices[c] == ContactChoice::opens) continue;
            closed[k] = true;
            switch (found->choices[c]) {
                case ContactChoice::smooth:
                    contact.grip = Grip::smooth;
                    break;
                case ContactChoice::slides:
                    contact.grip = Grip::sliding;
                    break;
                case ContactChoice::sticks:
                    contact.grip = Grip::sticking;
                    break;
                default:
                    contact.grip = Grip::starting;
                    set_path(contact, at.axes[c].normal_W, at.axes[c].to_world(found->directions[c]));
            }
        }
        closed_ = std::move(closed);
        std::fill(was_pushed_.begin(), was_pushed_.end(), false);
        build_mode();
        note_modes();
        is_first_ = false;
        place_members();
    }
    void set_path(ClusterContact<P>& contact, const Vector3<P>& normal_W, const Vector3<P>& direction_W) const {
        contact.path = SlipPath<P>{direction_W, cross(normal_W, direction_W), {}, t_};
    }
    /// Removes normal velocities and slips that are zero up to rounding, by impulses at the contacts.
    void remove_velocities(const std::vector<ClusterContact<P>>& contacts, ClusterResponse<P> at,
                           const std::vector<bool>& slips) {
        std::vector<P> friction;
        std::vector<ContactChoice> choices;
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            friction.push_back(contacts[c].friction);
            choices.push_back(slips[c] || !(friction[c] > P(0)) ? ContactChoice::smooth : ContactChoice::sticks);
        }
        at.acceleration = at.velocity;
        const ClusterModes<P> modes(at, friction, slips, 0, 0);
        const auto impulses = modes.solve(choices, std::vector<Vector3<P>>(contacts.size()));
        if (!impulses) return;
        for (std::size_t c = 0; c < contacts.size(); ++c) {
            const Vector3<P> J = at.axes[c].to_world(impulses->force[c]);
            for (std::size_t i = 0; i < members_.size(); ++i) {
                if (!contacts[c].has(i)) continue;
                const P sign(contacts[c].first == i ? 1 : -1);
                BodyMotion<P>& m = motions_[i];
                m.velocity_W = m.velocity_W + (sign / spheres_[i].mass) * J;
                const Vector3<P> turn = (-spheres_[i].radius / spheres_[i].moment) * cross(at.axes[c].normal_W, J);
                m.angular_velocity_B = m.angular_velocity_B + rotate_back(m.q, turn);
            }
        }
    }
    /// Times at which impacts of pairs accumulate: the flights after an impact with the separation speed u last
    /// 2 u / |c| (1 + e + e^2 + ..), where c is the acceleration of the open gap.
    void find_accumulations(const std::vector<std::size_t>& candidates, const ClusterModes<P>& modes,
                            const ClusterSolution<P>& found) {
        for (std::size_t c = 0; c < candidates.size(); ++c) {
            if (!contacts_[candidates[c]].is_pair() || !state(candidates[c]).separation) continue;
            PairState<P>& pair = state(candidates[c]);
            std::vector<ContactChoice> choices = found.choices;
            if (choices[c] == ContactChoice::opens) {
                pair.separation.reset();
                continue;
            }
            choices[c] = ContactChoice::opens;
            P rest(0);
            if (const auto forces = modes.solve(choices, found.directions); forces && forces->acceleration[c][2] < P(0))
                rest = P(-2) * *pair.separation / (forces->acceleration[c][2] * (P(1) - pair.restitution));
            pair.separation.reset();
            record_->events.push_back({t_ + rest, pair.contact, EventKind::accumulates, P(0), {}});
        }
    }

    /// Copies the contacts and their grips to the mode of the formulation.
    void build_mode() {
        leave_system();
        mode_.closed.clear(), mode_.open.clear(), closed_index_.clear(), open_index_.clear();
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            (closed_[k] ? mode_.closed : mode_.open).push_back(contacts_[k]);
            (closed_[k] ? closed_index_ : open_index_).push_back(k);
        }
        form_.set_mode(mode_);
    }
    bool is_at_rest(std::size_t i) const {
        const P small(std::max(error(6), 30 * settings_.step_error) * speed());
        return length(motions_[i].velocity_W) <= small &&
               length(motions_[i].angular_velocity_B) * spheres_[i].radius <= small;
    }
    /// Records the events that the present mode begins with, and its intervals.
    void note_modes() {
        for (std::size_t i = 0; i < members_.size(); ++i) {
            std::optional<std::size_t> plane;
            bool rolls = false;
            for (std::size_t k = 0; k < contacts_.size(); ++k)
                if (closed_[k] && !contacts_[k].is_pair() && contacts_[k].first == i)
                    plane = contacts_[k].number, rolls = contacts_[k].grip == Grip::sticking;
            drivers_[i]->note_mode(t_, motions_[i], plane, rolls, is_first_);
        }
        for (std::size_t k = 0; k < contacts_.size(); ++k)
            if (contacts_[k].is_pair()) note_pair(k);
    }
    void note_pair(std::size_t k) {
        PairState<P>& pair = state(k);
        const bool sticks = contacts_[k].grip == Grip::sticking;
        const bool landed = std::exchange(pair.has_landed, false);
        const auto note = [&](EventKind kind) { record_->events.push_back({t_, pair.contact, kind, P(0), {}}); };
        if (!is_first_ && !landed) {
            if (pair.closed && !closed_[k]) note(EventKind::lifts_off);
            if (!pair.closed && closed_[k]) note(EventKind::lands);
        }
        if (pair.closed && closed_[k] && pair.sticks != sticks) {
            const bool rests = is_at_rest(contacts_[k].first) && is_at_rest(*contacts_[k].second);
            note(!sticks ? EventKind::slides : rests ? EventKind::stops : EventKind::rolls);
        }
        const bool same = pair.closed == closed_[k] && pair.sticks == sticks;
        pair.closed = closed_[k], pair.sticks = sticks;
        if (same && (!closed_[k] || pair.interval)) return;
        close_interval(pair, *record_, t_);
        if (!closed_[k]) return;
        pair.interval = record_->intervals.size();
        record_->intervals.push_back({t_, t_, pair.contact, sticks ? Mode::rolling : Mode::sliding, 0});
    }
    void note_ratios(const Step& step) {
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            const ClusterContact<P>& contact = mode_.closed[c];
            const double friction = static_cast<double>(contact.friction);
            if (!(friction > 0)) continue;
            double largest = contact.grip == Grip::sticking ? 0 : 1;
            for (int i = 0; contact.grip == Grip::sticking && i <= 8; ++i) {
                const P s = step.length * P(i) / P(8);
                const double limit = friction * static_cast<double>(step.observed(form_.function(c), s)),
                             rest = static_cast<double>(step.observed(form_.function(c) + 1, s));
                if (limit > force_scale(contact) * rounding())
                    largest = std::max(largest, std::sqrt(std::max(0.0, limit * limit - rest)) / limit);
            }
            if (!contact.is_pair())
                drivers_[contact.first]->raise_ratio(largest);
            else if (const auto& interval = (*states_)[contact.number].interval)
                record_->intervals[*interval].largest_ratio =
                    std::max(record_->intervals[*interval].largest_ratio, largest);
        }
    }

    // A contact whose normal force has fallen to zero opens, and all others whose forces vanish then, as those of a
    // sphere that falls between two equal ones do.
    void open(std::size_t k, const Step& step) {
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            const std::size_t other = closed_index_[c];
            const P force = step.observed(form_.function(c), step.length);
            if (other != k && !(force <= P(4 * rounding() * force_scale(mode_.closed[c])))) continue;
            closed_[other] = false;
            zeros_[other] = 3;
        }
        continue_slips();
        note_modes();
    }
    // A contact that sticks starts to slide, against the friction that it needed.
    void start_to_slide(std::size_t k, const Step& step) {
        const std::size_t c = static_cast<std::size_t>(std::ranges::find(closed_index_, k) - closed_index_.begin());
        const Vector3<P> force = step.observed_vector(form_.function(c) + 3, step.length), n = normal(k);
        const Vector3<P> friction = force - dot(force, n) * n;
        contacts_[k].grip = Grip::starting;
        set_path(contacts_[k], n, Vector3<P>((P(-1) / length(friction)) * friction));
        continue_slips();
        note_modes();
    }
    // Slips that have started go on as sliding; those that are still zero start again.
    void continue_slips() {
        for (std::size_t k = 0; k < contacts_.size(); ++k) {
            ClusterContact<P>& contact = contacts_[k];
            if (!closed_[k] || contact.grip != Grip::starting || contact.path.start == t_) continue;
            const std::vector<ClusterContact<P>> one{contact};
            const ClusterResponse<P> at = response(one);
            if (tangential(at.velocity.front()) > zero_slip()) {
                contact.grip = Grip::sliding;
                continue;
            }
            const Vector3<P> n = normal(k);
            set_path(contact, n, slip_heading(contact.path, t_, n, Vector3<P>()).direction);
        }
        build_mode();
    }
    bool is_connected() const {
        std::vector<bool> reached(members_.size(), false);
        reached.front() = true;
        for (std::size_t round = 0; round < members_.size(); ++round)
            for (std::size_t k = 0; k < contacts_.size(); ++k) {
                if (!closed_[k] || !contacts_[k].is_pair()) continue;
                const std::size_t a = contacts_[k].first, b = *contacts_[k].second;
                if (reached[a] || reached[b]) reached[a] = reached[b] = true;
            }
        return std::ranges::all_of(reached, [](bool is) { return is; });
    }

    // steps

    bool may_step() {
        if (step_count_++ >= settings_.max_steps) fail("the step limit is reached " + at_time());
        if (const char* why = settings_.stop()) fail(why);
        return !fails();
    }
    void leave_system() {
        series_.reset();
        steps_.end_mode();
    }
    // size of the forces at a contact, N
    double force_scale(const ClusterContact<P>& contact) const {
        P mass = spheres_[contact.first].mass;
        if (contact.is_pair()) mass = std::min(mass, spheres_[*contact.second].mass);
        return static_cast<double>(mass) * acceleration_;
    }
    void note_sizes() {
        for (const BodyMotion<P>& m : motions_) {
            sizes_.position = std::max(sizes_.position, static_cast<double>(length(m.position_W)));
            sizes_.velocity = std::max(sizes_.velocity, static_cast<double>(length(m.velocity_W)));
            sizes_.angular_velocity =
                std::max(sizes_.angular_velocity, static_cast<double>(length(m.angular_velocity_B)));
        }
    }
    void place_members() {
        for (std::size_t i = 0; i < members_.size(); ++i) drivers_[i]->place(t_, motions_[i]);
    }
    void start_state() {
        y_.assign(static_cast<std::size_t>(form_.dimension()), P(0));
        form_.start(motions_, t_, y_.data());
    }
    Series<T> series_of_mode(int order) const {
        return Series<T>(cast_recording<T>(polhode::record<P>(form_, form_.dimension())), order);
    }
    bool plan_step_of_mode() {
        if (!series_) {
            start_state();
            series_.emplace(series_of_mode(settings_.steps ? order_of_starts : settings_.order));
        }
        if (!may_step()) return false;
        if constexpr (StepOrder<P>::adapts) series_->set_order(step_order());
        const int clock = form_.clock();
        std::fill(y_.begin() + clock + 1, y_.end(), P(0));
        series_->expand(y_.data());
        Step step{*series_, clock, mode_.is_stretched()};
        if (ends_slip(step)) return false;
        if (settings_.steps) return plan_step_of_method(step);
        const double length = std::min(series_step(), observed_step(step));
        if (std::isnan(length)) {
            fail("the motion is not finite " + at_time());
            return false;
        }
        step.length = P(length);
        return plan_step(step, false);
    }
    double series_step() const {
        return settings_.step_factor * taylor_step(*series_, series_->order(), form_.blocks(sizes_), step_digits());
    }
    // Ends a slip below the error of the steps that decreases. Returns whether the mode has changed.
    bool ends_slip(const Step& step) {
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            if (mode_.closed[c].grip != Grip::sliding) continue;
            const int index = form_.function(c) + 1;
            const P square = step.coefficient(index, 1), growth = P(2) * step.coefficient(index, 2);
            if (static_cast<double>(square) > zero_slip() * zero_slip() || growth > P(0)) continue;
            // the slip lasts for -2 square / growth in the units of dy/ds (follow_contacts.h)
            if (growth < P(0)) {
                const P factor = P(-2) * square / growth;
                for (int i = 0; i <= step.clock; ++i)
                    y_[static_cast<std::size_t>(i)] = y_[static_cast<std::size_t>(i)] + factor * step.coefficient(i, 1);
            }
            t_ = y_[static_cast<std::size_t>(step.clock)];
            motions_ = form_.motions(y_.data());
            std::vector<bool> known = sticking();
            known[closed_index_[c]] = true;
            choose(closed_contacts(), known);
            return true;
        }
        return false;
    }
    // The series of the observed functions must converge as well.
    double observed_step(const Step& step) const {
        double log2_step = std::numeric_limits<double>::infinity();
        const auto limit = [&](int index, double scale) {
            for (int k = step.order() - 4; k < step.order() && scale > 0; ++k) {
                const double size = log2_magnitude(series_->coefficient(index, k + 1)) + std::log2(k + 1);
                log2_step = std::min(log2_step, (std::log2(scale) - step_digits() * std::log2(10.0) - size) / k);
            }
        };
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            const double force = std::max(force_scale(mode_.closed[c]),
                                          std::abs(static_cast<double>(step.coefficient(form_.function(c), 1))));
            for (const int i : {0, 3, 4, 5}) limit(form_.function(c) + i, force);
            if (mode_.closed[c].grip == Grip::sticking) limit(form_.function(c) + 1, force * force);
        }
        for (std::size_t k = 0; k < open_index_.size(); ++k) limit(form_.gap(k), reach_);
        return settings_.step_factor * std::exp2(std::min(log2_step, 1000.0));
    }
    bool plan_step_of_method(Step step) {
        if (!steps_.is_running())
            steps_.start(form_, y_.data(),
                         scales_of(form_.blocks(sizes_), static_cast<std::size_t>(step.clock) + 1, scene_->duration));
        double longest = static_cast<double>(P(P(legs_[leg_].end) - t_));
        if (step.stretched) longest = decay_length(step);
        const double length = steps_.step(longest);
        if (!(length > 0)) {
            fail(steps_.fault() + " " + at_time());
            return false;
        }
        step.expansion = steps_.polynomial();
        step.length = P(length);
        return plan_step(step, false);
    }
    // The length in s over which a slip decays by several e-foldings.
    double decay_length(const Step& step) const {
        constexpr double foldings = 4;
        double shortest = std::numeric_limits<double>::max();
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            if (mode_.closed[c].grip != Grip::sliding) continue;
            const int index = form_.function(c) + 1;
            const double square = static_cast<double>(step.coefficient(index, 1)),
                         growth = 2 * static_cast<double>(step.coefficient(index, 2));
            if (growth < 0) shortest = std::min(shortest, foldings * 2 * square / -growth);
        }
        return shortest;
    }
    /// Plans the first step of slips that start from zero (slip_start.h).
    bool start_slip() {
        if (!may_step()) return false;
        start_state();
        starts_.clear();
        for (std::size_t c = 0; c < closed_index_.size(); ++c)
            if (mode_.closed[c].grip == Grip::starting)
                starts_.push_back({&mode_.closed[c].path, form_.function(c) + 1, form_.function(c) + 2});
        const auto expand = [&](int order) {
            form_.set_mode(mode_);
            Series<T> series = series_of_mode(order);
            series.expand(y_.data());
            return series;
        };
        const auto step_of = [&](const Series<T>& series) {
            return settings_.step_factor * taylor_step(series, series.order(), form_.blocks(sizes_), step_digits());
        };
        const SlipStartFault why = find_slip_paths(
            starts_, {step_order(), acceleration_, error(), std::max(error(6), 1e-9), false}, expand, step_of);
        if (why != SlipStartFault::none) {
            fail(fmt::format("a slip between {} does not grow from its start {}", names(), at_time()));
            return false;
        }
        for (std::size_t c = 0; c < closed_index_.size(); ++c) contacts_[closed_index_[c]].path = mode_.closed[c].path;
        series_.emplace(expand(step_order()));
        Step step{*series_, form_.clock(), false};
        double longest = std::min(series_step(), observed_step(step));
        for (const SlipStart<P>& start : starts_) longest = std::min(longest, path_step(*start.path, step_digits()));
        if (std::isnan(longest)) {
            fail("the motion is not finite " + at_time());
            return false;
        }
        step.length = P(longest);
        return plan_step(step, true);
    }
    bool plan_step(Step step, bool starts_slip) {
        allowed_ = static_cast<double>(step.length);
        const Leg& leg = legs_[leg_];
        bool to_end = false;
        if (!step.stretched) {
            if (P(leg.end) - t_ <= step.length) step.length = P(leg.end) - t_, to_end = true;
        } else if (!(step.clock_at_end() < P(leg.end))) {
            step.length = step.when(P(leg.end), t_), to_end = true;
        }
        const std::optional<Found> found = first_event(step, starts_slip);
        if (found) step.length = found->s, to_end = false;
        const P reached = to_end ? P(leg.end) : step.clock_at_end();
        if (!found && !to_end && !(reached > t_) && !step.stretched) {
            fail("step size below the spacing of numbers " + at_time());
            return false;
        }
        planned_.emplace(Planned{step, found, reached, starts_slip});
        return true;
    }
    std::optional<Found> first_event(const Step& step, bool starts_slip) const {
        std::optional<Found> first;
        const auto look = [&](std::vector<P> function, std::size_t zeros, double noise, typename Found::What what,
                              std::size_t contact) {
            const auto root = FirstRoot<P>(function, zeros, step.length, noise).find();
            if (root && (!first || *root < first->s)) first = Found{*root, what, contact};
        };
        const auto observed = [&](int index) {
            std::vector<P> function;
            for (int k = 1; k <= step.order(); ++k) function.push_back(P(k) * step.coefficient(index, k));
            return function;
        };
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            const int index = form_.function(c);
            const double force = 4 * rounding() * force_scale(mode_.closed[c]);
            const std::size_t k = closed_index_[c];
            look(observed(index), 0, force, Found::What::normal_force, k);
            if (mode_.closed[c].grip != Grip::sticking) continue;
            const double limit =
                static_cast<double>(mode_.closed[c].friction) * static_cast<double>(step.coefficient(index, 1));
            look(observed(index + 1), 0, 4 * rounding() * limit * limit + force * force, Found::What::cone, k);
        }
        for (std::size_t j = 0; j < open_index_.size(); ++j) {
            const std::size_t k = open_index_[j];
            std::vector<P> function = observed(form_.gap(j));
            if (step.expansion.is_of_method() && zeros_[k] > 0) {
                std::vector<P> exact;
                for (int i = 1; i <= order_of_starts; ++i)
                    exact.push_back(P(i) * static_cast<P>(series_->coefficient(form_.gap(j), i)));
                refine_coefficients(function, exact, step.length, reach_);
            }
            look(std::move(function), zeros_[k], reach_ * 1e-6 * error() * error(), Found::What::gap, k);
        }
        if (starts_slip) look_for_ends(step, look);
        return first;
    }
    // slips that start may return to zero
    template <class Look>
    void look_for_ends(const Step& step, const Look& look) const {
        std::size_t start = 0;
        for (std::size_t c = 0; c < closed_index_.size(); ++c) {
            if (mode_.closed[c].grip != Grip::starting) continue;
            std::vector<P> slip;
            for (int k = 0; k <= step.order(); ++k) slip.push_back(step.coefficient(starts_[start].along, k));
            look(std::move(slip), starts_[start++].zeros, 0, Found::What::slip, closed_index_[c]);
        }
    }
    void move_to(const Step& step, const P& t, bool at_event) {
        take_samples(step, t, at_event);
        note_ratios(step);
        step.expansion.evaluate(step.length, y_.data());
        t_ = t;
        motions_ = form_.motions(y_.data());
        note_sizes();
        place_members();
        std::fill(zeros_.begin(), zeros_.end(), 0);
    }

    // samples

    void take_samples(const Step& step, const P& reached, bool at_event) {
        const P uncertainty(scene_->duration * std::max(error(), settings_.step_error));
        const auto is_at_event = [&](double time) { return at_event && P(time) >= reached - uncertainty; };
        std::vector<P> y(static_cast<std::size_t>(form_.dimension()));
        while (is_due(next_sample(), reached) && !is_at_event(next_sample())) {
            const double time = next_sample();
            const P s = step.when(P(time), t_);
            step.expansion.evaluate(s, y.data());
            const auto forces =
                plane_forces([&](std::size_t c) { return step.observed_vector(form_.function(c) + 3, s); });
            show(time, form_.motions(y.data()), forces);
        }
    }
    // The next sample of any member: one that has ended its step at an event may have postponed a sample there.
    double next_sample() const {
        double next = std::numeric_limits<double>::infinity();
        for (const Member* driver : drivers_) next = std::min(next, driver->samples().front());
        return next;
    }
    bool is_due(double time, const P& reached) const {
        return std::isfinite(time) && legs_[leg_].shows(time) && P(time) <= reached;
    }
    void show(double time, const std::vector<BodyMotion<P>>& motions,
              const std::vector<std::vector<Vector3<P>>>& forces) {
        for (std::size_t i = 0; i < members_.size(); ++i)
            if (drivers_[i]->samples().front() <= time) drivers_[i]->append_sample(motions[i], forces[i]);
    }
    template <class Force>
    std::vector<std::vector<Vector3<P>>> plane_forces(const Force& force_of) const {
        std::vector<std::vector<Vector3<P>>> forces(members_.size(), std::vector<Vector3<P>>(scene_->planes.size()));
        for (std::size_t c = 0; c < closed_index_.size(); ++c)
            if (!mode_.closed[c].is_pair()) forces[mode_.closed[c].first][mode_.closed[c].number] = force_of(c);
        return forces;
    }
    // the forces at the start of the mode
    std::vector<std::vector<Vector3<P>>> present_forces() {
        start_state();
        std::vector<P> rates(y_.size(), P(0));
        form_.derivative(y_.data(), rates.data());
        return plane_forces([&](std::size_t c) { return vector_at(rates.data(), form_.function(c) + 3); });
    }
    // The drivers have taken the sample at the start of a leg without the forces between spheres.
    void show_start() {
        const auto forces = present_forces();
        for (std::size_t i = 0; i < members_.size(); ++i)
            drivers_[i]->replace_sample(legs_[leg_].begin, motions_[i], forces[i]);
        show_due(legs_[leg_].begin);
    }
    void show_rest_of_leg() { show_due(legs_[leg_].end); }
    void show_due(double t) {
        if (!(t_ >= P(t)) || !is_due(next_sample(), P(t))) return;
        const auto forces = present_forces();
        while (is_due(next_sample(), P(t))) show(next_sample(), motions_, forces);
    }

  public:
    /// Closes the interval of a pair that is open.
    static void close_interval(PairState<P>& pair, Record<P>& record, const P& t) {
        if (!pair.interval) return;
        record.intervals[*pair.interval].to = t;
        pair.interval.reset();
    }
};

}  // namespace polhode::contact
