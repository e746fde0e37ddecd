// Fuzzes the readers of numbers, quoted texts and regular expressions; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::words({reinterpret_cast<const char*>(data), size});
    return 0;
}
