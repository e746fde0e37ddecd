// Follows one body with contacts on planes from event to event, for any formulation and any scalar.
//
// ContactDriver integrates a formulation (reduced_form.h, truth/multiplier_form.h) by Taylor series (A. Jorba and M.
// Zou 2005, Exp. Math. 14, 99) or, in binary64, by the steps of another method (mode_steps.h). Impacts with
// slip and the first step of a slip from zero always use series.
//
// Each mode is a smooth system; an event function that falls to zero ends it (event_roots.h): the gap in flight, the
// normal force in sliding, the friction cone in rolling, the gaps of other points. transition() selects what follows:
// an impact (impact(), the shock equations of Darboux and Keller), contact in sliding or rolling, or flight. Sliding
// ends when the slip is below the error of the steps and decreases, since the slip itself has no change of sign.
//
// A ball may rest on two planes (two_contacts.h): each contact rolls or slides along the line of the planes. The slips
// have a constant direction there and change sign, so that events locate their ends.
//
// While the body slides with friction, the independent variable s is stretched, dt = |u_t| ds, because the direction of
// the slip converges by a power of the remaining time, so that no series in t converges there.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "integrators/contact/contact_record.h"
#include "integrators/contact/event_roots.h"
#include "integrators/contact/flat_rims.h"
#include "integrators/contact/mode_series.h"
#include "integrators/contact/mode_step.h"
#include "integrators/contact/mode_steps.h"
#include "integrators/contact/rotation_friction.h"
#include "integrators/contact/slip_start.h"
#include "integrators/contact/sphere_cluster.h"
#include "integrators/contact/transitions.h"
#include "integrators/contact/two_contacts.h"
#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"
#include "integrators/series/series.h"
#include "motion/itinerary.h"
#include "scene/plane_file.h"

namespace polhode::contact {

struct ContactSettings {
    int order = 20;
    double event_digits = 13;  ///< a slip or a speed of separation below 10^-event_digits of the motion's is zero
    double digits = 15;        ///< local error: 10^-digits of each block's size
    double step_factor = 1;    ///< ratio of the step to the one that just meets `digits`
    long max_steps = 100'000;
    /// Why the run must stop now; null to continue. Called before each step.
    std::function<const char*()> stop = [] { return nullptr; };
    MakeSystemSteps steps = nullptr;  ///< steps of a method; null: Taylor series
    double tolerance = 1e-10;         ///< tolerance of that method
    double step_error = 0;            ///< relative error that its steps leave in rates and times
};

template <class P, class Form>
class ContactDriver {
  public:
    ContactDriver(const Scene& scene, const std::vector<double>& sample_times, const ContactSettings& settings)
        : scene_(&scene),
          geometry_(make_geometry(scene)),
          rims_(geometry_),
          form_(scene, geometry_),
          settings_(settings),
          samples_(sample_times),
          steps_(settings.steps, settings.tolerance, scene.duration),
          order_(settings.order) {}

    Run<P> run() {
        start();
        while (plan()) take_planned_step();
        return finish();
    }

    // The parts of run(), for a scheduler of several bodies (follow_spheres.h).

    void start() {
        motion_ = form_.initial();
        legs_ = itinerary(*scene_);
    }
    /// Plans the next step up to its end, its first event or the end of the loads' leg. Returns false at the end of the
    /// motion or on a fault.
    bool plan() {
        while (!fails() && leg_ < legs_.size()) {
            if (!is_in_leg_) {
                enter_leg();
            } else if (!(t_ < P(legs_[leg_].end))) {
                show_rest_of_leg();
                ++leg_, is_in_leg_ = false;
                leave_system();
            } else if (!series_ && (onset_ || rotation_.starts_rolling)) {
                if (start_slip()) return true;
            } else if (plan_step_of_mode()) {
                return true;
            }
        }
        return false;
    }
    bool has_planned_step() const { return planned_.has_value(); }
    /// Time at the end of the planned step.
    const P& planned_end() const { return planned_->reached; }
    /// Takes the planned step and handles the event at its end.
    void take_planned_step() {
        const Planned planned = *planned_;
        planned_.reset();
        note_length(planned.step);
        move_to(planned.step, planned.reached, planned.found.has_value());
        if (!planned.found) check_face();
        if (planned.flat && planned.flat->crosses && contact_ && *contact_ == planned.flat->pair)
            fail(on_a_rim("falls flat", planned.flat->pair));
        const bool continues = !fails() && !planned.found && !planned.flat;
        if (!fails() && planned.found) handle(*planned.found);
        if (continues && planned.starts_rolling) {
            rotation_.starts_rolling = false, rotation_.path = {};
            form_.set_rotation(rotation_);
        }
        if (!continues || planned.starts_slip) leave_system();
    }
    /// Moves to a time within the planned step and cancels the rest of it. The caller then changes the velocities.
    void interrupt(const P& t) {
        if (planned_ && t > t_) {
            Step step = planned_->step;
            step.length = step.when(t, t_);
            note_length(step);
            move_to(step, t, true);
        }
        planned_.reset(), leave_system();
    }
    StepOrder<P>& step_order() { return order_; }
    /// Adds digits to the accuracy of the following steps.
    void set_further_digits(double digits) { further_digits_ = digits; }
    /// Adds to velocity and angular velocity (world axes).
    void add_velocity(const Vector3<P>& velocity_W, const Vector3<P>& angular_velocity_W) {
        motion_.velocity_W = motion_.velocity_W + velocity_W;
        motion_.angular_velocity_B = motion_.angular_velocity_B + rotate_back(motion_.q, angular_velocity_W);
        note_sizes();
    }
    /// Applies impacts with planes and selects the mode after a change of the velocities.
    void select_mode() { transition(nullptr); }
    /// Applies impacts with planes once. Returns whether there were any.
    bool apply_plane_impacts() {
        form_.set_time(t_);
        return apply_impacts(touching(), resting_speed(false), 1, pending_);
    }

    // For a sphere that a cluster of spheres moves (follow_cluster.h).

    /// Sets time and motion.
    void place(const P& t, const BodyMotion<P>& motion) {
        t_ = t, motion_ = motion;
        form_.set_time(t);
        note_sizes();
    }
    /// Continues alone from a motion under the loads that act from `leg_begin` (s) on.
    void resume(const P& t, const BodyMotion<P>& motion, double leg_begin) {
        place(t, motion);
        for (std::size_t i = 0; i < legs_.size(); ++i)
            if (legs_[i].begin <= leg_begin) leg_ = i;
        is_in_leg_ = true;
        BodyMotion<P> unchanged = motion;
        form_.enter(legs_[leg_].begin, unchanged);
        planned_.reset(), leave_system();
        std::fill(zeros_.begin(), zeros_.end(), 0);
    }
    /// Whether the loads that change at `begin` (s) act on it, if any do.
    bool has_entered(double begin) const {
        return std::ranges::none_of(
            legs_, [&](const Leg& leg) { return leg.begin == begin && leg.index >= leg_ + (is_in_leg_ ? 1 : 0); });
    }
    /// Records the events of a change to rolling or sliding on `plane`, or to flight, and its interval.
    void note_mode(const P& t, const BodyMotion<P>& motion, std::optional<std::size_t> plane, bool rolls, bool first) {
        place(t, motion);
        onset_.reset(), two_.reset();
        former_rotation_ = rotation_;
        const Impacts impacts = std::exchange(pending_, {});
        const System next = !plane ? System::flight : rolls ? System::rolling : System::sliding;
        record_mode(next, plane ? std::optional(Pair{*plane, 0}) : std::nullopt, first, mode_, contact_, impacts.landed,
                    impacts.accumulated);
    }
    /// Raises the largest |F|/(mu N) of the present interval.
    void raise_ratio(double ratio) {
        double& largest = run_.record.intervals.back().largest_ratio;
        largest = std::max(largest, ratio);
    }
    const SampleQueue& samples() const { return samples_; }
    void append_sample(const BodyMotion<P>& motion, const std::vector<Vector3<P>>& forces_W) {
        show(motion, forces_W, std::vector<Vector3<P>>(forces_W.size()));
        samples_.pop();
    }
    /// Replaces the last sample if it was taken at `time` (s) and the body is still there.
    void replace_sample(double time, const BodyMotion<P>& motion, const std::vector<Vector3<P>>& forces_W) {
        if (!(last_sample_ == time) || !(t_ == P(time)) || run_.motions.empty()) return;
        run_.motions.back() = motion, run_.forces_W.back() = forces_W;
    }
    const Scene& scene() const { return *scene_; }
    const Sizes& sizes() const { return sizes_; }
    SphereBody<P> sphere() const {
        const MassProperties<P> body = mass_properties<P>(scene_->body);
        return {body.mass, body.inertia[0][0], geometry_.pieces.front().radius};
    }
    /// The plane of the lasting contact, if there is one.
    std::optional<std::size_t> lasting_plane() const {
        return contact_ ? std::optional(contact_->plane) : std::nullopt;
    }
    bool rolls() const { return mode_ == System::rolling; }
    bool touches_plane(std::size_t plane) const {
        return !(gap(plane * geometry_.pieces.size(), motion_) > P(reach() * error(4 - further_digits_)));
    }
    Run<P> finish() {
        close_interval();
        run_.evaluations = settings_.steps ? steps_.evaluations() : run_.steps;
        return std::move(run_);
    }
    const std::string& fault() const { return run_.fault; }
    const P& time() const { return t_; }
    const BodyMotion<P>& motion() const { return motion_; }
    /// The motion at a time in the planned step; without one, the present motion. The end of a slip or of a series of
    /// impacts may have moved the body ahead of the caller's time by a time of the size of the errors.
    BodyMotion<P> motion_at(const P& t) {
        if (t < t_) {
            BodyMotion<P> earlier = motion_;
            earlier.position_W = motion_.position_W - (t_ - t) * motion_.velocity_W;
            return earlier;
        }
        if (!planned_ || !(t > t_)) return motion_;
        return planned_->motions.at(t, [&] {
            std::vector<P> y(static_cast<std::size_t>(form_.dimension()));
            planned_->step.expansion.evaluate(planned_->step.when(t, t_), y.data());
            return form_.motion(y.data());
        });
    }
    const ContactGeometry<P>& geometry() const { return geometry_; }
    /// Bound of the speeds of the motion so far, m/s.
    double largest_speed() const { return sizes_.velocity; }

  private:
    using T = typename SeriesScalar<P>::Type;

    using Step = ModeStep<P>;
    /// What impacts with planes at one time have led to.
    struct Impacts {
        bool landed = false;
        std::optional<Pair> accumulated;
    };
    struct Found {
        P s{0};
        enum class What {
            gap,
            normal_force,
            cone,
            rolling_limit,
            spin_limit,
            spin,
            slip,
            end_of_rolling
        } what = What::gap;
        std::size_t pair = 0;  // the observed gap, or the index in TwoContacts
    };
    /// A rim that becomes parallel to a plane, or ceases to be, ends a step.
    struct Flat {
        Pair pair;
        bool crosses = false;  // it becomes parallel at the end of the step
    };
    /// A step that is not taken yet.
    struct Planned {
        Step step;
        std::optional<Found> found;  // the event at its end
        P reached{0};                // time at its end
        bool starts_slip = false, starts_rolling = false;
        std::optional<Flat> flat{};  // why the step is shorter
        KnownTimes<P, BodyMotion<P>> motions{};
    };

