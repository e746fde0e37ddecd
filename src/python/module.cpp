// The extension module _polhode: numbers and texts. src/python/polhode is the public package.
#include "app/commands.h"
#include "check/check_files.h"
#include "python/bindings.h"
#include "text/message.h"

namespace polhode::python {
namespace {

// Exceptions have the messages of the program.
void bind_exceptions(py::module_& module) {
    const auto named = [](py::handle type, const char* about) {
        type.attr("__module__") = "polhode";
        type.attr("__doc__") = about;
    };
    named(py::register_exception<InputError>(module, "InputError", PyExc_ValueError),
          "Invalid scene, file, name or setting. The message is one line with place, fault and remedy.");
    named(py::register_exception<TruthUnavailable>(module, "NoTruthError", PyExc_RuntimeError),
          "The truth is not available. The message states the reason.");
    py::register_exception_translator(
        [](std::exception_ptr pointer) {  // NOLINT(performance-unnecessary-value-param): pybind11's signature
            try {
                if (pointer) std::rethrow_exception(pointer);
            } catch (const UsageError& error) {
                PyErr_SetString(py::module_::import("polhode._polhode").attr("InputError").ptr(), error.what());
            }
        });
}

}  // namespace
}  // namespace polhode::python

PYBIND11_MODULE(_polhode, module) {
    using namespace polhode::python;
    module.attr("__version__") = POLHODE_VERSION;
    bind_exceptions(module);
    bind_scenes(module);
    bind_solving(module);
    bind_truth(module);
    bind_contacts(module);
    bind_ensembles(module);
    bind_user_methods(module);
    bind_experiments(module);
    bind_measuring(module);
    bind_sensitivity(module);
    bind_lessons(module);
}
