// Any bytes as what an engine says, and as files that name engines: see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::engine({reinterpret_cast<const char*>(data), size});
    return 0;
}
