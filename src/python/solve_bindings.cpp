// Solving: trajectories as arrays that are views of the samples.
#include <fmt/format.h>

#include <cmath>

#include "app/commands.h"
#include "app/describe.h"
#include "app/lookup.h"
#include "integrators/analysis/joint_history.h"
#include "motion/event_formulas.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory_csv.h"
#include "python/bindings.h"
#include "text/message.h"

namespace polhode::python {
namespace {

constexpr py::ssize_t number = sizeof(double), sample_size = sizeof(Sample);
static_assert(sizeof(Sample) == 14 * sizeof(double), "arrays are views of the samples");

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Returns a view of `length` numbers of every sample; `first` points to these numbers in the first sample.
py::array block(const SolvedScene& solved, const double* first, py::ssize_t length, const py::object& owner) {
    const py::ssize_t bodies = solved.trajectory.bodies;
    const auto moments = static_cast<py::ssize_t>(solved.trajectory.moments());
    std::vector<py::ssize_t> shape{moments}, strides{bodies * sample_size};
    if (bodies > 1) shape.push_back(bodies), strides.push_back(sample_size);
    shape.push_back(length), strides.push_back(number);
    return view(first, std::move(shape), std::move(strides), owner);
}

// The first sample of an empty trajectory.
const Sample nothing{};
const Sample& first_of(const SolvedScene& solved) {
    return solved.trajectory.samples.empty() ? nothing : solved.trajectory.samples.front();
}

// Returns angular velocities in world axes, computed from those in body axes.
py::array world_rates(const SolvedScene& solved) {
    std::vector<double> rates;
    rates.reserve(3 * solved.trajectory.samples.size());
    for (const Sample& sample : solved.trajectory.samples) {
        const Vector3<double> w = angular_velocity_W(sample);
        rates.insert(rates.end(), {w[0], w[1], w[2]});
    }
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(solved.trajectory.moments())};
    if (solved.trajectory.bodies > 1) shape.push_back(solved.trajectory.bodies);
    shape.push_back(3);
    return take(std::move(rates), std::move(shape));
}

// Returns the reactions of joints and loops, (n, joints, 6), or None if the method did not compute them.
py::object reactions(const SolvedScene& solved, const py::object& owner) {
    const std::vector<Reaction<double>>& all = solved.trajectory.reactions;
    if (all.empty()) return py::none();
    static_assert(sizeof(Reaction<double>) == 6 * sizeof(double));
    const auto moments = static_cast<py::ssize_t>(solved.trajectory.moments());
    const auto joints = static_cast<py::ssize_t>(all.size()) / moments;
    return view(all.front().force_W.component.data(), {moments, joints, 6}, {joints * 6 * number, 6 * number, number},
                owner);
}

// Computes the motions of the joints at all samples. Throws UsageError if revolutions cannot be counted.
JointHistory<double> history_of(const SolvedScene& solved) {
    const std::shared_ptr<const Problem> problem = solved.scene->problem(solved.formulation, false);
    const Method* method = solved.settings ? &method_by_name(solved.method) : nullptr;
    JointHistory<double> history =
        joint_history(*problem, method, solved.settings.value_or(Settings{}), solved.trajectory);
    if (!history.fault.empty()) throw UsageError(history.fault);
    return history;
}

// Returns the values of formulas at all samples, shape (n, formulas). Throws UsageError as history_of() does.
py::array event_values(const EventFormulas& formulas, const SolvedScene& solved) {
    std::vector<double> values = call([&] {
        JointHistory<double> history;
        if (formulas.reads_joints()) history = history_of(solved);
        const std::size_t joints = formulas.reads_joints() ? solved.scene->scene().joints.size() : 0;
        std::vector<double> all;
        for (std::size_t k = 0; k < solved.trajectory.moments(); ++k) {
            const std::span<const JointMotion<double>> motions(history.motions.data() + k * joints, joints);
            const std::vector<double> now = formulas.values(solved.trajectory.at(k), motions);
            all.insert(all.end(), now.begin(), now.end());
        }
        return all;
    });
    return take(std::move(values),
                {static_cast<py::ssize_t>(solved.trajectory.moments()), static_cast<py::ssize_t>(formulas.size())});
}

// Returns the motions of the joints: for each joint its name, type, coordinates (n, k) and rates (n, k), and for a
// spherical joint its angular velocities (n, 3). Throws UsageError if revolutions cannot be counted.
py::list joints_of(const SolvedScene& solved) {
    const Scene& scene = solved.scene->scene();
    const JointHistory<double> history = call([&] { return history_of(solved); });
    static constexpr const char* types[] = {"revolute", "prismatic", "spherical", "universal", "fixed"};
    const std::size_t joints = scene.joints.size();
    const py::ssize_t moments = static_cast<py::ssize_t>(history.times.size());
    py::list all;
    for (std::size_t j = 0; j < joints; ++j) {
        std::vector<double> coordinates, rates, angular_velocities;
        for (std::size_t k = j; k < history.motions.size(); k += joints) {
            const JointMotion<double>& motion = history.motions[k];
            for (const double x : motion.coordinates()) coordinates.push_back(x);
            for (const double rate : motion.rates()) rates.push_back(rate);
            for (const double w : motion.angular_velocity.component) angular_velocities.push_back(w);
        }
        const auto columns = static_cast<py::ssize_t>(moments > 0 ? coordinates.size() / history.times.size() : 0);
        all.append(py::make_tuple(scene.joints[j].name, types[static_cast<std::size_t>(scene.joints[j].type)],
                                  take(std::move(coordinates), {moments, columns}),
                                  take(std::move(rates), {moments, columns}),
                                  take(std::move(angular_velocities), {moments, 3})));
    }
    return all;
}

void require_positive(const char* what, const std::optional<double>& value) {
    if (value && !(std::isfinite(*value) && *value > 0))
        throw UsageError(fmt::format("{} is {}; give a finite number > 0", what, *value));
}

std::shared_ptr<SolvedScene> solve_scene(const std::shared_ptr<ReadScene>& scene, const std::string& method,
                                         const Settings& settings, bool full, bool with_reactions) {
    require_positive("step", settings.step), require_positive("tolerance", settings.tolerance);
    auto solved = std::make_shared<SolvedScene>();
    solved->scene = scene;
    solved->trajectory = call([&] {
        const std::shared_ptr<const Problem> problem =
            scene->problem(full ? Formulation::full : Formulation::reduced, with_reactions);
        Choice choice{nullptr, ""};
        if (method == "auto")
            choice = choose_method(*problem, settings);
        else
            choice.method = &method_by_name(method);
        solved->method = choice.method->name, solved->why = choice.why;
        if (settings.step && !takes_step(*choice.method))
            throw UsageError(fmt::format("{} does not take a step; remove the argument step", choice.method->name));
        if (settings.tolerance && !takes_tolerance(*choice.method))
            throw UsageError(
                fmt::format("{} does not take a tolerance; remove the argument tolerance", choice.method->name));
        const Settings complete = with_defaults(*problem, *choice.method, settings);
        solved->tolerance = complete.tolerance;
        solved->settings = complete, solved->formulation = full ? Formulation::full : Formulation::reduced;
        const RaisingHere raising;
        return solve(*problem, *choice.method, complete);
    });
    return solved;
}

// Makes a trajectory from rows of 13 numbers: q, w in world axes, p, v.
std::shared_ptr<SolvedScene> trajectory_of(const std::shared_ptr<ReadScene>& scene, const std::string& made_by,
                                           const Array& times, const Array& rows) {
    auto solved = std::make_shared<SolvedScene>();
    solved->scene = scene, solved->method = made_by;
    const auto t = times.unchecked<1>();
    const auto row = rows.unchecked<2>();
    if (row.shape(1) != 13 || t.shape(0) == 0 || row.shape(0) % t.shape(0) != 0)
        throw py::value_error("the arrays have different lengths; give one row per time and body");
    const py::ssize_t bodies = row.shape(0) / t.shape(0);
    solved->trajectory.bodies = static_cast<int>(bodies);
    for (py::ssize_t i = 0; i < row.shape(0); ++i) {
        solved->trajectory.samples.push_back(sample_of(t(i / bodies), row.data(i, 0)));
    }
    return solved;
}

py::dict counts_of(const Trajectory& trajectory) {
    py::dict counts;
    counts["rejected_steps"] = trajectory.counts.rejected_steps;
    counts["newton_failures"] = trajectory.counts.newton_failures;
    counts["order_reductions"] = trajectory.counts.order_reductions;
    return counts;
}

}  // namespace

