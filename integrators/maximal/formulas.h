// The formula loads of a mechanism in maximal coordinates, over any scalar. The inputs of the
// formulas and their forces are computed independently of motion/formula_tree.h; the operations of the formulas are the
// same.
#pragma once

#include <vector>

#include "integrators/maximal/system.h"
#include "motion/formula_tree.h"

namespace polhode::maximal {

template <class P>
class Formulas {
    using System = maximal::System<P>;

  public:
    /// `system`: of the same scene, which must outlive this object. Later calls may pass another one of this scene.
    Formulas(const Scene& scene, const System& system)
        : scene_(&scene),
          terms_(compile_formulas(scene, scene.name),
                 mechanism_formula_constants<P>(scene, bodies_mass_properties<P>(scene))),
          reads_(terms_.set(), scene.bodies.size(), scene.joints.size()) {
        for (const int j : reads_.joints) {
            maximal::Link<P> link = joint(system, j);
            link.of = link.kind, link.kind = maximal::Kind::armature;
            accelerations_.push_back(link);
        }
    }

    /// Sets the joints whose coordinates are held: formulas read their rates and accelerations as zero, because
    /// rounding would give them signs.
    void hold(std::vector<char> held) { held_ = std::move(held); }
    FormulaValues<P>& terms() { return terms_; }
    const FormulaValues<P>& terms() const { return terms_; }

    /// The formulas' inputs at a state, whose time is at y[time]. The variables of the formulas start at y[variables].
    template <class S>
    MechanismState<S> state(const System& system, const S* y, const std::vector<maximal::Placement<S>>& at, int time,
                            int variables) const {
        MechanismState<S> result(scene_->bodies.size(), scene_->joints.size());
        result.input[0] = y[time];
        for (const int b : reads_.bodies) {
            const maximal::Placement<S>& body = at[static_cast<std::size_t>(b)];
            result.set_body(b, body.angular_velocity_B, body.q, body.position_W, body.velocity_W);
        }
        for (const int j : reads_.joints) {
            const maximal::LinkView<P, S> view = system.view(joint(system, j), at);
            const S x =
                joint(system, j).angles >= 0 ? y[system.angles() + joint(system, j).angles] : view.displacement();
            result.set_joint(scene_->bodies.size(), static_cast<std::size_t>(j), x,
                             is_held(j) ? S(0) : view.rates()[0]);
        }
        result.set_held(terms_.held(y + variables));
        return result;
    }
    /// Adds the loads that act to `on`.
    template <class S>
    void add(const System& system, const formula::Evaluation<S, P>& values,
             const std::vector<maximal::Placement<S>>& at, std::vector<maximal::Wrench<S>>& on) const {
        for (const std::size_t i : terms_.acting()) {
            const FormulaTerm& term = terms_.set().terms[i];
            if (term.joint < 0) continue;
            const maximal::Link<P>& link = joint(system, term.joint);
            const maximal::Row<S> row = system.view(link, at).coordinate_rows()[0];
            const S size = values.value(term.value[0]);
            on[static_cast<std::size_t>(link.to.body)].add_to(row, size);
            on[static_cast<std::size_t>(link.from.body)].add_from(row, size);
        }
        add_to_bodies(system, values, at, on);
    }
    /// The reactions at a state under all loads. `lambda`: the multipliers.
    std::vector<Reaction<P>> reactions(const System& system, const formula::Evaluation<P, P>& values, const P* y,
                                       const P* lambda) const {
        System with_motors = system;
        for (const std::size_t i : terms_.acting())
            if (const FormulaTerm& term = terms_.set().terms[i]; term.joint >= 0)
                with_motors.add_motor(static_cast<std::size_t>(term.joint), values.value(term.value[0]));
        const std::vector<maximal::Placement<P>> at = system.placements(y);
        std::vector<maximal::Wrench<P>> further(at.size());
        add_to_bodies(system, values, at, further);
        return with_motors.reactions(y, lambda, further);
    }
    /// The rates of the inputs, from the placements and the rates dy of the state. The variables of the formulas start
    /// at dy[variables].
    template <class S>
    MechanismState<S> state_rates(const System& system, const std::vector<maximal::Placement<S>>& at, const S* dy,
                                  int variables) const {
        MechanismState<S> rates(scene_->bodies.size(), scene_->joints.size());
        rates.input[0] = S(1);
        for (const int b : reads_.bodies) {
            if (system.place(b) < 0) continue;
            const Acceleration<S> a = acceleration_of(system, b, at, dy);
            rates.set_body(b, a.turning_B, quaternion_at(dy, system.place(b)),
                           at[static_cast<std::size_t>(b)].velocity_W, a.linear_W);
        }
        for (std::size_t i = 0; i < reads_.joints.size(); ++i) {
            const maximal::Link<P>& link = accelerations_[i];
            const maximal::Row<S> row = system.view(link, at).constraints()[0];
            const Acceleration<S> to = acceleration_of(system, link.to.body, at, dy),
                                  from = acceleration_of(system, link.from.body, at, dy);
            const S along = dot(row.force_W, to.linear_W - from.linear_W) + dot(row.to_B, to.turning_B) +
                            dot(row.from_B, from.turning_B) + row.bias;
            const S rate = system.view(joint(system, reads_.joints[i]), at).rates()[0];
            if (is_held(reads_.joints[i])) continue;
            rates.set_joint(scene_->bodies.size(), static_cast<std::size_t>(reads_.joints[i]), rate, along);
        }
        rates.set_held(terms_.held(dy + variables));
        return rates;
    }

