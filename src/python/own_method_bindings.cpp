// Methods written in Python: a step function, or a function that computes a whole trajectory. They are registered after
// polhode's methods, and experiments treat them like all others. Python code runs with the GIL held.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <span>

#include "experiment/plan/method_style.h"
#include "figure/curve_style.h"
#include "integrators/run/march.h"
#include "integrators/user_methods.h"
#include "motion/numbers.h"
#include "python/bindings.h"
#include "scene/scene_file.h"

namespace polhode::python {
namespace {

py::array_t<double> array_of(const double* y, int n) { return py::array_t<double>(n, y); }

// Reads a state of n numbers that a Python function returned.
void read_state(const py::object& given, int n, double* y, const char* who) {
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!values || values.ndim() != 1 || values.size() != n) {
        PyErr_Clear();
        throw py::value_error(fmt::format("{} is {}; give {} numbers", who, std::string(py::repr(given)), n));
    }
    std::copy_n(values.data(), n, y);
}

// The right-hand side f(t, y) of the current system, valid during a run.
class RightHandSide {
  public:
    using Function = std::function<void(double t, const double* y, double* rate)>;
    RightHandSide(int dimension, Function function) : dimension_(dimension), function_(std::move(function)) {}

    py::array_t<double> operator()(double t, const py::object& y) {
        if (!function_) throw py::value_error("f was called after its run; call f only within the step function");
        std::vector<double> state(static_cast<std::size_t>(dimension_)), rate(state.size());
        read_state(y, dimension_, state.data(), "f(t, y): y");
        ++evaluations;
        function_(t, state.data(), rate.data());
        return take(std::move(rate), {dimension_});
    }
    void end() { function_ = nullptr; }

    long evaluations = 0;

  private:
    int dimension_;
    Function function_;
};

// Steps y(t + h) = step(f, t, y, h) on the scene's system.
template <class SystemType>
class PythonStepper {
  public:
    PythonStepper(const Problem& problem, const py::function* step)
        : system_(problem), y_(system_.size()), step_(step), rates_(make_rates()) {
        restart();
    }
    ~PythonStepper() {  // NOLINT(bugprone-exception-escape): without a thread state Python cannot continue
        const py::gil_scoped_acquire gil;
        native_->end();
        rates_ = py::object();
    }
    PythonStepper(const PythonStepper&) = delete;
    PythonStepper& operator=(const PythonStepper&) = delete;

    void restart() {
        system_.initial(y_.data());
        native_->evaluations = 0;
    }
    void enter(const Segment& segment) { system_.enter(segment, y_.data()); }
    void step(double t, double h) {
        const py::gil_scoped_acquire gil;
        const py::object next = (*step_)(rates_, t, array_of(y_.data(), system_.size()), h);
        read_state(next, system_.size(), y_.data(), "the result of the step function");
    }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    bool finite() const {
        return std::ranges::all_of(y_, [](double value) { return std::isfinite(value); });
    }
    long rhs_evaluations() const { return native_->evaluations; }

  private:
    py::object make_rates() {
        const py::gil_scoped_acquire gil;
        py::object made = py::cast(RightHandSide(
            system_.size(), [this](double t, const double* y, double* rate) { system_.derivative(t, y, rate); }));
        native_ = made.cast<RightHandSide*>();
        return made;
    }

    SystemType system_;
    Numbers<SystemType::dimension> y_;
    const py::function* step_;
    RightHandSide* native_ = nullptr;
    py::object rates_;
};

Trajectory by_steps(const py::function& step, const Problem& problem, const Settings& settings) {
    return with_system(problem,
                       [&]<class SystemType>() { return march<PythonStepper<SystemType>>(problem, settings, &step); });
}

// Calls solve(scene text, directory, times, step, tolerance, time limit), which returns (rows of 13 numbers, steps,
// evaluations); see _methods.py.
Trajectory by_function(const py::function& solve, const Problem& problem, const Settings& settings) {
    if (problem.needs.user_torque) return unsupported("user-defined torques cannot be passed to a solver as a file");
    Trajectory trajectory;
    const py::gil_scoped_acquire gil;
    const std::vector<double> times =
        settings.times.empty() ? sample_times(problem.scene.duration, settings.samples) : settings.times;
    const bool last_alone = !settings.record;
    const Stopwatch stopwatch;
    for (int run = 0; run < settings.repetitions; ++run) {
        const py::tuple given = solve(write_scene(problem.scene), problem.scene.directory, times, settings.step,
                                      settings.tolerance, settings.seconds_limit);
        const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given[0]);
        const std::size_t bodies = body_count(problem.scene);
        if (!rows || rows.ndim() != 2 || rows.shape(1) != 13 ||
            static_cast<std::size_t>(rows.shape(0)) != times.size() * bodies)
            throw py::value_error("the solver returned a wrong number of rows; return one row per time and body");
        trajectory.samples.clear();
        trajectory.bodies = static_cast<int>(bodies);
        const auto row = rows.unchecked<2>();
        for (py::ssize_t i = 0; i < row.shape(0); ++i) {
            if (last_alone && static_cast<std::size_t>(i) / bodies + 1 < times.size()) continue;
            trajectory.samples.push_back(sample_of(times[static_cast<std::size_t>(i) / bodies], row.data(i, 0)));
        }
        trajectory.steps = given[1].cast<long>(), trajectory.rhs_evaluations = given[2].cast<long>();
    }
    trajectory.seconds = stopwatch.seconds() / settings.repetitions;
    const std::string fault = divergence(problem, trajectory.at(trajectory.moments() - 1), energy_bound(problem));
    if (!fault.empty()) trajectory.status = Status::diverged, trajectory.message = fault;
    return trajectory;
}

