// Replacement for gsl.cpp. The linker does not use it in programs that link the object file of gsl.cpp.
#include "integrators/gsl/gsl.h"

namespace polhode {

const std::span<const Method> gsl_methods{};

std::string gsl_library_version() { return ""; }

}  // namespace polhode
