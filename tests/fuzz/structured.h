// The structured mutator as libFuzzer calls it, for the one target that includes this. $POLHODE_PLAIN_MUTATOR, not
// empty, leaves all to libFuzzer's own: to compare.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "fuzz/json_mutator.h"
#include "scene/builtin.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace polhode::fuzz {

inline bool is_plain() {
    static const char* const asked = std::getenv("POLHODE_PLAIN_MUTATOR");
    return asked != nullptr && *asked != '\0';
}

/// The mutator that has the texts for examples.
inline JsonMutator mutator_of(std::span<const BuiltinText> texts) {
    std::vector<std::string_view> examples;
    for (const BuiltinText& one : texts) examples.push_back(one.text);
    return JsonMutator(examples);
}

inline std::size_t mutated(const JsonMutator& mutator, std::uint8_t* data, std::size_t size, std::size_t most,
                           unsigned seed) {
    return is_plain() ? LLVMFuzzerMutate(data, size, most) : mutator.mutate(data, size, most, seed, LLVMFuzzerMutate);
}

/// A part of one in the other; where that gives nothing, the first with its bytes changed.
inline std::size_t crossed(const JsonMutator& mutator, std::string_view first, std::string_view second,
                           std::uint8_t* out, std::size_t most, unsigned seed) {
    if (!is_plain())
        if (const std::size_t size = mutator.cross(first, second, out, most, seed); size > 0) return size;
    const std::size_t size = std::min(first.size(), most);
    std::copy_n(first.data(), size, out);
    return LLVMFuzzerMutate(out, size, most);
}

}  // namespace polhode::fuzz
