// The program as a library: its commands and experiments, for programs with user-defined methods.
#pragma once

#include <span>

#include "integrators/method.h"

namespace polhode {

/// Runs the command line like `polhode` and returns the exit code. The methods `own` are added after polhode's methods:
/// `list methods` lists them, `solve` accepts them, and `run` compares them with the others. Throws
/// std::invalid_argument if a name is taken. Call it once per process. Results are stored separately for each program
/// and each version of it.
///
///     int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv, {&my_method, 1}); }
int run_laboratory(int argc, const char* const* argv, std::span<const Method> own = {});

}  // namespace polhode
