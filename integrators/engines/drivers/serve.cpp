#include "integrators/engines/drivers/serve.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <iostream>
#include <nlohmann/json.hpp>

#include "scene/scene_file.h"

namespace polhode::engines {
namespace {

using nlohmann::json;

constexpr int answers_descriptor = 3;

void say(const json& line) {
    const std::string text = line.dump() + "\n";
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = write(answers_descriptor, text.data() + done, text.size() - done);
        if (written > 0)
            done += static_cast<std::size_t>(written);
        else if (written < 0 && errno != EINTR)
            throw std::runtime_error("nobody listens on descriptor 3");
    }
}

Vector3<double> vector_from(const json& v) { return {v.at(0), v.at(1), v.at(2)}; }
json array(const Vector3<double>& v) { return json::array({v[0], v[1], v[2]}); }
json array(const Quaternion<double>& q) { return json::array({q.w, q.x, q.y, q.z}); }

Request read_request(const json& request) {
    const Scene scene = parse_scene(request.at("scene").dump(), "the request");
    Request known{pose(scene, Formulation::full), {}, {}};
    const long steps = request.at("steps_per_sample");
    known.settings.samples = request.at("samples");
    known.settings.repetitions = request.at("repetitions");
    // a part of the sample interval that gives the number of steps back
    known.settings.step = scene.duration / static_cast<double>(known.settings.samples) / static_cast<double>(steps);
    Body& body = known.body;
    body.mass = request.at("mass"), body.moments = vector_from(request.at("moments"));
    const ExactBody<double>& start = known.problem.body;
    body.q = start.q, body.w = rotate(start.q, start.angular_velocity_B);
    body.p = start.position_W, body.v = start.velocity_W;
    if (!request.at("pivot").is_null()) body.pivot = vector_from(request.at("pivot"));
    for (const json& plane : request.at("planes"))
        body.planes.push_back(
            {vector_from(plane.at("normal")), plane.at("offset"), plane.at("restitution"), plane.at("friction")});
    for (const json& corner : request.at("hull")) body.hull.push_back(vector_from(corner));
    if (request.contains("ball")) body.ball = request.at("ball");
    body.setting = request.at("setting");
    return known;
}

json answer_to(const std::string& line, const Driver& driver, const std::function<Run(const Request&)>& run) {
    try {
        const Request request = read_request(json::parse(line));
        const auto known = [&](const auto& setting) { return setting.first == request.body.setting; };
        if (std::ranges::none_of(driver.settings, known))
            throw std::runtime_error("it has no setting " + request.body.setting);
        const Run done = run(request);
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

int serve(const Driver& driver, const std::function<Run(const Request&)>& run) {
    json hello{{"engine", driver.engine}, {"version", driver.version}, {"precision", driver.precision}};
    for (const auto& [name, what] : driver.settings) hello["settings"][name] = what;
    try {
        say(hello);
        for (std::string line; std::getline(std::cin, line);) say(answer_to(line, driver, run));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", driver.engine, error.what());
        return 1;
    }
    return 0;
}

}  // namespace polhode::engines
