// Requests to engines for one body, and their answers (README.md has the protocol).
//
// engine_scene() converts the scene to the body's principal frame (LoadConverter rotates the loads, engine_shapes()
// adds the shapes, body_formulas() the formulas). engine_request() writes it as JSON, with the loads as one piece per
// interval between events (PieceWriter). read_answer() reads samples and readback into the scene's body axes.
#include "integrators/engines/engine_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "integrators/engines/engine_json.h"
#include "integrators/run/watch.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

using engine_json::array, engine_json::json, engine_json::number, engine_json::quaternion_at, engine_json::vector_at;

/// Converts a load to the axes of the engine's body.
struct LoadConverter {
    const Quaternion<double>& q_BP;
    const Vector3<double>& center;

    Vector3<double> vector(const Vector3<double>& v, Frame frame) const {
        return frame == Frame::body ? rotate_back(q_BP, v) : v;
    }
    Vector3<double> point(const Vector3<double>& x, Frame frame) const {
        return frame == Frame::body ? rotate_back(q_BP, x - center) : x;
    }
    Load operator()(const Gravity& load) const { return load; }
    Load operator()(Torque load) const {
        load.vector = vector(load.vector, load.frame);
        return load;
    }
    Load operator()(Force load) const {
        load.vector = vector(load.vector, load.frame), load.point = point(load.point, load.point_frame);
        return load;
    }
    Load operator()(Impulse load) const {
        load.vector = vector(load.vector, load.frame), load.point = point(load.point, load.point_frame);
        return load;
    }
    Load operator()(Drag load) const {
        const Vector3<double>& c = load.rotational;
        const bool is_rotated = q_BP.x != 0 || q_BP.y != 0 || q_BP.z != 0;
        if (is_rotated && !(c[0] == c[1] && c[1] == c[2]))
            throw std::invalid_argument(
                "anisotropic drag is supported only where the body's axes are its principal axes");
        return load;
    }
    Load operator()(Spring load) const {
        load.rest_orientation = load.rest_orientation * q_BP;
        return load;
    }
    Load operator()(const UserTorque&) const {
        throw std::invalid_argument("a user-defined torque cannot be passed to another process");
    }
    // formulas are sent as a list of operations; see engine_formulas.h
    Load operator()(const FormulaLoad& load) const { return load; }
    Load operator()(const Motor&) const { throw std::invalid_argument(several_bodies); }
    Load operator()(const PointSpring&) const { throw std::invalid_argument(several_bodies); }

    static constexpr const char* several_bodies = "motors and point springs need a scene of several bodies";
};

/// Writes the loads that act from one event to the next.
struct PieceWriter {
    double begin;
    json& piece;

    void operator()(const Gravity& load) const { add("gravity", load.acceleration_W); }
    void operator()(const Torque& load) const { add(load.frame == Frame::body ? "torque_B" : "torque_W", load.vector); }
    void operator()(const Force& load) const { append("forces", load); }
    void operator()(const Impulse& load) const {
        if (load.at == begin) append("impulses", load);
    }
    void operator()(const Drag& load) const {
        json drag = piece.value("drag", json{{"rotational", {0, 0, 0}}, {"translational", 0}});
        for (int i = 0; i < 3; ++i) drag["rotational"][i] = drag["rotational"][i].get<double>() + load.rotational[i];
        drag["translational"] = drag["translational"].get<double>() + load.translational;
        piece["drag"] = drag;
    }
    void operator()(const Spring& load) const {
        piece["springs"].push_back({{"stiffness", load.stiffness}, {"rest", array(normalized(load.rest_orientation))}});
    }
    void operator()(const UserTorque&) const {}
    void operator()(const Motor&) const {}
    void operator()(const FormulaLoad&) const {}
    void operator()(const PointSpring&) const {}

  private:
    void add(const char* key, const Vector3<double>& v) const {
        Vector3<double> sum = v;
        if (piece.contains(key))
            for (int i = 0; i < 3; ++i) sum[i] += piece[key][i].get<double>();
        piece[key] = array(sum);
    }
    template <class PointLoad>
    void append(const char* key, const PointLoad& load) const {
        const auto word = [](Frame frame) { return frame == Frame::body ? "body" : "world"; };
        piece[key].push_back({{"vector", array(load.vector)},
                              {"frame", word(load.frame)},
                              {"point", array(load.point)},
                              {"point_frame", word(load.point_frame)}});
    }
};