    const Scene* scene_;
    ContactGeometry<P> geometry_;
    FlatRims<P> rims_;
    Form form_;
    ContactSettings settings_;
    SampleQueue samples_;
    Run<P> run_;
    double last_sample_ = -1;  // s
    P t_{0};
    BodyMotion<P> motion_;
    Sizes sizes_;
    Impacts pending_;                          // of impacts before the mode is selected
    std::optional<Pair> contact_;              // the lasting contact
    std::optional<TwoContacts<P>> two_;        // lasting contacts of a ball with two planes; contact_ is then the first
    std::array<std::size_t, 2> slip_zeros_{};  // known order of the zeros of their slips at the start of the mode
    std::optional<Pair> lifted_;               // the one of them that has just lifted off
    std::vector<Pair> face_;                   // all points of a face or an edge in contact; else empty
    std::optional<Vector3<P>> edge_B_;         // direction of the edge
    System mode_ = System::flight;
    std::vector<std::size_t> zeros_;  // known order of the zero of each pair's gap at the start of the mode
    bool has_started_ = false;        // the first transition
    std::size_t open_intervals_ = 0;  // at the end of the record
    long stalled_ = 0;                // events without progress in time
    P stalled_at_{-1};
    std::optional<Vector3<P>> onset_;      // slip starts from zero in this direction, in the contact's axes
    std::size_t slip_start_ = 0;           // order of the zero of the slip at the start of the planned step; 0: none
    std::size_t rolling_start_ = 0;        // as slip_start_, for the rolling velocity
    RotationFriction<P> rotation_;         // torsional and rolling friction of the mode
    std::size_t spin_zeros_ = 0;           // known order of the zero of the spin at the start of the mode
    RotationFriction<P> former_rotation_;  // before the transition
    Exceeded exceeded_ = Exceeded::none;   // the limit whose event led to the transition
    std::vector<Leg> legs_;
    std::size_t leg_ = 0;  // the present leg
    bool is_in_leg_ = false;
    std::optional<ModeSeries<T>> series_;    // expands the present mode
    std::optional<Series<T>> start_series_;  // a planned first step of a slip, whose path the equations contain
    ModeSteps<P, Form> steps_;               // of another method, if the settings have one
    double slip_scale_ = 0;                  // slip by which its errors are measured there
    double summed_slip_ = 0;                 // bound of the slip's error after a sum of impacts
    std::vector<P> y_;                       // the state of the mode
    double further_digits_ = 0;              // for the accuracy of steps
    StepOrder<P> order_;
    double allowed_ = 0;              // length of the planned step without events
    std::optional<Planned> planned_;  // refers to series_, start_series_ or steps_

    static ContactGeometry<P> make_geometry(const Scene& scene) {
        const Vector3<P> center = mass_properties<P>(scene.body).center;
        if (!scene.planes.empty()) return contact_geometry(scene, center, Quaternion<P>{});
        // a sphere that meets other spheres only: the hull without planes
        Scene with_plane = scene;
        with_plane.planes.resize(1);
        ContactGeometry<P> geometry = contact_geometry(with_plane, center, Quaternion<P>{});
        geometry.planes.clear();
        return geometry;
    }
    void enter_leg() {
        const Leg& leg = legs_[leg_];
        is_in_leg_ = true;
        t_ = P(leg.begin);
        form_.set_time(t_);
        form_.enter(leg.begin, motion_);
        note_sizes();
        if (leg.index == 0) start_at_contact();
        if (!fails()) transition(nullptr);
        if (!fails()) show_at(leg, leg.begin);
    }
    bool fails() const { return !run_.fault.empty(); }
    std::string at_time() const { return fmt::format("at t = {:.10g} s", static_cast<double>(t_)); }
    void fail(const std::string& fault) {
        if (run_.fault.empty()) run_.fault = fault;
    }
    std::string plane_at(Pair pair) const { return plane_name(*scene_, pair.plane); }
    double error(double further = 0) const { return std::pow(10.0, further - settings_.event_digits); }
    double step_digits() const { return settings_.digits + further_digits_; }
    void note_length(const Step& step) {
        order_.note(step.order(), step_digits(), allowed_, static_cast<double>(step.length));
    }
    double reach() const { return static_cast<double>(geometry_.reach); }
    double speed() const { return sizes_.velocity + reach() * sizes_.angular_velocity; }
    /// A slip below it is zero.
    double zero_slip() const { return std::max(error(2) * speed(), summed_slip_); }
    P mu(Pair pair) const { return geometry_.planes[pair.plane].friction; }

    // the sizes start from the motion, and from what the loads do over the body's length
    void note_sizes() {
        const auto size = [](const Vector3<P>& v) { return static_cast<double>(length(v)); };
        if (!has_started_ && geometry_.planes.empty()) {
            sizes_ = {0, reach(), 0};
        } else if (!has_started_) {
            Pair any;
            const ContactResponse<P> at = form_.response(any, motion_);
            const double fall = size(at.acceleration);
            sizes_ = {std::sqrt(fall / reach()), reach(), std::sqrt(fall * reach())};
            if (!(fall > 0)) sizes_ = {0, reach(), 0};
        }
        sizes_.angular_velocity = std::max(sizes_.angular_velocity, size(motion_.angular_velocity_B));
        sizes_.position = std::max(sizes_.position, size(motion_.position_W));
        sizes_.velocity = std::max(sizes_.velocity, size(motion_.velocity_W));
        if (sizes_.velocity == 0) sizes_.velocity = reach() * std::max(sizes_.angular_velocity, 1e-3);
        if (sizes_.angular_velocity == 0) sizes_.angular_velocity = sizes_.velocity / reach();
    }

    P gap(std::size_t k, const BodyMotion<P>& m) const {
        const Pair pair = form_.pair_at(k);
        const ContactPlane<P>& plane = geometry_.planes[pair.plane];
        return dot(plane.normal_W, m.position_W) +
               geometry_.pieces[pair.piece].lowest(rotate_back(m.q, plane.normal_W)) - plane.offset;
    }

    // a start that touches a plane within 10^-12 of the body's size touches it exactly: the plane is moved there
    void start_at_contact() {
        zeros_.assign(geometry_.size(), 0);
        rims_.update(geometry_, motion_.q);
        for (std::size_t plane = 0; plane < geometry_.planes.size(); ++plane) {
            const Placement<P> at{motion_.q, motion_.position_W, motion_.velocity_W, {}};
            const P distance = geometry_.distance(plane, at);
            if (Elementary<P>::magnitude(distance) <= P(1e-12 * reach()))
                geometry_.planes[plane].offset = geometry_.planes[plane].offset + distance;
        }
    }

    // Gaps drift by the error of the steps while contact lasts. Arrivals are located more accurately.
    std::vector<std::size_t> touching() const {
        std::vector<std::size_t> all;
        for (std::size_t k = 0; k < geometry_.size(); ++k) {
            const Pair pair = form_.pair_at(k);
            const bool lasts = (contact_ && *contact_ == pair) ||
                               (two_ && (two_->pairs[0] == pair || two_->pairs[1] == pair)) ||
                               std::find(face_.begin(), face_.end(), pair) != face_.end();
            const double tolerance = !has_started_ ? std::min(error(4), 1e-10) : error(lasts ? 8 : 4 - further_digits_);
            if (!(gap(k, motion_) > P(reach() * tolerance))) all.push_back(k);
        }
        return all;
    }

