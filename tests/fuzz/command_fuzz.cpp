// Fuzzes the command line, one word per line of the input; see command_oracle.h.
#include "fuzz/command_oracle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::command({reinterpret_cast<const char*>(data), size});
    return 0;
}
