// A mechanism in joint coordinates with limits and friction of joints, for JointDriver (follow_joints.h). Friction of a
// moving joint is a constant force on its coordinate. A joint that is held is locked; the force of the lock is the
// force that holds it.
//
// A joint with a prescribed motion has a given acceleration. Impulses do not change its rate. Loads given by formulas
// are those of FormulaTree, with the branches of the current signs of all switches (joint_switches.h).
//
// State: coordinates and rates of the tree, the time if motions are prescribed or loads are formulas, the variables of
// the formulas, then the time integrals of functions: the forces that hold joints, and the arguments of switches.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/joint_events.h"
#include "integrators/contact/prescribed_motions.h"
#include "motion/formula_tree.h"
#include "motion/mechanism_motion_of.h"
#include "motion/tree.h"

namespace polhode::contact {

template <class P>
class JointTreeForm {
  public:
    static constexpr const char* name = "joint coordinates";

    /// The scene must outlive the form.
    explicit JointTreeForm(const Scene& scene) : scene_(&scene), joints_(event_joints<P>(scene)), motions_(scene) {
        const std::vector<MassProperties<P>> properties = bodies_mass_properties<P>(scene);
        if (has_formula_loads(scene))
            formulas_.emplace(scene, compile_formulas(scene, scene.name), properties);
        else
            plain_.emplace(scene, properties);
        for (const EventJoint<P>& one : joints_) links_.push_back(tree().links().link_of_joint[one.joint]);
        for (std::size_t k = 0; k < motions_.size(); ++k)
            driven_.push_back(tree().links().link_of_joint[motions_.joint(k)]);
        if (driven_.empty()) return;
        std::vector<typename Tree<P>::Start> starts;
        const auto states = motions_.states(P(0));
        for (std::size_t k = 0; k < driven_.size(); ++k)
            starts.push_back({driven_[k], states[k].coordinate, states[k].rate});
        tree().restart(starts);
    }

    const std::vector<EventJoint<P>>& joints() const { return joints_; }
    std::vector<P> initial() const {
        std::vector<P> y(static_cast<std::size_t>(base_dimension()), P(0));
        tree().initial(y.data());
        return y;
    }
    /// Selects the loads from `begin` (s) on and applies the impulses there. All joints are free then. The signs of
    /// switches are those of their values.
    void enter(double begin, P* y) {
        begin_ = begin;
        held_.clear(), arguments_ = 0;
        lock_driven();
        tree().set_loads(*scene_, begin);
        if (has_time()) y[time_index()] = P(begin);
        if (!formulas_) refresh(y);
        const std::size_t n = static_cast<std::size_t>(tree().dimension());
        if (driven_.empty()) {
            tree().apply_impulses(*scene_, begin, y);
        } else {
            std::vector<P> longer = with_accelerations(y);
            tree().apply_impulses(*scene_, begin, longer.data());
            std::copy_n(longer.begin(), n, y);
        }
        if (!formulas_) return;
        terms().enter(begin);
        terms().sample(
            begin, [&] { return formula_state(y); }, y + time_index() + 1);
        terms().set_signs(formula_state(y));
        refresh(y);
    }
    /// Sets a constant force on each joint, and the joints that are held.
    void select(const std::vector<P>& forces, const std::vector<std::size_t>& held) {
        tree().set_loads(*scene_, begin_);
        for (std::size_t e = 0; e < links_.size(); ++e)
            if (!(forces[e] == P(0))) tree().add_motor(links_[e], forces[e]);
        held_.clear();
        for (const std::size_t e : held) held_.push_back(links_[e]);
        arguments_ = formulas_ ? terms().active_switches().size() : 0;
        tree().lock(held_, driven_, base_dimension());
    }

    /// The dimension without functions.
    int base_dimension() const { return motion_variables() + static_cast<int>(motions_.variables()); }
    int dimension() const { return switch_argument(arguments_); }
    /// Index of a joint's coordinate, of the integral of the k-th force that holds a joint, and of the integral of the
    /// argument of the k-th active switch.
    int coordinate(std::size_t e) const { return link(e).coordinate; }
    /// Index of the rate of a joint's coordinate.
    int rate(std::size_t e) const { return link(e).rate; }
    int holding_force(std::size_t k) const { return base_dimension() + static_cast<int>(k); }
    int switch_argument(std::size_t k) const { return holding_force(held_.size() + k); }
    template <class S>
    void derivative(const S* y, S* dy) const {
        if (driven_.empty()) return derivative_with_drives(y, dy);
        const std::vector<S> longer = with_accelerations(y);
        derivative_with_drives(longer.data(), dy);
    }
    /// The accelerations of all event joints, and the forces that hold joints, in the selected system.
    struct Selected {
        std::vector<P> accelerations, holding;
    };
    Selected selected(const P* y) const {
        std::vector<P> dy(static_cast<std::size_t>(dimension()));
        derivative(y, dy.data());
        Selected result;
        for (std::size_t e = 0; e < links_.size(); ++e)
            result.accelerations.push_back(dy[static_cast<std::size_t>(link(e).rate)]);
        for (std::size_t k = 0; k < held_.size(); ++k)
            result.holding.push_back(dy[static_cast<std::size_t>(holding_force(k))]);
        return result;
    }

