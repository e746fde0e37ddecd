// Requests to engines for several bodies, and their answers (README.md has the protocol).
//
// engine_mechanism() converts the scene: each body to its principal frame, each joint to anchors and axes at t = 0 with
// zero coordinates (convert_joint(), convert_loop()), joints sorted so that parents precede children.
// mechanism_request() writes this as JSON; read_mechanism_answer() reads the samples back into the scene's body axes.
#include "integrators/engines/engine_mechanism.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "body/orientation.h"
#include "integrators/engines/engine_json.h"
#include "integrators/run/watch.h"
#include "motion/formula_mechanism.h"
#include "motion/mechanism.h"
#include "scene/joint_file.h"
#include "scene/sphere_contacts.h"
#include "text/message.h"

namespace polhode {
namespace {

using engine_json::array, engine_json::json, engine_json::quaternion_at, engine_json::vector_at;

// Constant gravity. Motors are converted separately; impulses at t = 0 are part of the initial state.
Vector3<double> gravity_of(const Scene& scene) {
    Vector3<double> gravity;
    for (const Load& load : scene.loads) {
        if (const Gravity* field = std::get_if<Gravity>(&load)) {
            if (field->window.from > 0 || field->window.until < scene.duration)
                throw std::invalid_argument(
                    "the engine protocol supports mechanisms only with gravity that acts for the whole run");
            gravity = gravity + field->acceleration_W;
        } else if (const Impulse* impulse = std::get_if<Impulse>(&load)) {
            if (impulse->at > 0)
                throw std::invalid_argument("the engine protocol supports impulses on mechanisms only at t = 0");
        } else if (const Spring* spring = std::get_if<Spring>(&load); !std::holds_alternative<Motor>(load) &&
                                                                      !std::holds_alternative<FormulaLoad>(load) &&
                                                                      (!spring || spring->stiffness != 0)) {
            throw std::invalid_argument(
                "the engine protocol supports only gravity, motors, formulas and impulses at t = 0 as loads on "
                "mechanisms");
        }
    }
    return gravity;
}

/// Bodies by name, with their state at t = 0.
class InitialBodies {
  public:
    InitialBodies(const Scene& scene, const std::vector<EngineBody>& bodies,
                  const std::vector<MassProperties<double>>& properties)
        : scene_(&scene), bodies_(&bodies), properties_(&properties) {}

    int index(const std::string& name) const {
        for (std::size_t i = 0; i < scene_->bodies.size(); ++i)
            if (scene_->bodies[i].name == name) return static_cast<int>(i);
        return -1;
    }
    // a point of the scene's body in the axes of the engine's body, and in world axes
    Vector3<double> point(int body, const Vector3<double>& in_scene) const {
        if (body < 0) return in_scene;
        return rotate_back(at(body).q_BP, in_scene - (*properties_)[static_cast<std::size_t>(body)].center);
    }
    Vector3<double> point_to_world(int body, const Vector3<double>& point) const {
        return body < 0 ? point : at(body).p_W + rotate(at(body).q, point);
    }
    Vector3<double> point_from_world(int body, const Vector3<double>& place_W) const {
        return body < 0 ? place_W : rotate_back(at(body).q, place_W - at(body).p_W);
    }
    Vector3<double> axis_to_world(int body, const Vector3<double>& axis) const {
        return body < 0 ? axis : rotate(at(body).q, axis);
    }
    Vector3<double> axis_from_world(int body, const Vector3<double>& axis_W) const {
        return body < 0 ? axis_W : rotate_back(at(body).q, axis_W);
    }
    // an axis of the scene's body in world axes
    Vector3<double> axis_W(int body, const Vector3<double>& axis) const {
        const Vector3<double> unit = (1 / hypotenuse(axis)) * axis;
        return body < 0 ? unit : rotate(at(body).q, rotate_back(at(body).q_BP, unit));
    }
    Vector3<double> angular_velocity(int body) const { return body < 0 ? Vector3<double>() : at(body).w_W; }
    Vector3<double> point_velocity(int body, const Vector3<double>& place_W) const {
        return body < 0 ? Vector3<double>() : at(body).v + cross(at(body).w_W, place_W - at(body).p_W);
    }

