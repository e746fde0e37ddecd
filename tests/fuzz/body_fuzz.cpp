// Fuzzes the readers of meshes and robot files; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::body({reinterpret_cast<const char*>(data), size});
    return 0;
}
