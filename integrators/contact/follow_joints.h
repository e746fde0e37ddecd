// Follows a mechanism whose joints have limits and Coulomb friction from event to event, for any formulation and
// scalar.
//
// JointDriver integrates a formulation (joint_tree_form.h, joint_maximal_form.h) by Taylor series (A. Jorba and
// M. Zou 2005, Exp. Math. 14, 99) or, in binary64, by the steps of another method (mode_steps.h). Each mode is a smooth
// system: a joint moves without friction, forward or backward against its friction, or is held by friction or at a
// limit. A mode ends where an event function falls to zero (event_roots.h): the distance from a limit, the rate of a
// joint with friction, or the distance of the holding force from its bounds. An arrival at a limit is an impact by
// Newton's law on the coordinate, in which all joints take part and friction, which is bounded, exerts no impulse.
// Where rates vanish, the complementarity problem of box_forces.h decides which joints are held: [-F, F] bounds the
// force of friction F, and a limit removes the bound on its side. Formulations that can lock joints verify a set of
// held joints by solving for the accelerations; a wrong one is corrected joint by joint. Only where this does not end,
// or in other formulations, the matrix of the problem is formed.
//
// Switches of formula loads are events too (joint_switches.h).
//
// Infinitely many impacts end where the speed of separation is within the error of the steps.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/box_forces.h"
#include "integrators/contact/contact_state.h"
#include "integrators/contact/dependent_joints.h"
#include "integrators/contact/event_roots.h"
#include "integrators/contact/joint_events.h"
#include "integrators/contact/joint_switches.h"
#include "integrators/contact/mode_steps.h"
#include "integrators/series/limb_real.h"
#include "integrators/series/real.h"
#include "integrators/series/series.h"
#include "motion/itinerary.h"
#include "motion/problem.h"

namespace polhode::contact {

struct JointSettings {
    int order = 20;
    double digits = 15;        ///< local error: 10^-digits of each block's size
    double event_digits = 13;  ///< a rate below 10^-event_digits of the joint's largest is zero
    double step_factor = 1;    ///< ratio of the step to the one that just meets `digits`
    long max_steps = 100'000;
    /// Why the run must stop now; null to continue. Called before each step.
    std::function<const char*()> stop = [] { return nullptr; };
    MakeSystemSteps steps = nullptr;  ///< steps of a method; null: Taylor series
    double tolerance = 1e-10;         ///< tolerance of that method
    double step_error = 0;            ///< relative error that its steps leave in rates and times
};

template <class P, class Form>
class JointDriver {
  public:
    /// `blocks`: of the formulation's state, with estimates of their largest lengths. `scene` must outlive the driver.
    JointDriver(const Scene& scene, const Scales& scales, Form form, std::vector<Block> blocks,
                const std::vector<double>& sample_times, const JointSettings& settings)
        : scene_(&scene),
          form_(std::move(form)),
          blocks_(std::move(blocks)),
          settings_(settings),
          samples_(sample_times),
          states_(form_.joints().size()),
          error_(std::max(std::pow(10.0, -settings.event_digits), settings.step_error)),
          time_error_(scene.duration * error_),
          switches_(scene.duration, error_),
          steps_(settings.steps, settings.tolerance, scene.duration) {
        for (const EventJoint<P>& one : form_.joints())
            rate_scales_.push_back(scene.joints[one.joint].type == JointType::prismatic ? scales.velocity
                                                                                        : scales.angular_velocity);
    }

    JointRun<P> run() {
        y_ = form_.initial();
        base_ = y_.size();
        for (const Leg& leg : itinerary(*scene_)) {
            t_ = P(leg.begin);
            y_.resize(base_);
            form_.enter(leg.begin, y_.data());
            if (leg.index == 0) find_limits();
            switches_.set_signs(form_, y_.data());
            if (!fails()) collide();
            if (!fails()) settle();
            for (; !fails() && samples_.due(leg, leg.begin); samples_.pop()) show(y_.data());
            while (!fails() && t_ < P(leg.end)) advance(leg);
            for (; !fails() && samples_.due(leg, t_); samples_.pop()) show(y_.data());
            if (fails()) break;
        }
        run_.evaluations = settings_.steps ? steps_.evaluations() : run_.steps;
        return std::move(run_);
    }

  private:
    using T = typename SeriesScalar<P>::Type;

    // Leading coefficients of an event function that vanish up to rounding in the first step after an event.
    struct State {
        JointMode mode = JointMode::free;
        AtLimit at = AtLimit::none;
        AtLimit left = AtLimit::none;  // the limit that limit_zeros refers to
        std::size_t limit_zeros = 0, rate_zeros = 0;
        double largest_rate = 0;
        double largest_response = 0;  // change of its rate by a unit impulse; with loops only
        // If joints depend on each other by loops, one leads and is held (dependent_joints.h).
        std::size_t leader = 0;
        double direction = 1;  // sign of the ratio to the leader
        Box<P> box;            // bounds of the force on the leader
    };
    enum class Cause { lower_limit, upper_limit, stops, low_force, high_force, switches };
    struct Found {
        std::size_t joint;  // or an active switch
        Cause cause;
        P after;
    };