  private:
    const EngineBody& at(int body) const { return (*bodies_)[static_cast<std::size_t>(body)]; }

    const Scene* scene_;
    const std::vector<EngineBody>* bodies_;
    const std::vector<MassProperties<double>>* properties_;
};

void add_axis(EngineJoint& joint, const InitialBodies& initial, const Vector3<double>& axis_W) {
    joint.axes_W.push_back(axis_W);
    joint.parent_axes.push_back(initial.axis_from_world(joint.parent, axis_W));
    joint.child_axes.push_back(initial.axis_from_world(joint.child, axis_W));
}

// The laws of a joint, in the coordinate that is zero at t = 0.
EngineJointLaws convert_laws(const Joint& joint) {
    if (!joint.motion.empty())
        throw std::invalid_argument("the engine protocol does not support prescribed motions of joints");
    EngineJointLaws laws;
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
        const double start = joint.coordinate[0];
        laws.limits = {joint.limits.lower - start, joint.limits.upper - start, joint.limits.restitution};
        laws.friction = joint.friction, laws.armature = joint.armature[0];
        laws.stiffness = joint.stiffness[0], laws.rest = joint.rest[0] - start, laws.damping = joint.damping[0];
        return laws;
    }
    if (joint.stiffness != std::array<double, 2>{} || joint.damping != std::array<double, 2>{})
        throw std::invalid_argument(
            fmt::format("the engine protocol does not support springs and dampers of {} joints", name_of(joint.type)));
    if (joint.armature != std::array<double, 2>{})
        throw std::invalid_argument(
            fmt::format("the engine protocol does not support armature of {} joints", name_of(joint.type)));
    return laws;
}

EngineJoint convert_joint(const Joint& joint, const InitialBodies& initial) {
    EngineJoint result;
    result.laws = convert_laws(joint);
    result.name = joint.name, result.type = name_of(joint.type);
    result.parent = initial.index(joint.parent), result.child = initial.index(joint.child);
    result.child_point = initial.point(result.child, joint.child_point);
    result.anchor_W = initial.point_to_world(result.child, result.child_point);
    result.parent_point = initial.point_from_world(result.parent, result.anchor_W);
    result.angular_velocity_W = initial.angular_velocity(result.child) - initial.angular_velocity(result.parent);
    const Vector3<double> sliding_velocity =
        initial.point_velocity(result.child, result.anchor_W) - initial.point_velocity(result.parent, result.anchor_W);
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
        add_axis(result, initial, initial.axis_W(result.child, joint.axes[0]));
        result.rates = {
            dot(result.axes_W[0], joint.type == JointType::revolute ? result.angular_velocity_W : sliding_velocity)};
    } else if (joint.type == JointType::universal) {
        // the first axis is fixed in the middle frame: undoes the second angle's rotation
        const Vector3<double> second = initial.axis_W(result.child, joint.axes[1]);
        const Quaternion<double> back = quaternion_from_rotation_vector(-joint.coordinate[1] * second);
        add_axis(result, initial, rotate(back, initial.axis_W(result.child, joint.axes[0])));
        add_axis(result, initial, second);
        const double along = dot(result.axes_W[0], second), a = dot(result.axes_W[0], result.angular_velocity_W),
                     b = dot(second, result.angular_velocity_W), rest = 1 - along * along;
        result.rates = {(a - along * b) / rest, (b - along * a) / rest};
    }
    return result;
}

EngineJoint convert_loop(const Loop& loop, const InitialBodies& initial) {
    EngineJoint result;
    result.name = loop.name, result.type = name_of(loop.type), result.length = loop.length;
    result.parent = initial.index(loop.first), result.child = initial.index(loop.second);
    result.parent_point = initial.point(result.parent, loop.first_point);
    result.child_point = initial.point(result.child, loop.second_point);
    result.anchor_W = initial.point_to_world(result.child, result.child_point);
    result.angular_velocity_W = initial.angular_velocity(result.child) - initial.angular_velocity(result.parent);
    if (loop.type == LoopType::revolute) add_axis(result, initial, initial.axis_W(result.child, loop.second_axis));
    return result;
}

