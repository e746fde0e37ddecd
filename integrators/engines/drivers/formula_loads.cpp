#include "integrators/engines/drivers/formula_loads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "formula/evaluate.h"
#include "motion/finite.h"

namespace polhode::engines {
namespace {

using formula::Node, formula::no_node, formula::Operation;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// Attitude of the axes to which the formulas refer.
Quaternion<double> formula_attitude(const EngineFormulas& formulas, std::size_t body, const Motion& at) {
    return normalized(at.q) * conjugate(formulas.axes[body]);
}

}  // namespace

FormulaLoads::FormulaLoads(const EngineFormulas& formulas, const Mechanism& mechanism)
    : formulas_(&formulas),
      mechanism_(&mechanism),
      inputs_(index(formulas.count_inputs()), 0),
      values_(formulas.operations.size(), 0),
      due_(formulas.holds.size(), 0),
      loads_(formulas.axes.size()) {
    const int first = formulas.joint_input(0), end = formulas.joint_input(formulas.coordinates.size());
    for (std::size_t j = 0; j < formulas.coordinates.size(); ++j)
        inputs_[index(formulas.joint_input(j))] = formulas.coordinates[j];
    for (const Node& node : formulas.operations) {
        if (node.operation != Operation::input || node.a < first || node.a >= end) continue;
        const std::size_t joint = index((node.a - first) / 2);
        if (std::ranges::find(joints_read_, joint) == joints_read_.end()) joints_read_.push_back(joint);
    }
}

std::vector<double> FormulaLoads::split(double t, double stop) {
    std::vector<double> ends;
    for (; next_time_ < formulas_->times.size() && formulas_->times[next_time_] < stop; ++next_time_)
        if (formulas_->times[next_time_] > t) ends.push_back(formulas_->times[next_time_]);
    ends.push_back(stop);
    return ends;
}

const std::vector<BodyLoad>& FormulaLoads::evaluate(double t, double h, const std::vector<Motion>& motions) {
    set_inputs(t, motions);
    sample(t, h);
    compute(values_.size());
    loads_.assign(loads_.size(), {});
    const double middle = t + 0.5 * h;
    for (const EngineFormulaLoad& load : formulas_->loads)
        if (load.window.from <= middle && middle < load.window.until) add_load(load, t, motions);
    return loads_;
}

void FormulaLoads::set_inputs(double t, const std::vector<Motion>& motions) {
    inputs_[FormulaInputs::time] = t;
    for (std::size_t b = 0; b < motions.size(); ++b) {
        const Motion& at = motions[b];
        const Quaternion<double> q = formula_attitude(*formulas_, b, at);
        const Vector3<double> w = rotate_back(q, at.w);
        double* const to = inputs_.data() + MechanismInputs::of_body(static_cast<int>(b), 0);
        std::copy_n(&w[0], 3, to + FormulaInputs::angular_velocity);
        const double attitude[] = {q.w, q.x, q.y, q.z};
        std::copy_n(attitude, 4, to + FormulaInputs::attitude);
        std::copy_n(&at.p[0], 3, to + FormulaInputs::position), std::copy_n(&at.v[0], 3, to + FormulaInputs::velocity);
    }
    for (const std::size_t j : joints_read_) {
        const LinkJoint& joint = mechanism_->joints[j];
        const auto [x, rate] = joint_coordinate(joint, *mechanism_, motions);
        double& coordinate = inputs_[index(formulas_->joint_input(j))];
        const double now = x + formulas_->coordinates[j];
        // counts full revolutions
        coordinate =
            joint.type == "revolute" ? coordinate + std::remainder(now - coordinate, 2 * std::numbers::pi) : now;
        inputs_[index(formulas_->joint_input(j)) + 1] = rate;
    }
}

void FormulaLoads::sample(double t, double h) {
    // steps start at the multiples only up to rounding
    const double reached = t + 1e-6 * h;
    for (std::size_t i = 0; i < due_.size(); ++i) {
        const EngineHold& hold = formulas_->holds[i];
        if (reached < due_[i] * hold.period) continue;
        due_[i] = std::floor(reached / hold.period) + 1;
        compute(index(hold.value) + 1);
        inputs_[index(hold.input)] = values_[index(hold.value)];
    }
}

// Computes the first `count` operations.
void FormulaLoads::compute(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) values_[i] = compute_operation(formulas_->operations[i]);
}

double FormulaLoads::compute_operation(const Node& node) const {
    const auto value = [&](int operand) { return values_[index(operand)]; };
    switch (node.operation) {
        case Operation::number:
            return node.value;
        case Operation::input:
            return inputs_[index(node.a)];
        case Operation::add:
            return value(node.a) + value(node.b);
        case Operation::subtract:
            return value(node.a) - value(node.b);
        case Operation::multiply:
            return value(node.a) * value(node.b);
        case Operation::divide:
            return value(node.a) / value(node.b);
        case Operation::negate:
            return -value(node.a);
        case Operation::square_root:
            return std::sqrt(value(node.a));
        case Operation::sine:
            return std::sin(value(node.a));
        case Operation::cosine:
            return std::cos(value(node.a));
        case Operation::choose: {
            const auto& [argument, threshold] = formulas_->switches[index(node.a)];
            const double difference = value(argument) - (threshold == no_node ? 0 : value(threshold));
            return passes(node.test, formula::Functions<double>::sign(difference)) ? value(node.b) : value(node.c);
        }
        default:
            return formula::compute_transcendental<double>(node.operation, value(node.a),
                                                           node.b == no_node ? 0 : value(node.b));
    }
}

void FormulaLoads::add_load(const EngineFormulaLoad& load, double t, const std::vector<Motion>& motions) {
    Vector3<double> value;
    for (int i = 0; i < load.components(); ++i) value[i] = values_[index(load.value[index(i)])];
    if (!all_finite(value)) throw std::runtime_error(fmt::format("a formula has no finite value at t = {:.6g} s", t));
    if (load.kind == FormulaKind::motor) {
        add_joint_force(mechanism_->joints[index(load.joint)], value[0], motions,
                        [&](int body, const Vector3<double>& force, const Vector3<double>& torque) {
                            BodyLoad& sum = loads_[index(body)];
                            sum.force = sum.force + force, sum.torque = sum.torque + torque;
                        });
        return;
    }
    BodyLoad& sum = loads_[index(load.body)];
    const Motion& at = motions[index(load.body)];
    const Quaternion<double> q = formula_attitude(*formulas_, index(load.body), at);
    const Vector3<double> in_world = load.frame == Frame::body ? rotate(q, value) : value;
    if (load.kind == FormulaKind::torque) {
        sum.torque = sum.torque + in_world;
        return;
    }
    sum.force = sum.force + in_world;
    if (!load.point) return;
    const Vector3<double> arm = load.point_frame == Frame::body ? rotate(q, *load.point) : *load.point - at.p;
    sum.torque = sum.torque + cross(arm, in_world);
}

}  // namespace polhode::engines