    /// Sets the variables of the formulas to their values.
    void refresh(P* y) const {
        if (formulas_) formulas_->refresh(y);
        if (has_time()) motions_.update(y[time_index()], y + motion_variables());
    }

    // For FormulaSwitches (motion/formula_switches.h) and JointSwitches, if loads are formulas.
    bool has_formulas() const { return formulas_.has_value(); }
    FormulaValues<P>& terms() { return formulas_->terms(); }
    MechanismState<P> formula_state(const P* y) const { return formulas_->formula_state(y); }
    /// The arguments of the active switches.
    std::vector<P> switch_values(const P* y) const { return formulas_->switch_arguments(y); }
    /// The rates of the state without functions.
    void base_derivative(const P* y, P* dy) const {
        formulas_->derivative_by(driven_.empty() ? y : with_accelerations(y).data(), dy, true);
    }
    P switch_rate(int which, const P* y) const {
        return formulas_->switch_rate(which, driven_.empty() ? y : with_accelerations(y).data());
    }

    std::vector<P> rates(const P* y) const {
        std::vector<P> all;
        for (std::size_t e = 0; e < links_.size(); ++e) all.push_back(y[link(e).rate]);
        return all;
    }
    /// The changes of the rates of some joints by a unit impulse on each of them: row i, joint j.
    std::vector<P> response(const std::vector<std::size_t>& some, const P* y) {
        const std::size_t n = some.size();
        std::vector<P> matrix(n * n);
        for (std::size_t j = 0; j < n; ++j) {
            const std::vector<P> change = unit_response(some[j], y);
            for (std::size_t i = 0; i < n; ++i)
                matrix[i * n + j] = change[static_cast<std::size_t>(link(some[i]).rate - tree().links().coordinates)];
        }
        return matrix;
    }
    /// Applies an impulse on a joint's coordinate.
    void push(std::size_t e, const P& impulse, P* y) {
        const std::vector<P> change = unit_response(e, y);
        for (std::size_t k = 0; k < change.size(); ++k) {
            P& rate = y[static_cast<std::size_t>(tree().links().coordinates) + k];
            rate = rate + impulse * change[k];
        }
    }
    /// Moves y back onto the constraints of loops and couplings, from which rounding in binary64 leads away.
    void project(P* y) requires std::is_same_v<P, double> {
        if (scene_->loops.empty() && scene_->couplings.empty()) return;
        tree().lock({});
        tree().project(y);
        tree().lock(held_, driven_, base_dimension());
    }
    /// Sets the rate of a joint that is at rest up to rounding to zero.
    void stop(std::size_t e, P* y) const { y[link(e).rate] = P(0); }

    std::vector<BodyMotion<P>> motion(const P* y) const {
        std::vector<BodyMotion<P>> all = tree().motions(y);
        for (BodyMotion<P>& body : all) body.q = normalized(body.q);
        return all;
    }
    std::vector<Reaction<P>> reactions(const P* y) const {
        const std::vector<P> longer = with_accelerations(y);
        return formulas_ ? formulas_->reactions(*scene_, longer.data(), true)
                         : tree().reactions(*scene_, longer.data());
    }
    std::vector<std::array<P, 2>> joint_coordinates(const P* y) const { return tree().joint_coordinates(y); }

