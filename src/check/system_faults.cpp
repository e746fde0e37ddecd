#include "check/system_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "check/fault_effects.h"
#include "text/message.h"

namespace polhode {
namespace {

// Whether a fault of one body applies to several: faults of loads, of the file's columns, and of damping.
bool applies_to_several_bodies(const Hypothesis& h) {
    static constexpr std::array of_one_body{
        "gravity_in_body_axes", "force_at_center_of_mass", "force_at_wrong_point",   "impulse_at_wrong_point",
        "drag_per_step",        "drag_applied_to_w",       "damping_while_coasting", "loads_missing"};
    if (std::ranges::find(of_one_body, h.fault) != of_one_body.end()) return false;
    switch (h.subject) {
        case Subject::quaternion:
        case Subject::axes:
        case Subject::rate_columns:
        case Subject::lengths:
        case Subject::gyroscopic:
        case Subject::gravity:
        case Subject::torque:
        case Subject::force:
        case Subject::spring:
        case Subject::drag:
        case Subject::damping:
        case Subject::linear_damping:
        case Subject::time:
            return true;
        default:
            return false;
    }
}

SystemHypothesis of_several(const Hypothesis& h) {
    SystemHypothesis s{.fault = h.fault,
                       .subject = h.subject,
                       .what = h.what,
                       .remedy = h.remedy,
                       .apply = [&h](SystemCause& c, double x) { return h.apply(c, x); },
                       .convention = h.convention};
    const bool is_rate = h.subject == Subject::damping || h.subject == Subject::linear_damping;
    if (h.values) s.fit = is_rate ? FittedNumber{0, damping_trial, 0, 1e-4} : FittedNumber{1, 0.7, 0.05, 0.02};
    if (h.subject == Subject::time && s.fit) s.fit->least = 0.2, s.fit->most = 5;
    return s;
}

// Adds the faults of a factor: missing (0), doubled, fitted, and reversed if the quantity has a sign.
void add_factor(std::vector<SystemHypothesis>& all, const std::string& word, Subject subject, const std::string& what,
                const std::string& remedy, const std::function<bool(SystemCause&, double)>& apply,
                bool has_sign = false) {
    const auto fixed = [&](const char* ending, const char* description, double x) {
        all.push_back({.fault = word + ending,
                       .subject = subject,
                       .what = what + description,
                       .remedy = remedy,
                       .apply = [apply, x](SystemCause& c, double) { return apply(c, x); }});
    };
    fixed("_missing", " is missing", 0);
    if (has_sign) fixed("_reversed", " has the opposite sign", -1);
    fixed("_twice", " acts twice", 2);
    all.push_back({.fault = word + "_scaled",
                   .subject = subject,
                   .what = what + " is {} times the scene's",
                   .remedy = remedy,
                   .apply = apply,
                   .fit = FittedNumber{1, 0.7, 0.05, 0.02}});
}

// Adds the faults of the damping of one axis of joint k. `of` names the axis; `inertia`, kg m^2, scales the trial.
void add_joint_damping(std::vector<SystemHypothesis>& all, const Joint& joint, std::size_t k, std::size_t axis,
                       const std::string& of, double inertia) {
    if (joint.damping[axis] > 0)
        add_factor(all, "joint_damping", Subject::damping, "the damping " + of, "give the engine the joint's damping",
                   [k, axis](SystemCause& c, double x) {
                       c.scene.joints[k].damping[axis] *= x;
                       return true;
                   });
    else
        all.push_back({.fault = "joint_damping_left_on",
                       .subject = Subject::damping,
                       .what = fmt::format("damping {} is left on: {{}} {}", of,
                                           joint.type == JointType::prismatic ? "N s/m" : "N m s"),
                       .remedy = "set the engine's joint damping to zero",
                       .apply =
                           [k, axis](SystemCause& c, double x) {
                               c.scene.joints[k].damping[axis] += x;
                               return true;
                           },
                       .fit = FittedNumber{0, damping_trial * inertia, 0, 1e-4 * inertia}});
}

void add_joint_friction(std::vector<SystemHypothesis>& all, const Joint& joint, std::size_t k, std::size_t axis,
                        const std::string& of, double inertia) {
    all.push_back(
        {.fault = "joint_friction_left_on",
         .subject = Subject::limit,
         .what = fmt::format("friction {} is left on: {{}} {}", of, joint.type == JointType::prismatic ? "N" : "N m"),
         .remedy = "set the engine's joint friction to zero",
         .apply =
             [k, axis](SystemCause& c, double x) {
                 c.friction.push_back({k, axis, x});
                 return true;
             },
         .fit = FittedNumber{0, damping_trial * inertia, 0, 1e-4 * inertia}});
}

void add_joint(std::vector<SystemHypothesis>& all, const Scene& scene, std::size_t k, double inertia) {
    const Joint& joint = scene.joints[k];
    const std::string name = one_line(joint.name, 40);
    const int axes = joint.type == JointType::universal ? 2 : joint.type == JointType::fixed ? 0 : 1;
    for (int i = 0; i < axes; ++i) {
        const std::size_t axis = static_cast<std::size_t>(i);
        const std::string of =
            axes > 1 ? fmt::format("of axis {} of joint \"{}\"", i + 1, name) : fmt::format("of joint \"{}\"", name);
        add_joint_damping(all, joint, k, axis, of, inertia);
        if (joint.stiffness[axis] > 0)
            add_factor(
                all, "joint_spring", Subject::spring, "the spring " + of, "give the engine the joint's stiffness",
                [k, axis](SystemCause& c, double x) {
                    // a missing spring keeps its entry among the angles whose turns are counted
                    c.scene.joints[k].stiffness[axis] *= x == 0 ? 1e-30 : x;
                    return true;
                },
                true);
        if (joint.type != JointType::spherical) add_joint_friction(all, joint, k, axis, of, inertia);
    }
    const auto has_motor = [&](const Load& load) {
        const auto* motor = std::get_if<Motor>(&load);
        return motor != nullptr && motor->joint == joint.name;
    };
    if (std::ranges::any_of(scene.loads, has_motor))
        add_factor(
            all, "motor", Subject::torque, fmt::format("the motor of joint \"{}\"", name),
            "give the engine the motor's force",
            [name = joint.name](SystemCause& c, double x) {
                fault_effects::each<Motor>(c.scene, [&](Motor& m) { m.force *= m.joint == name ? x : 1; });
                return true;
            },
            true);
}

void add_body(std::vector<SystemHypothesis>& all, const Scene& scene, std::size_t b) {
    const std::string name = one_line(scene.bodies[b].name, 40);
    const auto number = [](double x) { return std::isfinite(x) && x > 0; };
    if (scene.bodies.size() > 1 && fault_effects::has<Gravity>(scene)) {
        // a force at the centre of mass adds the difference in the weight of one body
        const auto scale_weight = [b](SystemCause& c, double x) {
            const NamedBody& body = c.scene.bodies[b];
            std::vector<Load> more;
            fault_effects::each<Gravity>(c.scene, [&](const Gravity& g) {
                more.push_back(Force{((x - 1) * body.body.mass) * g.acceleration_W, Frame::world,
                                     body.body.center_of_mass, Frame::body, g.window, body.name});
            });
            c.scene.loads.insert(c.scene.loads.end(), more.begin(), more.end());
            return body.body.mass > 0;
        };
        add_factor(all, "gravity_on_body", Subject::gravity, fmt::format("gravity on body \"{}\"", name),
                   "apply the same gravity to all bodies", scale_weight);
    }
    const auto scaled = [&](const char* word, const char* what, double mass_by, double inertia_by) {
        all.push_back({.fault = word,
                       .subject = Subject::mass,
                       .what = fmt::format("the {} of body \"{}\" is {{}} times the scene's", what, name),
                       .remedy = "check the body's mass properties",
                       .apply =
                           [=](SystemCause& c, double x) {
                               Body& body = c.scene.bodies[b].body;
                               if (!(body.mass > 0) || !number(x)) return false;
                               body.mass *= std::pow(x, mass_by);
                               for (Vector3<double>& row : body.inertia_B.row) row = std::pow(x, inertia_by) * row;
                               return true;
                           },
                       .fit = FittedNumber{1, 0.9, 0.05, 0.02}});
    };
    scaled("body_mass_scaled", "mass", 1, 0);
    scaled("body_inertia_scaled", "inertia tensor", 0, 1);
    scaled("body_density_scaled", "density", 1, 1);
    const auto swapped = [&](const char* axes, std::array<std::size_t, 3> order) {
        all.push_back({.fault = "body_inertia_axes_permuted",
                       .subject = Subject::inertia,
                       .what = fmt::format("the moments of inertia of body \"{}\" about {} are exchanged", name, axes),
                       .remedy = "give the moments in the order of the body axes",
                       .apply = [b, order](SystemCause& c, double) {
                           Matrix3<double>& I = c.scene.bodies[b].body.inertia_B;
                           Matrix3<double> permuted;
                           for (std::size_t i = 0; i < 3; ++i)
                               for (std::size_t j = 0; j < 3; ++j) permuted[i][j] = I[order[i]][order[j]];
                           if (fault_effects::same_tensor(I, permuted)) return false;
                           I = permuted;
                           return true;
                       }});
    };
    swapped("x and y", {1, 0, 2}), swapped("y and z", {0, 2, 1}), swapped("x and z", {2, 1, 0});
}

}  // namespace

std::vector<SystemHypothesis> system_faults(const Scene& scene) {
    std::vector<SystemHypothesis> all;
    for (const Hypothesis& h : known_faults())
        if (applies_to_several_bodies(h)) all.push_back(of_several(h));
    if (fault_effects::has<PointSpring>(scene))
        add_factor(all, "point_spring", Subject::spring, "the force of the point springs",
                   "check the stiffness of these springs", [](SystemCause& c, double x) {
                       fault_effects::each<PointSpring>(c.scene, [&](PointSpring& s) { s.stiffness *= x; });
                       return true;
                   });
    // testing more bodies one by one would take minutes
    constexpr std::size_t most_bodies = 40;
    if (scene.bodies.size() > most_bodies) return all;
    for (std::size_t k = 0; k < scene.joints.size(); ++k) {
        const Joint& joint = scene.joints[k];
        const auto child = std::ranges::find(scene.bodies, joint.child, &NamedBody::name);
        // the smallest inertia that the joint moves
        const Vector3<double> arm = child->body.center_of_mass - joint.child_point;
        const Matrix3<double>& I = child->body.inertia_B;
        const double inertia = joint.type == JointType::prismatic
                                   ? child->body.mass
                                   : (I[0][0] + I[1][1] + I[2][2]) / 3 + child->body.mass * dot(arm, arm);
        add_joint(all, scene, k, inertia > 0 ? inertia : 1e-3);
    }
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) add_body(all, scene, b);
    return all;
}

}  // namespace polhode
