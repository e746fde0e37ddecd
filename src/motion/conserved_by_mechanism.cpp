// Conserved quantities of several bodies, and the plane of planar mechanisms.
//
// Changes collects how loads change a vector quantity: not at all, along one direction, or arbitrarily. The visitors
// LinearChanges and AngularChanges apply each load. For systems tied to the world, rotation_line() finds the line
// through the world's origin about which the system can rotate as a whole.

#include "motion/conserved_by_mechanism.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/mechanism.h"
#include "motion/mechanism_motion.h"

namespace polhode {
namespace {

using V3 = Vector3<double>;

constexpr double direction_tolerance = 1e-12;

V3 unit_of(const V3& v) { return (1 / length(v)) * v; }
bool are_parallel(const V3& a, const V3& b) {
    return length(cross(a, b)) <= direction_tolerance * length(a) * length(b);
}
bool are_across(const V3& a, const V3& b) { return std::abs(dot(a, b)) <= direction_tolerance * length(a) * length(b); }
bool is_zero(const V3& v) { return dot(v, v) == 0; }

// How a vector quantity changes: not at all, along one direction, or arbitrarily.
struct Changes {
    bool any = false;
    std::optional<V3> along;

    void by(const V3& v) {
        if (is_zero(v)) return;
        if (!along)
            along = unit_of(v);
        else
            any = any || !are_parallel(*along, v);
    }
    void add_arbitrary(bool condition = true) { any = any || condition; }
    bool none() const { return !any && !along; }
};

bool has_damper(const Joint& joint) { return joint.damping[0] != 0 || joint.damping[1] != 0; }
bool has_spring(const Joint& joint) { return joint.stiffness[0] != 0 || joint.stiffness[1] != 0; }
bool has_armature(const Joint& joint) { return joint.armature != std::array<double, 2>{}; }
bool has_drag(const Drag& drag) { return drag.translational != 0 || !is_zero(drag.rotational); }
bool connects_to_world(const PointSpring& spring) {
    return spring.stiffness != 0 && (spring.first == "world") != (spring.second == "world");
}

// Changes of the total linear momentum.
struct LinearChanges {
    Changes& changes;

    void operator()(const Gravity& load) const { changes.by(load.acceleration_W); }
    void operator()(const Force& load) const {
        if (load.frame == Frame::world)
            changes.by(load.vector);
        else
            changes.add_arbitrary(!is_zero(load.vector));
    }
    void operator()(const Impulse& load) const {
        if (load.at == 0) return;
        if (load.frame == Frame::world)
            changes.by(load.vector);
        else
            changes.add_arbitrary(!is_zero(load.vector));
    }
    void operator()(const Drag& load) const { changes.add_arbitrary(load.translational != 0); }
    void operator()(const PointSpring& load) const { changes.add_arbitrary(connects_to_world(load)); }
    void operator()(const Torque&) const {}
    void operator()(const Spring&) const {}
    void operator()(const Motor&) const {}
    void operator()(const UserTorque&) const { changes.add_arbitrary(); }
    void operator()(const FormulaLoad&) const { changes.add_arbitrary(); }
};

// Changes of the angular momentum about the common centre of mass, or about the world's origin.
struct AngularChanges {
    Changes& changes;
    bool about_origin;

