// Fuzzes the reader of ensemble tables in NumPy's format; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::npy({reinterpret_cast<const char*>(data), size});
    return 0;
}
