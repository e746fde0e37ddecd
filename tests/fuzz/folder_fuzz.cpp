// Fuzzes the reader of results folders; see folder_oracle.h.
#include "fuzz/folder_oracle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::folder({reinterpret_cast<const char*>(data), size});
    return 0;
}