    const Scene* scene_;
    Form form_;
    std::vector<Block> blocks_;
    JointSettings settings_;
    SampleQueue samples_;
    std::vector<State> states_;
    double error_;                     // relative error of rates and times of events
    double time_error_;                // s: times closer than this are equal
    std::vector<double> rate_scales_;  // rad/s or m/s
    std::vector<std::size_t> held_;
    std::vector<P> y_;
    std::size_t base_ = 0;
    P t_{0};
    JointRun<P> run_;
    long stalled_ = 0;
    std::size_t found_ = 0;  // events, including those that change no mode
    std::optional<Series<T>> series_;
    JointSwitches<P, Form> switches_;
    ModeSteps<P, Form> steps_;

    bool fails() const { return !run_.fault.empty(); }
    void fail(const std::string& fault) {
        if (run_.fault.empty()) run_.fault = fmt::format("{} at t = {:.10g} s", fault, static_cast<double>(t_));
    }
    const EventJoint<P>& joint(std::size_t e) const { return form_.joints()[e]; }
    // friction: the event names the joint; a limit: the joint that the limit belongs to, and the impulse on its
    // coordinate
    void record(std::size_t e, JointEventKind kind) { run_.events.push_back({t_, joint(e).joint, kind, P(0)}); }
    void record(std::size_t e, AtLimit at, JointEventKind kind, const P& impulse = P(0)) {
        const CoupledJoint<P>& one = limit(e, at).limited_joint;
        run_.events.push_back({t_, one.joint, kind, P(impulse / one.ratio)});
    }
    const CoordinateLimit<P>& limit(std::size_t e, AtLimit at) const {
        return at == AtLimit::lower ? joint(e).lower : joint(e).upper;
    }
    P coordinate(std::size_t e) const { return y_[static_cast<std::size_t>(form_.coordinate(e))]; }

    void show(const P* y) {
        run_.motions.push_back(form_.motion(y));
        run_.reactions.push_back(form_.reactions(y));
        if constexpr (requires { form_.joint_coordinates(y); }) {
            run_.coordinates.emplace_back();
            for (const std::array<P, 2>& x : form_.joint_coordinates(y))
                run_.coordinates.back().push_back({static_cast<double>(x[0]), static_cast<double>(x[1])});
        }
    }

    // joints that start at a limit up to rounding
    void find_limits() {
        for (std::size_t e = 0; e < states_.size(); ++e) {
            if (!scene_->loops.empty())
                states_[e].largest_response = static_cast<double>(form_.response({e}, y_.data()).front());
            const P x = coordinate(e), small = P(1e-12);
            for (const AtLimit at : {AtLimit::lower, AtLimit::upper}) {
                if (!limit(e, at).exists) continue;
                const P gap =
                    at == AtLimit::lower ? P(x - joint(e).lower.coordinate) : P(joint(e).upper.coordinate - x);
                if (gap <= small) states_[e].at = at;
                // the scene's check does not know where dependent joints start
                if (!(gap >= -small))
                    fail(fmt::format("joint {} is outside of its limits",
                                     scene_->joints[limit(e, at).limited_joint.joint].name));
            }
        }
    }

    // accelerations below this are rounding errors
    P least_acceleration() const {
        const double rate = *std::ranges::max_element(rate_scales_);
        return P(1e6) * Elementary<P>::epsilon() * P(rate / scene_->duration);
    }
    // rates below this are zero
    P least_rate(std::size_t e) const { return P(std::max(states_[e].largest_rate, rate_scales_[e]) * error_); }
    // the rate away from the limit
    P separation(std::size_t e, const std::vector<P>& rates) const {
        return states_[e].at == AtLimit::lower ? rates[e] : P(-rates[e]);
    }

