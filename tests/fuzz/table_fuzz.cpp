// Fuzzes the reader of result tables; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::table({reinterpret_cast<const char*>(data), size});
    return 0;
}