// Sorts the joints so that each one follows the joint that carries its parent.
void sort_joints(std::vector<EngineJoint>& joints) {
    std::vector<EngineJoint> sorted;
    while (!joints.empty()) {
        const auto is_free = [&](const EngineJoint& joint) {
            return std::ranges::none_of(joints, [&](const EngineJoint& other) { return other.child == joint.parent; });
        };
        const auto next = std::ranges::find_if(joints, is_free);
        sorted.push_back(*next);
        joints.erase(next);
    }
    joints = std::move(sorted);
}

int joint_index(const std::vector<EngineJoint>& joints, const std::string& name) {
    return static_cast<int>(std::ranges::find(joints, name, &EngineJoint::name) - joints.begin());
}

// Motors and couplings, which refer to the sorted joints.
void convert_joint_loads(const Scene& scene, EngineMechanism& mechanism) {
    for (const Load& load : scene.loads)
        if (const Motor* motor = std::get_if<Motor>(&load))
            mechanism.motors.push_back({joint_index(mechanism.joints, motor->joint), motor->force, motor->window});
    for (const Coupling& coupling : scene.couplings)
        mechanism.couplings.push_back({joint_index(mechanism.joints, coupling.first),
                                       joint_index(mechanism.joints, coupling.second), coupling.ratio});
}

// The motion of all bodies at t = 0, after the impulses at that time.
template <class Model>
std::vector<Sample> find_start(Model model) {
    std::vector<double> y(static_cast<std::size_t>(model.dimension()));
    model.initial(y.data()), model.enter(0, y.data());
    return model.motion(y.data());
}

// Every pair of balls collides, with the same coefficients.
EngineBalls convert_balls(const Scene& scene, const std::vector<EngineBody>& bodies) {
    EngineBalls balls;
    balls.planes = engine_planes(scene);
    const std::vector<SpherePair> pairs = sphere_pairs(scene);
    const auto is_like_first = [&](const SpherePair& pair) {
        return pair.restitution == pairs.front().restitution && pair.friction == pairs.front().friction;
    };
    if (2 * pairs.size() != bodies.size() * (bodies.size() - 1) || !std::ranges::all_of(pairs, is_like_first))
        throw std::invalid_argument(
            "the engine protocol supports contacts of balls only between all of them, with the same coefficients");
    balls.restitution = pairs.front().restitution, balls.friction = pairs.front().friction;
    const std::vector<MassProperties<double>> properties = bodies_mass_properties<double>(scene);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto shapes = engine_shapes(scene.bodies[b].body, properties[b].center, bodies[b].q_BP);
        if (shapes.size() != 1 || !shapes.front().is_centered_ball())
            throw std::invalid_argument(
                "the engine protocol supports contacts only of balls about their centre of mass");
        balls.radii.push_back(shapes.front().radius);
    }
    return balls;
}

json write_vectors(const std::vector<Vector3<double>>& vectors) {
    json all = json::array();
    for (const Vector3<double>& v : vectors) all.push_back(array(v));
    return all;
}

// JSON has no infinity: a limit that a joint does not have is null.
json write_limit(double limit) { return std::isfinite(limit) ? json(limit) : json(); }

// Writes only the laws that the joint has.
void write_laws(const EngineJointLaws& laws, json& entry) {
    if (laws.limits.any())
        entry["limits"] = {{"lower", write_limit(laws.limits.lower)},
                           {"upper", write_limit(laws.limits.upper)},
                           {"restitution", laws.limits.restitution}};
    if (laws.friction > 0) entry["friction"] = laws.friction;
    if (laws.armature > 0) entry["armature"] = laws.armature;
    if (laws.stiffness != 0) entry["stiffness"] = laws.stiffness, entry["rest"] = laws.rest;
    if (laws.damping != 0) entry["damping"] = laws.damping;
}

void write_joint_loads(const EngineMechanism& mechanism, json& request) {
    for (const EngineMotor& motor : mechanism.motors) {
        json entry{{"joint", motor.joint}, {"force", motor.force}, {"from", std::max(0.0, motor.window.from)}};
        if (std::isfinite(motor.window.until)) entry["until"] = motor.window.until;
        request["motors"].push_back(std::move(entry));
    }
    for (const EngineCoupling& coupling : mechanism.couplings)
        request["couplings"].push_back(
            {{"first", coupling.first}, {"second", coupling.second}, {"ratio", coupling.ratio}});
}