    /// Applies impacts of all joints that move into the limit that they are at.
    void collide() {
        constexpr int most_rounds = 100;
        for (int round = 0;; ++round) {
            const std::vector<P> rates = form_.rates(y_.data());
            bool approaches = false;
            std::vector<std::size_t> at_limits;
            for (std::size_t e = 0; e < states_.size(); ++e) {
                if (states_[e].at == AtLimit::none) continue;
                at_limits.push_back(e);
                // the rate of a joint that is held is zero up to rounding
                const bool is_rounding =
                    (round > 0 || states_[e].mode == JointMode::held) && -separation(e, rates) <= least_rate(e);
                if (!is_rounding) approaches = approaches || separation(e, rates) < P(0);
            }
            if (!approaches) return;
            if (round == most_rounds) return fail("simultaneous impacts on limits of joints do not end");
            if (!apply_impact(at_limits, rates)) return fail("no impulses were found for impacts on limits of joints");
        }
    }
    // Newton's law for all joints at limits: v+ + e v- >= 0 and impulse >= 0, one of them zero
    bool apply_impact(const std::vector<std::size_t>& at, const std::vector<P>& rates) {
        const std::size_t n = at.size();
        std::vector<P> A = form_.response(at, y_.data()), a;
        std::vector<Box<P>> boxes(n);
        for (std::size_t i = 0; i < n; ++i) {
            const P& v = rates[at[i]];
            const bool approaches = separation(at[i], rates) < P(0);
            a.push_back(approaches ? P((P(1) + limit(at[i], states_[at[i]].at).restitution) * v) : v);
            (states_[at[i]].at == AtLimit::lower ? boxes[i].has_high : boxes[i].has_low) = false;
        }
        const auto found = BoxForces<P>(std::move(A), std::move(a), std::move(boxes)).solve();
        if (!found) return false;
        for (std::size_t i = 0; i < n; ++i) {
            const P& impulse = found->forces[i];
            if (impulse == P(0)) continue;
            form_.push(at[i], impulse, y_.data());
            record(at[i], states_[at[i]].at, JointEventKind::impact, impulse);
        }
        switches_.set_signs(form_, y_.data());
        const std::vector<P> after = form_.rates(y_.data());
        for (auto event = run_.events.rbegin(); event != run_.events.rend() && event->t == t_; ++event)
            for (const std::size_t e : at)
                if (limited_joint(e) == event->joint && event->kind == JointEventKind::impact &&
                    separation(e, after) <= least_rate(e))
                    event->kind = JointEventKind::rests;
        return true;
    }

    // the joint of the limit that a joint is at
    std::size_t limited_joint(std::size_t e) const { return limit(e, states_[e].at).limited_joint.joint; }

