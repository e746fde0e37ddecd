// Follows a mechanism whose joints have limits and Coulomb friction from event to event, for any formulation and
// scalar.
//
// JointDriver integrates a formulation (joint_tree_form.h, truth/joint_maximal_form.h) by Taylor series (A. Jorba and
// M. Zou 2005, Exp. Math. 14, 99) or, in binary64, by the steps of another method (mode_steps.h). Each mode is a smooth
// system: a joint moves without friction, forward or backward against its friction, or is held by friction or at a
// limit. A mode ends where an event function falls to zero (event_roots.h): the distance from a limit, the rate of a
// joint with friction, or the distance of the holding force from its bounds. An arrival at a limit is an impact by
// Newton's law on the coordinate, in which all joints take part and friction, which is bounded, exerts no impulse.
// Where rates vanish, the complementarity problem of box_forces.h decides which joints are held: [-F, F] bounds the
// force of friction F, and a limit removes the bound on its side.
//
// Infinitely many impacts end where the speed of separation is within the error of the steps.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "integrators/contact/box_forces.h"
#include "integrators/contact/contact_state.h"
#include "integrators/contact/event_roots.h"
#include "integrators/contact/joint_events.h"
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
            if (leg.index == 0) require_independence(), find_limits();
            if (!fails()) collide();
            if (!fails()) choose_modes();
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
    };
    enum class Cause { lower_limit, upper_limit, stops, low_force, high_force };
    struct Found {
        std::size_t joint;
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
    std::optional<Series<T>> series_;
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

    // Loops can make the coordinates of several joints depend on each other; the forces that hold them are then not
    // unique. The pivots of the matrix of responses measure this.
    void require_independence() {
        if (scene_->loops.empty()) return;
        const std::size_t n = states_.size();
        const std::vector<P> response = form_.response(y_.data());
        std::vector<P> A = response;
        for (std::size_t k = 0; k < n; ++k) {
            const P& diagonal = response[k * n + k];
            if (!(A[k * n + k] > P(1e-9) * diagonal))
                return fail(fmt::format("friction or limits of joint {} depend on those of other joints by a loop",
                                        scene_->joints[joint(k).joint].name));
            for (std::size_t i = k + 1; i < n; ++i) {
                const P factor = A[i * n + k] / A[k * n + k];
                for (std::size_t j = k; j < n; ++j) A[i * n + j] = A[i * n + j] - factor * A[k * n + j];
            }
        }
    }
    // joints that start at a limit up to rounding
    void find_limits() {
        for (std::size_t e = 0; e < states_.size(); ++e) {
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
                if (round == 0 || !(-separation(e, rates) <= least_rate(e)))
                    approaches = approaches || separation(e, rates) < P(0);
            }
            if (!approaches) return;
            if (round == most_rounds) return fail("simultaneous impacts on limits of joints do not end");
            if (!apply_impact(at_limits, rates)) return fail("no impulses were found for impacts on limits of joints");
        }
    }
    // Newton's law for all joints at limits: v+ + e v- >= 0 and impulse >= 0, one of them zero
    bool apply_impact(const std::vector<std::size_t>& at, const std::vector<P>& rates) {
        const std::size_t n = at.size(), all = states_.size();
        const std::vector<P> response = form_.response(y_.data());
        std::vector<P> A(n * n), a;
        std::vector<Box<P>> boxes(n);
        for (std::size_t i = 0; i < n; ++i) {
            const P& v = rates[at[i]];
            const bool approaches = separation(at[i], rates) < P(0);
            a.push_back(approaches ? P((P(1) + limit(at[i], states_[at[i]].at).restitution) * v) : v);
            (states_[at[i]].at == AtLimit::lower ? boxes[i].has_high : boxes[i].has_low) = false;
            for (std::size_t j = 0; j < n; ++j) A[i * n + j] = response[at[i] * all + at[j]];
        }
        const auto found = BoxForces<P>(std::move(A), std::move(a), std::move(boxes)).solve();
        if (!found) return false;
        for (std::size_t i = 0; i < n; ++i) {
            const P& impulse = found->forces[i];
            if (impulse == P(0)) continue;
            form_.push(at[i], impulse, y_.data());
            record(at[i], states_[at[i]].at, JointEventKind::impact, impulse);
        }
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

    /// Decides which joints at rest are held, and where the others start to move.
    void choose_modes() {
        const std::vector<P> rates = form_.rates(y_.data());
        std::vector<std::size_t> at_rest;
        std::vector<P> forces(states_.size(), P(0));
        for (std::size_t e = 0; e < states_.size(); ++e) {
            State& state = states_[e];
            state.largest_rate = std::max(state.largest_rate, std::abs(static_cast<double>(rates[e])));
            state.rate_zeros = 0;
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
        const std::size_t n = at_rest.size(), all = states_.size();
        y_.resize(base_);
        form_.select(forces, {});
        const std::vector<P> free = accelerations();
        const std::vector<P> response = form_.response(y_.data());
        std::vector<P> A(n * n), a;
        std::vector<Box<P>> boxes;
        for (std::size_t i = 0; i < n; ++i) {
            a.push_back(free[at_rest[i]]);
            boxes.push_back(box_of(at_rest[i]));
            for (std::size_t j = 0; j < n; ++j) A[i * n + j] = response[at_rest[i] * all + at_rest[j]];
        }
        const auto found = BoxForces<P>(std::move(A), std::move(a), std::move(boxes)).solve();
        if (!found) {
            fail("the set of joints that are held by friction or limits was not found");
            return false;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t e = at_rest[i];
            State& state = states_[e];
            const JointMode former = state.mode;
            const AtLimit at = state.at;
            const bool has_friction = joint(e).friction > P(0), at_limit = at != AtLimit::none;
            if (found->sides[i] == BoxSide::within) {
                state.mode = JointMode::held;
                if (former != JointMode::held && has_friction && !at_limit) record(e, JointEventKind::sticks);
                continue;
            }
            start_moving(e, found->sides[i] == BoxSide::low, 1);
            if (former == JointMode::held) record_start(e, at);
        }
        return true;
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
        Series<T> series(cast_recording<T>(polhode::record<P>(form_, form_.dimension())), 2);
        series.expand(y_.data());
        std::vector<P> all;
        for (std::size_t e = 0; e < states_.size(); ++e)
            all.push_back(P(2) * P(series.coefficient(form_.coordinate(e), 2)));
        return all;
    }

    // Selects the system of the current modes.
    void select() {
        held_.clear();
        std::vector<P> forces;
        for (std::size_t e = 0; e < states_.size(); ++e) {
            forces.push_back(force_of(e));
            if (states_[e].mode == JointMode::held) held_.push_back(e);
        }
        form_.select(forces, held_);
        y_.resize(base_);
        y_.resize(static_cast<std::size_t>(form_.dimension()), P(0));
        steps_.end_mode();
        // with another method, the series only shows how events start
        series_.emplace(cast_recording<T>(polhode::record<P>(form_, form_.dimension())),
                        settings_.steps ? order_of_starts : settings_.order);
    }

    void advance(const Leg& leg) {
        if (run_.steps++ >= settings_.max_steps) return fail("the step limit is reached");
        if (const char* why = settings_.stop()) {
            run_.fault = why;
            return;
        }
        const P remaining = P(leg.end) - t_;
        double step = 0;
        if (settings_.steps) {
            if (!steps_.is_running()) {
                steps_.start(form_, y_.data(), state_scales());
                series_->expand(y_.data());
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
        if (stalled_ > most_stalled || (settings_.steps && run_.events.size() > most_events))
            return fail("too many events of joints");
        std::vector<P> at_sample(y_.size());
        // a sample at an event shows the motion after it
        const auto is_at_event = [&] { return found && P(samples_.front()) >= reached - P(time_error_); };
        for (; samples_.due(leg, reached) && !is_at_event(); samples_.pop()) {
            expansion.evaluate(P(P(samples_.front()) - t_), at_sample.data());
            show(at_sample.data());
        }
        expansion.evaluate(h, y_.data());
        if constexpr (requires { form_.project(y_.data()); }) form_.project(y_.data());
        t_ = reached;
        if (h > P(0))
            for (State& state : states_) state.limit_zeros = state.rate_zeros = 0;
        if (found) handle(*found);
    }

    void handle(const Found& found) {
        const std::size_t e = found.joint;
        State& state = states_[e];
        switch (found.cause) {
            case Cause::lower_limit:
            case Cause::upper_limit:
                state.at = found.cause == Cause::lower_limit ? AtLimit::lower : AtLimit::upper;
                y_.resize(base_);
                collide();
                if (!fails()) choose_modes();
                if (!fails()) record_rest(e);
                return;
            case Cause::stops:
                form_.stop(e, y_.data());
                y_.resize(base_);
                return choose_modes();
            case Cause::low_force:
            case Cause::high_force: {
                record_start(e, state.at);
                start_moving(e, found.cause == Cause::low_force, 2);
                return select();
            }
        }
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
            if (state.mode == JointMode::held) {
                const int place = form_.holding_force(k_held++);
                std::vector<P> force, low, high;
                for (int k = 0; k < order; ++k) force.push_back(P(k + 1) * expansion.coefficient(place, k + 1));
                const Box<P> box = box_of(e);
                low = high = force;
                for (P& c : high) c = -c;
                low[0] = low[0] - box.low, high[0] = high[0] + box.high;
                if (box.has_low) look(e, Cause::low_force, low, 0, 0);
                if (box.has_high) look(e, Cause::high_force, high, 0, 0);
                continue;
            }
            const int place = form_.coordinate(e);
            std::vector<P> x, rate;
            for (int k = 0; k <= order; ++k) x.push_back(expansion.coefficient(place, k));
            if (expansion.is_of_method() && (state.limit_zeros > 0 || state.rate_zeros > 0)) refine(x, place, h);
            for (int k = 0; k < order; ++k) rate.push_back(P(k + 1) * x[static_cast<std::size_t>(k) + 1]);
            state.largest_rate = std::max(state.largest_rate, std::abs(static_cast<double>(rate[0])));
            if (joint(e).lower.exists) {
                std::vector<P> gap = x;
                gap[0] = gap[0] - joint(e).lower.coordinate;
                look(e, Cause::lower_limit, gap, state.left == AtLimit::lower ? state.limit_zeros : 0, 0);
            }
            if (joint(e).upper.exists) {
                std::vector<P> gap = x;
                for (P& c : gap) c = -c;
                gap[0] = gap[0] + joint(e).upper.coordinate;
                look(e, Cause::upper_limit, gap, state.left == AtLimit::upper ? state.limit_zeros : 0, 0);
            }
            if (state.mode == JointMode::free) continue;
            if (state.mode == JointMode::backward)
                for (P& c : rate) c = -c;
            look(e, Cause::stops, rate, state.rate_zeros, state.largest_rate * rounding);
        }
        return first;
    }

    // Refines the coefficients of a coordinate in the first step of a mode by another method.
    void refine(std::vector<P>& x, int place, const P& h) const {
        std::vector<P> exact;
        for (int k = 0; k <= order_of_starts; ++k) exact.push_back(P(series_->coefficient(place, k)));
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
        return settings_.step_factor * std::exp2(log2_step);
    }
};

}  // namespace polhode::contact
