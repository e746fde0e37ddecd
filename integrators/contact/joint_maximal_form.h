// Second formulation of a mechanism with limits and friction of joints, written independently of joint_tree_form.h:
// every body in maximal coordinates (integrators/maximal). The truth verifies the first formulation by it, and IDA's
// methods solve it (constrained_joint_form.h). A joint that is held has a row of constraints for its coordinate; the
// multiplier is the force that holds it. Impulses act on the momenta of all bodies and are propagated by the joints'
// multipliers.
//
// State: that of maximal::System, then the coordinates of the joints with limits or friction, integrated from their
// rates, the time and the variables of the formulas where needed, and the time integrals of the forces that hold joints
// and of the arguments of switches.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/joint_events.h"
#include "integrators/contact/prescribed_motions.h"
#include "integrators/maximal/formulas.h"
#include "integrators/maximal/system.h"

namespace polhode::contact {

template <class P>
class JointMaximalForm {
  public:
    static constexpr const char* name = "maximal coordinates";
    using System = maximal::System<P>;
    using Motions = std::vector<BodyMotion<P>>;

    /// `start`: motions of the bodies at t = 0; `coordinates`: of the joints. `counted`: joints whose coordinates are
    /// in the state of the bodies' equations. The scene must outlive the form.
    JointMaximalForm(const Scene& scene, Motions start, std::vector<std::array<P, 2>> coordinates,
                     std::vector<int> counted = {})
        : scene_(&scene),
          start_(std::move(start)),
          coordinates_(std::move(coordinates)),
          counted_(std::move(counted)),
          joints_(event_joints<P>(scene)),
          motions_(scene),
          driven_(joints_with_motions(motions_)),
          free_(scene, start_, std::span<const std::array<P, 2>>(coordinates_), maximal::LoopRows::shortest, driven_,
                counted_) {
        if (has_formula_loads(scene)) formulas_.emplace(scene, free_);
    }

    const std::vector<EventJoint<P>>& joints() const { return joints_; }
    std::vector<P> initial() const {
        std::vector<P> y(static_cast<std::size_t>(free_.dimension()));
        free_.initial(y.data());
        for (const EventJoint<P>& one : joints_) y.push_back(coordinates_[one.joint][0]);
        y.resize(static_cast<std::size_t>(base_dimension()), P(0));
        return y;
    }
    void enter(double begin, P* y) {
        begin_ = begin;
        system_.reset(), held_ = 0, arguments_ = 0;
        if (formulas_) formulas_->hold({});
        if (driven_.empty())
            free_.enter(begin, y);
        else
            add_momenta(y, [&](P* rest) { free_.enter(begin, rest); });
        if (has_time()) y[time()] = P(begin);
        if (!formulas_) return refresh(y);
        terms().enter(begin);
        terms().sample(
            begin, [&] { return formula_state(y); }, y + time() + 1);
        terms().set_signs(formula_state(y));
        refresh(y);
    }
    void select(const std::vector<P>& forces, const std::vector<std::size_t>& held) {
        std::vector<int> locked;
        for (const std::size_t e : held) locked.push_back(static_cast<int>(joints_[e].joint));
        locked.insert(locked.end(), driven_.begin(), driven_.end());
        held_ = held.size();
        if (formulas_) hold_for_formulas(held);
        arguments_ = formulas_ ? terms().active_switches().size() : 0;
        system_.emplace(*scene_, start_, std::span<const std::array<P, 2>>(coordinates_), maximal::LoopRows::shortest,
                        locked, counted_);
        system_->select_loads(begin_);
        for (std::size_t e = 0; e < joints_.size(); ++e) system_->add_motor(joints_[e].joint, forces[e]);
    }

    int base_dimension() const { return motion_variables() + static_cast<int>(motions_.variables()); }
    int dimension() const { return switch_argument(arguments_); }
    int coordinate(std::size_t e) const { return free_.dimension() + static_cast<int>(e); }
    int holding_force(std::size_t k) const { return base_dimension() + static_cast<int>(k); }
    int switch_argument(std::size_t k) const { return holding_force(held_ + k); }
    template <class S>
    void derivative(const S* y, S* dy) const {
        const std::vector<S> multipliers = find_rates(y, dy);
        for (std::size_t k = 0; k < held_; ++k) {
            const int row = system_->dynamics().first_row(first_lock() + k);
            dy[holding_force(k)] = multipliers[static_cast<std::size_t>(row)];
        }
        if (arguments_ == 0) return;
        const std::vector<S> arguments = switch_arguments(y);
        for (std::size_t k = 0; k < arguments_; ++k) dy[switch_argument(k)] = arguments[k];
    }