    /// Applies impacts until no touching point approaches, then selects the mode. `arrived`: the kind of event that led
    /// here, if the transition is not an impact.
    void transition(const EventKind* arrived) {
        form_.set_time(t_);
        if (rims_.update(geometry_, motion_.q)) leave_system();
        const std::vector<std::size_t> near = touching();
        if (t_ == stalled_at_) {
            if (++stalled_ > 1000) return fail(stalled_fault(near));
        } else {
            stalled_ = 0, stalled_at_ = t_;
        }
        const bool first = !has_started_;
        has_started_ = true;
        const System former = mode_;
        const std::optional<Pair> former_contact = contact_;
        const std::vector<Pair> former_face = face_;
        const std::optional<TwoContacts<P>> former_two = std::exchange(two_, std::nullopt);
        former_rotation_ = rotation_;
        set_rotation({});
        release_face();
        const double resting = resting_speed(first);
        Impacts impacts = std::exchange(pending_, {});
        apply_impacts(near, resting, 200, impacts);
        if (fails()) return;
        zeros_.assign(geometry_.size(), 0);
        std::optional<Pair> lasting;
        std::vector<Pair> all, resting_pairs;
        for (const std::size_t k : near) {
            const Pair pair = form_.pair_at(k);
            const ContactResponse<P> at = form_.response(pair, motion_);
            if (at.velocity[2] > P(resting)) {
                zeros_[k] = 1;
                continue;
            }
            resting_pairs.push_back(pair);
            if (Elementary<P>::magnitude(at.acceleration[2]) <= P(error(2)) * length(at.acceleration)) {
                // a contact on which nothing presses: its gap stays zero up to rounding
                zeros_[k] = 3;
                continue;
            }
            if (at.acceleration[2] > P(0) || !(at.acceleration[2] < P(0))) {
                const bool lifted = arrived && *arrived == EventKind::lifts_off;
                zeros_[k] = lifted ? 3 : 2;
                continue;
            }
            all.push_back(pair);
        }
        if (former_two && arrived) std::erase(all, *lifted_);
        if (resting_pairs.size() == 2 && is_ball() && !lifted_) {
            const std::array<bool, 2> presses = pressed_planes({resting_pairs[0], resting_pairs[1]});
            if (presses[0] && presses[1]) {
                if (impacts.accumulated) record(*impacts.accumulated, EventKind::accumulates);
                return enter_two({resting_pairs[0], resting_pairs[1]},
                                 {first, former, former_contact, former_two, impacts.landed});
            }
            for (std::size_t i = 0; i < 2; ++i)
                if (presses[1 - i] && !presses[i] && std::erase(all, resting_pairs[i]) > 0)
                    zeros_[index_of(resting_pairs[i])] = 2;
        }
        if (!all.empty()) lasting = all.front();
        if ((all.size() > 1 || (lasting && flat_rim(*lasting))) && !start_face(all)) return;
        if (former_two) return leave_planes(*former_two, lasting, impacts.landed);
        if (arrived && *arrived == EventKind::lifts_off) {
            if (lasting && former_contact && *lasting == *former_contact) lasting.reset();
            if (former_contact) zeros_[index_of(*former_contact)] = 3;
            for (const Pair& pair : former_face) zeros_[index_of(pair)] = 3;
            release_face();
        }
        enter_mode(lasting, first, former, former_contact, impacts.landed, impacts.accumulated);
    }
    /// A speed of separation below it is zero.
    double resting_speed(bool first) const {
        return speed() * (first ? 1e-12 : std::max(error(1), settings_.step_error));
    }
    /// Applies impacts until no touching point approaches, in at most `rounds` rounds. Returns whether there were any.
    bool apply_impacts(const std::vector<std::size_t>& near, double resting, int rounds, Impacts& impacts) {
        bool any = false;
        for (int round = 0; round < rounds; ++round) {
            if (impact_together(near, resting, impacts)) {
                if (fails()) return true;
                any = true;
                continue;
            }
            bool again = false;
            for (const std::size_t k : near) {
                const Pair pair = form_.pair_at(k);
                const ContactResponse<P> at = form_.response(pair, motion_);
                if (!(at.velocity[2] < P(-resting))) continue;
                if (flat_rim(pair) && !is_central(pair, at)) {
                    fail(on_a_rim("lands flat", pair));
                    return any;
                }
                if (!impact(pair, at, resting, impacts)) return true;
                again = any = true;
            }
            if (!again) return any;
        }
        if (rounds > 1) fail("simultaneous impacts do not end " + at_time());
        return any;
    }
    // lasting contacts with two planes
    /// What preceded a transition.
    struct Former {
        bool is_first = false;
        System mode = System::flight;
        std::optional<Pair> contact;
        std::optional<TwoContacts<P>> two;
        bool landed = false;
    };
    bool is_ball() const {
        const MassProperties<P> body = mass_properties<P>(scene_->body);
        bool is =
            geometry_.pieces.size() == 1 && !geometry_.pieces[0].extended && length(geometry_.pieces[0].center) == P(0);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) is = is && body.inertia[i][j] == (i == j ? body.inertia[0][0] : P(0));
        return is;
    }
    BallBetweenPlanes<P> ball_between(const std::array<Pair, 2>& pairs) const {
        const MassProperties<P> body = mass_properties<P>(scene_->body);
        BallBetweenPlanes<P> ball;
        ball.mass = body.mass, ball.moment = body.inertia[0][0], ball.radius = geometry_.pieces[0].radius;
        for (std::size_t i = 0; i < 2; ++i)
            ball.normal_W[i] = geometry_.planes[pairs[i].plane].normal_W, ball.friction[i] = mu(pairs[i]);
        const Vector3<P> line = cross(ball.normal_W[0], ball.normal_W[1]);
        const P sine = length(line);
        if (sine > P(0)) ball.line_W = (P(1) / sine) * line;
        ball.torque_W = form_.load_torque(motion_);
        // the acceleration of the contact point, without that by rotation
        const ContactResponse<P> at = form_.response(pairs[0], motion_);
        const Vector3<P> arm = -(ball.radius * ball.normal_W[0]);
        ball.acceleration_W = ContactAxes<P>(ball.normal_W[0]).to_world(at.acceleration) -
                              (P(1) / ball.moment) * cross(ball.torque_W, arm);
        ball.rounding = P(error(2));
        return ball;
    }
    // which of two planes that a ball touches press on it
    std::array<bool, 2> pressed_planes(const std::array<Pair, 2>& pairs) const {
        const BallBetweenPlanes<P> ball = ball_between(pairs);
        if (!(length(ball.line_W) > P(0))) return {false, false};
        const P least = P(error(2)) * ball.mass * length(ball.acceleration_W);
        const std::array<P, 2> N = ball.normal_forces();
        return {N[0] > least, N[1] > least};
    }
    /// u_i . d of both contacts.
    std::array<P, 2> slips_along(const BallBetweenPlanes<P>& ball) const {
        const Vector3<P> w = rotate(motion_.q, motion_.angular_velocity_B);
        std::array<P, 2> slips{};
        for (std::size_t i = 0; i < 2; ++i)
            slips[i] = dot(ball.line_W, motion_.velocity_W - ball.radius * cross(w, ball.normal_W[i]));
        return slips;
    }
    std::string two_planes(const std::array<Pair, 2>& pairs) const {
        return fmt::format("{} and {} {}", plane_at(pairs[0]), plane_at(pairs[1]), at_time());
    }
    // Why events repeat at one time. Friction at one plane may press a rotating ball to the other one, whose friction
    // lifts it.
    std::string stalled_fault(const std::vector<std::size_t>& near) const {
        if (near.size() == 2 && is_ball() && near[0] / geometry_.pieces.size() != near[1] / geometry_.pieces.size())
            return rotation_fault({form_.pair_at(near[0]), form_.pair_at(near[1])});
        return "too many events " + at_time();
    }
    std::string rotation_fault(const std::array<Pair, 2>& pairs) const {
        return "rotation about the line of two planes with friction is not supported: the ball touches " +
               two_planes(pairs);
    }
    // why the modes do not cover two contacts; empty if they do
    std::string two_contacts_fault(const BallBetweenPlanes<P>& ball, const std::array<Pair, 2>& pairs) const {
        for (const Pair& pair : pairs)
            if (const Plane& plane = scene_->planes[pair.plane];
                plane.rolling_friction > 0 || plane.torsional_friction > 0)
                return "torsional and rolling friction at two lasting contacts are not supported: the ball touches " +
                       two_planes(pairs);
        const P spin = ball.radius * dot(ball.line_W, rotate(motion_.q, motion_.angular_velocity_B));
        const bool rubs = ball.friction[0] > P(0) || ball.friction[1] > P(0);
        // the steps of a method do not keep a zero spin
        const double zero = std::max(error(3), settings_.steps ? std::sqrt(settings_.tolerance) : 0);
        if (rubs && Elementary<P>::magnitude(spin) > P(zero * speed())) return rotation_fault(pairs);
        const P twist = Elementary<P>::magnitude(dot(ball.line_W, ball.torque_W));
        if (rubs && twist > P(error(2)) * ball.mass * ball.radius * length(ball.acceleration_W))
            return "torques about the line of two planes with friction are not supported: the ball touches " +
                   two_planes(pairs);
        return "";
    }
    /// Starts or continues the contact of a ball with two planes.
    void enter_two(const std::array<Pair, 2>& pairs, const Former& former) {
        const BallBetweenPlanes<P> ball = ball_between(pairs);
        if (const std::string why = two_contacts_fault(ball, pairs); !why.empty()) return fail(why);
        std::array<int, 2> slip{};
        const std::array<P, 2> slips = slips_along(ball);
        for (std::size_t i = 0; i < 2; ++i)
            if (Elementary<P>::magnitude(slips[i]) > P(error(3) * speed())) slip[i] = slips[i] > P(0) ? 1 : -1;
        select_two(pairs, ball, slip, former);
    }
    void select_two(const std::array<Pair, 2>& pairs, const BallBetweenPlanes<P>& ball, const std::array<int, 2>& slip,
                    const Former& former) {
        const TwoContactChoice choice = TwoContactModes<P>(ball, slip).choose();
        if (!choice.found) return fail("no mode of two contacts is consistent with friction " + at_time());
        if (choice.is_pressed) return fail(pressed_fault(pairs));
        remove_slips(ball, slip);
        for (std::size_t i = 0; i < 2; ++i) slip_zeros_[i] = slip[i] == 0 && choice.slip[i] != 0 ? 1 : 0;
        two_ = TwoContacts<P>{pairs, choice.slip, ball.line_W};
        mode_ = System::two_contacts, contact_ = pairs[0];
        onset_.reset();
        if (former.is_first) return open_interval();
        bool changed = !former.two;
        for (std::size_t i = 0; i < 2; ++i) {
            const bool slides = choice.slip[i] != 0;
            bool known = false, slid = false;
            if (former.two)
                known = true, slid = former.two->slip[i] != 0;
            else if (former.contact && *former.contact == pairs[i])
                known = true, slid = former.mode != System::rolling;
            if (!known && !former.landed) record(pairs[i], EventKind::lands);
            if (!known || slid == slides) continue;
            changed = true;
            record(pairs[i], slides ? EventKind::slides : is_at_rest() ? EventKind::stops : EventKind::rolls);
        }
        if (changed) open_interval();
    }
    std::string pressed_fault(const std::array<Pair, 2>& pairs) const {
        return "the friction that presses a ball between two planes is not determined by rigid laws: the ball "
               "touches " +
               two_planes(pairs);
    }
    /// Removes the velocity across the line, the rotation about it where friction acts, and slips that are zero.
    void remove_slips(const BallBetweenPlanes<P>& ball, const std::array<int, 2>& slip) {
        const Vector3<P>& d = ball.line_W;
        Vector3<P> w = rotate(motion_.q, motion_.angular_velocity_B);
        P along = dot(d, motion_.velocity_W);
        const std::array<P, 2> slips = slips_along(ball);
        if (ball.friction[0] > P(0) || ball.friction[1] > P(0)) w = w - dot(w, d) * d;
        // u_i . d = V - r w . t_i, with unit vectors t_i and t_1 . t_2 = n_1 . n_2
        if (slip[0] == 0 && slip[1] == 0) {
            const Vector3<P> t[2] = {cross(ball.normal_W[0], d), cross(ball.normal_W[1], d)};
            const P c = ball.cosine(), scale = P(1) / (ball.radius * (P(1) - c * c));
            w = w + scale * ((slips[0] - c * slips[1]) * t[0] + (slips[1] - c * slips[0]) * t[1]);
        } else if (slip[0] == 0 || slip[1] == 0) {
            along = along - slips[slip[0] == 0 ? 0 : 1];
        }
        motion_.velocity_W = along * d;
        motion_.angular_velocity_B = rotate_back(motion_.q, w);
    }
    // One or both of two contacts end.
    void leave_planes(const TwoContacts<P>& two, const std::optional<Pair>& lasting, bool landed) {
        System former = System::flight;
        std::optional<Pair> stays;
        for (std::size_t i = 0; i < 2; ++i) {
            if (lasting && two.pairs[i] == *lasting) {
                stays = lasting, former = two.slip[i] == 0 ? System::rolling : System::sliding;
                continue;
            }
            record(two.pairs[i], EventKind::lifts_off);
            if (lifted_ && *lifted_ == two.pairs[i]) zeros_[index_of(*lifted_)] = 3;
        }
        lifted_.reset();
        enter_mode(lasting, false, former, stays, landed, {});
        if (!fails()) open_interval();
    }
    void release_face() {
        face_.clear(), edge_B_.reset();
        form_.permit({});
    }
    /// Starts contact at several points of one plane: without rotation on a face (with a spin if it is smooth), in
    /// planar motion along an edge.
    /// Returns false if the motion cannot be followed.
    bool start_face(const std::vector<Pair>& points) {
        const auto other = std::find_if(points.begin(), points.end(),
                                        [&](const Pair& pair) { return pair.plane != points.front().plane; });
        if (other != points.end()) {
            fail(fmt::format("lasting contacts with several planes are not supported: the body touches {} and {} {}",
                             plane_at(points.front()), plane_at(*other), at_time()));
            return false;
        }
        face_ = points;
        if (!spans_area(points)) return start_edge();
        if (length(motion_.angular_velocity_B) * P(reach()) <= P(error(6) * speed())) {
            motion_.angular_velocity_B = Vector3<P>();
            form_.permit({PermittedRotation<P>::Kind::none});
            return true;
        }
        // a smooth face may spin about a principal axis
        const bool is_smooth = !(mu(points.front()) > P(0));
        if (is_smooth && permit_axis(rotate_back(motion_.q, geometry_.planes[points.front().plane].normal_W)))
            return true;
        fail(spins_on_face());
        return false;
    }
    /// Restricts the rotation to an axis. Returns false if it is not principal, or if the body rotates about others.
    bool permit_axis(const Vector3<P>& axis_B) {
        constexpr double principal = 1e-12;
        const Vector3<P> Ia = mass_properties<P>(scene_->body).inertia * axis_B;
        const P moment = dot(axis_B, Ia), turn = dot(axis_B, motion_.angular_velocity_B);
        const Vector3<P> others = motion_.angular_velocity_B - turn * axis_B;
        if (length(others) * P(reach()) > P(error(6) * speed())) return false;
        if (length(Vector3<P>(Ia - moment * axis_B)) > P(principal) * moment) return false;
        motion_.angular_velocity_B = turn * axis_B;
        form_.permit({PermittedRotation<P>::Kind::about_axis, axis_B, moment});
        return true;
    }
    /// Starts contact along an edge in planar motion: the body rotates about a principal axis parallel to the edge. Its
    /// motion then does not depend on how the force is distributed along the edge.
    bool start_edge() {
        const Plane& plane = scene_->planes[face_.front().plane];
        if (plane.rolling_friction > 0 || plane.torsional_friction > 0) {
            fail(fmt::format("touches {} along an edge {}: torsional and rolling friction are not supported there",
                             plane_at(face_.front()), at_time()));
            return false;
        }
        const Vector3<P> n = rotate_back(motion_.q, geometry_.planes[face_.front().plane].normal_W);
        Vector3<P> along;
        for (const Pair& pair : face_) {
            const Vector3<P> from_first =
                geometry_.pieces[pair.piece].lowest_point(n) - geometry_.pieces[face_.front().piece].lowest_point(n);
            if (length(from_first) > length(along)) along = from_first;
        }
        const Vector3<P> axis = (P(1) / length(along)) * along;
        if (!permit_axis(axis)) {
            fail(undetermined_edge());
            return false;
        }
        edge_B_ = axis;
        return true;
    }
    std::string undetermined_edge() const {
        return fmt::format("touches {} along an edge {}: the forces at two points are not determined by rigid laws",
                           plane_at(face_.front()), at_time());
    }
    std::string spins_on_face() const {
        return fmt::format("spins on a face {}: the pressure under a face is not determined by rigid laws", at_time());
    }
    // the rim of this contact, if it is parallel to the plane
    const typename FlatRims<P>::Rim* flat_rim(Pair pair) const {
        return rims_.flat(geometry_, pair.plane, pair.piece, motion_.q);
    }
    // Whether an impact on a whole rim acts at its centre: by symmetry, if it neither slips with friction nor turns the
    // body.
    bool is_central(Pair pair, const ContactResponse<P>& at) const {
        const Vector3<double> arm = face_point(pair);
        const Vector3<P> n = rotate_back(motion_.q, geometry_.planes[pair.plane].normal_W);
        const P slip = length(Vector3<P>(at.velocity[0], at.velocity[1], P(0)));
        const P turn = P(reach()) * length(cross(n, motion_.angular_velocity_B)), small(error(2) * speed());
        return (!(mu(pair) > P(0)) || slip <= small) && turn <= small && std::hypot(arm[0], arm[1]) <= 1e-12 * reach();
    }
    std::string on_a_rim(const char* what, Pair pair) const {
        return fmt::format("{} on {} {}: impulses along a rim are not determined by rigid laws", what, plane_at(pair),
                           at_time());
    }
    // the point of the face in the contact's axes, from the centre of mass, m
    Vector3<double> face_point(Pair pair) const {
        const ContactPlane<P>& plane = geometry_.planes[pair.plane];
        const Vector3<P> n = rotate_back(motion_.q, plane.normal_W);
        const Vector3<P> arm = rotate(motion_.q, geometry_.pieces[pair.piece].lowest_point(n));
        return cast<double>(ContactAxes<P>(plane.normal_W).from_world(arm));
    }
    bool spans_area(const std::vector<Pair>& points) const {
        if (std::ranges::any_of(points, [&](const Pair& pair) { return flat_rim(pair) != nullptr; })) return true;
        double largest = 0;
        const Vector3<double> a = face_point(points[0]);
        for (const Pair& second : points)
            for (const Pair& third : points) {
                const Vector3<double> b = face_point(second) - a, c = face_point(third) - a;
                largest = std::max(largest, std::abs(b[0] * c[1] - b[1] * c[0]));
            }
        return largest > 1e-9 * reach() * reach();
    }
    // the force of the plane on a face or an edge, in the contact's axes
    Vector3<P> face_force() const {
        const ContactResponse<P> at = form_.response(*contact_, motion_);
        if (mode_ == System::rolling) return -(inverse(at.matrix) * at.acceleration);
        const P slip = square_root(P(at.velocity[0] * at.velocity[0] + at.velocity[1] * at.velocity[1]));
        Vector3<P> direction;
        if (onset_)
            direction = *onset_;
        else if (slip > P(0))
            direction = Vector3<P>(at.velocity[0] / slip, at.velocity[1] / slip, P(0));
        const P& friction = mu(*contact_);
        const Vector3<P> f(-friction * direction[0], -friction * direction[1], P(1));
        return -(at.acceleration[2] / Vector3<P>(at.matrix * f)[2]) * f;
    }
    /// The pressure under a face acts at a point (x, y) where it balances the moment of loads and friction about the
    /// centre of mass. The body tips over if this point is not within the face, and rotates if a moment about the
    /// normal remains.
    void check_face() {
        if (face_.empty() || fails()) return;
        const ContactAxes<P> axes(geometry_.planes[contact_->plane].normal_W);
        const Vector3<double> F = cast<double>(face_force());
        const Vector3<double> M = cast<double>(axes.from_world(-form_.load_torque(motion_)));
        if (edge_B_) return check_edge(cast<double>(axes.from_world(rotate(motion_.q, *edge_B_))), F, M);
        const double h = -face_point(face_.front())[2];
        const double y = (M[0] - h * F[1]) / F[2], x = -(M[1] + h * F[0]) / F[2];
        if (std::abs(M[2] - (x * F[1] - y * F[0])) > 1e-9 * F[2] * reach()) return fail(spins_on_face());
        if (!is_within_face(x, y)) fail(fmt::format("tips over {}", at_time()));
    }
    // The force along an edge acts at p + x e, where it balances the moment M about the horizontal direction across the
    // edge; the moment about the normal must vanish.
    void check_edge(const Vector3<double>& e, const Vector3<double>& F, const Vector3<double>& M) {
        const Vector3<double> p = face_point(face_.front()), normal(0, 0, 1), across = cross(normal, e);
        const Vector3<double> rest = cross(p, F) - M;
        const double x = dot(rest, across) / F[2];
        if (std::abs(dot(rest, normal) + x * dot(F, across)) > 1e-9 * F[2] * reach()) return fail(undetermined_edge());
        double least = 0, most = 0;
        for (const Pair& pair : face_) {
            const double place = dot(e, Vector3<double>(face_point(pair) - p));
            least = std::min(least, place), most = std::max(most, place);
        }
        const double rounding = 1e-12 * reach();
        if (x < least - rounding || x > most + rounding) fail(fmt::format("tips over {}", at_time()));
    }
    // whether the point is on the inner side of each border of the face
    bool is_within_face(double x, double y) const {
        const double rounding = 1e-12 * reach() * reach();
        for (const Pair& pair : face_)
            if (const auto* rim = flat_rim(pair)) {
                const Vector3<double> middle = face_point(pair);
                const double radius = static_cast<double>(rim->radius);
                if (std::hypot(x - middle[0], y - middle[1]) <= radius * (1 + 1e-12)) return true;
            }
        if (face_.size() < 3) return false;
        for (const Pair& first : face_)
            for (const Pair& second : face_) {
                const Vector3<double> a = face_point(first), edge = face_point(second) - a;
                const auto side = [&](double px, double py) { return edge[0] * (py - a[1]) - edge[1] * (px - a[0]); };
                bool is_border = hypotenuse(edge) > 0;
                for (const Pair& other : face_) {
                    const Vector3<double> c = face_point(other);
                    is_border = is_border && side(c[0], c[1]) >= -rounding;
                }
                if (is_border && side(x, y) < -rounding) return false;
            }
        return true;
    }
    std::size_t index_of(Pair pair) const { return pair.plane * geometry_.pieces.size() + pair.piece; }

