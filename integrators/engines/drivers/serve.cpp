#include "integrators/engines/drivers/serve.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iostream>
#include <nlohmann/json.hpp>

#include "scene/scene_file.h"

namespace polhode::engines {
namespace {

using nlohmann::json;

constexpr int answers_descriptor = 3;

void write_line(const json& line) {
    const std::string text = line.dump() + "\n";
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = write(answers_descriptor, text.data() + done, text.size() - done);
        if (written > 0)
            done += static_cast<std::size_t>(written);
        else if (written < 0 && errno != EINTR)
            throw std::runtime_error("cannot write to descriptor 3");
    }
}

Vector3<double> read_vector(const json& v) { return {v.at(0), v.at(1), v.at(2)}; }
json array(const Vector3<double>& v) { return json::array({v[0], v[1], v[2]}); }
json array(const Quaternion<double>& q) { return json::array({q.w, q.x, q.y, q.z}); }

std::vector<Plane> read_planes(const json& request) {
    std::vector<Plane> planes;
    for (const json& plane : request.at("planes"))
        planes.push_back(
            {read_vector(plane.at("normal")), plane.at("offset"), plane.at("restitution"), plane.at("friction")});
    return planes;
}

EngineShape read_shape(const json& shape) {
    const json& q = shape.at("orientation");
    EngineShape result{shape.at("type"), read_vector(shape.at("position")), {q.at(0), q.at(1), q.at(2), q.at(3)}};
    result.radius = shape.value("radius", 0.0), result.half_height = shape.value("half_height", 0.0);
    if (shape.contains("half_extents")) result.half = read_vector(shape.at("half_extents"));
    if (shape.contains("semi_axes")) result.half = read_vector(shape.at("semi_axes"));
    if (shape.contains("corners"))
        for (const json& corner : shape.at("corners")) result.corners.push_back(read_vector(corner));
    return result;
}

// Adds the events of formulas, which the scene of the request does not have: each begins a segment with the loads of
// the segment before it.
void add_events(const std::vector<double>& times, Problem& problem) {
    std::vector<Segment>& segments = problem.segments;
    for (const double begin : times) {
        const auto after = std::ranges::upper_bound(segments, begin, {}, &Segment::begin);
        if (after == segments.begin() || std::prev(after)->begin == begin) continue;
        Segment added = *std::prev(after);
        added.begin = begin, added.impulses.clear();
        std::prev(after)->end = begin, std::prev(after)->last = false;
        segments.insert(after, std::move(added));
    }
    for (std::size_t i = 0; i < segments.size(); ++i) segments[i].index = i;
}

Request read_request(const json& request) {
    const Scene scene = parse_scene(request.at("scene").dump(), "the request");
    Request result{pose(scene, Formulation::full), {}, {}};
    const long steps = request.at("steps_per_sample");
    result.settings.samples = request.at("samples");
    result.settings.repetitions = request.at("repetitions");
    // the fraction of the sample interval from which the same number of steps is computed
    result.settings.step = scene.duration / static_cast<double>(result.settings.samples) / static_cast<double>(steps);
    Body& body = result.body;
    body.mass = request.at("mass"), body.moments = read_vector(request.at("moments"));
    const ExactBody<double>& start = result.problem.body;
    body.q = start.q, body.w = rotate(start.q, start.angular_velocity_B);
    body.p = start.position_W, body.v = start.velocity_W;
    if (!request.at("pivot").is_null()) body.pivot = read_vector(request.at("pivot"));
    body.planes = read_planes(request);
    for (const json& shape : request.at("shapes")) body.shapes.push_back(read_shape(shape));
    body.setting = request.at("setting");
    if (request.contains("formulas")) {
        body.formulas = read_formulas(request.at("formulas"));
        add_events(body.formulas->times, result.problem);
    }
    return result;
}

std::vector<Vector3<double>> read_vectors(const json& list) {
    std::vector<Vector3<double>> all;
    for (const json& v : list) all.push_back(read_vector(v));
    return all;
}

JointLaws read_laws(const json& joint) {
    JointLaws laws;
    laws.friction = joint.value("friction", 0.0), laws.armature = joint.value("armature", 0.0);
    laws.stiffness = joint.value("stiffness", 0.0), laws.rest = joint.value("rest", 0.0);
    laws.damping = joint.value("damping", 0.0);
    if (!joint.contains("limits")) return laws;
    const json& limits = joint.at("limits");
    if (limits.at("lower").is_number()) laws.limits.lower = limits.at("lower");
    if (limits.at("upper").is_number()) laws.limits.upper = limits.at("upper");
    laws.limits.restitution = limits.at("restitution");
    return laws;
}

void read_joint_loads(const json& request, Mechanism& mechanism) {
    for (const json& motor : request.value("motors", json::array()))
        mechanism.motors.push_back({motor.at("joint"), motor.at("force"), motor.at("from"),
                                    motor.value("until", std::numeric_limits<double>::infinity())});
    for (const json& coupling : request.value("couplings", json::array()))
        mechanism.couplings.push_back({coupling.at("first"), coupling.at("second"), coupling.at("ratio")});
}

std::vector<LinkJoint> read_joints(const json& list) {
    std::vector<LinkJoint> all;
    for (const json& joint : list)
        all.push_back({joint.at("type"), joint.at("parent"), joint.at("child"), read_vector(joint.at("anchor")),
                       read_vector(joint.at("parent_point")), read_vector(joint.at("child_point")),
                       read_vectors(joint.at("axes")), read_vectors(joint.at("parent_axes")),
                       read_vectors(joint.at("child_axes")), read_vector(joint.at("turning")),
                       joint.at("rates").get<std::vector<double>>(), read_laws(joint)});
    return all;
}

MechanismRequest read_mechanism(const json& request) {
    MechanismRequest result;
    result.duration = request.at("duration"), result.samples = request.at("samples");
    result.steps_per_sample = request.at("steps_per_sample"), result.repetitions = request.at("repetitions");
    Mechanism& all = result.mechanism;
    all.setting = request.at("setting"), all.gravity = read_vector(request.at("gravity"));
    for (const json& body : request.at("bodies")) {
        const json& q = body.at("q");
        all.bodies.push_back({body.at("mass"),
                              read_vector(body.at("moments")),
                              {{q.at(0), q.at(1), q.at(2), q.at(3)},
                               read_vector(body.at("w")),
                               read_vector(body.at("p")),
                               read_vector(body.at("v"))}});
    }
    all.joints = read_joints(request.at("joints")), all.loops = read_joints(request.at("loops"));
    read_joint_loads(request, all);
    if (request.contains("formulas")) all.formulas = read_formulas(request.at("formulas"));
    if (request.contains("balls")) {
        const json& contact = request.at("contact");
        all.balls = {request.at("balls").get<std::vector<double>>(), contact.at("restitution"), contact.at("friction"),
                     read_planes(request)};
    }
    return result;
}

json make_row(const Motion& at) {
    return {at.q.w,  at.q.x,  at.q.y,  at.q.z,  at.w[0], at.w[1], at.w[2],
            at.p[0], at.p[1], at.p[2], at.v[0], at.v[1], at.v[2]};
}

json mechanism_answer(const MechanismRun& done) {
    json samples = json::array();
    for (const std::vector<Motion>& moment : done.moments) {
        json rows = json::array();
        for (const Motion& at : moment) rows.push_back(make_row(at));
        samples.push_back(std::move(rows));
    }
    return {{"status", "ok"}, {"message", ""}, {"seconds", done.seconds}, {"steps", done.steps}, {"samples", samples}};
}

json make_answer(const std::string& line, const Driver& driver, const std::function<Run(const Request&)>& run,
                 const std::function<MechanismRun(const MechanismRequest&)>& run_mechanism) {
    try {
        const json request = json::parse(line);
        const auto matches = [&](const auto& setting) { return request.at("setting") == setting.first; };
        if (std::ranges::none_of(driver.settings, matches))
            throw std::runtime_error("unknown setting " + request.at("setting").get<std::string>());
        if (request.contains("bodies")) {
            if (!run_mechanism) throw Unsupported("this driver supports only scenes of one body");
            return mechanism_answer(run_mechanism(read_mechanism(request)));
        }
        const Run done = run(read_request(request));
        const Trajectory& trajectory = done.trajectory;
        json answer{{"status", name_of(trajectory.status)},
                    {"message", trajectory.message},
                    {"seconds", trajectory.seconds},
                    {"steps", trajectory.steps}};
        json samples = json::array();
        for (const Sample& s : trajectory.samples) {
            const Vector3<double> w = rotate(normalized(s.q), s.angular_velocity_B);
            samples.push_back({s.q.w, s.q.x, s.q.y, s.q.z, w[0], w[1], w[2], s.position_W[0], s.position_W[1],
                               s.position_W[2], s.velocity_W[0], s.velocity_W[1], s.velocity_W[2]});
        }
        answer["samples"] = std::move(samples);
        const EngineReadback& back = done.readback;
        answer["readback"] = {{"mass", *back.mass},  {"moments", array(*back.moments)},
                              {"q", array(*back.q)}, {"w", array(*back.w)},
                              {"p", array(*back.p)}, {"v", array(*back.v)}};
        return answer;
    } catch (const Unsupported& reason) {
        return {{"status", "unsupported"}, {"message", reason.what()}};
    } catch (const std::exception& error) {
        return {{"status", "failed"}, {"message", error.what()}};
    }
}

}  // namespace

int serve(const Driver& driver, const std::function<Run(const Request&)>& run,
          const std::function<MechanismRun(const MechanismRequest&)>& run_mechanism) {
    json hello{{"engine", driver.engine}, {"version", driver.version}, {"precision", driver.precision}};
    for (const auto& [name, what] : driver.settings) hello["settings"][name] = what;
    if (run_mechanism) hello["joints"] = driver.joints, hello["loops"] = driver.loops;
    hello["shapes"] = driver.shapes, hello["contacts"] = driver.contacts, hello["laws"] = driver.laws;
    hello["formulas"] = true;
    try {
        write_line(hello);
        for (std::string line; std::getline(std::cin, line);) write_line(make_answer(line, driver, run, run_mechanism));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", driver.engine, error.what());
        return 1;
    }
    return 0;
}

}  // namespace polhode::engines
