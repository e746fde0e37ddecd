// Fuzzes the readers of trajectory files and of --convention; see oracles.h.
#include "fuzz/oracles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    polhode::oracles::trajectory(text);
    polhode::oracles::convention(text);
    return 0;
}
