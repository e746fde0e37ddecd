// What the files of the Python module share.
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

/// A torque of the user's own: what is called, its name, and when it acts (s).
using NamedTorque = std::tuple<py::function, std::string, std::optional<double>, std::optional<double>>;

/// A scene that was read, and the problems that it was posed as. Never changes, so that calls may share it.
class ReadScene {
  public:
    /// Reads JSON; `file` is named in errors, the files it names are relative to `directory`. Throws InputError.
    ReadScene(const std::string& text, const std::string& file, const std::string& directory,
              const std::vector<NamedTorque>& torques);

    const Scene& scene() const { return scene_; }
    /// Posed at the first call, by whichever thread. To be called without the GIL: a user's torque is asked.
    std::shared_ptr<const Problem> problem(Formulation formulation, bool reactions) const;

  private:
    Scene scene_;
    mutable std::mutex mutex_;
    mutable std::shared_ptr<const Problem> posed_[2][2];  // full or not, with reactions or not
};

/// A trajectory for Python, with what it is of.
struct SolvedScene {
    std::shared_ptr<const ReadScene> scene;
    Trajectory trajectory;
    std::string method;
    std::string why;  ///< `auto` chose it
    std::optional<double> tolerance;
};

/// The method of that name, also one that was made in Python. Throws InputError, with near misses.
const Method& method_by_name(const std::string& name);

/// An array over memory that belongs to `owner`.
template <class T>
py::array_t<T> view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                    const py::object& owner) {
    py::array_t<T> array(std::move(shape), std::move(strides), data, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

/// An array that takes over a vector's memory.
template <class T>
py::array_t<T> take(std::vector<T>&& values, std::vector<py::ssize_t> shape) {
    auto* kept = new std::vector<T>(std::move(values));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(std::move(shape), kept->data(), owner);
}

/// A sample from 13 numbers of a trajectory's row: q, w in world axes, p, v.
inline Sample sample_of(double t, const double* row) {
    Sample sample;
    sample.t = t, sample.q = {row[0], row[1], row[2], row[3]};
    const Vector3<double> w_W(row[4], row[5], row[6]);
    sample.angular_velocity_B = (1 / squared_norm(sample.q)) * rotate(conjugate(sample.q), w_W);
    sample.position_W = {row[7], row[8], row[9]}, sample.velocity_W = {row[10], row[11], row[12]};
    return sample;
}

/// A Python function that any thread may copy, call and let go of.
inline std::shared_ptr<py::function> kept(const py::function& function) {
    return {new py::function(function), [](py::function* f) {
                const py::gil_scoped_acquire gil;
                delete f;
            }};
}

/// How often Python is asked for signals.
inline constexpr std::chrono::milliseconds between_signals{20};

/// Calls f without the GIL in this thread. Python's signals are looked at now and then; one whose handler throws, as
/// Ctrl-C's does, ends the call early, and its exception is thrown here.
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
        const Interruption scope{Interruption::Question(interrupted)};
        return f();
    }();
    if (thrown) throw std::move(*thrown);
    return result;
}

/// Calls f without the GIL in a thread of its own, for what shares its work among threads: this one waits and looks at
/// Python's signals. `stop` is called as well when one ends the call.
template <class F>
auto call_aside(F&& f, const std::function<void()>& stop = {}) {
    std::atomic<bool> stopped = false;
    std::optional<py::error_already_set> thrown;
    auto running = std::async(std::launch::async, [&] {
        const Interruption scope{Interruption::Question([&] { return stopped.load(); })};
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

/// While it lives, an exception of a method written in Python is thrown on in this thread; else it fails the run.
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
void bind_ensembles(py::module_& module);
void bind_own_methods(py::module_& module);
void bind_experiments(py::module_& module);
void bind_measuring(py::module_& module);

}  // namespace polhode::python
