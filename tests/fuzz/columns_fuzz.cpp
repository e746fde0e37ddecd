// Fuzzes column names: a line of `--columns` followed by a table that has them; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::columns({reinterpret_cast<const char*>(data), size});
    return 0;
}
