// Shared types and functions of the Python module: scenes, arrays, and calls without the interpreter lock (GIL).
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "integrators/method.h"
#include "integrators/run/watch.h"
#include "text/interruption.h"

namespace polhode::python {

namespace py = pybind11;

/// A user-defined torque: function, name, start and end (s).
using NamedTorque = std::tuple<py::function, std::string, std::optional<double>, std::optional<double>>;

/// A scene and the problems posed from it. It is immutable, so that calls can share it.
class ReadScene {
  public:
    /// Parses JSON. Errors name `file`; files named in the scene are relative to `directory`. Throws InputError.
    ReadScene(const std::string& text, const std::string& file, const std::string& directory,
              const std::vector<NamedTorque>& torques);

    const Scene& scene() const { return scene_; }
    /// Returns the problem, posed at the first call from any thread. Call it without the GIL, because posing calls
    /// user-defined torques.
    std::shared_ptr<const Problem> problem(Formulation formulation, bool reactions) const;

  private:
    Scene scene_;
    mutable std::mutex mutex_;
    mutable std::shared_ptr<const Problem> posed_[2][2];  // by formulation and by reactions
};

/// A trajectory for Python, with its scene and method.
struct SolvedScene {
    std::shared_ptr<const ReadScene> scene;
    Trajectory trajectory;
    std::string method;
    std::string why;  ///< why `auto` selected the method
    std::optional<double> tolerance;
    std::optional<Settings> settings;  ///< settings of the run; empty for a trajectory of another program
    Formulation formulation = Formulation::reduced;
};

/// Returns the method of this name, including methods registered in Python. Throws UsageError with similar names.
const Method& method_by_name(const std::string& name);

/// Returns a read-only array over memory that belongs to `owner`.
template <class T>
py::array_t<T> view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                    const py::object& owner) {
    py::array_t<T> array(std::move(shape), std::move(strides), data, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

/// Returns an array that takes ownership of a vector.
template <class T>
py::array_t<T> take(std::vector<T>&& values, std::vector<py::ssize_t> shape) {
    auto* kept = new std::vector<T>(std::move(values));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(std::move(shape), kept->data(), owner);
}

/// Makes a sample from the 13 numbers of a row: q, w in world axes, p, v.
inline Sample sample_of(double t, const double* row) {
    Sample sample;
    sample.t = t, sample.q = {row[0], row[1], row[2], row[3]};
    const Vector3<double> w_W(row[4], row[5], row[6]);
    sample.angular_velocity_B = (1 / squared_norm(sample.q)) * rotate(conjugate(sample.q), w_W);
    sample.position_W = {row[7], row[8], row[9]}, sample.velocity_W = {row[10], row[11], row[12]};
    return sample;
}

/// Returns a Python function that any thread may copy, call and release.
inline std::shared_ptr<py::function> share_function(const py::function& function) {
    return {new py::function(function), [](py::function* f) {
                const py::gil_scoped_acquire gil;
                delete f;
            }};
}

/// Interval between checks for Python signals.
inline constexpr std::chrono::milliseconds between_signals{20};

/// Calls f without the GIL in this thread and checks for Python signals at intervals. If a signal handler throws, as
/// for Ctrl-C, the call ends early and rethrows the exception.
template <class F>
auto call(F&& f) {
    using Clock = std::chrono::steady_clock;
    std::optional<py::error_already_set> thrown;
    Clock::time_point next = Clock::now() + between_signals;
    const auto interrupted = [&] {
        if (thrown) return true;
        if (Clock::now() < next) return false;
        const py::gil_scoped_acquire gil;
        if (PyErr_CheckSignals() != 0) thrown.emplace();
        next = Clock::now() + between_signals;
        return thrown.has_value();
    };
    auto result = [&] {
        const py::gil_scoped_release released;
        const Interruption scope{Interruption::Callback(interrupted)};
        return f();
    }();
    if (thrown) throw std::move(*thrown);
    return result;
}

/// Calls f without the GIL in a separate thread, for functions that use several threads. This thread waits and checks
/// for Python signals. `stop` is also called if a signal ends the call.
template <class F>
auto call_in_thread(F&& f, const std::function<void()>& stop = {}) {
    std::atomic<bool> stopped = false;
    std::optional<py::error_already_set> thrown;
    auto running = std::async(std::launch::async, [&] {
        const Interruption scope{Interruption::Callback([&] { return stopped.load(); })};
        return f();
    });
    for (bool ready = false; !ready;) {
        {
            const py::gil_scoped_release released;
            ready = running.wait_for(between_signals) == std::future_status::ready;
        }
        if (ready || thrown || PyErr_CheckSignals() == 0) continue;
        thrown.emplace();
        stopped = true;
        if (stop) stop();
    }
    try {
        auto result = running.get();
        if (!thrown) return result;
    } catch (...) {
        if (!thrown) throw;
    }
    throw std::move(*thrown);
}

/// During its lifetime, exceptions of methods written in Python are rethrown in this thread; otherwise they fail the
/// run.
class RaisingHere {
  public:
    RaisingHere();
    ~RaisingHere();
    RaisingHere(const RaisingHere&) = delete;
    RaisingHere& operator=(const RaisingHere&) = delete;
};

void bind_scenes(py::module_& module);
void bind_solving(py::module_& module);
void bind_truth(py::module_& module);
void bind_contacts(py::module_& module);
void bind_ensembles(py::module_& module);
void bind_user_methods(py::module_& module);
void bind_experiments(py::module_& module);
void bind_measuring(py::module_& module);
void bind_sensitivity(py::module_& module);
void bind_lessons(py::module_& module);

}  // namespace polhode::python
