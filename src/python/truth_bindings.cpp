// The truth, errors of trajectories against it, and checks of files.
#include <fmt/format.h>

#include "check/check_files.h"
#include "check/limits.h"
#include "integrators/truth/balls/certified.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "python/bindings.h"
#include "text/message.h"

namespace polhode::python {
namespace {

// Sample times: N equal intervals, or given times.
struct SampleTimes {
    long samples = 100;
    std::vector<double> times;
};

DecimalReference decimals_of(const ReadScene& scene, const SampleTimes& at, int digits, double max_seconds) {
    return call_in_thread([&] {
        return at.times.empty() ? decimal_reference(scene.scene(), at.samples, digits, max_seconds)
                                : decimal_reference(scene.scene(), at.times, digits, max_seconds);
    });
}

CertifiedReference certified_of(const ReadScene& scene, const SampleTimes& at, int digits, double max_seconds) {
    return call_in_thread([&] {
        return at.times.empty() ? certified_reference(scene.scene(), at.samples, digits, max_seconds)
                                : certified_reference(scene.scene(), at.times, digits, max_seconds);
    });
}

template <class T>
py::object optional_of(const std::optional<T>& value) {
    return value ? py::cast(*value) : py::none();
}

// Returns errors at each sample and over the run, by the names of the measures.
py::dict errors_of(const SolvedScene& solved, int digits, double max_seconds) {
    ErrorSeries series;
    Errors run;
    Reference truth;
    call_in_thread([&] {
        std::vector<double> times;
        const Trajectory& trajectory = solved.trajectory;
        for (std::size_t k = 0; k < trajectory.moments(); ++k)
            times.push_back(trajectory.samples[k * static_cast<std::size_t>(trajectory.bodies)].t);
        if (times.empty()) throw TruthUnavailable("the trajectory has no samples: " + trajectory.message);
        truth = reference(solved.scene->scene(), times, digits, max_seconds);
        if (!truth.available) throw TruthUnavailable(truth.message);
        series = error_series(solved.scene->scene(), trajectory, truth);
        run = errors(series, trajectory, truth);
        return true;
    });
    py::dict at_samples, largest, final;
    for (std::size_t i = 0; i < measures().size(); ++i) {
        const std::string name(measures()[i].name);
        if (series[i].empty()) continue;
        const auto length = static_cast<py::ssize_t>(series[i].size());
        at_samples[name.c_str()] = take(std::move(series[i]), {length});
        largest[name.c_str()] = optional_of(run[i].max);
        final[name.c_str()] = optional_of(run[i].final);
    }
    py::dict result;
    const auto length = static_cast<py::ssize_t>(series.t.size());
    result["t"] = take(std::move(series.t), {length});
    result["series"] = at_samples, result["max"] = largest, result["final"] = final;
    result["bound"] = truth.bound, result["truth"] = truth.message;
    result["worst_body"] = series.worst_body;
    return result;
}

// Returns the verdict, text, JSON and explanation of `polhode check` for tables of numbers.
std::tuple<bool, std::string, std::string, std::string> check_texts(
    const ReadScene& scene, const std::vector<std::pair<std::string, std::string>>& tables,
    const std::string& convention, const std::map<std::string, std::string>& limits, bool explain) {
    const Convention read = convention.empty() ? Convention{} : parse_convention(convention);
    ErrorLimits allowed(scene.scene());
    for (const auto& [block, limit] : limits) allowed.set(block, limit);
    std::vector<NamedText> files;
    for (const auto& [name, text] : tables) files.push_back({name, text});
    const std::vector<CheckedFile> checked =
        call_in_thread([&] { return check_files(scene.scene(), files, read, {}, allowed, explain); });
    bool passed = true;
    for (const CheckedFile& file : checked)
        for (const BlockVerdict& verdict : allowed.verdicts(file.file_errors)) passed = passed && !verdict.failed;
    return {passed, check_text(allowed, checked), check_json(scene.scene(), allowed, checked),
            explain ? explanation_text(checked) : ""};
}

py::list measures_list() {
    py::list all;
    for (const Measure& measure : measures()) {
        py::dict entry;
        entry["name"] = std::string(measure.name), entry["title"] = std::string(measure.title);
        entry["unit"] = std::string(measure.unit), entry["meaning"] = std::string(measure.meaning);
        all.append(entry);
    }
    return all;
}

}  // namespace

void bind_truth(py::module_& module) {
    using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
    py::class_<SampleTimes>(module, "SampleTimes").def(py::init([](long samples, const Array& times) {
        return SampleTimes{samples, {times.data(), times.data() + times.size()}};
    }));
    py::class_<DecimalReference>(module, "DecimalReference")
        .def_readonly("available", &DecimalReference::available)
        .def_readonly("message", &DecimalReference::message)
        .def_readonly("bound", &DecimalReference::bound)
        .def_readonly("times", &DecimalReference::times)
        .def_readonly("bodies", &DecimalReference::bodies)
        .def_readonly("columns", &DecimalReference::columns)
        .def_readonly("impact_times", &DecimalReference::impact_times)
        .def_readonly("scene_hash", &DecimalReference::scene_hash);
    py::class_<CertifiedNumber>(module, "CertifiedNumber")
        .def_readonly("value", &CertifiedNumber::value)
        .def_readonly("radius", &CertifiedNumber::radius)
        .def_readonly("digits", &CertifiedNumber::digits);
    py::class_<CertifiedReference>(module, "CertifiedReference")
        .def_readonly("available", &CertifiedReference::available)
        .def_readonly("message", &CertifiedReference::message)
        .def_readonly("digits", &CertifiedReference::digits)
        .def_readonly("radius", &CertifiedReference::radius)
        .def_readonly("times", &CertifiedReference::times)
        .def_readonly("bodies", &CertifiedReference::bodies)
        .def_readonly("columns", &CertifiedReference::columns)
        .def_readonly("scene_hash", &CertifiedReference::scene_hash);
    module.def("decimals", &decimals_of);
    module.def("certified", &certified_of);
    module.def("errors", &errors_of);
    module.def("check", &check_texts);
    module.def("measures", &measures_list);
}

}  // namespace polhode::python
