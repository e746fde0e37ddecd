// Fuzzes the reader of files of the truth cache; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::cache({reinterpret_cast<const char*>(data), size});
    return 0;
}