    /// Decides on the modes of the joints, and on the signs of switches at their thresholds, which depend on them.
    void settle() {
        constexpr int most_rounds = 8;
        for (int round = 0; round < most_rounds; ++round) {
            choose_modes();
            if (fails() || !resolve_switches()) return;
        }
        fail("no signs of the switches of formulas agree with the modes of the joints");
    }
    /// Sets the signs of the switches that are at their thresholds, in the modes of the joints: the side to which the
    /// argument moves under the equations of that side. Returns whether any has changed.
    bool resolve_switches() {
        if (!form_.has_formulas()) return false;
        bool changed = false;
        const std::vector<int> active = form_.terms().active_switches();
        for (const int which : active) {
            if (form_.terms().sign(which) != 0) continue;
            int found = 0;
            for (const int sign : {1, -1})
                if (found == 0 && try_sign(which, sign) == sign) found = sign;
            try_sign(which, found);
            changed = changed || found != 0;
        }
        return changed;
    }
    // Selects the system with this sign of a switch. Returns the sign of the first coefficient of its argument's
    // change.
    int try_sign(int which, int sign) {
        form_.terms().set_sign(which, sign);
        form_.refresh(y_.data());
        select();
        series_->expand(y_.data());
        const std::vector<int>& active = form_.terms().active_switches();
        const auto at = std::ranges::find(active, which);
        if (at == active.end()) return 0;
        const int place = form_.switch_argument(static_cast<std::size_t>(at - active.begin()));
        const std::vector<P> c = function_coefficients(StepExpansion<P>(*series_), place);
        const std::size_t first = count_zeros(c, P(scene_->duration * 0x1p-10), 1);
        return first == c.size() ? 0 : c[first] > P(0) ? 1 : -1;
    }
    // The coefficients of a function whose integral is a component of the state.
    std::vector<P> function_coefficients(const StepExpansion<P>& expansion, int place) const {
        std::vector<P> c;
        for (int k = 0; k < expansion.order(); ++k) c.push_back(P(k + 1) * expansion.coefficient(place, k + 1));
        return c;
    }
    // The number of leading coefficients, at least `from`, whose terms over a time h are rounding errors.
    std::size_t count_zeros(const std::vector<P>& c, const P& h, std::size_t from) const {
        std::vector<double> terms;
        P power(1);
        for (const P& one : c)
            terms.push_back(static_cast<double>(P(Elementary<P>::magnitude(one) * power))), power = power * h;
        double largest = 0;
        for (std::size_t k = from; k < terms.size(); ++k) largest = std::max(largest, terms[k]);
        while (from < terms.size() && !(terms[from] > std::max(error_, 1e-8) * largest)) ++from;
        return from;
    }
    /// Decides which joints at rest are held, and where the others start to move.
    void choose_modes() {
        const std::vector<P> rates = form_.rates(y_.data());
        std::vector<std::size_t> at_rest;
        std::vector<P> forces(states_.size(), P(0));
        for (std::size_t e = 0; e < states_.size(); ++e) {
            State& state = states_[e];
            state.largest_rate = std::max(state.largest_rate, std::abs(static_cast<double>(rates[e])));
            state.rate_zeros = 0;
            state.leader = e, state.direction = 1, state.box = box_of(e);
            const bool is_at_rest = Elementary<P>::magnitude(rates[e]) <= least_rate(e);
            const bool is_bound = joint(e).friction > P(0) || state.at != AtLimit::none;
            if (is_at_rest && is_bound) {
                at_rest.push_back(e);
                form_.stop(e, y_.data());
                continue;
            }
            state.mode = joint(e).friction > P(0) ? (rates[e] > P(0) ? JointMode::forward : JointMode::backward)
                                                  : JointMode::free;
            if (state.at != AtLimit::none) leave_limit(state, 1);
            forces[e] = force_of(e);
        }
        if (!at_rest.empty() && !hold(at_rest, forces)) return;
        select();
    }
    P force_of(std::size_t e) const {
        const JointMode mode = states_[e].mode;
        return mode == JointMode::forward    ? P(-joint(e).friction)
               : mode == JointMode::backward ? joint(e).friction
                                             : P(0);
    }
    Box<P> box_of(std::size_t e) const {
        Box<P> box{-joint(e).friction, joint(e).friction, true, true};
        if (states_[e].at == AtLimit::lower) box.has_high = false;
        if (states_[e].at == AtLimit::upper) box.has_low = false;
        return box;
    }
    // Solves for the forces of joints at rest. `forces`: those of the others. Returns false on failure.
    bool hold(const std::vector<std::size_t>& at_rest, const std::vector<P>& forces) {
        std::vector<std::size_t> leaders = at_rest;
        if (!scene_->loops.empty() && !find_leaders(leaders, forces)) return false;
        if (leaders.empty()) return true;
        std::vector<BoxSide> sides = correct_sides(leaders, forces);
        if (sides.empty()) sides = solve_sides(leaders, forces);
        if (sides.empty()) {
            fail("the set of joints that are held by friction or limits was not found");
            return false;
        }
        for (const std::size_t e : at_rest) {
            const auto leader = std::ranges::find(leaders, states_[e].leader);
            if (leader == leaders.end()) continue;
            const BoxSide side = sides[static_cast<std::size_t>(leader - leaders.begin())];
            take_side(e, side == BoxSide::within, (side == BoxSide::low) == (states_[e].direction > 0));
        }
        return true;
    }
    void take_side(std::size_t e, bool is_held, bool forward) {
        State& state = states_[e];
        const JointMode former = state.mode;
        const AtLimit at = state.at;
        if (is_held) {
            state.mode = JointMode::held;
            if (former != JointMode::held && joint(e).friction > P(0) && at == AtLimit::none)
                record(e, JointEventKind::sticks);
            return;
        }
        start_moving(e, forward, 1);
        if (former == JointMode::held) record_start(e, at);
    }
    // Of joints at rest in a scene with loops, selects independent ones, with the bounds of all that follow them. A
    // joint at a dead centre of a linkage does not respond to forces: its friction follows its acceleration. Returns
    // false on failure.
    bool find_leaders(std::vector<std::size_t>& at_rest, const std::vector<P>& forces) {
        const std::size_t n = at_rest.size();
        y_.resize(base_);
        const std::vector<P> response = form_.response(at_rest, y_.data());
        std::vector<P> sizes;
        bool responds = true;
        for (std::size_t i = 0; i < n; ++i) {
            double& largest = states_[at_rest[i]].largest_response;
            largest = std::max(largest, static_cast<double>(response[i * n + i]));
            sizes.push_back(P(largest));
            responds = responds && response[i * n + i] > P(1e-9 * largest);
        }
        if (!responds && n == 1) {
            form_.select(forces, {});
            take_side(at_rest[0], false, accelerations()[at_rest[0]] > P(0));
            at_rest.clear();
            return true;
        }
        const auto found = find_dependence(response, sizes);
        if (!found) {
            fail(fmt::format("the forces that hold joint {} and others in a loop are not unique",
                             scene_->joints[joint(at_rest.back()).joint].name));
            return false;
        }
        for (const Follower<P>& one : found->followers) {
            State& follower = states_[at_rest[one.joint]];
            follower.leader = at_rest[one.leader];
            follower.direction = one.ratio > P(0) ? 1 : -1;
            State& leader = states_[follower.leader];
            leader.box = add_follower(leader.box, box_of(at_rest[one.joint]), one.ratio);
        }
        std::vector<std::size_t> leaders;
        for (const std::size_t i : found->leaders) leaders.push_back(at_rest[i]);
        std::ranges::sort(leaders);
        at_rest = std::move(leaders);
        return true;
    }
    // Finds the joints that are held by the matrix of the complementarity problem. Returns nothing on failure.
    std::vector<BoxSide> solve_sides(const std::vector<std::size_t>& at_rest, const std::vector<P>& forces) {
        y_.resize(base_);
        form_.select(forces, {});
        const std::vector<P> free = accelerations();
        std::vector<P> a;
        std::vector<Box<P>> boxes;
        for (const std::size_t e : at_rest) {
            a.push_back(free[e]);
            boxes.push_back(states_[e].box);
        }
        const auto found =
            BoxForces<P>(form_.response(at_rest, y_.data()), std::move(a), std::move(boxes), least_acceleration())
                .solve();
        return found ? found->sides : std::vector<BoxSide>();
    }
    // Finds the joints that are held by locking all of them, releasing those whose forces exceed their bounds, and
    // holding those that would move against their forces, until all conditions are met. Each round costs as much as a
    // right-hand side. Returns nothing if the rounds do not end, or if the formulation cannot lock joints.
    std::vector<BoxSide> correct_sides([[maybe_unused]] const std::vector<std::size_t>& at_rest,
                                       [[maybe_unused]] const std::vector<P>& forces) {
        if constexpr (requires { form_.selected(y_.data()); }) {
            constexpr int most_rounds = 30;
            std::vector<BoxSide> sides(at_rest.size(), BoxSide::within);
            for (int round = 0; round < most_rounds; ++round)
                if (!correct_once(at_rest, forces, sides)) return sides;
        }
        return {};
    }
    // Returns whether any side has changed.
    bool correct_once(const std::vector<std::size_t>& at_rest, std::vector<P> forces, std::vector<BoxSide>& sides) {
        std::vector<std::size_t> held;
        for (std::size_t i = 0; i < at_rest.size(); ++i) {
            const Box<P>& box = states_[at_rest[i]].box;
            if (sides[i] == BoxSide::within)
                held.push_back(at_rest[i]);
            else
                forces[at_rest[i]] = sides[i] == BoxSide::low ? box.low : box.high;
        }
        form_.select(forces, held);
        y_.resize(static_cast<std::size_t>(form_.dimension()), P(0));
        const auto found = form_.selected(y_.data());
        P largest(0);
        for (const P& a : found.accelerations) largest = std::max(largest, P(Elementary<P>::magnitude(a)));
        const P small = std::max(P(P(1e6) * Elementary<P>::epsilon() * largest), least_acceleration());
        // a force beyond its bound by rounding holds the joint
        const auto exceeds = [&](std::size_t e, const P& excess) {
            return excess > P(0) && excess * form_.response({e}, y_.data()).front() > small;
        };
        bool changed = false;
        std::size_t k = 0;
        for (std::size_t i = 0; i < at_rest.size(); ++i) {
            const Box<P>& box = states_[at_rest[i]].box;
            const BoxSide former = sides[i];
            if (former == BoxSide::within) {
                const P& force = found.holding[k++];
                if (box.has_low && exceeds(at_rest[i], P(box.low - force))) sides[i] = BoxSide::low;
                if (box.has_high && exceeds(at_rest[i], P(force - box.high))) sides[i] = BoxSide::high;
            } else {
                const P& a = found.accelerations[at_rest[i]];
                if (former == BoxSide::low ? !(a >= -small) : !(a <= small)) sides[i] = BoxSide::within;
            }
            changed = changed || sides[i] != former;
        }
        y_.resize(base_);
        return changed;
    }
    // a held joint starts to move
    void record_start(std::size_t e, AtLimit at) {
        if (at != AtLimit::none)
            record(e, at, JointEventKind::leaves);
        else
            record(e, JointEventKind::slips);
    }
    /// `zeros`: order of the zero of the rate.
    void start_moving(std::size_t e, bool forward, std::size_t zeros) {
        State& state = states_[e];
        state.mode = joint(e).friction > P(0) ? (forward ? JointMode::forward : JointMode::backward) : JointMode::free;
        state.rate_zeros = zeros;
        if (state.at != AtLimit::none) leave_limit(state, zeros + 1);
    }
    static void leave_limit(State& state, std::size_t zeros) {
        state.left = state.at, state.limit_zeros = zeros, state.at = AtLimit::none;
    }