    void record(Pair pair, EventKind kind) { run_.record.events.push_back({t_, pair.plane, kind, P(0), {}}); }

    void enter_mode(std::optional<Pair> lasting, bool first, System former, std::optional<Pair> former_contact,
                    bool landed, std::optional<Pair> accumulated) {
        System next = System::flight;
        if (lasting) {
            const std::optional<System> found = contact_mode(*lasting);
            if (fails()) return;
            if (found)
                next = *found;
            else
                zeros_[index_of(*lasting)] = 2, lasting.reset();
        }
        record_mode(next, lasting, first, former, former_contact, landed, accumulated);
    }
    void record_mode(System next, std::optional<Pair> lasting, bool first, System former,
                     std::optional<Pair> former_contact, bool landed, std::optional<Pair> accumulated) {
        if (accumulated) record(*accumulated, EventKind::accumulates);
        const bool continues = former_contact && lasting && *former_contact == *lasting;
        if (!first && !landed) {
            if (former_contact && !continues && former != System::flight && !lasting)
                record(*former_contact, EventKind::lifts_off);
            if (lasting && !continues && !accumulated) record(*lasting, EventKind::lands);
            if (lasting && continues) record_rotation(*lasting, next);
            if (lasting && continues && next != former)
                record(*lasting, next == System::sliding ? EventKind::slides
                                 : is_at_rest()          ? EventKind::stops
                                                         : EventKind::rolls);
        }
        const bool same =
            continues && next == former && !first && rotation_.has_equations_of(former_rotation_) && !onset_;
        mode_ = next, contact_ = lasting;
        if (!contact_) release_face();
        check_face();
        if (!same) open_interval();
    }

    // records the events of spin and rolling. A body that comes to rest stops: the other events say nothing more.
    void record_rotation(Pair pair, System next) {
        if (!rotation_.acts) return;
        const RotationFriction<P>& former = former_rotation_;
        const bool rests = next == System::rolling && rotation_.holds_rolling && is_at_rest();
        if (rests && mode_ == System::rolling && !former.holds_rolling) return record(pair, EventKind::stops);
        if (rests && mode_ == System::rolling && former.spin != 0 && rotation_.holds_spin)
            return record(pair, EventKind::stops);
        if (rests && mode_ == System::sliding) return;
        if (rotation_.holds_rolling != former.holds_rolling)
            record(pair, rotation_.holds_rolling ? EventKind::rolling_stops : EventKind::rolling_starts);
        if (rotation_.holds_spin != former.holds_spin)
            record(pair, rotation_.holds_spin ? EventKind::spin_stops : EventKind::spin_starts);
    }
    void set_rotation(const RotationFriction<P>& rotation) {
        rotation_ = rotation;
        form_.set_rotation(rotation_);
    }
    /// Selects the mode on a plane with torsional or rolling friction. Velocities below the error of the steps become
    /// exactly zero.
    std::optional<System> rotation_mode(Pair pair, const Plane& plane) {
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        RotatingContact<P> contact = rotating_contact(pair, axes);
        contact.friction = P(plane.friction), contact.rolling = P(plane.rolling_friction);
        contact.torsional = P(plane.torsional_friction), contact.rounding = P(error(2));
        const Vector3<P> u = form_.response(pair, motion_).velocity;
        const P small(zero_slip());
        const Vector3<P> w = axes.from_world(rotate(motion_.q, motion_.angular_velocity_B));
        if (length(Vector3<P>(u[0], u[1], P(0))) > small || !(contact.friction > P(0)))
            contact.slip = Vector3<P>(u[0], u[1], P(0));
        if (length(Vector3<P>(w[0], w[1], P(0))) * P(reach()) > small || !(contact.rolling > P(0)))
            contact.angular_velocity[0] = w[0], contact.angular_velocity[1] = w[1];
        if (Elementary<P>::magnitude(w[2]) * P(reach()) > small || !(contact.torsional > P(0)))
            contact.angular_velocity[2] = w[2];
        const std::optional<RotationMode<P>> found = RotationModeChoice<P>(contact, exceeded_).choose();
        exceeded_ = Exceeded::none;
        if (!found) {
            fail("no mode of sliding and rolling is consistent with friction " + at_time());
            return {};
        }
        // v = u - w x s
        motion_.angular_velocity_B = rotate_back(motion_.q, axes.to_world(contact.angular_velocity));
        motion_.velocity_W = axes.to_world(contact.slip - cross(contact.angular_velocity, contact.arm));
        enter_rotation_mode(*found, contact, axes);
        return found->slides ? System::sliding : System::rolling;
    }
    // masses, arm and accelerations without forces of the plane, in the axes of the contact
    RotatingContact<P> rotating_contact(Pair pair, const ContactAxes<P>& axes) const {
        const MassProperties<P> body = mass_properties<P>(scene_->body);
        const Matrix3<P> inverse_inertia = inverse(body.inertia);
        const Vector3<P>& w = motion_.angular_velocity_B;
        const auto to_axes = [&](const Vector3<P>& v_B) { return axes.from_world(rotate(motion_.q, v_B)); };
        const Vector3<P> tau = rotate_back(motion_.q, form_.load_torque(motion_));
        RotatingContact<P> contact;
        contact.inverse_mass = P(1) / body.mass;
        contact.arm = to_axes(geometry_.pieces[pair.piece].lowest_point(rotate_back(motion_.q, axes.normal_W)));
        contact.acceleration = form_.response(pair, motion_).acceleration;
        contact.angular_acceleration = to_axes(inverse_inertia * (tau - cross(w, body.inertia * w)));
        for (std::size_t j = 0; j < 3; ++j) {
            const Vector3<P> column = to_axes(inverse_inertia * rotate_back(motion_.q, axes[j]));
            for (std::size_t i = 0; i < 3; ++i) contact.inverse_inertia[i][j] = column[i];
        }
        return contact;
    }
    // the path that starts now along a direction in the axes of the contact
    SlipPath<P> straight_path(const ContactAxes<P>& axes, const Vector3<P>& direction) const {
        const Vector3<P> direction_W = axes.to_world(direction);
        return {direction_W, cross(axes.normal_W, direction_W), {}, t_};
    }
    void enter_rotation_mode(const RotationMode<P>& mode, const RotatingContact<P>& contact,
                             const ContactAxes<P>& axes) {
        RotationFriction<P> rotation;
        rotation.acts = true;
        rotation.rolling = contact.rolling, rotation.torsional = contact.torsional;
        rotation.holds_rolling = mode.holds_rolling, rotation.holds_spin = mode.holds_spin, rotation.spin = mode.spin;
        rotation.starts_rolling = mode.rolling_start.has_value();
        if (mode.rolling_start) rotation.path = straight_path(axes, *mode.rolling_start);
        spin_zeros_ = contact.angular_velocity[2] == P(0) ? 1 : 0;
        onset_ = mode.slip_start;
        set_rotation(rotation);
    }

