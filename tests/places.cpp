#include "places.h"

namespace polhode {

std::string source_dir() { return POLHODE_SOURCE_DIR; }
std::string program_path() { return POLHODE_PROGRAM; }

}  // namespace polhode
