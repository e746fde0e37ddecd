// Scenes: their texts, and parsed scenes.
#include <limits>
#include <nlohmann/json.hpp>

#include "app/describe.h"
#include "motion/mechanism_motion.h"
#include "python/bindings.h"
#include "report/body_shape.h"
#include "scene/builtin.h"
#include "scene/scene_file.h"
#include "scene/scene_keys.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode::python {
namespace {

// Arrays of the state that a user-defined torque accesses; they are created on access.
py::array_t<double> array_of(const Vector3<double>& v) { return py::array_t<double>(3, v.component.data()); }

// Wraps a Python function as a torque that any thread may call, copy and destroy without holding the GIL.
std::function<Vector3<double>(const LoadState&)> torque_of(const py::function& function) {
    return [torque = share_function(function)](const LoadState& now) {
        const py::gil_scoped_acquire gil;
        const py::object given = (*torque)(now);
        const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
        if (!values || values.size() != 3) {
            PyErr_Clear();
            throw py::value_error("a torque function returned " + std::string(py::repr(given)) +
                                  "; return three numbers, N m in body axes");
        }
        return Vector3<double>(values.data()[0], values.data()[1], values.data()[2]);
    };
}

// Converts JSON with comments to strict JSON and keeps the order of keys.
std::string without_comments(std::string_view text, const std::string& file) {
    const JsonDocument checked(text, file);  // throws InputError with place and fault
    return nlohmann::ordered_json::parse(text, nullptr, true, true).dump();
}

// Returns the text of a scene, and the directory to which the files named in it are relative.
std::pair<std::string, std::string> scene_text(const std::string& name) {
    const Scene scene = find_scene(name);  // throws if it does not exist or is invalid
    const std::string_view text = builtin_scene_text(name);
    return {without_comments(text.empty() ? read_text(name) : std::string(text), name), scene.directory};
}

}  // namespace

ReadScene::ReadScene(const std::string& text, const std::string& file, const std::string& directory,
                     const std::vector<NamedTorque>& torques)
    : scene_(parse_scene(text, file, directory)) {
    for (const auto& [function, name, from, until] : torques) {
        UserTorque torque{name, torque_of(function), {}};
        torque.window.from = from.value_or(torque.window.from);
        torque.window.until = until.value_or(torque.window.until);
        scene_.loads.emplace_back(std::move(torque));
    }
    if (!torques.empty()) validate(scene_, file);
}

std::shared_ptr<const Problem> ReadScene::problem(Formulation formulation, bool reactions) const {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const Problem>& posed = posed_[formulation == Formulation::reduced ? 0 : 1][reactions ? 1 : 0];
    if (!posed) {
        auto made = std::make_shared<Problem>(pose(scene_, formulation));
        made->reactions = reactions;
        posed = std::move(made);
    }
    return posed;
}

void bind_scenes(py::module_& module) {
    py::class_<LoadState>(module, "LoadState", "The state that a user-defined torque is called with.")
        .def_readonly("t", &LoadState::t, "Time, s.")
        .def_property_readonly(
            "q", [](const LoadState& s) { return py::make_tuple(s.q.w, s.q.x, s.q.y, s.q.z); },
            "Attitude (w, x, y, z), body to world, as the method computed it (not normalised).")
        .def_property_readonly(
            "w_B", [](const LoadState& s) { return array_of(s.angular_velocity_B); },
            "Angular velocity, body axes, rad/s.")
        .def_property_readonly(
            "p", [](const LoadState& s) { return array_of(s.position_W); }, "Centre of mass, world axes, m.")
        .def_property_readonly(
            "v", [](const LoadState& s) { return array_of(s.velocity_W); },
            "Velocity of the centre of mass, world axes, m/s.");

    py::class_<ReadScene, std::shared_ptr<ReadScene>>(module, "ReadScene")
        .def(py::init<const std::string&, const std::string&, const std::string&, const std::vector<NamedTorque>&>())
        .def_property_readonly("duration", [](const ReadScene& s) { return s.scene().duration; })
        .def_property_readonly("bodies", [](const ReadScene& s) { return body_names(s.scene()); })
        .def_property_readonly("joints", [](const ReadScene& s) { return joint_names(s.scene()); })
        .def("centers_of_mass",
             [](const ReadScene& s) {
                 std::vector<double> centers;
                 for (std::size_t b = 0; b < body_count(s.scene()); ++b)
                     for (const double x : scene_body(s.scene(), b).body.center_of_mass.component) centers.push_back(x);
                 return take(std::move(centers), {static_cast<py::ssize_t>(body_count(s.scene())), 3});
             })
        .def("shapes",
             [](const ReadScene& s) {
                 Json all = Json::array();
                 for (std::size_t b = 0; b < body_count(s.scene()); ++b)
                     all.push_back(body_shape_json(s.scene().name, scene_body(s.scene(), b).body));
                 return all.dump();
             })
        .def_property_readonly("omitted", [](const ReadScene& s) { return s.scene().omitted; })
        .def_property_readonly("assumed", [](const ReadScene& s) { return s.scene().assumed; })
        .def("describe", [](const ReadScene& s) { return call([&] { return describe_scene(s.scene()); }); })
        .def("canonical", [](const ReadScene& s) { return write_scene(s.scene()); });

    module.def("scene_text", &scene_text);
    module.def("allow_outside_files", &allow_outside_files, py::arg("allowed"),
               "Allows or forbids scene and experiment files to name files outside their directories. The default is "
               "to forbid it.");
    // (object, key, type, unit, default, example, meaning) of every key of a scene file
    module.def("scene_keys", [] {
        py::list all;
        for (const FileKey& key : scene_keys())
            all.append(py::make_tuple(key.object, key.key, key.type, key.unit, key.fallback, key.example, key.meaning));
        return all;
    });
    module.def("scene_names", &builtin_scene_names);
    module.def("experiment_names", &builtin_experiment_names);
    module.def("experiment_text", [](const std::string& name) {
        const std::string_view text = builtin_experiment_text(name);
        return without_comments(text.empty() ? read_text(name) : std::string(text), name);
    });
}

}  // namespace polhode::python