    bool is_at_rest() const {
        const P small(error(6) * speed());
        return length(motion_.velocity_W) <= small && length(motion_.angular_velocity_B) * P(reach()) <= small;
    }

    // the mode of a contact whose point does not approach; nothing if the contact force would pull
    std::optional<System> contact_mode(Pair pair) {
        onset_.reset();
        const Plane& plane = scene_->planes[pair.plane];
        // a face does not rotate
        if (face_.empty() && (plane.rolling_friction > 0 || plane.torsional_friction > 0))
            return rotation_mode(pair, plane);
        const ContactResponse<P> at = form_.response(pair, motion_);
        const P friction = mu(pair);
        if (!(friction > P(0))) return System::sliding;
        const P slip = square_root(P(at.velocity[0] * at.velocity[0] + at.velocity[1] * at.velocity[1]));
        if (slip > P(zero_slip())) {
            const Vector3<P> direction(at.velocity[0] / slip, at.velocity[1] / slip, P(0));
            const SlidingStart<P> start = sliding_start(at, friction, direction);
            if (!(start.stiffness > P(0))) {
                fail("Painleve's paradox " + at_time());
                return {};
            }
            return System::sliding;
        }
        if (is_admissible(rolling_force(at), friction, P(error(2)))) return System::rolling;
        const std::optional<Vector3<P>> direction = slip_direction(at, friction);
        if (!direction) {
            fail("Painleve's paradox " + at_time());
            return {};
        }
        onset_ = direction;
        return System::sliding;
    }

    /// Applies the impact at a pair. Returns false if the motion cannot be followed.
    bool impact(Pair pair, const ContactResponse<P>& before, double resting, Impacts& impacts) {
        const BodyMotion<P> start = motion_;
        if (!resolve_shock(pair, before, scene_->planes[pair.plane])) return false;
        return note_impact(pair, start, P(-before.velocity[2]), resting, impacts);
    }
    /// Without friction, the impacts of several points on one plane at one time follow Moreau's law (motion/impact.h),
    /// which does not depend on their order: a box that lands flat stays flat. Returns whether there were any.
    bool impact_together(const std::vector<std::size_t>& near, double resting, Impacts& impacts) {
        if (near.size() < 2) return false;
        std::vector<Pair> approaching;
        P approach(0);
        for (const std::size_t k : near) {
            const Pair pair = form_.pair_at(k);
            const P speed = -form_.response(pair, motion_).velocity[2];
            if (!(speed > P(resting))) continue;
            approaching.push_back(pair);
            approach = std::max(approach, speed);
        }
        if (approaching.size() < 2 || mu(approaching.front()) > P(0)) return false;
        const std::size_t number = approaching.front().plane;
        if (std::ranges::any_of(approaching, [&](const Pair& pair) { return pair.plane != number; })) return false;
        const ContactPlane<P>& plane = geometry_.planes[number];
        const MassProperties<P> mass = mass_properties<P>(scene_->body);
        const Vector3<P> n = rotate_back(motion_.q, plane.normal_W);
        std::vector<Contact<P>> contacts;
        for (const std::size_t k : near)
            if (const Pair pair = form_.pair_at(k); pair.plane == number)
                contacts.push_back(
                    {motion_.position_W + rotate(motion_.q, geometry_.pieces[pair.piece].lowest_point(n)),
                     plane.normal_W, plane.restitution, P(0)});
        ImpactBody<P> body{P(1) / mass.mass, rotated(Matrix3<P>(inverse(mass.inertia)), motion_.q), motion_.position_W,
                           motion_.velocity_W, rotate(motion_.q, motion_.angular_velocity_B)};
        if (!resolve_impact(body, contacts).resolved) {
            fail("no impulses were found for simultaneous contacts " + at_time());
            return true;
        }
        const BodyMotion<P> start = motion_;
        motion_.velocity_W = body.velocity_W;
        // impulses that balance leave a rotation of the size of rounding errors
        const Vector3<P> jump = rotate_back(motion_.q, body.angular_velocity_W) - motion_.angular_velocity_B;
        if (P(reach()) * length(jump) > contact_rounding(approach))
            motion_.angular_velocity_B = motion_.angular_velocity_B + jump;
        const auto separation = [&](const Pair& pair) { return form_.response(pair, motion_).velocity[2]; };
        Pair fastest = approaching.front();
        for (const Pair& pair : approaching)
            if (separation(pair) > separation(fastest)) fastest = pair;
        note_impact(fastest, start, approach, resting, impacts);
        return true;
    }
    /// Records an impact that has changed the motion `start`, and sums the impacts that follow if they accumulate.
    bool note_impact(Pair pair, const BodyMotion<P>& start, const P& approach, double resting, Impacts& impacts) {
        constexpr std::size_t most_impacts = 100'000;
        const Plane& plane = scene_->planes[pair.plane];
        const P separation = form_.response(pair, motion_).velocity[2];
        const P mass = mass_properties<P>(scene_->body).mass;
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        const Vector3<P> impulse = mass * (motion_.velocity_W - start.velocity_W);
        const P normal = dot(impulse, axes.normal_W);
        const bool separates = separation > P(resting);
        // below this speed the rest of a series of impacts is a geometric sum to the accuracy of the steps
        const bool accumulates = plane.restitution > 0 && !separates;
        run_.record.events.push_back({t_, pair.plane, separates || accumulates ? EventKind::impact : EventKind::lands,
                                      normal, impulse - normal * axes.normal_W});
        if (!separates || accumulates) {
            impacts.landed = true;
            if (accumulates) impacts.accumulated = pair, sum_impacts(pair, separation, P(separation / approach));
        }
        note_sizes();
        if (run_.record.events.size() > most_impacts) {
            fail("too many impacts " + at_time());
            return false;
        }
        return true;
    }

    /// The flights after an impact with the separation speed u last 2 u / |c| (1 + r + r^2 + ..), where r is the ratio
    /// of successive speeds and c the normal acceleration. Moves the body over this time and removes the normal
    /// velocity.
    void sum_impacts(Pair pair, const P& separation, const P& ratio) {
        // the impulses that remain change the slip as well
        constexpr double most_change = 100;
        const double left = static_cast<double>(P(separation / (P(1) - ratio)));
        if (left > 0) summed_slip_ = std::max(summed_slip_, most_change * left);
        const ContactResponse<P> at = form_.response(pair, motion_);
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        motion_.velocity_W = motion_.velocity_W - at.velocity[2] * axes.normal_W;
        if (!(separation > P(0)) || !(at.acceleration[2] < P(0)) || !(ratio < P(1))) return;
        const P rest = P(-2) * separation / (at.acceleration[2] * (P(1) - ratio));
        t_ = t_ + rest;
        form_.set_time(t_);
        const P half = rest / P(2);
        const Vector3<P> turn = half * motion_.angular_velocity_B;
        motion_.q = normalized(motion_.q * Quaternion<P>{P(1), turn[0], turn[1], turn[2]});
        motion_.position_W = motion_.position_W + rest * motion_.velocity_W;
        // the contact point has moved over the rotating body
        motion_.velocity_W = motion_.velocity_W - form_.response(pair, motion_).velocity[2] * axes.normal_W;
    }

    /// How far an impact has come.
    struct Shock {
        bool compressing = true;
        P impulse{0}, work{0};                          // since the start
        P compression_impulse{0}, compression_work{0};  // at the end of compression
        P approach{0};                                  // u_n at the start
        double speed = 0;                               // |u| at the start: errors are relative to it
        double zero_slip = 0;                           // a slip below it is zero
    };
    // what remains until the impact ends, given the normal velocity, the impulse and the work
    static P remaining(const Plane& plane, const Shock& shock, const P& normal, const P& impulse, const P& work) {
        const P e(plane.restitution);
        switch (plane.restitution_law) {
            case RestitutionLaw::stronge:
                return -e * e * shock.compression_work - (work - shock.compression_work);
            case RestitutionLaw::poisson:
                return (P(1) + e) * shock.compression_impulse - impulse;
            case RestitutionLaw::newton:
                break;
        }
        return -e * shock.approach - normal;
    }

    /// The impact of a ball. K is diagonal, so the slip keeps its direction and the normal motion is independent of
    /// friction. All laws of restitution give the normal impulse p = -(1 + e) u_n / K_nn, and friction gives the
    /// smaller of mu p and |u_t| / K_tt against the slip.
    void strike_ball(Pair pair, const ContactResponse<P>& before, const Plane& plane) {
        const P normal = -(P(1) + P(plane.restitution)) * before.velocity[2] / before.matrix[2][2];
        Vector3<P> impulse(P(0), P(0), normal);
        const P slip =
            square_root(P(before.velocity[0] * before.velocity[0] + before.velocity[1] * before.velocity[1]));
        if (slip > P(0)) {
            const P share = std::min(P(mu(pair) * normal), P(slip / before.matrix[0][0])) / slip;
            impulse[0] = -share * before.velocity[0], impulse[1] = -share * before.velocity[1];
        }
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        form_.push(motion_, pair, axes.to_world(impulse));
    }
    bool resolve_shock(Pair pair, const ContactResponse<P>& before, const Plane& plane) {
        // in binary64 the shock equations are integrated, so that the two check each other
        if constexpr (!std::is_same_v<P, double>)
            if (is_ball()) {
                strike_ball(pair, before, plane);
                return true;
            }
        Shock shock;
        shock.approach = before.velocity[2];
        shock.speed = static_cast<double>(length(before.velocity));
        // impacts that accumulate are as slow as the accuracy allows
        const double rounding = 1e3 * static_cast<double>(Elementary<P>::epsilon());
        shock.zero_slip = std::max(error(2) * shock.speed, rounding * speed());
        const P slip =
            square_root(P(before.velocity[0] * before.velocity[0] + before.velocity[1] * before.velocity[1]));
        if (mu(pair) > P(0) && slip > P(shock.zero_slip)) {
            const std::optional<bool> ended = follow_shock(pair, plane, shock);
            if (!ended) return false;
            if (*ended) return true;
        }
        return finish_shock(pair, plane, shock);
    }

