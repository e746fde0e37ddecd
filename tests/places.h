// Where the tests' own files are. Functions and not macros: a compiled test is the same in every checkout.
#pragma once

#include <string>

namespace polhode {

/// The root of the source tree.
std::string source_dir();
/// The program of the build that is tested.
std::string program_path();

}  // namespace polhode