json write_pieces(const Scene& scene) {
    json pieces = json::array();
    for (const Leg& leg : itinerary(scene)) {
        json piece{{"begin", leg.begin}};
        for (const Load& load : scene.loads)
            if (std::holds_alternative<Impulse>(load) || acts(window_of(load), leg.begin))
                std::visit(PieceWriter{leg.begin, piece}, load);
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

json write_shape(const EngineShape& shape) {
    json written{{"type", shape.type}, {"position", array(shape.position)}, {"orientation", array(shape.q)}};
    if (shape.radius > 0) written["radius"] = shape.radius;
    if (shape.type == "cylinder" || shape.type == "capsule") written["half_height"] = shape.half_height;
    if (shape.type == "box") written["half_extents"] = array(shape.half);
    if (shape.type == "ellipsoid") written["semi_axes"] = array(shape.half);
    for (const Vector3<double>& corner : shape.corners) written["corners"].push_back(array(corner));
    return written;
}

EngineReadback read_readback(const json& answer) {
    EngineReadback readback;
    const auto found = answer.find("readback");
    if (found == answer.end() || !found->is_object()) return readback;
    const auto vector = [&](const char* key, std::optional<Vector3<double>>& v) {
        if (const auto at = found->find(key); at != found->end() && at->is_array()) v = vector_at(*at, 0);
    };
    if (const auto mass = found->find("mass"); mass != found->end() && mass->is_number()) readback.mass = number(*mass);
    vector("moments", readback.moments), vector("w", readback.w), vector("p", readback.p), vector("v", readback.v);
    if (const auto q = found->find("q"); q != found->end() && q->is_array()) readback.q = quaternion_at(*q, 0);
    return readback;
}

// Reads the samples up to the first that is not finite or exceeds the energy bound.
void read_samples(const json& rows, const Problem& problem, const EngineScene& scene, const Settings& settings,
                  Trajectory& trajectory) {
    const std::size_t count = static_cast<std::size_t>(settings.samples) + 1;
    if (rows.size() != count) throw std::invalid_argument(fmt::format("{} samples instead of {}", rows.size(), count));
    const double bound = energy_bound(problem);
    const Quaternion<double> q_PB = conjugate(scene.q_BP);
    for (std::size_t k = 0; k < count; ++k) {
        const json& row = rows[k];
        Sample s;
        s.t = sample_time(problem.scene.duration, static_cast<long>(k), settings.samples);
        const Quaternion<double> q = quaternion_at(row, 0);
        s.q = q * q_PB;
        s.angular_velocity_B = rotate_back(normalized(s.q), vector_at(row, 4));
        s.position_W = vector_at(row, 7), s.velocity_W = vector_at(row, 10);
        if (!record(problem, s, bound, trajectory)) return;
    }
    if (!settings.record) trajectory.samples.erase(trajectory.samples.begin(), trajectory.samples.end() - 1);
}

}  // namespace

std::vector<Plane> engine_planes(const Scene& scene) {
    std::vector<Plane> planes;
    for (Plane plane : scene.planes) {
        const Plane& first = scene.planes.front();
        if (plane.friction != first.friction || plane.restitution != first.restitution)
            throw std::invalid_argument("the engine protocol does not support planes with different coefficients");
        if (plane.torsional_friction > 0 || plane.rolling_friction > 0)
            throw std::invalid_argument("the engine protocol does not support torsional and rolling friction");
        const double length = hypotenuse(plane.normal_W);
        plane.normal_W = (1 / length) * plane.normal_W, plane.offset /= length;
        planes.push_back(plane);
    }
    return planes;
}

EngineScene engine_scene(const Problem& problem) {
    const Scene& scene = problem.scene;
    const ExactBody<double>& body = problem.body;
    EngineScene result;
    // the inertia about the centre of mass, also with a pivot
    Scene free = scene;
    free.pivot.reset(), free.planes.clear(), free.loads.clear();
    const PrincipalFrame frame = is_diagonal(scene.body.inertia_B)
                                     ? engine_frame(scene.body.inertia_B)
                                     : pose(free, Formulation::full_principal).body.principal;
    result.moments = frame.moments, result.q_BP = frame.q_BP;
    const Vector3<double>& center = scene.body.center_of_mass;
    for (const Load& load : scene.loads)
        if (Load converted = std::visit(LoadConverter{result.q_BP, center}, load);
            !std::holds_alternative<FormulaLoad>(converted))
            free.loads.push_back(std::move(converted));
    free.parameters.clear(), free.tables.clear(), free.let.clear();
    result.formulas = body_formulas(scene, body, result.q_BP, center);
    result.planes = engine_planes(scene);
    if (!result.planes.empty()) result.shapes = engine_shapes(scene.body, center, result.q_BP);
    free.body = {scene.body.mass, diagonal(result.moments), {}, nullptr};
    free.initial = {body.q * result.q_BP, rotate(body.q, body.angular_velocity_B), Frame::world, body.position_W,
                    body.velocity_W};
    if (scene.pivot) result.pivot = rotate_back(result.q_BP, *scene.pivot - center);
    result.free = std::move(free);
    return result;
}

double readback_difference(const EngineScene& scene, const EngineReadback& readback) {
    double worst = 0;
    const auto compare = [&](const Vector3<double>& requested, const std::optional<Vector3<double>>& reported) {
        if (!reported) return;
        const double size = hypotenuse(requested), difference = hypotenuse(*reported - requested);
        worst = std::max(worst, size > 0 ? difference / size : difference);
    };
    const Initial& initial = scene.free.initial;
    compare(scene.moments, readback.moments), compare(initial.angular_velocity, readback.w);
    compare(initial.position_W, readback.p), compare(initial.velocity_W, readback.v);
    if (readback.mass) worst = std::max(worst, std::abs(*readback.mass / scene.free.body.mass - 1));
    if (readback.q) {
        const Quaternion<double> turn = conjugate(initial.orientation) * *readback.q;
        worst = std::max(worst, 2 * std::atan2(hypotenuse(vector_part(turn)), std::abs(turn.w)));
    }
    return worst;
}

std::string engine_request(const EngineScene& scene, const std::string& setting, const Settings& settings,
                           long steps_per_sample) {
    const Scene& free = scene.free;
    json hull = json::array(), shapes = json::array();
    for (const Vector3<double>& corner : polyhedron_corners(scene.shapes)) hull.push_back(array(corner));
    for (const EngineShape& shape : scene.shapes) shapes.push_back(write_shape(shape));
    json request{{"setting", setting},
                 {"duration", free.duration},
                 {"samples", settings.samples},
                 {"steps_per_sample", steps_per_sample},
                 {"repetitions", settings.repetitions},
                 {"mass", free.body.mass},
                 {"moments", array(scene.moments)},
                 {"q", array(free.initial.orientation)},
                 {"w", array(free.initial.angular_velocity)},
                 {"p", array(free.initial.position_W)},
                 {"v", array(free.initial.velocity_W)},
                 {"pivot", scene.pivot ? array(*scene.pivot) : json()},
                 {"pieces", write_pieces(free)},
                 {"planes", engine_json::write_planes(scene.planes)},
                 {"hull", hull},
                 {"shapes", shapes},
                 {"scene", json::parse(write_scene(free), nullptr, true, true)}};
    if (scene.shapes.size() == 1 && scene.shapes.front().is_centered_ball())
        request["ball"] = scene.shapes.front().radius;
    if (scene.formulas)
        request["formulas"] =
            write_formulas(align_to_steps(*scene.formulas, free.duration, settings.samples, steps_per_sample));
    return request.dump();
}

EngineHello read_hello(std::string_view line) {
    const json hello = json::parse(line, nullptr, false);
    if (!hello.is_object()) throw std::invalid_argument("did not send a JSON object as its first line");
    EngineHello result;
    try {
        result.version = one_line(hello.value("version", ""), 80);
        result.missing = one_line(hello.value("missing", ""), 300);
        result.contacts = hello.value("contacts", false), result.formulas = hello.value("formulas", false);
        if (const auto settings = hello.find("settings"); settings != hello.end())
            for (const auto& [name, what] : settings->items())
                result.settings.emplace_back(one_line(name, 80), one_line(what.get<std::string>(), 300));
        for (const auto& [key, types] : {std::pair{"joints", &result.joints},
                                         {"loops", &result.loops},
                                         {"shapes", &result.shapes},
                                         {"laws", &result.laws}})
            for (const json& type : hello.value(key, json::array()))
                types->push_back(one_line(type.get<std::string>(), 80));
    } catch (const json::exception&) {
        throw std::invalid_argument("sent a first line with values of wrong types");
    }
    return result;
}

EngineAnswer read_answer(std::string_view line, const Problem& problem, const EngineScene& scene,
                         const Settings& settings, long steps_per_sample) {
    EngineAnswer result;
    Trajectory& trajectory = result.trajectory;
    try {
        const json answer = json::parse(line);
        if (!engine_json::read_outcome(answer, trajectory)) return result;
        trajectory.step = problem.scene.duration / static_cast<double>(settings.samples * steps_per_sample);
        result.readback = read_readback(answer);
        read_samples(answer.at("samples"), problem, scene, settings, trajectory);
    } catch (const std::exception& error) {
        trajectory = engine_json::make_failed_trajectory(error);
    }
    return result;
}

}  // namespace polhode