    // The part of an impact without a change of direction: sticking, or slip from zero in a constant direction.
    bool finish_shock(Pair pair, const Plane& plane, Shock& shock) {
        ContactResponse<P> at = form_.response(pair, motion_);
        Vector3<P> f(P(0), P(0), P(1));
        if (mu(pair) > P(0)) {
            at.acceleration = Vector3<P>(P(0), P(0), P(-1));
            const Vector3<P> stick = rolling_force(at);
            if (is_admissible(stick, mu(pair), P(error(2)))) {
                f = (P(1) / stick[2]) * stick;
            } else {
                const std::optional<Vector3<P>> direction = slip_direction(at, mu(pair));
                if (!direction) {
                    fail("the impact has no consistent direction of slip " + at_time());
                    return false;
                }
                f = Vector3<P>(-mu(pair) * (*direction)[0], -mu(pair) * (*direction)[1], P(1));
            }
        }
        const P slope = (at.matrix * f)[2];
        P normal = at.velocity[2], total(0);
        const auto add = [&](const P& impulse) {
            shock.work = shock.work + normal * impulse + slope * impulse * impulse / P(2);
            shock.impulse = shock.impulse + impulse;
            normal = normal + slope * impulse, total = total + impulse;
        };
        if (shock.compressing) {
            add(P(-normal / slope));
            normal = P(0);
            end_compression(shock);
        }
        switch (plane.restitution_law) {
            case RestitutionLaw::stronge: {
                // normal j + slope j^2 / 2 = what remains of the work
                const P rest = remaining(plane, shock, normal, shock.impulse, shock.work);
                if (rest > P(0)) add(P((square_root(P(normal * normal + P(2) * slope * rest)) - normal) / slope));
                break;
            }
            case RestitutionLaw::poisson:
                add(remaining(plane, shock, normal, shock.impulse, shock.work));
                break;
            case RestitutionLaw::newton:
                if (const P rest = remaining(plane, shock, normal, shock.impulse, shock.work); rest > P(0))
                    add(P(rest / slope));
                break;
        }
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        form_.push(motion_, pair, axes.to_world(total * f));
        return true;
    }
    static void end_compression(Shock& shock) {
        shock.compressing = false;
        shock.compression_impulse = shock.impulse, shock.compression_work = shock.work;
    }

    /// Follows an impact while it slips. Returns whether it ended (otherwise the slip did); nothing on a fault.
    std::optional<bool> follow_shock(Pair pair, const Plane& plane, Shock& shock) {
        form_.select(System::shock, pair);
        const int n = form_.dimension(), clock = form_.clock(), work = form_.work(), normal = clock + 1;
        std::vector<P> y(n);
        form_.start(motion_, P(0), y.data());
        const Sizes sizes{shock.speed / reach(), sizes_.position, shock.speed};
        // errors above the limit at which a slip is zero would keep it from its end
        const double digits = std::max(settings_.digits, settings_.event_digits);
        Series<T> series(cast_recording<T>(record_form(n)), settings_.order);
        for (;;) {
            if (!may_step()) return {};
            for (int i = clock + 1; i < n; ++i) y[i] = P(0);
            series.expand(y.data());
            const auto coefficient = [&](int i, int k) { return static_cast<P>(series.coefficient(i, k)); };
            const P square = coefficient(clock + 2, 1), growth = P(2) * coefficient(clock + 2, 2);
            if (square <= P(shock.zero_slip) * P(shock.zero_slip) && !(growth > P(0))) {
                motion_ = form_.motion(y.data());
                shock.impulse = y[clock], shock.work = y[work];
                return false;
            }
            const std::vector<Block> blocks = form_.blocks(sizes, std::sqrt(static_cast<double>(square)));
            P h(step_of(series, blocks, digits));
            bool ends = false, compressed = false;
            if (shock.compressing) {
                std::vector<P> approach;
                for (int k = 1; k <= settings_.order; ++k) approach.push_back(P(-k) * coefficient(normal, k));
                if (const auto root = FirstRoot<P>(approach, 0, h, 0).find()) h = *root, compressed = true;
            } else {
                std::vector<P> rest;
                for (int k = 0; k < settings_.order; ++k) {
                    const P velocity = P(k + 1) * coefficient(normal, k + 1);
                    Shock only = shock;
                    if (k > 0) only.approach = only.compression_impulse = only.compression_work = P(0);
                    rest.push_back(remaining(plane, only, velocity, coefficient(clock, k), coefficient(work, k)));
                }
                if (const auto root = FirstRoot<P>(rest, 0, h, 0).find()) h = *root, ends = true;
            }
            series.evaluate(h, y.data());
            if (compressed) {
                shock.impulse = y[clock], shock.work = y[work];
                end_compression(shock);
                ends = plane.restitution == 0;
            }
            if (ends) {
                motion_ = form_.motion(y.data());
                return true;
            }
        }
    }

    Recording<P> record_form(int n) const { return polhode::record<P>(form_, n); }
    bool may_step() {
        if (run_.steps++ >= settings_.max_steps) fail("the step limit is reached " + at_time());
        if (const char* why = settings_.stop()) fail(why);
        return !fails();
    }

    void leave_system() {
        series_.reset();
        steps_.end_mode();
    }
    template <class Expanded>
    double step_of(const Expanded& series, const std::vector<Block>& blocks) const {
        return step_of(series, blocks, step_digits());
    }
    template <class Expanded>
    double step_of(const Expanded& series, const std::vector<Block>& blocks, double digits) const {
        return settings_.step_factor * taylor_step(series, series.order(), blocks, digits);
    }
    // The series of the observed functions must converge as well. Their sizes: the body's length for gaps, the contact
    // force for forces, and its square for the cone.
    template <class Expanded>
    double observed_step(const Expanded& series, const Step& step) const {
        const int first = step.clock + 1, own = form_.own_functions(), all = form_.first_variable() - first;
        const int rotation = rotation_.acts && contact_ ? form_.first_rotation_function() - first : own;
        double force = 0;
        for (int i = 0; i < rotation; ++i)
            if (i != 1 && !(two_ && (i == 2 || i == 3)))
                force = std::max(force, std::abs(static_cast<double>(step.coefficient(first + i, 1))));
        double log2_step = std::numeric_limits<double>::infinity();
        for (int i = 0; i < all; ++i) {
            if (i < own && (i == 1 || i == 5) && mode_ == System::sliding) continue;
            if (i == rotation && i < own && !rotation_.holds_rolling) continue;
            if (i == rotation + 2 && i < own) continue;
            const double scale = i >= own        ? reach()
                                 : two_          ? two_scale(i, force)
                                 : i >= rotation ? rotation_scale(i - rotation, force)
                                 : i == 1        ? force * force
                                                 : force;
            for (int k = series.order() - 4; k < series.order(); ++k) {
                const double size = log2_magnitude(series.coefficient(first + i, k + 1)) + std::log2(k + 1);
                log2_step = std::min(log2_step, (std::log2(scale) - step_digits() * std::log2(10.0) - size) / k);
            }
        }
        return settings_.step_factor * std::exp2(std::min(log2_step, 1000.0));
    }
    // scale of a function of two contacts
    double two_scale(int i, double force) const {
        if (i != 2 && i != 3) return force;
        return two_->slip[static_cast<std::size_t>(i - 2)] != 0 ? speed() : force * force;
    }
    // scale of a function of torsional and rolling friction
    double rotation_scale(int i, double force) const {
        const double rolling = static_cast<double>(rotation_.rolling) * force,
                     torsional = static_cast<double>(rotation_.torsional) * force;
        if (i == 0) return rolling * rolling;
        if (i == 1) return rotation_.holds_spin ? torsional * torsional : sizes_.angular_velocity;
        return rolling + torsional;
    }

    // Adds the end of a motion that starts from zero, if its path is known as a series: it returns to zero before the
    // first event. `along`: index of the integral of the acceleration along the path.
    void look_for_end(const Step& step, int along, std::size_t zeros, typename Found::What what,
                      std::optional<Found>& first) const {
        if (zeros == 0) return;
        std::vector<P> function;
        for (int k = 0; k <= step.order(); ++k) function.push_back(step.coefficient(along, k));
        const auto root = FirstRoot<P>(function, zeros, step.length, 0).find();
        if (root && (!first || *root < first->s)) first = Found{*root, what, 0};
    }
    // Relative rounding error of a gap with a zero of this order at the start of the step. Nothing may press on a
    // contact with a zero of order 3, so that its gap consists of rounding errors.
    double gap_rounding(std::size_t zeros) const {
        const double least = 1e-6 * error() * error();
        if (zeros < 3) return least;
        return std::max(least, std::min(1e3 * static_cast<double>(Elementary<P>::epsilon()), 1e-30));
    }
    // the first event within the step
    std::optional<Found> first_event(const Step& step) const {
        std::optional<Found> first;
        look_for_end(step, step.clock + 6, slip_start_, Found::What::slip, first);
        look_for_end(step, form_.first_rotation_function() + 2, rolling_start_, Found::What::end_of_rolling, first);
        const auto look = [&](int index, std::size_t zeros, double noise, typename Found::What what, std::size_t pair) {
            std::vector<P> function;
            for (int k = 1; k <= step.order(); ++k) function.push_back(P(k) * step.coefficient(index, k));
            if (step.expansion.is_of_method() && zeros > 0) {
                std::vector<P> exact;
                for (int k = 1; k <= order_of_starts; ++k)
                    exact.push_back(P(k) * static_cast<P>(series_->coefficient(index, k)));
                refine_coefficients(function, exact, step.length, what == Found::What::gap ? reach() : speed());
            }
            const auto root = FirstRoot<P>(function, zeros, step.length, noise).find();
            if (root && (!first || *root < first->s)) first = Found{*root, what, pair};
        };
        int next = step.clock + 1 + form_.own_functions();
        const std::vector<std::size_t>& gaps = form_.observed_gaps();
        for (std::size_t i = 0; i < gaps.size(); ++i)
            if (std::find(face_.begin(), face_.end(), form_.pair_at(gaps[i])) != face_.end())
                ++next;
            else
                look(next++, zeros_[gaps[i]], reach() * gap_rounding(zeros_[gaps[i]]), Found::What::gap, gaps[i]);
        for (std::size_t i = 0; two_ && i < 2; ++i) {
            const int normal = step.clock + 1 + static_cast<int>(i);
            look(normal, 0, 0, Found::What::normal_force, i);
            const double limit =
                static_cast<double>(mu(two_->pairs[i])) * static_cast<double>(step.coefficient(normal, 1));
            if (!(limit > 0)) continue;
            if (two_->slip[i] != 0)
                look(normal + 2, slip_zeros_[i], 0, Found::What::slip, i);
            else
                look(normal + 2, 0, 4 * error(2) * limit * limit, Found::What::cone, i);
        }
        if (mode_ == System::sliding) look(step.clock + 1, 0, 0, Found::What::normal_force, 0);
        if (mode_ == System::rolling) {
            look(step.clock + 1, 0, 0, Found::What::normal_force, 0);
            // a force that stays on the cone up to rounding does not leave it
            const double limit =
                static_cast<double>(mu(*contact_)) * static_cast<double>(step.coefficient(step.clock + 1, 1));
            look(step.clock + 2, 0, 4 * error(2) * limit * limit, Found::What::cone, 0);
        }
        if (rotation_.acts && contact_) {
            const int rotation = form_.first_rotation_function();
            if (rotation_.holds_rolling) look(rotation, 0, 0, Found::What::rolling_limit, 0);
            if (rotation_.holds_spin) look(rotation + 1, 0, 0, Found::What::spin_limit, 0);
            if (rotation_.spin != 0) look(rotation + 1, spin_zeros_, 0, Found::What::spin, 0);
        }
        return first;
    }

