// Fuzzes the reader of experiment files. Most inputs are JSON made of parts of the built-in experiments; see oracles.h.
#include "fuzz/oracles.h"
#include "fuzz/structured.h"

namespace {

const polhode::fuzz::JsonMutator& mutator() {
    static const polhode::fuzz::JsonMutator one = polhode::fuzz::mutator_of(polhode::builtin_experiments());
    return one;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    polhode::oracles::experiment({reinterpret_cast<const char*>(data), size});
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
    return polhode::fuzz::mutated(mutator(), data, size, most, seed);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* first, std::size_t first_size,
                                                 const std::uint8_t* second, std::size_t second_size, std::uint8_t* out,
                                                 std::size_t most, unsigned seed) {
    return polhode::fuzz::crossed(mutator(), {reinterpret_cast<const char*>(first), first_size},
                                  {reinterpret_cast<const char*>(second), second_size}, out, most, seed);
}