    // accelerations of the event joints in the selected system
    std::vector<P> accelerations() {
        y_.resize(static_cast<std::size_t>(form_.dimension()), P(0));
        if constexpr (requires { form_.selected(y_.data()); }) {
            std::vector<P> all = form_.selected(y_.data()).accelerations;
            y_.resize(base_);
            return all;
        }
        Series<T> series(cast_recording<T>(polhode::record<P>(form_, form_.dimension())), 2);
        series.expand(y_.data());
        std::vector<P> all;
        for (std::size_t e = 0; e < states_.size(); ++e)
            all.push_back(P(2) * P(series.coefficient(form_.coordinate(e), 2)));
        y_.resize(base_);
        return all;
    }

    // Selects the system of the current modes.
    void select() {
        held_.clear();
        std::vector<P> forces;
        for (std::size_t e = 0; e < states_.size(); ++e) {
            forces.push_back(force_of(e));
            if (states_[e].mode == JointMode::held && states_[e].leader == e) held_.push_back(e);
        }
        form_.select(forces, held_);
        y_.resize(base_);
        y_.resize(static_cast<std::size_t>(form_.dimension()), P(0));
        steps_.end_mode();
        // with another method, the series only shows how events start
        Recording<T> recording = cast_recording<T>(polhode::record<P>(form_, form_.dimension()));
        const int order = settings_.steps ? order_of_starts : settings_.order;
        if (series_)
            series_->assign(std::move(recording), order, SeriesRows::operands);
        else
            series_.emplace(std::move(recording), order, SeriesRows::operands);
    }

