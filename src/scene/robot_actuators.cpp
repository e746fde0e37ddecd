#include "scene/robot_actuators.h"

#include <fmt/format.h>

#include <algorithm>

#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

double within(const JointLimits& range, double x) { return std::max(range.lower, std::min(x, range.upper)); }

// The force of an actuator on the coordinate x of its joint: a + b x + c x', within `bounds`.
struct AffineForce {
    double constant = 0, per_coordinate = 0, per_rate = 0;
    JointLimits bounds;

    AffineForce(const Robot::Actuator& from, double control) {
        const double c = within(from.control, control), g = from.gear;
        const auto coefficient = [&](std::size_t i) { return from.gain[i] * c + from.bias[i]; };
        // l = g (x + reference), and the force on the joint is g f
        constant = g * (coefficient(0) + coefficient(1) * g * from.reference);
        per_coordinate = g * g * coefficient(1), per_rate = g * g * coefficient(2);
        bounds = from.force;
        bounds.lower = g < 0 ? g * from.force.upper : g * from.force.lower;
        bounds.upper = g < 0 ? g * from.force.lower : g * from.force.upper;
    }
    bool is_constant() const { return per_coordinate == 0 && per_rate == 0; }
    std::string formula(const Joint& joint) const {
        const bool turns = joint.type == JointType::revolute;
        std::string sum = shortest_decimal(constant);
        const auto add = [&](double factor, const char* quantity) {
            if (factor != 0)
                sum += fmt::format(" {} {}*\"{}\".{}", factor < 0 ? '-' : '+', shortest_decimal(std::abs(factor)),
                                   joint.name, quantity);
        };
        add(per_coordinate, turns ? "angle" : "displacement");
        add(per_rate, turns ? "rate" : "speed");
        const JointLimits unlimited;
        if (bounds.lower > unlimited.lower && bounds.upper < unlimited.upper)
            return fmt::format("clamp({}, {}, {})", sum, shortest_decimal(bounds.lower),
                               shortest_decimal(bounds.upper));
        if (bounds.lower > unlimited.lower) return fmt::format("max({}, {})", sum, shortest_decimal(bounds.lower));
        if (bounds.upper < unlimited.upper) return fmt::format("min({}, {})", sum, shortest_decimal(bounds.upper));
        return sum;
    }
};

void check_controls(const Robot& robot, const RobotOptions& options, const std::string& path) {
    std::vector<std::string> names;
    for (const Robot::Actuator& one : robot.actuators) names.push_back(one.name);
    for (const auto& [name, value] : options.controls) {
        if (std::ranges::find(names, name) != names.end()) continue;
        const std::string meant = did_you_mean(name, names);
        throw InputError(path, "", fmt::format("has no actuator \"{}\" of a joint", one_line(name, 60)),
                         !meant.empty()  ? meant
                         : names.empty() ? "remove it from \"controls\""
                                         : "give one of " + join_with_commas(names));
    }
}

}  // namespace

void add_actuators(Robot& robot, const RobotOptions& options, const std::string& path, Scene& scene) {
    check_controls(robot, options, path);
    for (const Robot::Actuator& one : robot.actuators) {
        const auto joint = std::ranges::find_if(scene.joints, [&](const Joint& j) {
            return j.name == one.joint && (j.type == JointType::revolute || j.type == JointType::prismatic);
        });
        if (joint == scene.joints.end()) continue;  // its note stays
        const auto given = options.controls.find(one.name);
        const AffineForce force(one, given == options.controls.end() ? 0 : given->second);
        remove_notes(robot, "actuators", {one.name});
        if (!force.is_constant()) {
            FormulaLoad load;
            load.kind = FormulaKind::motor, load.joint = joint->name, load.formula = force.formula(*joint);
            scene.loads.push_back(std::move(load));
            robot.assumed["actuators as motors by formulas"].push_back(one.name);
        } else if (const double constant = within(force.bounds, force.constant); constant != 0) {
            scene.loads.push_back(Motor{joint->name, constant, {}});
            robot.assumed["actuators as constant motors"].push_back(one.name);
        } else {
            robot.assumed["actuators that exert no force with their control"].push_back(one.name);
        }
    }
}

}  // namespace polhode
