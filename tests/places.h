// Paths used by the tests. These are functions, not macros, so that compiled tests are identical in every checkout.
#pragma once

#include <string>

namespace polhode {

/// The root of the source tree.
std::string source_dir();
/// The program of the tested build.
std::string program_path();

}  // namespace polhode