    bool has_formulas() const { return formulas_.has_value(); }
    FormulaValues<P>& terms() { return formulas_->terms(); }
    MechanismState<P> formula_state(const P* y) const { return formula_inputs(y, free_.placements(y)); }
    void refresh(P* y) const {
        if (formulas_) formulas_->terms().update_auxiliaries(formula_state(y), y + time() + 1);
        if (has_time()) motions_.update(y[time()], y + motion_variables());
    }
    std::vector<P> switch_values(const P* y) const { return switch_arguments(y); }
    void base_derivative(const P* y, P* dy) const { find_rates(y, dy); }
    P switch_rate(int which, const P* y) const {
        const FormulaValues<P>& terms = formulas_->terms();
        std::vector<P> dy(static_cast<std::size_t>(base_dimension()), P(0));
        find_rates(y, dy.data());
        const std::vector<maximal::Placement<P>> at = free_.placements(y);
        const formula::Evaluation<P, P> values = terms.template evaluate<P>(formula_state(y), nullptr, true);
        const std::vector<P> all =
            values.compute_rates(formulas_->state_rates(free_, at, dy.data(), time() + 1).input.data());
        return all[static_cast<std::size_t>(
            terms.set().auxiliaries[static_cast<std::size_t>(terms.switch_auxiliary(which))])];
    }

    std::vector<P> rates(const P* y) const {
        const std::vector<maximal::Placement<P>> at = free_.placements(y);
        std::vector<P> all;
        for (const EventJoint<P>& one : joints_)
            all.push_back(free_.view(free_.mechanism().links[one.joint], at).rates()[0]);
        return all;
    }
    std::vector<P> response(const std::vector<std::size_t>& some, const P* y) const {
        const std::size_t n = some.size();
        const std::vector<P> before = rates(y);
        std::vector<P> matrix(n * n);
        for (std::size_t j = 0; j < n; ++j) {
            std::vector<P> pushed(y, y + free_.dimension());
            push(some[j], P(1), pushed.data());
            const std::vector<P> after = rates(pushed.data());
            for (std::size_t i = 0; i < n; ++i) matrix[i * n + j] = after[some[i]] - before[some[i]];
        }
        return matrix;
    }
    void push(std::size_t e, const P& impulse, P* y) const {
        if (driven_.empty()) return free_.push(joints_[e].joint, impulse, y);
        add_momenta(y, [&](P* rest) { free_.push(joints_[e].joint, impulse, rest); });
    }
    /// The rate is a function of momenta, which remain as they are; it is zero up to rounding.
    void stop(std::size_t, P*) const {}

    Motions motion(const P* y) const {
        Motions all = free_.motions(y);
        for (BodyMotion<P>& body : all) body.q = normalized(body.q);
        return all;
    }
    std::vector<Reaction<P>> reactions(const P* y) const {
        if (driven_.empty() && !formulas_) return system_->reactions(y);
        std::vector<P> dy(static_cast<std::size_t>(dimension()));
        const std::vector<P> multipliers = find_rates(y, dy.data());
        if (!formulas_) return system_->reactions(y, multipliers.data());
        const formula::Evaluation<P, P> values =
            formulas_->terms().template evaluate<P>(formula_state(y), nullptr, true);
        return formulas_->reactions(*system_, values, y, multipliers.data());
    }