    std::vector<Block> blocks(const std::vector<double>& scales) const {
        std::vector<Block> all;
        const auto note = [&](int first, int size) {
            all.push_back({first, size, scales[static_cast<std::size_t>(first)]});
        };
        for (const Link<P>& one : tree().links().links) {
            if (one.kind == LinkJoint::free) {
                note(one.coordinate, 4), note(one.coordinate + 4, 3);
                note(one.rate, 3), note(one.rate + 3, 3);
            } else {
                note(one.coordinate, one.coordinates()), note(one.rate, one.rates());
            }
        }
        for (int i = time_index() + 1; i < base_dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

    /// Increases the scales of the state y at the start of a mode. With the scale x of a coordinate, its rate has at
    /// least the scales x / duration and sqrt(acceleration x). Prescribed coordinates and rates have their largest
    /// lengths over the run.
    void widen_scales(const P* y, std::vector<double>& scales) const {
        const auto widen = [&](int i, double size) {
            double& scale = scales[static_cast<std::size_t>(i)];
            scale = std::max(scale, std::abs(size));
        };
        std::vector<P> dy(static_cast<std::size_t>(dimension()));
        derivative(y, dy.data());
        for (const Link<P>& one : tree().links().links)
            for (int i = 0; one.kind != LinkJoint::free && i < std::min(one.rates(), one.coordinates()); ++i) {
                const double size = scales[static_cast<std::size_t>(one.coordinate) + static_cast<std::size_t>(i)];
                const P& acceleration = dy[static_cast<std::size_t>(one.rate) + static_cast<std::size_t>(i)];
                widen(one.rate + i, std::sqrt(std::abs(static_cast<double>(acceleration)) * size));
                widen(one.rate + i, size / scene_->duration);
            }
        constexpr int points = 200;
        for (int i = 0; !driven_.empty() && i <= points; ++i) {
            const auto states = motions_.states(P(scene_->duration * i / points));
            for (std::size_t k = 0; k < driven_.size(); ++k) {
                const Link<P>& one = tree().links().links[static_cast<std::size_t>(driven_[k])];
                widen(one.coordinate, static_cast<double>(states[k].coordinate));
                widen(one.rate, static_cast<double>(states[k].rate));
            }
        }
    }

  private:
    const Scene* scene_;
    std::optional<Tree<P>> plain_;            // without formulas
    std::optional<FormulaTree<P>> formulas_;  // with formulas
    std::vector<EventJoint<P>> joints_;
    PrescribedMotions<P> motions_;
    std::vector<int> links_;   // by event joint
    std::vector<int> held_;    // links that are held
    std::vector<int> driven_;  // links with prescribed motions
    double begin_ = 0;
    std::size_t arguments_ = 0;  // number of active switches

    Tree<P>& tree() { return formulas_ ? formulas_->tree() : *plain_; }
    const Tree<P>& tree() const { return formulas_ ? formulas_->tree() : *plain_; }
    bool has_time() const { return formulas_ || !driven_.empty(); }
    int time_index() const { return tree().dimension(); }
    // index of the first variable of prescribed motions
    int motion_variables() const {
        return tree().dimension() + (has_time() ? 1 : 0) + (formulas_ ? formulas_->terms().auxiliaries() : 0);
    }
    void lock_driven() { tree().lock({}, driven_, base_dimension()); }

    // The state without functions, and the accelerations of driven links.
    template <class S>
    std::vector<S> with_accelerations(const S* y) const {
        std::vector<S> longer(y, y + base_dimension());
        if (driven_.empty()) return longer;
        for (const S& a : motions_.accelerations(y[time_index()], y + motion_variables())) longer.push_back(a);
        return longer;
    }
    template <class S>
    void derivative_with_drives(const S* y, S* dy) const {
        if (formulas_) {
            formulas_->derivative_by(y, dy, true);
        } else {
            plain_->derivative(y, dy);
            if (has_time()) dy[time_index()] = S(P(1));
        }
        if (has_time()) motions_.variable_rates(y[time_index()], y + motion_variables(), dy + motion_variables());
        const std::vector<S>& forces = tree().template work<S>().locks;
        for (std::size_t k = 0; k < held_.size(); ++k) dy[holding_force(k)] = forces[k];
        if (arguments_ == 0) return;
        const std::vector<S> arguments = formulas_->switch_arguments(y);
        for (std::size_t k = 0; k < arguments_; ++k) dy[switch_argument(k)] = arguments[k];
    }
    // The changes of all rates by a unit impulse on an event joint, at constant rates of the driven links. Releases the
    // held joints; the driver selects a mode afterwards.
    std::vector<P> unit_response(std::size_t e, const P* y) {
        lock_driven();
        return tree().unit_response(links_[e], driven_.empty() ? y : with_accelerations(y).data());
    }
    const Link<P>& link(std::size_t e) const { return tree().links().links[static_cast<std::size_t>(links_[e])]; }
};

}  // namespace polhode::contact