    void advance(const Leg& leg) {
        if (run_.steps++ >= settings_.max_steps) return fail("the step limit is reached");
        if (const char* why = settings_.stop()) {
            run_.fault = why;
            return;
        }
        const P remaining = P(leg.end) - t_;
        double step = 0;
        const bool starts = settings_.steps && !steps_.is_running();
        if (settings_.steps) {
            if (starts) {
                series_->expand(y_.data());
                steps_.start(form_, y_.data(), state_scales(), function_scales());
            }
            step = steps_.step(static_cast<double>(remaining));
            if (!(step > 0)) return fail(steps_.fault());
        } else {
            series_->expand(y_.data());
            step = step_size();
            if (std::isnan(step)) return fail("the motion is not finite");
        }
        const StepExpansion<P> expansion = settings_.steps ? StepExpansion<P>(steps_.polynomial()) : *series_;
        const bool to_end = remaining <= P(step);
        P h = to_end ? remaining : P(step);
        P reached = to_end ? P(leg.end) : t_ + h;
        // an event at the end of a leg may be found shortly after it
        const std::optional<Found> found = first_event(expansion, to_end ? P(h + P(time_error_)) : h);
        if (found) h = found->after, reached = std::min(P(t_ + h), P(leg.end));
        if (!to_end && !found && !(reached > t_)) return fail("step size below the spacing of numbers");
        // events within the error of their times; impacts that accumulate have some
        constexpr long most_stalled = 1000;
        stalled_ = found && !(h > P(time_error_)) ? stalled_ + 1 : 0;
        // errors of a method's steps can prevent small bounces from ending
        constexpr std::size_t most_events = 20'000;
        found_ += found ? 1 : 0;
        if (stalled_ > most_stalled || (settings_.steps && found_ > most_events))
            return fail("too many events of joints");
        const StepExpansion<P> motion =
            starts && found && is_start_accurate(h) ? StepExpansion<P>(*series_) : expansion;
        std::vector<P> at_sample(y_.size());
        // a sample at an event shows the motion after it
        const auto is_at_event = [&] { return found && P(samples_.front()) >= reached - P(time_error_); };
        for (; samples_.due(leg, reached) && !is_at_event(); samples_.pop()) {
            motion.evaluate(P(P(samples_.front()) - t_), at_sample.data());
            show(at_sample.data());
        }
        motion.evaluate(h, y_.data());
        if constexpr (requires { form_.project(y_.data()); }) form_.project(y_.data());
        form_.refresh(y_.data());
        t_ = reached;
        if (h > P(0))
            for (State& state : states_) state.limit_zeros = state.rate_zeros = 0;
        if (found) handle(*found);
    }

    void handle(const Found& found) {
        if (found.cause == Cause::switches) return cross_switch(found.joint);
        const std::size_t e = found.joint;
        State& state = states_[e];
        switch (found.cause) {
            case Cause::lower_limit:
            case Cause::upper_limit:
                state.at = found.cause == Cause::lower_limit ? AtLimit::lower : AtLimit::upper;
                y_.resize(base_);
                collide();
                if (!fails()) settle();
                if (!fails()) record_rest(e);
                return;
            case Cause::stops:
                form_.stop(e, y_.data());
                y_.resize(base_);
                switches_.set_signs(form_, y_.data());
                return settle();
            case Cause::low_force:
            case Cause::high_force:
                for (std::size_t other = 0; other < states_.size(); ++other)
                    if (states_[other].leader == e && states_[other].mode == JointMode::held)
                        release(other, (found.cause == Cause::low_force) == (states_[other].direction > 0));
                select();
                resolve_switches();
                return;
            case Cause::switches:
                return;
        }
    }
    void release(std::size_t e, bool forward) {
        record_start(e, states_[e].at);
        start_moving(e, forward, 2);
    }
    void cross_switch(std::size_t which) {
        if (const std::string fault = switches_.cross(form_, which, y_.data()); !fault.empty()) return fail(fault);
        y_.resize(base_);
        settle();
    }

    /// Records the arrival of a joint that now rests on a limit, unless an impact there did. A joint that turns at a
    /// distance from the limit below the rounding of its coordinate arrives without an impact.
    void record_rest(std::size_t e) {
        if (states_[e].mode != JointMode::held) return;
        for (auto event = run_.events.rbegin(); event != run_.events.rend() && event->t == t_; ++event)
            if (event->joint == limited_joint(e) && event->kind == JointEventKind::rests) return;
        record(e, states_[e].at, JointEventKind::rests);
    }