    // the state of the selected system
    void start_state() {
        form_.set_time(t_);
        y_.assign(static_cast<std::size_t>(form_.dimension()), P(0));
        form_.start(motion_, t_, y_.data());
    }
    void enter_system() {
        if (two_)
            form_.select_two(*two_);
        else
            form_.select(mode_, contact_.value_or(Pair{}));
        start_state();
        const int n = form_.dimension();
        // with another method, the series only shows whether a slip ends and how events start
        series_.emplace(cast_recording<T>(record_form(n)), settings_.steps ? order_of_starts : settings_.order);
    }
    /// Plans a step of the present mode. Returns false if the mode ends before.
    bool plan_step_of_mode() {
        if (rims_.update(geometry_, motion_.q)) leave_system();
        if (!series_) enter_system();
        const int clock = form_.clock();
        if (!may_step()) return false;
        form_.set_time(t_);
        std::fill(y_.begin() + clock + 1, y_.begin() + form_.first_variable(), P(0));
        form_.refresh(y_.data());
        if constexpr (StepOrder<P>::adapts) series_->set_order(order_.next());
        series_->expand(y_.data());
        Step step{*series_, clock, form_.is_stretched()};
        double slip = 0;
        if (two_)
            if (const std::string why = two_contacts_fault(ball_between(two_->pairs), two_->pairs); !why.empty()) {
                fail(why);
                return false;
            }
        if (rotation_.acts && ends_rolling(step, y_)) {
            leave_system();
            return false;
        }
        if (step.stretched && form_.is_stretched_by_slip()) {
            const P square = step.coefficient(clock + 2, 1), growth = P(2) * step.coefficient(clock + 2, 2);
            slip = std::sqrt(static_cast<double>(square));
            // growth = 2 |u_t|^2 d|u_t|/dt
            if (slip <= zero_slip() && !(growth > P(0))) {
                end_slip(*series_, square, growth, y_);
                leave_system();
                return false;
            }
        }
        if (settings_.steps) return plan_step_of_method(step, slip);
        const double length = std::min(step_of(*series_, form_.blocks(sizes_, slip)), observed_step(*series_, step));
        if (std::isnan(length)) {
            fail("the motion is not finite " + at_time());
            return false;
        }
        step.length = P(length);
        return plan_step(step, false, false);
    }
    // The length in s over which a slip or a rolling velocity decays by several e-foldings. Beyond that, its direction
    // and with it the normal force would not be resolved.
    double decay_length(const Step& step) const {
        constexpr double foldings = 4;
        double shortest = std::numeric_limits<double>::max();
        const auto limit = [&](int index) {
            const double square = static_cast<double>(step.coefficient(index, 1)),
                         growth = 2 * static_cast<double>(step.coefficient(index, 2));
            if (growth < 0) shortest = std::min(shortest, foldings * 2 * square / -growth);
        };
        if (form_.is_stretched_by_slip()) limit(step.clock + 2);
        if (form_.is_stretched_by_rolling()) limit(form_.first_rotation_function());
        return shortest;
    }
    bool has_formulas() const {
        if constexpr (requires { form_.has_formulas(); }) return form_.has_formulas();
        return false;
    }
    void start_steps(double slip) {
        slip_scale_ = slip;
        // the clock comes last
        const std::size_t components = static_cast<std::size_t>(form_.clock()) + 1;
        // the gap of a disc changes fast where the disc is almost parallel to the plane
        std::vector<double> functions;
        if (rims_.any() && !has_formulas()) {
            functions.assign(static_cast<std::size_t>(form_.first_variable()) - components, 0);
            for (std::size_t i = 0; i < form_.observed_gaps().size(); ++i)
                functions[static_cast<std::size_t>(form_.own_functions()) + i] = reach();
        }
        steps_.start(form_, y_.data(), scales_of(form_.blocks(sizes_, slip), components, scene_->duration),
                     std::move(functions));
    }
    bool plan_step_of_method(Step step, double slip) {
        // the error of a slip must be small relative to the slip, because its direction matters: start again where it
        // has decreased
        constexpr double decrease = 0.03;
        if (!steps_.is_running() || (form_.is_stretched_by_slip() && slip < decrease * slip_scale_)) start_steps(slip);
        const double left = static_cast<double>(P(P(legs_[leg_].end) - t_));
        const double length = steps_.step(step.stretched ? decay_length(step) : left);
        if (!(length > 0)) {
            fail(steps_.fault() + " " + at_time());
            return false;
        }
        step.expansion = steps_.polynomial();
        step.length = P(length);
        return plan_step(step, false, false);
    }
    // Plans a step of at most step.length. Returns false on a fault.
    bool plan_step(Step step, bool starts_slip, bool starts_rolling) {
        allowed_ = static_cast<double>(step.length);
        const Leg& leg = legs_[leg_];
        bool to_end = false;
        if (!step.stretched) {
            if (P(leg.end) - t_ <= step.length) step.length = P(leg.end) - t_, to_end = true;
        } else {
            limit_to_leg(step, leg, to_end);
        }
        std::optional<Flat> flat = limit_to_rims(step);
        if (fails()) return false;
        if (flat) to_end = false;
        const std::optional<Found> found = first_event(step);
        if (found) step.length = found->s, to_end = false, flat.reset();
        const P reached = to_end ? P(leg.end) : step.clock_at_end();
        if (!found && !to_end && !(reached > t_) && !step.stretched) {
            fail("step size below the spacing of numbers " + at_time());
            return false;
        }
        planned_.emplace(Planned{step, found, reached, starts_slip, starts_rolling, flat});
        return true;
    }
    // Shortens a step in which a rim passes through an attitude parallel to a plane (flat_rims.h).
    std::optional<Flat> limit_to_rims(Step& step) {
        std::optional<Flat> limit;
        if (!rims_.any()) return limit;
        std::vector<P> y(static_cast<std::size_t>(form_.dimension()));
        const auto motion_in = [&](const P& s) {
            step.expansion.evaluate(s, y.data());
            return form_.motion(y.data());
        };
        for (const typename FlatRims<P>::Rim& rim : rims_.all())
            for (std::size_t plane = 0; plane < geometry_.planes.size(); ++plane) {
                const Vector3<P>& n = geometry_.planes[plane].normal_W;
                const auto tilt_at = [&](const P& s) { return rims_.tilt(rim, n, motion_in(s).q); };
                const Pair pair{plane, rim.piece};
                const Vector3<P> start = rims_.tilt(rim, n, motion_.q);
                if (geometry_.pieces[rim.piece].extended) {
                    const Vector3<P> rate =
                        transposed(rim.axes) * cross(rotate_back(motion_.q, n), motion_.angular_velocity_B);
                    if (rims_.is_planar(start, rate) && end_where_parallel(step, start, tilt_at))
                        limit = Flat{pair, true};
                    continue;
                }
                // the height of the centre is that of the rim while the rim stays parallel to this plane; it is not for
                // a plane of another direction, such as a wall
                if (rims_.is_parallel(rim, start) && !rims_.has_tilted(rim, start, tilt_at(step.length)) &&
                    !rims_.has_tilted(rim, start, tilt_at(step.length / P(2))))
                    continue;
                const P before = step.length;
                if (!stay_apart(step, pair, gap(index_of(pair), motion_) - length(start), motion_in)) return {};
                if (!limit || step.length < before) limit = Flat{pair};
            }
        return limit;
    }
    // Ends a step where an inclination that changes along itself passes through zero. Returns whether it does.
    template <class TiltAt>
    bool end_where_parallel(Step& step, const Vector3<P>& start, const TiltAt& tilt_at) const {
        constexpr int parts = 16, most_halvings = 400;
        for (int i = 1; i <= parts; ++i) {
            P low = step.length * P(i - 1) / P(parts), high = step.length * P(i) / P(parts);
            const Vector3<P> before = i == 1 ? start : tilt_at(low);
            if (!(dot(before, tilt_at(high)) < P(0))) continue;
            for (int k = 0; k < most_halvings && high - low > P(2) * Elementary<P>::epsilon() * high; ++k) {
                const P middle = (low + high) / P(2);
                (dot(before, tilt_at(middle)) < P(0) ? high : low) = middle;
            }
            step.length = high;
            return true;
        }
        return false;
    }
    // Limits a step so that a piece with the present distance from a plane certainly stays apart.
    template <class MotionIn>
    bool stay_apart(Step& step, Pair pair, const P& distance, const MotionIn& motion_in) {
        if (!(distance > P(1e-9 * reach()))) {
            fail(flat_rim(pair) ? on_a_rim("tilts", pair)
                                : fmt::format("reaches {} {} while its rim is parallel to another plane, which is not "
                                              "supported",
                                              plane_at(pair), at_time()));
            return false;
        }
        P speed(0);
        for (const P& s : {P(0), P(step.length / P(2)), step.length}) {
            const BodyMotion<P> m = motion_in(s);
            speed = std::max(speed, length(m.velocity_W) + P(reach()) * length(m.angular_velocity_B));
        }
        const P longest = distance / (P(2) * speed);
        while (step.clock_at_end() - t_ > longest) step.length = step.length / P(2);
        return true;
    }
    // Moves along the step, whose length ends at the time t.
    void move_to(const Step& step, const P& t, bool at_event = false) {
        take_samples(step, legs_[leg_], t_, t, at_event);
        note_ratio(step);
        step.expansion.evaluate(step.length, y_.data());
        t_ = t;
        motion_ = form_.motion(y_.data());
        note_sizes();
        std::fill(zeros_.begin(), zeros_.end(), 0);
        spin_zeros_ = 0;
        slip_zeros_ = {};
    }
    void limit_to_leg(Step& step, const Leg& leg, bool& to_end) const {
        // a long step may reach the end of the leg long before its end: halve until the clock is monotone
        if (step.clock_at_end() < P(leg.end)) return;
        step.length = step.when(P(leg.end), t_);
        to_end = true;
    }

    // Takes the samples at the end of the leg that an event there has postponed.
    void show_rest_of_leg() { show_at(legs_[leg_], legs_[leg_].end); }
    /// Takes the samples up to the time t with the present motion and mode.
    void show_at(const Leg& leg, double t) {
        if (!samples_.due(leg, t)) return;
        const auto [forces, torques] = present_reactions();
        for (; samples_.due(leg, t); samples_.pop()) show(motion_, forces, torques);
    }
    using PlaneVectors = std::vector<Vector3<P>>;  // one for each plane, world axes
    /// Contact forces and torques in the present mode.
    std::pair<PlaneVectors, PlaneVectors> present_reactions() {
        if (!contact_) return {PlaneVectors(scene_->planes.size()), PlaneVectors(scene_->planes.size())};
        if (onset_) {
            const ContactAxes<P> axes(geometry_.planes[contact_->plane].normal_W);
            form_.select(System::onset, *contact_);
            form_.set_path(straight_path(axes, *onset_));
            start_state();
        } else {
            enter_system();
        }
        const int n = form_.dimension();
        Series<T> series(cast_recording<T>(record_form(n)), 2);
        series.expand(y_.data());
        const Step step{series, form_.clock(), form_.is_stretched()};
        auto reactions = reactions_at(step, P(0));
        leave_system();
        return reactions;
    }
    /// Contact forces and torques at s within a step.
    std::pair<PlaneVectors, PlaneVectors> reactions_at(const Step& step, const P& s) const {
        PlaneVectors forces(scene_->planes.size()), torques(scene_->planes.size());
        if (two_) {
            for (std::size_t i = 0; i < 2; ++i)
                forces[two_->pairs[i].plane] = step.observed_vector(step.clock + 5 + 3 * static_cast<int>(i), s);
        } else if (contact_) {
            forces[contact_->plane] = step.observed_vector(step.clock + 3, s);
            if (rotation_.acts) torques[contact_->plane] = step.observed_vector(form_.first_rotation_function() + 3, s);
        }
        return {std::move(forces), std::move(torques)};
    }
    void take_samples(const Step& step, const Leg& leg, const P& start, const P& reached, bool at_event) {
        std::vector<P> y(form_.dimension());
        // a sample at an event, up to the error of its time, shows the motion after it
        const P uncertainty(scene_->duration * std::max(error(), settings_.step_error));
        const auto is_at_event = [&] { return at_event && P(samples_.front()) >= reached - uncertainty; };
        for (; samples_.due(leg, reached) && !is_at_event(); samples_.pop()) {
            const P s = step.when(P(samples_.front()), start);
            step.expansion.evaluate(s, y.data());
            auto [forces, torques] = reactions_at(step, s);
            show(form_.motion(y.data()), std::move(forces), std::move(torques));
        }
    }
    void show(const BodyMotion<P>& m, std::vector<Vector3<P>> forces, std::vector<Vector3<P>> torques) {
        last_sample_ = samples_.front();
        run_.motions.push_back(m);
        run_.forces_W.push_back(std::move(forces));
        run_.torques_W.push_back(std::move(torques));
    }

