// Any bytes as trajectory files: see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::trajectory({reinterpret_cast<const char*>(data), size});
    return 0;
}