    /// The first event in a step of length h. Rates that fall to the error of the steps count as zero.
    std::optional<Found> first_event(const StepExpansion<P>& expansion, const P& h) {
        std::optional<Found> first;
        const int order = expansion.order();
        const auto look = [&](std::size_t e, Cause cause, const std::vector<P>& c, std::size_t zeros, double noise) {
            const std::optional<P> after = FirstRoot<P>(c, zeros, first ? first->after : h, noise).find();
            if (after && (!first || *after < first->after)) first = Found{e, cause, *after};
        };
        std::size_t k_held = 0;
        for (std::size_t e = 0; e < states_.size(); ++e) {
            State& state = states_[e];
            const double rounding = std::pow(10.0, -settings_.digits);
            if (state.mode == JointMode::held && state.leader != e) continue;
            if (state.mode == JointMode::held) {
                const Box<P>& box = state.box;
                std::vector<P> low = function_coefficients(expansion, form_.holding_force(k_held++)), high = low;
                for (P& c : high) c = -c;
                low[0] = low[0] - box.low, high[0] = high[0] + box.high;
                if (box.has_low) allow_rounding(e, low[0]);
                if (box.has_high) allow_rounding(e, high[0]);
                if (box.has_low) look(e, Cause::low_force, low, 0, 0);
                if (box.has_high) look(e, Cause::high_force, high, 0, 0);
                continue;
            }
            const int place = form_.coordinate(e);
            std::vector<P> x, rate;
            for (int k = 0; k <= order; ++k) x.push_back(expansion.coefficient(place, k));
            if (expansion.is_of_method() && (state.limit_zeros > 0 || state.rate_zeros > 0)) refine(x, place, h);
            for (int k = 0; k < order; ++k) rate.push_back(P(k + 1) * x[static_cast<std::size_t>(k) + 1]);
            if (expansion.is_of_method()) take_rate(e, expansion, h, rate, x);
            state.largest_rate = std::max(state.largest_rate, std::abs(static_cast<double>(rate[0])));
            if (joint(e).lower.exists) {
                std::vector<P> gap = x;
                gap[0] = gap[0] - joint(e).lower.coordinate;
                look(e, Cause::lower_limit, gap, zeros_of_gap(state, AtLimit::lower, gap), 0);
            }
            if (joint(e).upper.exists) {
                std::vector<P> gap = x;
                for (P& c : gap) c = -c;
                gap[0] = gap[0] + joint(e).upper.coordinate;
                look(e, Cause::upper_limit, gap, zeros_of_gap(state, AtLimit::upper, gap), 0);
            }
            if (state.mode == JointMode::free) continue;
            if (state.mode == JointMode::backward)
                for (P& c : rate) c = -c;
            look(e, Cause::stops, rate, state.rate_zeros, state.largest_rate * rounding);
        }
        if (form_.has_formulas()) look_at_switches(expansion, h, look);
        return first;
    }
    // Leading coefficients of the distance from a limit that vanish. After a short step away from the limit, which
    // methods start with, the distance is still a rounding error.
    std::size_t zeros_of_gap(const State& state, AtLimit at, const std::vector<P>& gap) const {
        if (state.left == at && state.limit_zeros > 0) return state.limit_zeros;
        return settings_.steps && Elementary<P>::magnitude(gap[0]) <= P(error_) && gap[1] > P(0) ? 1 : 0;
    }
    // In short steps of a method the derivative of the coordinate's polynomial is a rounding error, unlike the
    // polynomial of the rate.
    void take_rate([[maybe_unused]] std::size_t e, [[maybe_unused]] const StepExpansion<P>& expansion,
                   [[maybe_unused]] const P& h, [[maybe_unused]] std::vector<P>& rate,
                   [[maybe_unused]] std::vector<P>& x) const {
        if constexpr (requires { form_.rate(e); }) {
            for (std::size_t k = 0; k < rate.size(); ++k)
                rate[k] = expansion.coefficient(form_.rate(e), static_cast<int>(k));
            if (states_[e].rate_zeros > 0) refine(rate, form_.rate(e), h);
            for (std::size_t k = 0; k < rate.size(); ++k) x[k + 1] = rate[k] / P(static_cast<double>(k + 1));
        } else if constexpr (requires { form_.rate_function(e); }) {
            const int place = form_.rate_function(e);
            rate = function_coefficients(expansion, place);
            if (states_[e].rate_zeros > 0) {
                std::vector<P> exact;
                for (int k = 0; k < order_of_starts; ++k)
                    exact.push_back(P(k + 1) * P(series_->coefficient(place, k + 1)));
                refine(rate, exact, h);
            }
            for (std::size_t k = 0; k < rate.size(); ++k) x[k + 1] = rate[k] / P(static_cast<double>(k + 1));
        }
    }
    // A force that is at its bound up to rounding falls below it only by more than rounding.
    void allow_rounding(std::size_t e, P& distance) {
        const P size = Elementary<P>::magnitude(distance);
        if (!(size * size <= Elementary<P>::epsilon())) return;
        const P rounding = least_acceleration() / form_.response({e}, y_.data()).front();
        if (size <= rounding) distance = distance + rounding;
    }
    // Looks for the first switch whose argument passes its threshold.
    template <class Look>
    void look_at_switches(const StepExpansion<P>& expansion, const P& h, const Look& look) {
        const auto& terms = form_.terms();
        const std::vector<int>& active = terms.active_switches();
        for (std::size_t k = 0; k < active.size(); ++k) {
            const int sign = terms.sign(active[k]), place = form_.switch_argument(k);
            if (sign == 0) continue;
            const P threshold = terms.switch_threshold(active[k]);
            std::vector<P> c = function_coefficients(expansion, place);
            const P value = c[0];
            c[0] = c[0] - threshold;
            if (sign < 0)
                for (P& one : c) one = -one;
            // after an event at the threshold, the argument differs from it by rounding
            const bool is_at_threshold = switches_.is_zero(active[k], c[0], value);
            look(k, Cause::switches, c, is_at_threshold ? count_zeros(c, h, 1) : 0, 0);
        }
    }

