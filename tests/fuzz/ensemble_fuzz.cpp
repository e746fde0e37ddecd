// Fuzzes the reader of ensemble tables (CSV); see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::ensemble({reinterpret_cast<const char*>(data), size});
    return 0;
}