json write_joints(const std::vector<EngineJoint>& joints) {
    json all = json::array();
    for (const EngineJoint& joint : joints) {
        json entry{{"name", joint.name},
                   {"type", joint.type},
                   {"parent", joint.parent},
                   {"child", joint.child},
                   {"anchor", array(joint.anchor_W)},
                   {"parent_point", array(joint.parent_point)},
                   {"child_point", array(joint.child_point)},
                   {"axes", write_vectors(joint.axes_W)},
                   {"parent_axes", write_vectors(joint.parent_axes)},
                   {"child_axes", write_vectors(joint.child_axes)},
                   {"turning", array(joint.angular_velocity_W)},
                   {"rates", joint.rates}};
        if (joint.length > 0) entry["length"] = joint.length;
        write_laws(joint.laws, entry);
        all.push_back(std::move(entry));
    }
    return all;
}

void read_mechanism_samples(const json& rows, const Problem& problem, const EngineMechanism& mechanism,
                            const Settings& settings, Trajectory& trajectory) {
    const std::size_t expected = static_cast<std::size_t>(settings.samples) + 1, count = mechanism.bodies.size();
    if (rows.size() != expected)
        throw std::invalid_argument(fmt::format("{} samples instead of {}", rows.size(), expected));
    const double bound = energy_bound(problem);
    for (std::size_t k = 0; k < expected; ++k) {
        if (rows[k].size() != count)
            throw std::invalid_argument(fmt::format("{} bodies instead of {}", rows[k].size(), count));
        std::vector<Sample> moment;
        for (std::size_t b = 0; b < count; ++b) {
            const json& row = rows[k][b];
            Sample s;
            s.t = sample_time(problem.scene.duration, static_cast<long>(k), settings.samples);
            s.q = quaternion_at(row, 0) * conjugate(mechanism.bodies[b].q_BP);
            s.angular_velocity_B = rotate_back(normalized(s.q), vector_at(row, 4));
            s.position_W = vector_at(row, 7), s.velocity_W = vector_at(row, 10);
            moment.push_back(s);
        }
        if (!record(problem, moment, bound, trajectory)) return;
        // timings keep only the last sample
        if (!settings.record && k + 1 < expected) trajectory.samples.clear();
    }
}

std::string describe_law(const std::string& law) {
    return law == "restitution" ? "restitution at the limits of joints"
           : law == "springs"   ? "springs and dampers of joints"
                                : law + " of joints";
}

}  // namespace

EngineMechanism engine_mechanism(const Problem& problem) {
    const Scene& scene = problem.scene;
    EngineMechanism result;
    result.gravity = gravity_of(scene);
    const std::vector<Sample> start =
        has_formula_loads(scene) ? find_start(formula_mechanism_of(problem)) : find_start(mechanism_of(problem));
    const std::vector<MassProperties<double>> properties = bodies_mass_properties<double>(scene);
    for (std::size_t b = 0; b < properties.size(); ++b) {
        EngineBody body;
        body.name = scene.bodies[b].name, body.mass = properties[b].mass;
        const PrincipalFrame frame = engine_frame(properties[b].inertia);
        body.moments = frame.moments, body.q_BP = frame.q_BP;
        const Sample& s = start[b];
        body.q = normalized(s.q) * body.q_BP, body.w_W = rotate(normalized(s.q), s.angular_velocity_B);
        body.p_W = s.position_W, body.v = s.velocity_W;
        result.bodies.push_back(body);
    }
    if (has_sphere_contacts(scene)) result.balls = convert_balls(scene, result.bodies);
    const InitialBodies initial(scene, result.bodies, properties);
    for (const Joint& joint : scene.joints) result.joints.push_back(convert_joint(joint, initial));
    sort_joints(result.joints);
    convert_joint_loads(scene, result);
    for (const Loop& loop : scene.loops) result.loops.push_back(convert_loop(loop, initial));
    result.formulas = mechanism_formulas(scene, result);
    return result;
}