    void operator()(const Gravity& load) const {
        // its moment about the origin is perpendicular to it but otherwise arbitrary
        if (about_origin && !is_zero(load.acceleration_W)) changes.add_arbitrary();
    }
    void operator()(const Torque& load) const {
        if (load.frame == Frame::world)
            changes.by(load.vector);
        else
            changes.add_arbitrary(!is_zero(load.vector));
    }
    void operator()(const Force& load) const { changes.add_arbitrary(!is_zero(load.vector)); }
    void operator()(const Impulse& load) const { changes.add_arbitrary(load.at != 0 && !is_zero(load.vector)); }
    void operator()(const Drag& load) const { changes.add_arbitrary(has_drag(load)); }
    void operator()(const Spring& load) const { changes.add_arbitrary(load.stiffness != 0); }
    void operator()(const PointSpring& load) const { changes.add_arbitrary(connects_to_world(load)); }
    void operator()(const Motor&) const {}
    void operator()(const UserTorque&) const { changes.add_arbitrary(); }
    void operator()(const FormulaLoad&) const { changes.add_arbitrary(); }
};

bool conserves_mechanism_energy(const Problem& problem) {
    const Scene& scene = problem.scene;
    if (problem.segments.size() > 1 || std::ranges::any_of(scene.joints, has_damper)) return false;
    if (std::ranges::any_of(scene.joints, [](const Joint& joint) {
            return joint.friction != 0 || !joint.motion.empty() ||
                   (joint.limits.any() && joint.limits.restitution != 1);
        }))
        return false;
    return std::ranges::none_of(scene.loads, [](const Load& load) {
        if (const auto* torque = std::get_if<Torque>(&load)) return !is_zero(torque->vector);
        if (const auto* force = std::get_if<Force>(&load))
            return !is_zero(force->vector) && (force->frame == Frame::body || force->point_frame == Frame::world);
        if (const auto* drag = std::get_if<Drag>(&load)) return has_drag(*drag);
        if (const auto* motor = std::get_if<Motor>(&load)) return motor->force != 0;
        return std::holds_alternative<UserTorque>(load);
    });
}

// The axis of a revolute or prismatic joint in world axes; motion of the joint does not change it.
V3 axis_in_world(const Scene& scene, const Joint& joint, const std::vector<Sample>& start) {
    const Sample& child = start[static_cast<std::size_t>(body_index(scene, joint.child))];
    return unit_of(rotate(normalized(child.q), joint.axes[0]));
}

bool is_free_base(const Scene& scene, std::size_t body) {
    return std::ranges::none_of(scene.joints, [&](const Joint& j) { return j.child == scene.bodies[body].name; });
}

// The line through the origin about which the joints to the world let the whole system rotate: its direction, or zero
// if it may rotate freely about the origin. Nothing if there is no such line.
std::optional<V3> rotation_line(const Scene& scene, const std::vector<Sample>& start) {
    std::optional<V3> line;
    std::vector<V3> points;
    for (const Loop& loop : scene.loops)
        if ((loop.first == "world") != (loop.second == "world")) return std::nullopt;
    for (const Joint& joint : scene.joints) {
        if (joint.parent != "world") continue;
        if (has_damper(joint) || has_spring(joint) || has_armature(joint)) return std::nullopt;
        if (joint.friction != 0 || joint.limits.any() || !scene.couplings.empty()) return std::nullopt;
        if (!joint.motion.empty()) return std::nullopt;
        for (const Load& load : scene.loads)
            if (const auto* motor = std::get_if<Motor>(&load); motor && motor->joint == joint.name) return std::nullopt;
        if (joint.type == JointType::revolute) {
            const V3 axis = axis_in_world(scene, joint, start);
            if (line && !are_parallel(*line, axis)) return std::nullopt;
            line = line ? line : axis;
        } else if (joint.type != JointType::spherical) {
            return std::nullopt;
        }
        points.push_back(joint.parent_point);
    }
    for (const V3& point : points) {
        if (is_zero(point)) continue;
        if (line && !are_parallel(*line, point)) return std::nullopt;
        line = line ? line : unit_of(point);
    }
    return line ? *line : V3();
}

SystemInvariants<double> invariants_after_impulses(MechanismModel& model, std::vector<double>& y,
                                                   const MechanismMeasure<double>& measure) {
    model.enter(0, y.data());
    std::vector<BodyMotion<double>> motions;
    for (const Sample& s : model.motion(y.data()))
        motions.push_back({normalized(s.q), s.angular_velocity_B, s.position_W, s.velocity_W});
    JointCoordinates coordinates(model.scene());
    return measure.invariants(0, motions, coordinates);
}

void add_vector(std::vector<Conserved>& found, ConservedKind kind, const char* name, const char* formula,
                const V3& value, const V3& direction = {}) {
    found.push_back({kind, name, formula, {value[0], value[1], value[2]}, nullptr, direction});
}

// Adds a vector that the loads do not change, or its part perpendicular to the line along which they change it.
void add_unchanged(std::vector<Conserved>& found, const Changes& changes, ConservedKind whole, ConservedKind part,
                   const char* name, const char* formula, const V3& value) {
    if (changes.none()) add_vector(found, whole, name, formula, value);
    if (changes.any || !changes.along) return;
    const V3& u = *changes.along;
    add_vector(found, part, (std::string(name) + " perpendicular to u").c_str(), formula, value - dot(value, u) * u, u);
}

void add_momenta_of_free_system(std::vector<Conserved>& found, const Scene& scene,
                                const SystemInvariants<double>& at_start) {
    Changes linear, angular;
    for (const Load& load : scene.loads)
        std::visit(LinearChanges{linear}, load), std::visit(AngularChanges{angular, false}, load);
    add_unchanged(found, angular, ConservedKind::angular_momentum, ConservedKind::angular_momentum_component,
                  "angular momentum", "L of the system about its centre of mass, world axes, kg m^2/s",
                  at_start.angular_momentum_W);
    add_unchanged(found, linear, ConservedKind::linear_momentum, ConservedKind::linear_momentum_component,
                  "linear momentum", "p of the system, world axes, kg m/s", at_start.linear_momentum_W);
}

// The angular momentum of a system that is tied to the world, about the world's origin or along the line of its joints.
void add_momentum_of_tied_system(std::vector<Conserved>& found, const Scene& scene, const std::vector<Sample>& before,
                                 const SystemInvariants<double>& at_start) {
    std::optional<V3> line = rotation_line(scene, before);
    if (!line) return;
    // gravity parallel to the line has no moment about it; if only a point is fixed, gravity determines the line
    Changes other;
    for (const Load& load : scene.loads) {
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            if (is_zero(gravity->acceleration_W)) continue;
            if (is_zero(*line)) line = unit_of(gravity->acceleration_W);
            if (!are_parallel(*line, gravity->acceleration_W)) return;
        } else if (const auto* torque = std::get_if<Torque>(&load); torque && torque->frame == Frame::world) {
            if (is_zero(torque->vector)) continue;
            if (is_zero(*line) || !are_across(*line, torque->vector)) return;
        } else {
            std::visit(AngularChanges{other, true}, load);
        }
    }
    if (!other.none()) return;
    if (is_zero(*line)) {
        add_vector(found, ConservedKind::angular_momentum, "angular momentum",
                   "L about the world's origin, world axes, kg m^2/s", at_start.angular_momentum_W);
        return;
    }
    found.push_back({ConservedKind::angular_momentum_component,
                     "angular momentum along u",
                     "L . u about the world's origin, kg m^2/s",
                     {dot(at_start.angular_momentum_W, *line)},
                     nullptr,
                     *line});
}

}  // namespace

