// Pages of lessons.
#include "python/bindings.h"
#include "report/lessons.h"
#include "report/report.h"

namespace polhode::python {

void bind_lessons(py::module_& module) {
    // writes the page of a built-in lesson or a lesson file
    module.def("write_lesson_page", [](const std::string& lesson, const std::string& output) {
        return call([&] { return write_lesson_page(lesson, output).path; });
    });
    module.def("lesson_names", &builtin_lesson_names);
}

}  // namespace polhode::python