// An exception in a user-defined method fails its row in experiments, and is rethrown by polhode.solve().
class Thrown {
  public:
    static Trajectory solve(const std::function<Trajectory()>& run) {
        if (raises) return run();
        Trajectory trajectory;
        try {
            return run();
        } catch (const py::error_already_set& error) {
            const py::gil_scoped_acquire gil;
            trajectory.message = error.what();
        } catch (const std::exception& error) {
            trajectory.message = error.what();
        }
        trajectory.status = Status::failed;
        trajectory.message = trajectory.message.substr(0, trajectory.message.find('\n'));
        return trajectory;
    }
    static inline thread_local bool raises = false;
};

void add_user_method(const std::string& name, const std::string& documentation, const std::string& source, int order,
                     const std::string& conserves, const std::string& control, const std::string& identity,
                     const std::optional<py::function>& step, const std::optional<py::function>& solve) {
    Method description;
    description.name = name, description.documentation = documentation, description.source = source;
    description.order = order, description.conserves = conserves, description.identity = identity;
    description.general_systems = true;
    description.control = control == "step"        ? Control::fixed_step
                          : control == "tolerance" ? Control::tolerance
                          : control == "none"      ? Control::none
                                                   : Control::fixed_step_or_tolerance;
    const std::shared_ptr<py::function> function = share_function(step ? *step : *solve);
    const bool steps = step.has_value();
    add_method(make_method(description, [function, steps](const Problem& problem, const Settings& settings) {
        return Thrown::solve(
            [&] { return steps ? by_steps(*function, problem, settings) : by_function(*function, problem, settings); });
    }));
}

std::string control_of(const Method& method) {
    if (takes_step(method)) return takes_tolerance(method) ? "step or tolerance" : "step";
    return takes_tolerance(method) ? "tolerance" : "none";
}

py::dict entry_of(const Method& method) {
    py::dict entry;
    entry["name"] = std::string(method.name), entry["documentation"] = std::string(method.documentation);
    entry["source"] = std::string(method.source), entry["conserves"] = std::string(method.conserves);
    entry["order"] = method.order > 0 ? py::cast(method.order) : py::none();
    entry["control"] = control_of(method);
    entry["library"] = method.library.empty() ? "polhode" : std::string(method.library);
    entry["planes"] = method.planes;
    const MethodStyle style = method_style(method);
    entry["color"] = color_of(style.color), entry["mark"] = mark_name(style.mark);
    // whether samples are computed between steps, without affecting the steps
    entry["dense"] = method.control != Control::fixed_step && method.family != Family::engine;
    return entry;
}

}  // namespace

RaisingHere::RaisingHere() { Thrown::raises = true; }
RaisingHere::~RaisingHere() { Thrown::raises = false; }

void bind_user_methods(py::module_& module) {
    py::class_<RightHandSide>(module, "RightHandSide", "The right-hand side of the system of a scene.")
        .def("__call__", &RightHandSide::operator(), py::arg("t"), py::arg("y"), "dy/dt at time t (s) and state y.");
    module.def("add_method", &add_user_method, py::arg("name"), py::arg("documentation"), py::arg("source"),
               py::arg("order"), py::arg("conserves"), py::arg("control"), py::arg("identity"), py::kw_only(),
               py::arg("step"), py::arg("solve"));
    module.def("plain_colors", [] {
        py::list all;
        for (int place = 0; place < color_count - 1; ++place) all.append(color_of(plain_style(place).color));
        return all;
    });
    module.def("methods", [] {
        py::list all;
        for (const Method* method : methods()) all.append(entry_of(*method));
        return all;
    });
}

}  // namespace polhode::python
