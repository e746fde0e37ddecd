// Builds a tape from the input; machine code and interpreters must agree bit for bit
// (integrators/tape/tape_oracle.h).
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::tape({reinterpret_cast<const char*>(data), size});
    return 0;
}
