// A scene as canonical JSON.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "scene/body_file.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/json_document.h"

namespace polhode {
namespace {

std::string json(const Vector3<double>& v) {
    return fmt::format("[{}, {}, {}]", shortest_decimal(v[0]), shortest_decimal(v[1]), shortest_decimal(v[2]));
}

std::string json(const Quaternion<double>& q) {
    return fmt::format("[{}, {}, {}, {}]", shortest_decimal(q.w), shortest_decimal(q.x), shortest_decimal(q.y),
                       shortest_decimal(q.z));
}

std::string json(Frame frame) { return frame == Frame::body ? "\"body\"" : "\"world\""; }

std::string json(const Window& window) {
    std::string text;
    if (std::isfinite(window.from)) text += ", \"from\": " + shortest_decimal(window.from);
    if (std::isfinite(window.until)) text += ", \"until\": " + shortest_decimal(window.until);
    return text;
}

struct LoadWriter {
    std::string operator()(const Gravity& load) const {
        return fmt::format(R"({{"type": "gravity", "acceleration": {}{}}})", json(load.acceleration_W),
                           json(load.window));
    }
    std::string operator()(const Torque& load) const {
        return fmt::format(R"({{"type": "torque", "vector": {}, "frame": {}{}}})", json(load.vector), json(load.frame),
                           json(load.window));
    }
    std::string operator()(const Force& load) const {
        return fmt::format(R"({{"type": "force", "vector": {}, "frame": {}, "point": {}, "point_frame": {}{}}})",
                           json(load.vector), json(load.frame), json(load.point), json(load.point_frame),
                           json(load.window));
    }
    std::string operator()(const Impulse& load) const {
        return fmt::format(
            R"({{"type": "impulse", "vector": {}, "frame": {}, "point": {}, "point_frame": {}, "at": {}}})",
            json(load.vector), json(load.frame), json(load.point), json(load.point_frame), shortest_decimal(load.at));
    }
    std::string operator()(const Drag& load) const {
        return fmt::format(R"({{"type": "drag", "rotational": {}, "translational": {}{}}})", json(load.rotational),
                           shortest_decimal(load.translational), json(load.window));
    }
    std::string operator()(const Spring& load) const {
        return fmt::format(R"({{"type": "spring", "stiffness": {}, "rest_orientation": {}{}}})",
                           shortest_decimal(load.stiffness), json(load.rest_orientation), json(load.window));
    }
    std::string operator()(const UserTorque& load) const {
        throw std::invalid_argument(fmt::format("the user's torque \"{}\" has no file form", load.name));
    }
};

}  // namespace

std::string write_scene(const Scene& scene) {
    std::string text = "{\n  \"name\": " + json_string(scene.name);
    const auto member = [&](const char* key, const std::string& value) {
        text += fmt::format(",\n  \"{}\": {}", key, value);
    };
    if (!scene.about.empty()) member("about", json_string(scene.about));
    if (!scene.source.empty()) member("source", json_string(scene.source));
    member("duration", shortest_decimal(scene.duration));
    member("body", "{\n    " + write_body(scene.body) + "\n  }");
    const Initial& initial = scene.initial;
    std::string start =
        fmt::format("{{\n    \"orientation\": {},\n    \"angular_velocity\": {},\n    \"angular_velocity_frame\": {}",
                    json(initial.orientation), json(initial.angular_velocity), json(initial.angular_velocity_frame));
    if (!scene.pivot)
        start += fmt::format(",\n    \"position\": {},\n    \"velocity\": {}", json(initial.position_W),
                             json(initial.velocity_W));
    member("initial", start + "\n  }");
    if (scene.pivot) member("pivot", json(*scene.pivot));
    std::string loads;
    for (const Load& load : scene.loads)
        loads += (loads.empty() ? "\n    " : ",\n    ") + std::visit(LoadWriter{}, load);
    if (!loads.empty()) member("loads", "[" + loads + "\n  ]");
    std::string planes;
    for (const Plane& plane : scene.planes)
        planes +=
            fmt::format(R"({}{{"normal": {}, "offset": {}, "restitution": {}, "friction": {}}})",
                        planes.empty() ? "\n    " : ",\n    ", json(plane.normal_W), shortest_decimal(plane.offset),
                        shortest_decimal(plane.restitution), shortest_decimal(plane.friction));
    if (!planes.empty()) member("planes", "[" + planes + "\n  ]");
    std::string tolerated;
    for (const std::string_view block : tolerated_blocks)
        if (const std::optional<double> error = tolerated_error(scene, block))
            tolerated += fmt::format("{}\"{}\": {}", tolerated.empty() ? "" : ", ", block, shortest_decimal(*error));
    if (!tolerated.empty()) member("tolerated", "{" + tolerated + "}");
    return text + "\n}\n";
}

}  // namespace polhode