    // Whether the series at the start of a mode by another method is more accurate over a time h than the polynomial of
    // a longer step, whose error is that of the step. The small motions between impacts that accumulate need this.
    bool is_start_accurate(const P& h) const {
        const double log2_h = log2_magnitude(h), allowed = std::log2(1e-2 * settings_.tolerance);
        for (const Block& block : blocks_)
            for (int i = block.first; i < block.first + block.size; ++i)
                for (int k = order_of_starts - 1; k <= order_of_starts; ++k)
                    if (!(log2_magnitude(series_->coefficient(i, k)) + k * log2_h <=
                          allowed + std::log2(std::max(block.scale, std::numeric_limits<double>::min()))))
                        return false;
        return true;
    }
    // Refines the coefficients of a coordinate in the first step of a mode by another method.
    void refine(std::vector<P>& x, int place, const P& h) const {
        std::vector<P> exact;
        for (int k = 0; k <= order_of_starts; ++k) exact.push_back(P(series_->coefficient(place, k)));
        refine(x, exact, h);
    }
    static void refine(std::vector<P>& x, const std::vector<P>& exact, const P& h) {
        P size(0), power(1);
        for (const P& c : x) size = std::max(size, Elementary<P>::magnitude(P(c * power))), power = power * h;
        refine_coefficients(x, exact, h, static_cast<double>(size));
    }
    // sizes of the components of the state for another method
    std::vector<double> state_scales() const {
        std::vector<double> scales = scales_of(blocks_, base_, scene_->duration);
        if constexpr (requires { form_.widen_scales(y_.data(), scales); }) form_.widen_scales(y_.data(), scales);
        return scales;
    }
    // |c_k| h^k <= 10^-digits scale for the last four coefficients, because one may vanish by symmetry
    double step_size() {
        double log2_step = std::numeric_limits<double>::infinity();
        const auto log2_largest = [](const Block& block, auto&& component) {
            double largest = -std::numeric_limits<double>::infinity();
            for (int i = block.first; i < block.first + block.size; ++i)
                largest = std::max(largest, log2_magnitude(component(i)));
            return largest;
        };
        for (Block& block : blocks_) {
            block.scale = std::max(
                block.scale,
                std::exp2(log2_largest(block, [&](int i) -> const P& { return y_[static_cast<std::size_t>(i)]; })));
            for (int k = settings_.order - 3; k <= settings_.order; ++k) {
                const double size = log2_largest(block, [&](int i) -> const T& { return series_->coefficient(i, k); });
                const double allowed = std::log2(block.scale) - settings_.digits * std::log2(10.0);
                log2_step = std::min(log2_step, (allowed - size) / k);
            }
        }
        log2_step = std::min(log2_step, log2_step_of_functions());
        return settings_.step_factor * std::exp2(log2_step);
    }
    // Sizes of the functions whose integrals are components of the state: forces that hold joints, and arguments of
    // switches. Zero if there is none.
    std::vector<double> function_scales() {
        std::vector<double> scales;
        const auto value = [&](int place) { return std::abs(static_cast<double>(P(series_->coefficient(place, 1)))); };
        for (std::size_t k = 0; k < held_.size(); ++k) {
            const Box<P>& box = states_[held_[k]].box;
            double size = value(form_.holding_force(k));
            if (box.has_low) size = std::max(size, std::abs(static_cast<double>(box.low)));
            if (box.has_high) size = std::max(size, std::abs(static_cast<double>(box.high)));
            scales.push_back(size);
        }
        if (!form_.has_formulas()) return scales;
        const std::vector<int>& active = form_.terms().active_switches();
        for (std::size_t k = 0; k < active.size(); ++k)
            scales.push_back(std::max(value(form_.switch_argument(k)), switches_.largest(active[k])));
        return scales;
    }
    // The same criterion for the functions, which change where the state does not, such as in modes in which all joints
    // are held or driven.
    double log2_step_of_functions() {
        double log2_step = std::numeric_limits<double>::infinity();
        const std::vector<double> scales = function_scales();
        for (std::size_t f = 0; f < scales.size(); ++f) {
            if (!(scales[f] > 0)) continue;
            const int place = form_.holding_force(f);
            for (int k = settings_.order - 3; k <= settings_.order; ++k) {
                const double size = std::log2(static_cast<double>(k)) + log2_magnitude(series_->coefficient(place, k));
                const double allowed = std::log2(scales[f]) - settings_.digits * std::log2(10.0);
                log2_step = std::min(log2_step, (allowed - size) / (k - 1));
            }
        }
        return log2_step;
    }
};

}  // namespace polhode::contact