    void open_interval() {
        close_interval();
        open_intervals_ = two_ ? 2 : 1;
        for (std::size_t i = 0; two_ && i < 2; ++i)
            run_.record.intervals.push_back(
                {t_, t_, two_->pairs[i].plane, two_->slip[i] == 0 ? Mode::rolling : Mode::sliding, 0});
        if (!two_) run_.record.intervals.push_back({t_, t_, contact_.value_or(Pair{}).plane, present_mode(), 0});
    }
    Mode present_mode() const {
        if (mode_ == System::flight) return Mode::flight;
        const bool slides = mode_ == System::sliding, no_spin = rotation_.holds_spin;
        if (!rotation_.holds_rolling) {
            if (no_spin) return slides ? Mode::sliding_without_spin : Mode::rolling_without_spin;
            return slides ? Mode::sliding : Mode::rolling;
        }
        if (slides) return no_spin ? Mode::sliding_without_rotation : Mode::sliding_without_rolling;
        // a spin that starts is zero at first
        return no_spin || (rotation_.spin == 0 && is_at_rest()) ? Mode::resting : Mode::spinning;
    }
    void close_interval() {
        std::vector<Interval<P>>& all = run_.record.intervals;
        for (std::size_t i = all.size() - open_intervals_; i < all.size(); ++i) all[i].to = t_;
        // a mode that ends when it starts is no interval
        for (; open_intervals_ > 0 && !(all.back().to > all.back().from) && !fails(); --open_intervals_) all.pop_back();
        open_intervals_ = 0;
    }
    void note_two_ratios(const Step& step) {
        std::vector<Interval<P>>& all = run_.record.intervals;
        for (std::size_t c = 0; c < 2; ++c) {
            double& largest = all[all.size() - 2 + c].largest_ratio;
            const double friction = static_cast<double>(mu(two_->pairs[c]));
            if (!(friction > 0)) continue;
            if (two_->slip[c] != 0) largest = 1;
            for (int i = 0; two_->slip[c] == 0 && i <= 8; ++i) {
                const P s = step.length * P(i) / P(8);
                const int normal = step.clock + 1 + static_cast<int>(c);
                // (mu N)^2 - A^2
                const double limit = friction * static_cast<double>(step.observed(normal, s)),
                             rest = static_cast<double>(step.observed(normal + 2, s));
                largest = std::max(largest, std::sqrt(std::max(0.0, limit * limit - rest)) / limit);
            }
        }
    }
    // the largest |F|/(mu N) at nine points of the step
    void note_ratio(const Step& step) {
        if (mode_ == System::flight || run_.record.intervals.empty()) return;
        if (two_) return note_two_ratios(step);
        double& largest = run_.record.intervals.back().largest_ratio;
        const double friction = form_.friction_of(*contact_);
        if (!(friction > 0)) return;
        if (mode_ == System::sliding) {
            largest = 1;
            return;
        }
        for (int i = 0; i <= 8; ++i) {
            const P s = step.length * P(i) / P(8);
            const Vector3<P> force = step.observed_vector(step.clock + 3, s);
            const Vector3<P> f = ContactAxes<P>(geometry_.planes[contact_->plane].normal_W).from_world(force);
            const double normal = static_cast<double>(f[2]);
            const double tangential = std::hypot(static_cast<double>(f[0]), static_cast<double>(f[1]));
            // a force that rounding leaves at a body at rest is zero
            if (rotation_.acts && tangential < error() * normal) continue;
            largest = std::max(largest, tangential / (friction * normal));
        }
    }

    // Ends the mode if the rolling velocity is below the error of the steps and decreases, like end_slip().
    bool ends_rolling(const Step& step, std::vector<P>& y) {
        if (!form_.is_stretched_by_rolling()) return false;
        const int index = form_.first_rotation_function();
        const P square = step.coefficient(index, 1), growth = P(2) * step.coefficient(index, 2);
        const P small(error(2) * speed() / reach());
        if (square > small * small || growth > P(0)) return false;
        move_to_end(*series_, square, growth, y);
        remove_rolling();
        transition(nullptr);
        return true;
    }
    void remove_rolling() {
        const ContactAxes<P> axes(geometry_.planes[contact_->plane].normal_W);
        const Vector3<P> spin = rotate(motion_.q, motion_.angular_velocity_B);
        const P normal = dot(spin, axes.normal_W);
        motion_.angular_velocity_B = rotate_back(motion_.q, Vector3<P>(normal * axes.normal_W));
        // the slip is kept
        const Vector3<P> arm =
            rotate(motion_.q, geometry_.pieces[contact_->piece].lowest_point(rotate_back(motion_.q, axes.normal_W)));
        motion_.velocity_W = motion_.velocity_W + cross(Vector3<P>(spin - normal * axes.normal_W), arm);
    }
    // The slip is below the error of the steps and decreases: it ends after the time |u_t| / |d|u_t|/dt|.
    void end_slip(const ModeSeries<T>& series, const P& square, const P& growth, std::vector<P>& y) {
        move_to_end(series, square, growth, y);
        remove_slip();
        transition(nullptr);
    }
    // Moves to the end of a slip or a rolling velocity whose square and its growth are given.
    void move_to_end(const ModeSeries<T>& series, const P& square, const P& growth, std::vector<P>& y) {
        // dy/dt = c_1 / |u_t|, d|u_t|/dt = growth / (2 |u_t|^2), and the remaining time is -|u_t| / (d|u_t|/dt)
        if (growth < P(0)) {
            const P factor = P(-2) * square / growth;
            for (int i = 0; i <= form_.clock(); ++i) y[i] = y[i] + factor * static_cast<P>(series.coefficient(i, 1));
        }
        t_ = y[form_.clock()];
        motion_ = form_.motion(y.data());
    }
    void remove_slip() {
        const ContactAxes<P> axes(geometry_.planes[contact_->plane].normal_W);
        const Vector3<P> u = form_.response(*contact_, motion_).velocity;
        motion_.velocity_W = motion_.velocity_W - u[0] * axes.first_W - u[1] * axes.second_W;
    }

    /// Plans the first step of a slip or a rolling velocity that starts from zero (slip_start.h). Returns false on a
    /// fault.
    bool start_slip() {
        const Pair pair = *contact_;
        const ContactAxes<P> axes(geometry_.planes[pair.plane].normal_W);
        const bool slips = onset_.has_value(), rolls = rotation_.starts_rolling;
        SlipPath<P> path;
        if (slips) path = straight_path(axes, *onset_);
        onset_.reset();
        form_.select(slips ? System::onset : mode_, pair);
        start_state();
        const int n = form_.dimension(), clock = form_.clock(), order = order_.next();
        const auto expand = [&](int to_order) {
            if (slips) form_.set_path(path);
            if (rolls) form_.set_rotation(rotation_);
            Series<T> series(cast_recording<T>(record_form(n)), to_order);
            series.expand(y_.data());
            return series;
        };
        const double acceleration = static_cast<double>(length(form_.response(pair, motion_).acceleration));
        const bool both = slips && rolls;
        slip_start_ = rolling_start_ = 0;
        if (slips) slip_start_ = find_path(path, expand, {clock + 2, clock + 6, acceleration, both, "slip"});
        if (rolls) {
            const int first = form_.first_rotation_function();
            rolling_start_ =
                find_path(rotation_.path, expand, {first, first + 2, acceleration / reach(), both, "rolling"});
        }
        if (fails()) return false;
        const Series<T>& series = start_series_.emplace(expand(order));
        Step step{series, clock, false};
        double longest = std::min(step_of(series, form_.blocks(sizes_, 0)), observed_step(series, step));
        for (const SlipPath<P>* curve : {&std::as_const(path), &std::as_const(rotation_.path)})
            longest = std::min(longest, path_step(*curve, step_digits()));
        if (!may_step()) return false;
        if (std::isnan(longest)) {
            fail("the motion is not finite " + at_time());
            return false;
        }
        step.length = P(longest);
        const bool planned = plan_step(step, true, rolls);
        slip_start_ = rolling_start_ = 0;
        return planned;
    }
    /// A motion that starts from zero: indices of the observed accelerations across and along its direction, the size
    /// of accelerations, and whether its direction must be constant.
    struct Onset {
        int across = 0, along = 0;
        double acceleration = 0;
        bool must_be_straight = false;
        const char* name = "";
    };
    // Finds the series of the angle of `path`, which `expand` uses. Returns the order of the velocity's zero at the
    // start; 0 on a fault.
    template <class Expand>
    std::size_t find_path(SlipPath<P>& path, const Expand& expand, const Onset& onset) {
        std::vector<SlipStart<P>> start{{&path, onset.across, onset.along}};
        const SlipStartFault why =
            find_slip_paths(start, {order_.next(), onset.acceleration, error(), error(6), onset.must_be_straight},
                            expand, [&](const Series<T>& series) { return step_of(series, form_.blocks(sizes_, 0)); });
        if (why == SlipStartFault::does_not_grow)
            fail(fmt::format("{} at {} does not grow from its start {}", onset.name, plane_at(*contact_), at_time()));
        if (why == SlipStartFault::is_curved)
            fail("sliding and rolling start together along curves, which is not supported, " + at_time());
        return fails() ? 0 : start.front().zeros;
    }

    void handle_two(const Found& found) {
        TwoContacts<P> two = *two_;
        if (found.what == Found::What::normal_force) {
            lifted_ = two.pairs[found.pair];
            const EventKind lifts = EventKind::lifts_off;
            return transition(&lifts);
        }
        const BallBetweenPlanes<P> ball = ball_between(two.pairs);
        std::array<int, 2> slip = two.slip;
        const Former former{false, mode_, contact_, two, false};
        if (found.what == Found::What::slip) {
            const std::array<P, 2> slips = slips_along(ball);
            for (std::size_t i = 0; i < 2; ++i)
                if (i == found.pair || !(Elementary<P>::magnitude(slips[i]) > P(error(3) * speed()))) slip[i] = 0;
            for (std::size_t i = 0; i < 2; ++i)
                if (!(ball.friction[i] > P(0))) slip[i] = 1;
            return select_two(two.pairs, ball, slip, former);
        }
        // rolling becomes sliding. While the ball rolls at both, friction that presses it could hold it
        const std::size_t other = 1 - found.pair;
        if (slip[other] == 0 && ball.friction[other] > P(0)) return fail(pressed_fault(two.pairs));
        const P friction = TwoContactModes<P>(ball, slip).friction(slip)[found.pair];
        slip[found.pair] = friction > P(0) ? -1 : 1;
        two_->slip = slip, slip_zeros_ = {}, slip_zeros_[found.pair] = 1;
        record(two.pairs[found.pair], EventKind::slides);
        open_interval();
    }
    void handle(const Found& found) {
        form_.set_time(t_);
        if (found.what == Found::What::gap) return transition(nullptr);
        if (two_) return handle_two(found);
        if (found.what == Found::What::slip || found.what == Found::What::end_of_rolling) {
            if (found.what == Found::What::slip)
                remove_slip();
            else
                remove_rolling();
            return transition(nullptr);
        }
        if (found.what == Found::What::normal_force) {
            const EventKind lifts = EventKind::lifts_off;
            return transition(&lifts);
        }
        if (rotation_.acts) {
            exceeded_ = found.what == Found::What::cone            ? Exceeded::slip
                        : found.what == Found::What::rolling_limit ? Exceeded::rolling
                        : found.what == Found::What::spin_limit    ? Exceeded::spin
                                                                   : Exceeded::none;
            return transition(nullptr);
        }
        // rolling becomes sliding, against the friction that it needed
        const Vector3<P> force = rolling_force(form_.response(*contact_, motion_));
        const P size = square_root(P(force[0] * force[0] + force[1] * force[1]));
        remove_slip();
        onset_ = Vector3<P>(-force[0] / size, -force[1] / size, P(0));
        record(*contact_, EventKind::slides);
        mode_ = System::sliding;
        open_interval();
    }
};

}  // namespace polhode::contact
