// Any bytes as a tape: machine code and the interpreters give the same bits (tests/integrators/tape/tape_oracle.h).
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::tape({reinterpret_cast<const char*>(data), size});
    return 0;
}