  private:
    const Scene* scene_;
    FormulaValues<P> terms_;
    FormulaReads reads_;
    std::vector<char> held_;                       // by joint; empty if none is held
    std::vector<maximal::Link<P>> accelerations_;  // by joint that formulas read: rows of its coordinate's acceleration

    template <class S>
    void add_to_bodies(const System& system, const formula::Evaluation<S, P>& values,
                       const std::vector<maximal::Placement<S>>& at, std::vector<maximal::Wrench<S>>& on) const {
        for (const std::size_t i : terms_.acting()) {
            const FormulaTerm& term = terms_.set().terms[i];
            const FormulaLoad& load = term.load;
            if (term.joint >= 0) continue;
            const maximal::Placement<S>& body = at[static_cast<std::size_t>(term.body)];
            maximal::Wrench<S>& sum = on[static_cast<std::size_t>(term.body)];
            const Vector3<S> value(values.value(term.value[0]), values.value(term.value[1]),
                                   values.value(term.value[2]));
            if (load.kind == FormulaKind::torque) {
                Vector3<S>& torque = load.frame == Frame::body ? sum.torque_B : sum.torque_W;
                torque = torque + value;
                continue;
            }
            const Vector3<S> force_W = load.frame == Frame::body ? body.world(value) : value;
            sum.force_W = sum.force_W + force_W;
            if (!load.has_point) continue;
            const Vector3<S> arm_W = load.point_frame == Frame::world
                                         ? Vector3<S>(cast<P>(load.point) - body.position_W)
                                         : Vector3<S>(body.world(system.mechanism().arm(term.body, load.point)));
            sum.torque_W = sum.torque_W + cross(arm_W, force_W);
        }
    }
    bool is_held(int j) const { return !held_.empty() && held_[static_cast<std::size_t>(j)]; }
    static const maximal::Link<P>& joint(const System& system, int j) {
        return system.mechanism().links[static_cast<std::size_t>(j)];
    }
    // Accelerations of a body's centre of mass, world axes, and of its rotation, body axes, from the rates of momenta.
    template <class S>
    struct Acceleration {
        Vector3<S> linear_W, turning_B;
    };
    template <class S>
    Acceleration<S> acceleration_of(const System& system, int b, const std::vector<maximal::Placement<S>>& at,
                                    const S* dy) const {
        const int first = b < system.mechanism().world() ? system.place(b) : -1;
        if (first < 0) return {};
        const maximal::MaximalBody<P>& body = system.mechanism().bodies[static_cast<std::size_t>(b)];
        const maximal::Placement<S>& placement = at[static_cast<std::size_t>(b)];
        const Vector3<S>& w = placement.angular_velocity_B;
        const Vector3<S> torque_B = placement.body(vector_at(dy, first + 7)) - cross(w, body.inertia * w);
        return {(P(1) / body.mass) * vector_at(dy, first + 10), body.inverse_inertia * torque_B};
    }
};

}  // namespace polhode::maximal
