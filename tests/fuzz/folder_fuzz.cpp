// Any bytes as the files of a folder of results: see folder_oracle.h.
#include "fuzz/folder_oracle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::folder({reinterpret_cast<const char*>(data), size});
    return 0;
}
