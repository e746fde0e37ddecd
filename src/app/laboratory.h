// The program as a library: its commands and experiments, for a program of one's own with methods of one's own.
#pragma once

#include <span>

#include "integrators/method.h"

namespace polhode {

/// What `polhode` does with its command line, and the exit code. The methods given stand behind polhode's own: `list
/// methods` names them, `solve` takes them, and `run` measures them beside the others. Their names must be free:
/// throws std::invalid_argument. Once a process. Results of such a program are kept apart from other programs', and
/// from its own of before it was last changed.
///
///     int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv, {&my_method, 1}); }
int run_laboratory(int argc, const char* const* argv, std::span<const Method> own = {});

}  // namespace polhode