std::vector<Conserved> conserved_by_mechanism(const Problem& problem) {
    const Scene& scene = problem.scene;
    if (!scene.planes.empty() || !scene.contacts.empty()) return {};  // changed by impacts and friction
    MechanismModel model = mechanism_of(problem);
    std::vector<double> y(static_cast<std::size_t>(model.dimension()));
    model.initial(y.data());
    const std::vector<Sample> before = model.motion(y.data());
    const MechanismMeasure<double> measure(scene);
    const SystemInvariants<double> at_start = invariants_after_impulses(model, y, measure);
    std::vector<Conserved> found;
    if (conserves_mechanism_energy(problem))
        found.push_back(
            {ConservedKind::energy, "energy", "E, kinetic and potential, J", {at_start.energy}, nullptr, {}});
    if (measure.is_tied_to_world())
        add_momentum_of_tied_system(found, scene, before, at_start);
    else
        add_momenta_of_free_system(found, scene, at_start);
    return found;
}

std::optional<V3> plane_of_motion(const Problem& problem) {
    const Scene& scene = problem.scene;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        if (is_free_base(scene, b)) return std::nullopt;
    // formulas may push the bodies out of the plane
    if (!std::holds_alternative<MechanismSystem>(problem.system)) return std::nullopt;
    const MechanismModel& model = mechanism_of(problem);
    std::vector<double> y(static_cast<std::size_t>(model.dimension()));
    model.initial(y.data());
    const std::vector<Sample> start = model.motion(y.data());
    std::optional<V3> normal;
    std::vector<V3> slides;
    for (const Joint& joint : scene.joints) {
        if (joint.type == JointType::fixed) continue;
        if (joint.type != JointType::revolute && joint.type != JointType::prismatic) return std::nullopt;
        const V3 axis = axis_in_world(scene, joint, start);
        if (joint.type == JointType::prismatic) {
            slides.push_back(axis);
            continue;
        }
        if (normal && !are_parallel(*normal, axis)) return std::nullopt;
        normal = normal ? normal : axis;
    }
    // without a revolute joint nothing rotates: two slides that are not parallel define the normal, otherwise it is
    // not unique
    for (std::size_t i = 1; !normal && i < slides.size(); ++i)
        if (const V3 product = cross(slides[0], slides[i]); length(product) > direction_tolerance)
            normal = unit_of(product);
    if (!normal) return std::nullopt;
    for (const V3& slide : slides)
        if (!are_across(*normal, slide)) return std::nullopt;
    return normal;
}

}  // namespace polhode
