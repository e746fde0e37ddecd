// Fuzzes the readers of engine messages and of files that list engines; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::engine({reinterpret_cast<const char*>(data), size});
    return 0;
}