std::vector<std::string> joint_laws(const EngineMechanism& mechanism) {
    std::vector<std::string> all;
    const auto add = [&](const char* law, bool (*has)(const EngineJointLaws&)) {
        if (std::ranges::any_of(mechanism.joints, has, &EngineJoint::laws)) all.emplace_back(law);
    };
    add("limits", [](const EngineJointLaws& laws) { return laws.limits.any(); });
    add("restitution", [](const EngineJointLaws& laws) { return laws.limits.any() && laws.limits.restitution > 0; });
    add("friction", [](const EngineJointLaws& laws) { return laws.friction > 0; });
    add("armature", [](const EngineJointLaws& laws) { return laws.armature > 0; });
    add("springs", [](const EngineJointLaws& laws) { return laws.stiffness != 0 || laws.damping != 0; });
    if (!mechanism.motors.empty()) all.emplace_back("motors");
    if (!mechanism.couplings.empty()) all.emplace_back("couplings");
    return all;
}

std::string joints_refusal(const EngineMechanism& mechanism, const EngineHello& hello) {
    const auto knows = [](const std::vector<std::string>& types, const std::string& type) {
        return std::ranges::find(types, type) != types.end();
    };
    if (mechanism.balls && !hello.contacts) return "its driver does not support contacts of several balls";
    if (mechanism.formulas && !hello.formulas) return no_formulas;
    if (hello.joints.empty() && !mechanism.balls) return "its driver does not support joints";
    for (const EngineJoint& joint : mechanism.joints)
        if (!knows(hello.joints, joint.type)) return fmt::format("it does not support {} joints", joint.type);
    for (const EngineJoint& loop : mechanism.loops)
        if (!knows(hello.loops, loop.type))
            return fmt::format("it does not support loops closed by a {} joint", loop.type);
    for (const std::string& law : joint_laws(mechanism))
        if (!knows(hello.laws, law)) return fmt::format("it does not support {}", describe_law(law));
    return "";
}

std::string mechanism_request(const EngineMechanism& mechanism, const std::string& setting, double duration,
                              const Settings& settings, long steps_per_sample) {
    json bodies = json::array();
    for (const EngineBody& body : mechanism.bodies)
        bodies.push_back({{"name", body.name},
                          {"mass", body.mass},
                          {"moments", array(body.moments)},
                          {"q", array(body.q)},
                          {"w", array(body.w_W)},
                          {"p", array(body.p_W)},
                          {"v", array(body.v)}});
    json request{{"setting", setting},
                 {"duration", duration},
                 {"samples", settings.samples},
                 {"steps_per_sample", steps_per_sample},
                 {"repetitions", settings.repetitions},
                 {"gravity", array(mechanism.gravity)},
                 {"bodies", std::move(bodies)},
                 {"joints", write_joints(mechanism.joints)},
                 {"loops", write_joints(mechanism.loops)}};
    write_joint_loads(mechanism, request);
    if (mechanism.formulas)
        request["formulas"] =
            write_formulas(align_to_steps(*mechanism.formulas, duration, settings.samples, steps_per_sample));
    if (const auto& balls = mechanism.balls) {
        request["balls"] = balls->radii, request["planes"] = engine_json::write_planes(balls->planes);
        request["contact"] = {{"restitution", balls->restitution}, {"friction", balls->friction}};
    }
    return request.dump();
}

Trajectory read_mechanism_answer(std::string_view line, const Problem& problem, const EngineMechanism& mechanism,
                                 const Settings& settings, long steps_per_sample) {
    Trajectory trajectory;
    trajectory.bodies = static_cast<int>(mechanism.bodies.size());
    try {
        const json answer = json::parse(line);
        if (!engine_json::read_outcome(answer, trajectory)) return trajectory;
        trajectory.step = problem.scene.duration / static_cast<double>(settings.samples * steps_per_sample);
        read_mechanism_samples(answer.at("samples"), problem, mechanism, settings, trajectory);
    } catch (const std::exception& error) {
        trajectory = engine_json::make_failed_trajectory(error);
    }
    return trajectory;
}

}  // namespace polhode
