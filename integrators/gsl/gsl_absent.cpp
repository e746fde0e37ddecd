// In place of gsl.cpp. What is linked with gsl.cpp's object file never asks the library for this one.
#include "integrators/gsl/gsl.h"

namespace polhode {

const std::span<const Method> gsl_methods{};

std::string gsl_library_version() { return ""; }

}  // namespace polhode
