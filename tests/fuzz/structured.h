// Connects the structured JSON mutator to libFuzzer, for the one target that includes this header. A non-empty
// $POLHODE_PLAIN_MUTATOR selects libFuzzer's own mutator, for comparison.
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

/// A mutator with these texts as examples.
inline JsonMutator mutator_of(std::span<const BuiltinText> texts) {
    std::vector<std::string_view> examples;
    for (const BuiltinText& one : texts) examples.push_back(one.text);
    return JsonMutator(examples);
}

inline std::size_t mutated(const JsonMutator& mutator, std::uint8_t* data, std::size_t size, std::size_t most,
                           unsigned seed) {
    return is_plain() ? LLVMFuzzerMutate(data, size, most) : mutator.mutate(data, size, most, seed, LLVMFuzzerMutate);
}

/// Replaces a part of the first input by one of the second. If that is impossible, changes the bytes of the first.
inline std::size_t crossed(const JsonMutator& mutator, std::string_view first, std::string_view second,
                           std::uint8_t* out, std::size_t most, unsigned seed) {
    if (!is_plain())
        if (const std::size_t size = mutator.cross(first, second, out, most, seed); size > 0) return size;
    const std::size_t size = std::min(first.size(), most);
    std::copy_n(first.data(), size, out);
    return LLVMFuzzerMutate(out, size, most);
}

}  // namespace polhode::fuzz