    std::vector<Block> blocks(const Scales& scales) const {
        std::vector<Block> all;
        const maximal::Mechanism<P>& mechanism = free_.mechanism();
        for (int b = 0; b < mechanism.world(); ++b) {
            const int first = free_.place(b);
            if (first < 0) continue;
            const maximal::MaximalBody<P>& body = mechanism.bodies[static_cast<std::size_t>(b)];
            const double reach = static_cast<double>(body.reach());
            const double velocity = std::max(scales.velocity, scales.angular_velocity * reach);
            all.push_back({first, 4, 1});
            all.push_back({first + 4, 3, std::max(scales.position, reach)});
            all.push_back({first + 7, 3, static_cast<double>(body.least_moment()) * scales.angular_velocity});
            all.push_back({first + 10, 3, static_cast<double>(body.mass) * velocity});
        }
        for (int i = free_.angles(); i < free_.dimension(); ++i) all.push_back({i, 1, 1});
        for (int i = time() + 1; i < base_dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

  protected:
    const Scene& scene() const { return *scene_; }
    /// The equations without locks of held joints, and those of the selected mode.
    const System& free_system() const { return free_; }
    const System& mode_system() const { return *system_; }
    const PrescribedMotions<P>& prescribed() const { return motions_; }
    double mode_begin() const { return begin_; }
    /// The loads given by formulas, or null, and their variables in a state.
    const maximal::Formulas<P>* formulas() const { return formulas_ ? &*formulas_ : nullptr; }
    std::vector<P> formula_variables(const P* y) const { return {y + time() + 1, y + motion_variables()}; }
    /// Index of the time in the state, if motions are prescribed or loads are formulas.
    int time() const { return free_.dimension() + static_cast<int>(joints_.size()); }
    bool has_time() const { return formulas_ || !driven_.empty(); }

  private:
    const Scene* scene_;
    Motions start_;
    std::vector<std::array<P, 2>> coordinates_;
    std::vector<int> counted_;
    std::vector<EventJoint<P>> joints_;
    PrescribedMotions<P> motions_;
    std::vector<int> driven_;       // joints with prescribed motions
    System free_;                   // no joint is held; driven joints are locked
    std::optional<System> system_;  // the equations in the current mode
    std::optional<maximal::Formulas<P>> formulas_;
    double begin_ = 0;
    std::size_t held_ = 0, arguments_ = 0;

    // index of the first variable of prescribed motions
    int motion_variables() const {
        return time() + (has_time() ? 1 : 0) + (formulas_ ? formulas_->terms().auxiliaries() : 0);
    }
    // Marks the joints that are held, and those coupled with them.
    void hold_for_formulas(const std::vector<std::size_t>& held) {
        std::vector<char> is_held(scene_->joints.size(), 0);
        for (const std::size_t e : held)
            for (const CoupledJoint<P>& one : coupled_joints<P>(*scene_, joints_[e].joint)) is_held[one.joint] = 1;
        formulas_->hold(std::move(is_held));
    }
    template <class S>
    MechanismState<S> formula_inputs(const S* y, const std::vector<maximal::Placement<S>>& at) const {
        return formulas_->state(free_, y, at, time(), time() + 1);
    }
    template <class S>
    std::vector<S> switch_arguments(const S* y) const {
        const FormulaValues<P>& terms = formulas_->terms();
        std::vector<S> all;
        if constexpr (formula::TracedScalar<S>) {
            for (const SwitchOf<P>& point : switches_of(terms, time() + 1)) all.push_back(y[point.component]);
        } else {
            const formula::Evaluation<S, P> values =
                terms.template evaluate<S>(formula_inputs(y, free_.placements(y)), nullptr, true);
            for (const int which : terms.active_switches())
                all.push_back(
                    values.value(terms.set().auxiliaries[static_cast<std::size_t>(terms.switch_auxiliary(which))]));
        }
        return all;
    }

    static std::vector<int> joints_with_motions(const PrescribedMotions<P>& motions) {
        std::vector<int> all;
        for (std::size_t k = 0; k < motions.size(); ++k) all.push_back(static_cast<int>(motions.joint(k)));
        return all;
    }
    // Applies impulses that leave the rates of driven joints unchanged. System stops these joints, so that the impulses
    // are applied to the system at rest and its momenta added to y.
    template <class Do>
    void add_momenta(P* y, Do&& apply) const {
        constexpr int first = 7, last = System::body_size;
        std::vector<P> rest(y, y + free_.dimension());
        const auto for_momenta = [&](auto&& act) {
            for (int b = 0; b < free_.mechanism().world(); ++b)
                for (int i = first; free_.place(b) >= 0 && i < last; ++i) act(free_.place(b) + i);
        };
        for_momenta([&](int i) { rest[static_cast<std::size_t>(i)] = P(0); });
        apply(rest.data());
        for_momenta([&](int i) { y[i] = y[i] + rest[static_cast<std::size_t>(i)]; });
    }
    // Index of the first locked joint among the links: joints, loops and the two coordinates of each coupling precede.
    std::size_t first_lock() const {
        return scene_->joints.size() + scene_->loops.size() + 2 * scene_->couplings.size();
    }
    // The rates of the state without functions. Returns the multipliers. Like System::rates(), with the accelerations
    // of driven joints in place of zero, and with formulas.
    template <class S>
    std::vector<S> find_rates(const S* y, S* dy) const {
        const std::vector<maximal::Placement<S>> at = system_->placements(y);
        maximal::Rows<S> rows = system_->dynamics().constraints(at);
        if (!driven_.empty()) {
            const std::vector<S> accelerations = motions_.accelerations(y[time()], y + motion_variables());
            for (std::size_t k = 0; k < accelerations.size(); ++k) {
                maximal::Row<S>& row = rows[first_lock() + held_ + k].front();
                row.bias = row.bias - accelerations[k];
            }
        }
        std::vector<maximal::Wrench<S>> on(at.size());
        maximal::add_forces(system_->mechanism(), system_->loads(), at, y + system_->angles(), on);
        std::optional<formula::Evaluation<S, P>> values;
        if (formulas_) {
            values.emplace(formulas_->terms().template evaluate<S>(formula_inputs(y, at), y + time() + 1, true));
            formulas_->add(*system_, *values, at, on);
        }
        std::vector<S> lambda = system_->dynamics().multipliers(at, rows, on);
        system_->dynamics().add_constraint_forces(rows, lambda, on);
        system_->put_rates(at, on, dy);
        for (std::size_t e = 0; e < joints_.size(); ++e)
            dy[coordinate(e)] = system_->view(system_->mechanism().links[joints_[e].joint], at).rates()[0];
        if (has_time()) dy[time()] = S(P(1));
        if (has_time()) motions_.variable_rates(y[time()], y + motion_variables(), dy + motion_variables());
        if (values) put_variable_rates(at, *values, dy);
        return lambda;
    }
    template <class S>
    void put_variable_rates(const std::vector<maximal::Placement<S>>& at, const formula::Evaluation<S, P>& values,
                            S* dy) const {
        const int first = time() + 1;
        for (int i = first; i < motion_variables(); ++i) dy[i] = S(0);
        if (formula::TracedScalar<S>)
            formulas_->terms().auxiliary_rates(formulas_->state_rates(free_, at, dy, first), values, dy + first);
    }
};

}  // namespace polhode::contact
