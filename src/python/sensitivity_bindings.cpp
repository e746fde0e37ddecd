// Derivatives of motions with respect to numbers of the scene.
#include "integrators/fit/scene_sensitivities.h"
#include "python/bindings.h"

namespace polhode::python {
namespace {

using NumberArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Returns (status, message, steps, numbers of the motion, derivatives). The numbers of a row are those of a
// trajectory file: q, w in world axes, p, v; shape (n, bodies, 13). Shape of the derivatives: (n, bodies, 12,
// parameters).
py::tuple sensitivity_arrays(
    const ReadScene& scene,
    const std::vector<std::tuple<std::shared_ptr<ReadScene>, std::shared_ptr<ReadScene>, double>>& sides,
    const NumberArray& times, double tolerance, double max_seconds) {
    std::vector<SceneChange> changes;
    for (const auto& [ahead, behind, by] : sides) changes.push_back({ahead->scene(), behind->scene(), by});
    const std::vector<double> at(times.data(), times.data() + times.size());
    SensitivitySettings settings;
    settings.tolerance = tolerance, settings.seconds_limit = max_seconds;
    Sensitivities found = call([&] { return scene_sensitivities(scene.scene(), changes, at, settings); });
    std::vector<double> rows;
    for (const Sample& s : found.samples) {
        const Vector3<double> w = angular_velocity_W(s);
        rows.insert(rows.end(), {s.q.w, s.q.x, s.q.y, s.q.z, w[0], w[1], w[2], s.position_W[0], s.position_W[1],
                                 s.position_W[2], s.velocity_W[0], s.velocity_W[1], s.velocity_W[2]});
    }
    const py::ssize_t bodies = found.bodies, n = static_cast<py::ssize_t>(found.samples.size()) / bodies;
    if (found.status != Status::ok) rows.clear(), found.derivatives.clear();
    const py::ssize_t moments = found.status == Status::ok ? n : 0;
    return py::make_tuple(
        name_of(found.status), found.message, found.steps, take(std::move(rows), {moments, bodies, 13}),
        take(std::move(found.derivatives), {moments, bodies, static_cast<py::ssize_t>(Sensitivities::quantities),
                                            static_cast<py::ssize_t>(found.parameters)}));
}

}  // namespace

void bind_sensitivity(py::module_& module) { module.def("sensitivities", &sensitivity_arrays); }

}  // namespace polhode::python