const Method& method_by_name(const std::string& name) { return method_named(name); }

void bind_solving(py::module_& module) {
    py::class_<Settings>(module, "Settings")
        .def(py::init([](std::optional<double> step, std::optional<double> tolerance, long samples, const Array& times,
                         long max_steps, long max_evaluations, double max_seconds) {
                 Settings settings;
                 settings.step = step, settings.tolerance = tolerance, settings.samples = samples;
                 settings.times.assign(times.data(), times.data() + times.size());
                 settings.max_steps = max_steps, settings.max_evaluations = max_evaluations;
                 settings.seconds_limit = max_seconds;
                 return settings;
             }),
             py::arg("step") = py::none(), py::arg("tolerance") = py::none(), py::arg("samples") = Settings{}.samples,
             py::arg("times") = Array(0), py::arg("max_steps") = Settings{}.max_steps,
             py::arg("max_evaluations") = Settings{}.max_evaluations,
             py::arg("max_seconds") = Settings{}.seconds_limit);

    const auto array = [](py::ssize_t length, auto member) {
        return py::cpp_function([length, member](const py::object& self) {
            const SolvedScene& solved = self.cast<const SolvedScene&>();
            return block(solved, member(first_of(solved)), length, self);
        });
    };
    py::class_<SolvedScene, std::shared_ptr<SolvedScene>>(module, "SolvedScene")
        .def_property_readonly("t",
                               [](const py::object& self) {
                                   const SolvedScene& solved = self.cast<const SolvedScene&>();
                                   return view(&first_of(solved).t,
                                               {static_cast<py::ssize_t>(solved.trajectory.moments())},
                                               {solved.trajectory.bodies * sample_size}, self);
                               })
        .def_property_readonly("q", array(4, [](const Sample& s) { return &s.q.w; }))
        .def_property_readonly("w_B", array(3, [](const Sample& s) { return s.angular_velocity_B.component.data(); }))
        .def_property_readonly("p", array(3, [](const Sample& s) { return s.position_W.component.data(); }))
        .def_property_readonly("v", array(3, [](const Sample& s) { return s.velocity_W.component.data(); }))
        .def("w", &world_rates)
        .def("reactions", [](const py::object& self) { return reactions(self.cast<const SolvedScene&>(), self); })
        .def("joints", &joints_of)
        .def_property_readonly("impact_times", [](const SolvedScene& s) { return s.trajectory.impact_times; })
        .def_property_readonly("status", [](const SolvedScene& s) { return name_of(s.trajectory.status); })
        .def_property_readonly("message", [](const SolvedScene& s) { return s.trajectory.message; })
        .def_property_readonly("steps", [](const SolvedScene& s) { return s.trajectory.steps; })
        .def_property_readonly("rhs_evaluations", [](const SolvedScene& s) { return s.trajectory.rhs_evaluations; })
        .def_property_readonly("sample_evaluations",
                               [](const SolvedScene& s) { return s.trajectory.sample_evaluations; })
        .def_property_readonly("counts", [](const SolvedScene& s) { return counts_of(s.trajectory); })
        .def_property_readonly("seconds", [](const SolvedScene& s) { return s.trajectory.seconds; })
        .def_property_readonly("step", [](const SolvedScene& s) { return s.trajectory.step; })
        .def_readonly("method", &SolvedScene::method)
        .def_readonly("why", &SolvedScene::why)
        .def_readonly("tolerance", &SolvedScene::tolerance)
        .def_readonly("scene", &SolvedScene::scene)
        .def("csv", [](const SolvedScene& s) {
            const py::gil_scoped_release released;
            return trajectory_csv(s.trajectory, body_names(s.scene->scene()));
        });

    py::class_<EventFormulas>(module, "EventFormulas")
        .def(py::init([](const ReadScene& scene, const std::vector<std::string>& formulas) {
            return EventFormulas(scene.scene(), formulas);
        }))
        .def("values", [](const EventFormulas& self, const SolvedScene& solved) { return event_values(self, solved); });

    module.def("method_description", [](const std::string& name) -> std::optional<std::string> {
        if (name == "auto")
            return "auto\n\n  Selects a method for the scene; polhode describe SCENE prints which and why.\n";
        const Method* method = find_method(name);
        return method ? std::optional(describe_method(*method)) : std::nullopt;
    });
    module.def("solve", &solve_scene);
    module.def("trajectory_of", &trajectory_of);
}

}  // namespace polhode::python
